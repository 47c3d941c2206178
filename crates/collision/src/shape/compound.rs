//! Several geometries as one.
//!
//! # Method
//! A compound is the union of its parts, each a geometry at a pose. Parts are shared, never copied: what a question made a
//! part build serves every compound and every shape it is in. A tree over the boxes of the parts is built when a question
//! first needs it.
//!
//! ```text
//!   compound            leaves, depth first
//!   ├─ box              0
//!   ├─ compound
//!   │  ├─ mesh          1
//!   │  └─ sphere        2
//!   └─ hull             3
//! ```

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use glam::DQuat;

use super::{
    Form, Geometry,
    bounds::{farthest_of_part, part_bounds},
    built::Structure,
    ladder::Ladder,
    lazy::Lazy,
    limits::{AXES, GeometryError, Limits, check_count, check_finite, out_of_limits},
};
use crate::{
    broad::StaticTree,
    math::{Aabb, Pose},
};

/// A geometry in a compound.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its form; no half space.
    pub geometry: Arc<Geometry>,
    /// Where it is in the compound.
    pub pose: Pose,
}

/// The union of several geometries.
#[derive(Debug)]
pub struct Compound {
    parts: Vec<Part>,
    /// For each part the number of its first leaf.
    first_leaves: Vec<u32>,
    leaf_count: u32,
    depth: u32,
    has_surface: bool,
    tree: Lazy<StaticTree>,
    ladder: Ladder,
}

impl Compound {
    /// `parts` are checked but for the depth and number of what they consist of.
    fn new(parts: Vec<Part>) -> Result<Self, GeometryError> {
        let mut compound = Self {
            first_leaves: Vec::with_capacity(parts.len()),
            leaf_count: 0,
            depth: 1,
            has_surface: false,
            parts: Vec::new(),
            tree: Lazy::default(),
            ladder: Ladder::default(),
        };
        for (index, part) in parts.iter().enumerate() {
            compound.first_leaves.push(compound.leaf_count);
            let (leaf_count, depth, has_surface) = match part.geometry.form() {
                Form::Compound(inner) => (inner.leaf_count, inner.depth + 1, inner.has_surface),
                Form::Mesh(_) => (1, 1, true),
                Form::Convex(_) | Form::HeightField(_) | Form::HalfSpace(_) => (1, 1, false),
            };
            if depth > Limits::COMPOUND_DEPTH {
                return Err(GeometryError::Bad {
                    field: format!("parts[{index}].geometry"),
                    reason: "is a compound of 4 levels already: compounds may hold compounds, 4 deep in all, so place inner parts in the outer one".into(),
                });
            }
            compound.leaf_count += leaf_count;
            compound.depth = compound.depth.max(depth);
            compound.has_surface |= has_surface;
            let (found, most) = (compound.leaf_count as usize, Limits::COMPOUND_PARTS);
            if found > most {
                return Err(GeometryError::TooMany { field: format!("parts[{index}]"), found, most });
            }
        }
        compound.parts = parts;
        Ok(compound)
    }

    /// The parts, in the order sent.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The number of the first leaf of a part: leaves are what is no compound, counted depth first.
    #[must_use]
    pub fn first_leaf(&self, part: usize) -> u32 {
        self.first_leaves[part]
    }

    /// How many leaves there are, with those of compounds in it.
    #[must_use]
    pub fn leaf_count(&self) -> u32 {
        self.leaf_count
    }

    /// How many compounds are in each other, this one included.
    #[must_use]
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Whether there is a surface of triangles in it.
    pub(crate) fn has_surface(&self) -> bool {
        self.has_surface
    }

    /// The tree over the boxes of its parts; built when a question first needs it. Leaves are parts.
    #[must_use]
    pub fn tree(&self) -> &StaticTree {
        self.tree.get_or_build(|| {
            let boxes: Vec<Aabb> = self.parts.iter().map(|part| part.geometry.bounds(&part.pose)).collect();
            StaticTree::build(&boxes)
        })
    }

    /// The tree, if a question has needed it.
    #[must_use]
    pub fn built_tree(&self) -> Option<&StaticTree> {
        self.tree.built()
    }

    /// Bytes held now, without its parts: its lists, and its tree if that is built.
    #[must_use]
    pub fn own_bytes(&self) -> u64 {
        let lists = size_of_val(self.parts.as_slice()) + size_of_val(self.first_leaves.as_slice());
        (size_of::<Self>() + lists) as u64
            + self.ladder.memory_bytes()
            + self.tree.built().map_or(0, StaticTree::memory_bytes)
    }

    /// What questions made it build for itself, stand-ins aside.
    pub(super) fn structure(&self) -> Option<Structure> {
        let tree_bytes = self.built_tree().map_or(0, StaticTree::memory_bytes);
        Structure::of("compound_tree", tree_bytes, [self.tree.receipt()])
    }

    /// What may stand in for it.
    pub(super) fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    /// The box of all parts, rounded outwards.
    pub(super) fn bounds(&self) -> Aabb {
        part_bounds(self.parts.iter().map(|part| part.geometry.bounds(&part.pose)))
    }

