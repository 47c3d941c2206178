//! What a version of a world holds, what was built for it, and what that costs.

use std::sync::Arc;

use super::{Settings, Snapshot, Tick, Time};
use crate::{
    answer::Representation,
    broad::StaticTree,
    math::Aabb,
    shape::{Form, Geometry, distinct},
};

/// What a version holds, what was built for it and what that costs.
#[derive(Clone, Debug)]
pub struct Description {
    /// The version.
    pub tick: Tick,
    /// The oldest tick that can be asked.
    pub oldest_tick: Tick,
    /// When it was made.
    pub time: Time,
    /// The settings in force.
    pub settings: Settings,
    /// Shapes.
    pub shape_count: u64,
    /// Of those, the static ones.
    pub static_count: u64,
    /// Canonical bounds of all shapes; `None` in an empty world.
    pub bounds: Option<Aabb>,
    /// Surface-area cost of the dynamic tree, 1 being that of a fresh one.
    pub tree_cost: f64,
    /// Levels of the dynamic tree.
    pub tree_depth: u32,
    /// What was built.
    pub built: Vec<BuiltStructure>,
    /// All memory the version holds, bytes.
    pub memory_bytes: u64,
}

/// Something that was built because a question or an edit first needed it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuiltStructure {
    /// `dynamic_tree`, `static_tree`, `mesh_tree`, `compound_tree`, `ball_and_box`, `simplified_hull` and `decomposition` (what stands
    /// in for geometries; the last are the convex parts that meshes bring or that questions had made), `history` (its ticks), `past_trees` (what questions to the past had built).
    pub name: &'static str,
    /// How many of them.
    pub count: u64,
    /// What they hold in memory, bytes.
    pub memory_bytes: u64,
    /// What it took to build them in all versions so far, nanoseconds; `None` for what grows edit by edit, and in a world
    /// without a clock.
    pub build_ns: Option<u64>,
    /// The tick at which the first was needed; `None` where that is not kept.
    pub first_tick: Option<Tick>,
}

impl Snapshot {
    /// What it holds and what was built for it. Costs a pass over all shapes, and the building of a tree over the moving
    /// ones, which the dynamic tree is compared with: about 0.5 µs a shape.
    #[must_use]
    pub fn describe(&self) -> Description {
        let state = self.state();
        let mut bounds: Option<Aabb> = None;
        let mut moving_boxes = Vec::with_capacity(state.moving.len());
        let mut geometries: Vec<&Arc<Geometry>> = Vec::with_capacity(self.len());
        for (_, entry) in state.shapes.iter() {
            bounds = Some(bounds.map_or(entry.bounds, |bounds| bounds.union(entry.bounds)));
            geometries.push(&entry.shape.geometry);
            if !entry.is_static() {
                moving_boxes.push(entry.bounds);
            }
        }
        let trees = self.structures();
        let geometries = distinct(geometries);
        let geometry_bytes: u64 = geometries.iter().map(|geometry| geometry.own_bytes()).sum();
        let tree_bytes: u64 = trees.iter().map(|structure| structure.memory_bytes).sum();
        let built = trees.into_iter().chain(built_in(&geometries)).collect();
        Description {
            tick: self.tick,
            oldest_tick: self.oldest_tick(),
            time: self.time,
            settings: self.settings,
            shape_count: self.len() as u64,
            static_count: state.static_count as u64,
            bounds,
            tree_cost: cost_ratio(state.moving.area_sum(), StaticTree::build(&moving_boxes).area_sum()),
            tree_depth: state.moving.depth(),
            built,
            memory_bytes: tree_bytes + geometry_bytes + state.shapes.memory_bytes() + state.ids.memory_bytes(),
        }
    }

    /// What its history holds, and what questions to the past had built, bytes; geometries not.
    #[must_use]
    pub fn past_memory_bytes(&self) -> u64 {
        let history = if self.history.len() > 0 { self.history.memory_bytes() } else { 0 };
        history + self.kept.holds(self.state()).1
    }

    /// All but what geometries hold.
    fn structures(&self) -> Vec<BuiltStructure> {
        let state = self.state();
        let mut built = Vec::new();
        if !state.moving.is_empty() {
            built.push(BuiltStructure {
                name: "dynamic_tree",
                count: 1,
                memory_bytes: state.moving.memory_bytes(),
                build_ns: None,
                first_tick: self.moving_since,
            });
        }
        if let Some(fixed) = state.fixed_if_built() {
            built.push(BuiltStructure {
                name: "static_tree",
                count: 1,
                memory_bytes: fixed.memory_bytes(),
                build_ns: state.fixed_ledger.nanoseconds(),
                first_tick: state.fixed_ledger.first_tick(),
            });
        }
        if self.history.len() > 0 {
            built.push(BuiltStructure {
                name: "history",
                count: self.history.len(),
                memory_bytes: self.history.memory_bytes(),
                build_ns: None,
                first_tick: self.history_since,
            });
        }
        let (count, memory_bytes) = self.kept.holds(state);
        if count > 0 {
            let (build_ns, first_tick) = (self.kept.ledger.nanoseconds(), self.kept.ledger.first_tick());
            built.push(BuiltStructure { name: "past_trees", count, memory_bytes, build_ns, first_tick });
        }
        built
    }
}

/// What geometries were needed to build so far; its memory is that of the geometries.
fn built_in(geometries: &[&Arc<Geometry>]) -> impl Iterator<Item = BuiltStructure> {
    let [mut meshes, mut compounds, mut fields] = ["mesh_tree", "compound_tree", "height_pyramid"].map(Sum::of);
    let [mut volumes, mut hulls, mut parts] = ["ball_and_box", "simplified_hull", "decomposition"].map(Sum::of);
    for geometry in geometries {
        for rung in geometry.stand_ins_built() {
            match rung.representation() {
                // Made together with the box.
                Representation::Ball => volumes.0.memory_bytes += rung.memory_bytes(),
                Representation::OrientedBox => volumes.add(Some(rung.memory_bytes())),
                Representation::SimplifiedHull => hulls.add(Some(rung.memory_bytes())),
                Representation::Decomposition | Representation::Exact => {}
            }
        }
        match geometry.form() {
            Form::Mesh(mesh) => {
                meshes.add(mesh.built_tree().map(StaticTree::memory_bytes));
                let cut = mesh.parts().into_iter().chain(mesh.all_made_parts());
                cut.for_each(|made| parts.add(Some(made.whole.memory_bytes())));
            }
            Form::Compound(compound) => compounds.add(compound.built_tree().map(StaticTree::memory_bytes)),
            Form::HeightField(field) => fields.add(field.built_bytes()),
            Form::Convex(_) | Form::HalfSpace(_) => {}
        }
    }
    [meshes, compounds, fields, volumes, hulls, parts]
        .into_iter()
        .map(|sum| sum.0)
        .filter(|structure| structure.count > 0)
}

/// All structures of one kind.
struct Sum(BuiltStructure);

impl Sum {
    fn of(name: &'static str) -> Self {
        Self(BuiltStructure { name, count: 0, memory_bytes: 0, build_ns: None, first_tick: None })
    }

    /// One more, if it is built.
    fn add(&mut self, bytes: Option<u64>) {
        self.0.count += u64::from(bytes.is_some());
        self.0.memory_bytes += bytes.unwrap_or(0);
    }
}

/// 1 where the fresh tree costs nothing: of points, or of nothing.
fn cost_ratio(found: f64, fresh: f64) -> f64 {
    if fresh > 0.0 { found / fresh } else { 1.0 }
}
