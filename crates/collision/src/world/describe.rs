//! What a version of a world holds, what was built for it, and what that costs.

use std::{collections::BTreeMap, sync::Arc};

use super::{Settings, Snapshot, Tick, Time};
use crate::{
    answer::Representation,
    broad::StaticTree,
    math::Aabb,
    shape::{Form, Geometry, Receipt, Structure, distinct},
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
    /// `dynamic_tree`, `static_tree`, `history` (its ticks), `past_trees` (what questions to the past had built); of geometries
    /// what [`Structure`] names, and what stands in for them: `ball_and_box`, `simplified_hull` and `decomposition` (the convex
    /// parts that meshes bring or that questions had made).
    pub name: &'static str,
    /// How many of them.
    pub count: u64,
    /// What they hold in memory, bytes.
    pub memory_bytes: u64,
    /// What it took to build them in all versions so far, nanoseconds; `None` for what grows edit by edit, and where no question
    /// with a clock had it built.
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
            geometries.push(&entry.shape().geometry);
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
    let mut sums = Sums::default();
    for geometry in geometries {
        for Structure { name, memory_bytes, receipt } in geometry.structures_built() {
            sums.add(name, memory_bytes, receipt);
        }
        for rung in geometry.stand_ins_built() {
            match rung.representation() {
                // Made together with the box, which says what both took.
                Representation::Ball => sums.of("ball_and_box").memory_bytes += rung.memory_bytes(),
                Representation::OrientedBox => sums.add("ball_and_box", rung.memory_bytes(), rung.receipt()),
                Representation::SimplifiedHull => sums.add("simplified_hull", rung.memory_bytes(), rung.receipt()),
                Representation::Decomposition | Representation::Exact => {}
            }
        }
        if let Form::Mesh(mesh) = geometry.form() {
            for cut in mesh.parts().into_iter().chain(mesh.all_made_parts()) {
                sums.add("decomposition", cut.whole.memory_bytes(), cut.receipt);
            }
        }
    }
    sums.0.into_values()
}

/// All structures of each kind, by name.
#[derive(Default)]
struct Sums(BTreeMap<&'static str, BuiltStructure>);

impl Sums {
    fn of(&mut self, name: &'static str) -> &mut BuiltStructure {
        let none = BuiltStructure { name, count: 0, memory_bytes: 0, build_ns: None, first_tick: None };
        self.0.entry(name).or_insert(none)
    }

    /// One more.
    fn add(&mut self, name: &'static str, memory_bytes: u64, receipt: Receipt) {
        let sum = self.of(name);
        sum.count += 1;
        sum.memory_bytes += memory_bytes;
        let before = Receipt { build_ns: sum.build_ns, first_tick: sum.first_tick.map(Tick::get) };
        let all = before.and(receipt);
        (sum.build_ns, sum.first_tick) = (all.build_ns, all.first_tick.and_then(Tick::new));
    }
}

/// 1 where the fresh tree costs nothing: of points, or of nothing.
fn cost_ratio(found: f64, fresh: f64) -> f64 {
    if fresh > 0.0 { found / fresh } else { 1.0 }
}