    /// No point is farther from the local origin; rounded up.
    pub(super) fn reach(&self) -> f64 {
        let reaches = self.parts.iter().map(|part| farthest_of_part(part.pose.position, part.geometry.reach()));
        reaches.fold(0.0, f64::max)
    }

    /// Each part and its place `scale` times as large. Parts that were one stay one.
    pub(super) fn scaled(&self, scale: f64) -> Result<Self, GeometryError> {
        let mut made: HashMap<*const Geometry, Arc<Geometry>> = HashMap::new();
        let mut parts = Vec::with_capacity(self.parts.len());
        for Part { geometry, pose } in &self.parts {
            let scaled = match made.get(&Arc::as_ptr(geometry)) {
                Some(known) => known.clone(),
                None => Arc::new(Geometry::clone(geometry).scaled(scale)?),
            };
            made.insert(Arc::as_ptr(geometry), scaled.clone());
            parts.push(Part { geometry: scaled, pose: Pose::new(pose.position * scale, pose.rotation) });
        }
        Self::new(parts)
    }
}

/// The geometries and all that they consist of, each once however often it is shared.
#[must_use]
pub fn distinct<'a>(geometries: impl IntoIterator<Item = &'a Arc<Geometry>>) -> Vec<&'a Arc<Geometry>> {
    let (mut seen, mut found) = (HashSet::new(), Vec::new());
    let mut open: Vec<&Arc<Geometry>> = geometries.into_iter().collect();
    while let Some(geometry) = open.pop() {
        if seen.insert(Arc::as_ptr(geometry)) {
            found.push(geometry);
            if let Form::Compound(compound) = geometry.form() {
                open.extend(compound.parts.iter().map(|part| &part.geometry));
            }
        }
    }
    found
}

impl Geometry {
    /// The union of several geometries, each at a pose in the frame of the compound. A compound may hold compounds, up to
    /// [`Limits::COMPOUND_DEPTH`] deep, and no half space.
    ///
    /// Distances and first touches are those of the best part, contacts those of all parts.
    ///
    /// # Errors
    /// No part, too many, too deep, a half space, a pose that is not finite or out of limits.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use collision::{DVec3, accuracy::Accuracy, answer::Work, math::Pose, narrow, shape::{Geometry, Part}};
    /// let ball = Arc::new(Geometry::sphere(1.0).unwrap());
    /// let part = |x| Part { geometry: ball.clone(), pose: Pose::at(DVec3::X * x) };
    /// let dumbbell = Geometry::compound(vec![part(-3.0), part(3.0)]).unwrap();
    /// let point = Geometry::point();
    /// let [a, b] = [&point, &dumbbell].map(|geometry| narrow::Placed { geometry, pose: Pose::IDENTITY });
    /// let apart = narrow::distance(a, b, 4e12, &Accuracy::default(), &mut Work::default()).unwrap();
    /// assert_eq!((apart.distance, apart.feature_b.part), (2.0, Some(0)));
    /// ```
    pub fn compound(parts: Vec<Part>) -> Result<Self, GeometryError> {
        check_count("parts", parts.len(), Limits::COMPOUND_PARTS, "a compound needs 1 to 65536 parts")?;
        for (index, part) in parts.iter().enumerate() {
            if matches!(part.geometry.form(), Form::HalfSpace(_)) {
                return Err(GeometryError::Bad {
                    field: format!("parts[{index}].geometry"),
                    reason: "is a half space, which has no end: place it as a shape of its own".into(),
                });
            }
            check_pose(index, &part.pose)?;
        }
        Self::of_compound(Compound::new(parts)?, "parts")
    }

    pub(super) fn of_compound(compound: Compound, field: &str) -> Result<Self, GeometryError> {
        let made = Self::of(Form::Compound(Arc::new(compound)));
        let bounds = made.local_bounds();
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        if farthest > Limits::COORDINATE {
            let allowed = "such that all parts stay within 1e12 metres of the local origin";
            return Err(out_of_limits(field.into(), farthest, allowed));
        }
        Ok(made)
    }
}

fn check_pose(index: usize, pose: &Pose) -> Result<(), GeometryError> {
    for (axis, value) in pose.position.to_array().into_iter().enumerate() {
        let field = || format!("parts[{index}].pose.position.{}", AXES[axis]);
        check_finite(field, value)?;
        if value.abs() > Limits::COORDINATE {
            return Err(out_of_limits(field(), value, "within 1e12 metres of 0"));
        }
    }
    for (axis, value) in ["x", "y", "z", "w"].into_iter().zip(pose.rotation.to_array()) {
        check_finite(|| format!("parts[{index}].pose.rotation.{axis}"), value)?;
    }
    if pose.rotation == DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0) {
        return Err(GeometryError::Bad {
            field: format!("parts[{index}].pose.rotation"),
            reason: "is (0, 0, 0, 0): it may have any length but 0".into(),
        });
    }
    Ok(())
}
