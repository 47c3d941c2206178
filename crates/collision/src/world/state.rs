//! What a version of a world is made of, and the edits on it.

use std::{
    hint::black_box,
    sync::{Arc, OnceLock},
};

use smallvec::SmallVec;

use super::{
    Edit, Shape, ShapeId, Tick,
    directory::Directory,
    edit::Motion,
    history::Changes,
    ledger::Ledger,
    store::{Entry, Slot, Store},
};
use crate::{
    broad::{DynamicTree, StaticTree},
    math::{Aabb, Pose},
};

/// Shapes and the trees over them. Clones share everything until one of them writes.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    pub(super) shapes: Store,
    pub(super) ids: Directory,
    /// Over the dynamic and kinematic shapes; leaf numbers are slots.
    pub(super) moving: DynamicTree,
    pub(super) static_count: usize,
    /// Shapes whose moves are swept.
    pub(super) bullet_count: usize,
    /// Over the static shapes, built by the first question. Shared by all versions with the same static shapes.
    fixed: Arc<OnceLock<Fixed>>,
    /// What building the tree over the static shapes costs.
    pub(super) fixed_ledger: Arc<Ledger>,
    /// How fat the boxes of moving shapes are, metres; `None` tunes it for each.
    pub(super) margin: Option<f64>,
}

/// The tree over the static shapes.
#[derive(Debug, Default)]
pub(super) struct Fixed {
    pub(super) tree: StaticTree,
    /// The slot of each leaf.
    slots: Vec<Slot>,
}

impl Fixed {
    fn build(shapes: &Store) -> Self {
        let entries = shapes.iter().filter(|(_, entry)| entry.is_static());
        let (slots, boxes): (Vec<Slot>, Vec<(Aabb, u32)>) =
            entries.map(|(slot, entry)| (slot, (entry.bounds, entry.shape().layers))).unzip();
        Self { tree: StaticTree::build_on_layers(boxes.iter().copied()), slots }
    }

    /// The slot of a leaf.
    pub(super) fn slot(&self, leaf: u32) -> Slot {
        self.slots[leaf as usize]
    }

    /// Bytes it holds in memory.
    pub(super) fn memory_bytes(&self) -> u64 {
        self.tree.memory_bytes() + (self.slots.capacity() * size_of::<Slot>()) as u64
    }
}

/// How fat the box of a shape is, as a multiple of the way of its last move. At 3, a shape that goes straight on leaves
/// its fat box at every fourth tick; 2 to 4 measured best. Smaller changes the tree more often, larger offers more shapes
/// to the questions. Answers do not depend on it.
const MARGIN_PER_STEP: f64 = 3.0;

/// The fat margin at most, as a multiple of the largest extent of the box: a shape that goes far beyond its own size at
/// each tick leaves any fat box, and must not spoil the tree with a huge one.
const MARGIN_PER_EXTENT: f64 = 0.5;

/// Edits whose shapes are read together. More than a processor can wait for at once gain nothing.
pub(super) const READ_TOGETHER: usize = 32;

/// Shapes from which on that pays: of 100,000, moves cost a quarter less, of 10,000 they cost a twentieth more, as each is looked up
/// twice and hardly waited for.
const READ_AHEAD_MIN: usize = 1 << 15;

impl State {
    /// A shape and its box.
    pub(super) fn get(&self, id: ShapeId) -> Option<&Entry> {
        self.ids.get(id).map(|slot| self.shapes.entry(slot))
    }

    /// The tree over the static shapes, if it was built.
    pub(super) fn fixed_if_built(&self) -> Option<&Fixed> {
        self.fixed.get()
    }

    /// The tree over the static shapes; the first call builds it, for a question at `tick`.
    pub(super) fn fixed(&self, tick: Tick) -> &Fixed {
        self.fixed.get_or_init(|| self.fixed_ledger.time(tick, || Fixed::build(&self.shapes)))
    }

    /// Whether what is in a slot is in the dynamic tree.
    pub(super) fn is_moving(&self, slot: Slot) -> bool {
        self.shapes.get(slot).is_some_and(|entry| !entry.is_static())
    }

    /// The slots of the shapes in the dynamic tree.
    pub(super) fn moving_slots(&self) -> impl Iterator<Item = Slot> {
        self.shapes.iter().filter(|(_, entry)| !entry.is_static()).map(|(slot, _)| slot)
    }

    /// Bytes of the shapes, their order and the dynamic tree; what is shared included, geometries not.
    pub(super) fn memory_bytes(&self) -> u64 {
        self.shapes.memory_bytes() + self.ids.memory_bytes() + self.moving.memory_bytes()
    }

    /// The same less what `other` shares, and the static tree if it does not share that.
    pub(super) fn bytes_beside(&self, other: &Self) -> u64 {
        let own_fixed = if Arc::ptr_eq(&self.fixed, &other.fixed) { None } else { self.fixed.get() };
        self.shapes.bytes_beside(&other.shapes)
            + self.ids.bytes_beside(&other.ids)
            + self.moving.bytes_beside(&other.moving)
            + own_fixed.map_or(0, Fixed::memory_bytes)
    }

    /// Reads what some edits will want, so that they need not wait for it one after the other. Changes nothing.
    pub(super) fn read_ahead(&self, edits: &[Edit]) {
        if self.shapes.len() < READ_AHEAD_MIN {
            return;
        }
        let ids = edits.iter().filter_map(|edit| match edit {
            Edit::Move { id, .. } | Edit::Remove(id) => Some(*id),
            Edit::Insert(_) | Edit::Clear => None,
        });
        let slots: SmallVec<[Slot; READ_TOGETHER]> = ids.filter_map(|id| self.ids.get(id)).collect();
        black_box(slots.iter().fold(0, |all, &slot| all ^ self.shapes.entry(slot).read_ahead()));
        self.moving.read_ahead(slots.iter().map(|slot| slot.0));
    }

    /// Applies one edit and says how many shapes it changed; `Err` names the shape that it needs and that is not there.
    pub(super) fn apply(&mut self, edit: Edit, changes: &mut Changes) -> Result<u64, ShapeId> {
        match edit {
            Edit::Insert(shape) => {
                self.insert(shape, changes);
                Ok(1)
            }
            Edit::Move { id, position, rotation, velocity, angular_velocity, teleport } => {
                let slot = self.ids.get(id).ok_or(id)?;
                let motion = if teleport { Motion::Teleported } else { Motion::Travelled };
                let shape = self.shapes.entry_mut(slot).shape_mut();
                let velocity = velocity.unwrap_or(shape.velocity);
                let angular_velocity = angular_velocity.unwrap_or(shape.angular_velocity);
                changes.moves(slot, shape, [velocity, angular_velocity], motion);
                (shape.velocity, shape.angular_velocity) = (velocity, angular_velocity);
                let pose = Pose {
                    position: position.unwrap_or(shape.pose.position),
                    rotation: rotation.unwrap_or(shape.pose.rotation),
                };
                self.place(slot, pose, motion);
                Ok(1)
            }
            Edit::Remove(id) => Ok(u64::from(self.remove(id, changes))),
            Edit::Clear => {
                let count = self.shapes.len() as u64;
                self.shapes.iter().for_each(|(slot, entry)| changes.empties(slot, entry.shape()));
                let fixed_ledger = Arc::clone(&self.fixed_ledger);
                *self = Self { fixed_ledger, margin: self.margin, ..Self::default() };
                Ok(count)
            }
        }
    }

    /// Puts in a shape; one with the same id is replaced whole.
    pub(super) fn insert(&mut self, shape: Shape, changes: &mut Changes) {
        self.remove(shape.id, changes);
        let id = shape.id;
        self.bullet_count += usize::from(shape.bullet);
        let (bounds, layers) = (shape.geometry.bounds(&shape.pose), shape.layers);
        let entry = Entry::new(shape, bounds);
        let is_static = entry.is_static();
        let slot = self.shapes.insert(entry);
        self.ids.insert(id, slot);
        changes.fills(slot);
        if is_static {
            self.static_count += 1;
            self.forget_fixed();
        } else {
            // How fast it moves is not known yet, and most shapes of a level never do.
            self.moving.insert(slot.0, bounds, self.margin.unwrap_or(0.0), layers);
        }
    }

    /// Takes out a shape and says whether it was there.
    pub(super) fn remove(&mut self, id: ShapeId, changes: &mut Changes) -> bool {
        let Some(slot) = self.ids.remove(id) else {
            return false;
        };
        let entry = self.shapes.entry(slot);
        changes.empties(slot, entry.shape());
        self.bullet_count -= usize::from(entry.shape().bullet);
        if entry.is_static() {
            self.static_count -= 1;
            self.forget_fixed();
        } else {
            self.moving.remove(slot.0);
        }
        self.shapes.remove(slot);
        true
    }

    fn place(&mut self, slot: Slot, pose: Pose, motion: Motion) {
        let entry = self.shapes.entry_mut(slot);
        if entry.shape().pose == pose {
            // Equal, but perhaps −0 for 0: what was sent is what is kept.
            entry.shape_mut().pose = pose;
            return;
        }
        let bounds = entry.shape().geometry.bounds(&pose);
        let step = match motion {
            Motion::Travelled => bounds.center().distance(entry.bounds.center()),
            Motion::Teleported => 0.0,
        };
        entry.shape_mut().pose = pose;
        entry.bounds = bounds;
        if entry.is_static() {
            self.forget_fixed();
        } else {
            let extent = (bounds.max - bounds.min).max_element();
            let margin = self.margin.unwrap_or((MARGIN_PER_STEP * step).min(MARGIN_PER_EXTENT * extent));
            self.moving.update(slot.0, bounds, margin);
        }
    }

    /// The static shapes changed: the next question builds their tree anew. Versions that were handed out keep theirs.
    fn forget_fixed(&mut self) {
        if Arc::strong_count(&self.fixed) > 1 || self.fixed.get().is_some() {
            self.fixed = Arc::default();
        }
    }
}
