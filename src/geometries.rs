//! A session's geometries: each is kept once, by the hash of its content.

use std::{
    collections::{BTreeMap, HashMap},
    ops::Bound::{Excluded, Unbounded},
    sync::{Arc, Weak},
};

use collision::{
    shape::{Geometry, GeometryId, distinct},
    world::Snapshot,
};
use parking_lot::Mutex;

use crate::{
    building::{Building, Stage},
    problem::{Checked, Problem, Reason, quoted},
};

/// Rough memory of one shape in a world besides its geometry: itself, its leaf and its box.
const SHAPE_BYTES: u64 = 512;
/// Shapes looked at in one go when uses are counted.
const PAGE: usize = 4096;

/// The geometries of a session.
#[derive(Debug)]
pub(crate) struct Geometries {
    held: Mutex<Held>,
    quotas: Quotas,
}

/// What geometries may take.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quotas {
    /// Memory of geometries and shapes, bytes.
    pub(crate) bytes: u64,
    /// Steps that the convex parts of one mesh may take.
    pub(crate) decompose_steps: u64,
}

impl Quotas {
    /// Whatever they take.
    pub(crate) const NONE: Self = Self { bytes: u64::MAX, decompose_steps: u64::MAX };
}

#[derive(Debug, Default)]
struct Held {
    registered: BTreeMap<GeometryId, Arc<Geometry>>,
    /// Written in place somewhere; held by the shapes and compounds that use them, and shared between equal ones.
    in_place: HashMap<GeometryId, Weak<Geometry>>,
    /// How many may be in `in_place` before those nobody holds any more are dropped.
    sweep_at: usize,
    /// What they held when they were last counted, and all that came since.
    counted_bytes: u64,
    /// Room for those that are being uploaded or cut.
    promised_bytes: u64,
    /// Those that are being cut, and those that could not be.
    building: BTreeMap<GeometryId, Arc<Building>>,
}

impl Held {
    const SWEEP_LEAST: usize = 1024;

    fn find(&self, id: GeometryId) -> Option<Arc<Geometry>> {
        let in_place = || self.in_place.get(&id).and_then(Weak::upgrade);
        self.registered.get(&id).cloned().or_else(in_place)
    }

    fn sweep(&mut self) {
        if self.in_place.len() >= self.sweep_at.max(Self::SWEEP_LEAST) {
            self.in_place.retain(|_, geometry| geometry.strong_count() > 0);
            self.sweep_at = self.in_place.len() * 2;
        }
    }

    /// Counts what they hold now. Costs a pass over all of them.
    fn count_bytes(&mut self) -> u64 {
        let in_place: Vec<Arc<Geometry>> = self.in_place.values().filter_map(Weak::upgrade).collect();
        let all = distinct(in_place.iter().chain(self.registered.values()));
        self.counted_bytes = all.into_iter().map(|geometry| geometry.own_bytes()).sum();
        self.counted_bytes
    }

    /// Lets go of one that is being cut, and calls it off.
    fn drop_building(&mut self, id: GeometryId) {
        if let Some(building) = self.building.remove(&id) {
            self.promised_bytes -= building.promised_bytes();
            building.set(Stage::Forgotten);
        }
    }

    /// Whether they and `more` bytes are within the quota; counts again before it says no.
    fn check_quota(&mut self, more: u64, quota_bytes: u64) -> Checked<()> {
        let more = self.promised_bytes + more;
        if self.counted_bytes + more <= quota_bytes {
            return Ok(());
        }
        let used = self.count_bytes() + more;
        if used <= quota_bytes {
            return Ok(());
        }
        let what = format!(
            "the session would hold about {used} bytes and may hold {quota_bytes}: remove shapes, delete geometries, or \
             raise session_memory_bytes"
        );
        Err(Problem::new(Reason::QuotaExceeded, what).with("quota", "session_memory_bytes").with("limit", quota_bytes))
    }
}

/// A geometry that has an id.
#[derive(Clone, Debug)]
pub(crate) enum Known {
    /// It can be placed.
    Ready(Arc<Geometry>),
    /// It is being cut into parts, or could not be.
    InWork(Arc<Building>),
}

impl Known {
    /// Its id.
    pub(crate) fn id(&self) -> GeometryId {
        match self {
            Self::Ready(geometry) => geometry.id(),
            Self::InWork(building) => building.id,
        }
    }
}

/// Room that is held until this is dropped.
#[derive(Debug)]
pub(crate) struct Room<'a> {
    geometries: &'a Geometries,
    bytes: u64,
}

impl Drop for Room<'_> {
    fn drop(&mut self) {
        self.geometries.held.lock().promised_bytes -= self.bytes;
    }
}

impl Geometries {
    /// None yet.
    pub(crate) fn new(quotas: Quotas) -> Self {
        Self { held: Mutex::default(), quotas }
    }

    /// Steps that the convex parts of one mesh may take.
    pub(crate) fn decompose_steps(&self) -> u64 {
        self.quotas.decompose_steps
    }

    /// The same geometries for a copy of the world, which may forget them and register others.
    pub(crate) fn fork(&self) -> Self {
        let held = self.held.lock();
        let held = Held {
            registered: held.registered.clone(),
            in_place: held.in_place.clone(),
            sweep_at: held.sweep_at,
            counted_bytes: held.counted_bytes,
            promised_bytes: 0,
            // What is in work is begun anew by the caller.
            building: BTreeMap::new(),
        };
        Self { held: Mutex::new(held), quotas: self.quotas }
    }

    /// A place for geometries that come with a world, of which it is not sure yet that all come; with the same quota.
    pub(crate) fn staging(&self) -> Self {
        Self::new(self.quotas)
    }

    /// Takes in those that came with a world of so many shapes, all or none.
    ///
    /// # Errors
    /// The memory quota.
    pub(crate) fn adopt(&self, staged: Self, shape_count: usize) -> Checked<()> {
        let mut staged = staged.held.into_inner();
        let bytes = staged.count_bytes();
        let mut held = self.held.lock();
        held.check_quota(bytes + shape_bytes(shape_count), self.quotas.bytes)?;
        held.counted_bytes += bytes;
        held.registered.extend(staged.registered);
        held.in_place.extend(staged.in_place);
        Ok(())
    }

    /// Registers a geometry; the one that is kept, if there is an equal one.
    ///
    /// # Errors
    /// The memory quota.
    pub(crate) fn register(&self, geometry: Geometry, world: &Snapshot) -> Checked<Arc<Geometry>> {
        let id = geometry.id();
        let mut held = self.held.lock();
        if let Some(known) = held.registered.get(&id) {
            return Ok(known.clone());
        }
        let geometry = held.find(id).unwrap_or_else(|| Arc::new(geometry));
        let bytes = geometry.memory_bytes();
        held.check_quota(bytes + shape_bytes(world.len()), self.quotas.bytes)?;
        held.counted_bytes += bytes;
        held.registered.insert(id, geometry.clone());
        Ok(geometry)
    }

    /// Takes a mesh in that is to be cut; what is known of its id. If that is `building` itself, the caller has it cut.
    ///
    /// # Errors
    /// The memory quota.
    pub(crate) fn begin(&self, building: &Arc<Building>, world: &Snapshot) -> Checked<Known> {
        let mut held = self.held.lock();
        if let Some(geometry) = held.find(building.id) {
            held.registered.insert(building.id, geometry.clone());
            return Ok(Known::Ready(geometry));
        }
        if let Some(known) = held.building.get(&building.id) {
            if !matches!(known.stage(), Stage::Failed(_)) {
                return Ok(Known::InWork(known.clone()));
            }
            held.drop_building(building.id);
        }
        held.check_quota(building.mesh.memory_bytes() + shape_bytes(world.len()), self.quotas.bytes)?;
        held.promised_bytes += building.promised_bytes();
        held.building.insert(building.id, building.clone());
        Ok(Known::InWork(building.clone()))
    }

    /// Registers what a mesh has become, unless it is forgotten by now.
    pub(crate) fn finish(&self, building: &Arc<Building>, made: Checked<Arc<Geometry>>, world: &Snapshot) {
        let mut held = self.held.lock();
        if !held.building.get(&building.id).is_some_and(|known| Arc::ptr_eq(known, building)) {
            return;
        }
        let registered = made.and_then(|geometry| {
            let more = geometry.memory_bytes().saturating_sub(building.promised_bytes());
            held.check_quota(more + shape_bytes(world.len()), self.quotas.bytes)?;
            Ok(geometry)
        });
        match registered {
            Ok(geometry) => {
                held.drop_building(building.id);
                held.counted_bytes += geometry.memory_bytes();
                held.registered.insert(building.id, geometry);
                building.set(Stage::Ready);
            }
            Err(problem) => building.set(Stage::Failed(problem)),
        }
    }

    /// What is known of an id.
    ///
    /// # Errors
    /// `text` is no id, or nothing is registered under it.
    pub(crate) fn known(&self, text: &str) -> Checked<Known> {
        let building = parse_id(text).and_then(|id| self.held.lock().building.get(&id).cloned());
        match building {
            Some(building) => Ok(Known::InWork(building)),
            None => self.get(text).map(Known::Ready),
        }
    }

    /// Holds room for so many bytes that are on their way.
    ///
    /// # Errors
    /// The memory quota.
    pub(crate) fn hold_room(&self, bytes: u64, world: &Snapshot) -> Checked<Room<'_>> {
        let mut held = self.held.lock();
        held.check_quota(bytes + shape_bytes(world.len()), self.quotas.bytes)?;
        held.promised_bytes += bytes;
        Ok(Room { geometries: self, bytes })
    }

    /// The shared copy of a geometry that was written in place.
    pub(crate) fn share(&self, geometry: Geometry) -> Arc<Geometry> {
        let id = geometry.id();
        let mut held = self.held.lock();
        if let Some(known) = held.find(id) {
            return known;
        }
        held.sweep();
        let geometry = Arc::new(geometry);
        held.counted_bytes += geometry.memory_bytes();
        held.in_place.insert(id, Arc::downgrade(&geometry));
        geometry
    }

    /// The geometry of an id.
    ///
    /// # Errors
    /// `text` is no id, or nothing is registered under it.
    pub(crate) fn get(&self, text: &str) -> Checked<Arc<Geometry>> {
        let id = parse_id(text);
        let found = id.and_then(|id| self.held.lock().find(id));
        found.ok_or_else(|| {
            if let Some(building) = id.and_then(|id| self.held.lock().building.get(&id).cloned()) {
                return not_ready(&building);
            }
            let text = quoted(text);
            let what = format!("is {text}: this session knows no such geometry; CreateGeometry gives the id");
            Problem::at("geometry_id", Reason::GeometryNotFound, what)
        })
    }

    /// Registered geometries after `after`, by id, at most `most`.
    pub(crate) fn after(&self, after: Option<GeometryId>, most: usize) -> Vec<Known> {
        let held = self.held.lock();
        let from = after.map_or(Unbounded, Excluded);
        let ready = held.registered.range((from, Unbounded)).take(most).map(|(_, ready)| Known::Ready(ready.clone()));
        let in_work = held.building.range((from, Unbounded)).take(most).map(|(_, known)| Known::InWork(known.clone()));
        let mut found: Vec<Known> = ready.chain(in_work).collect();
        found.sort_by_key(Known::id);
        found.truncate(most);
        found
    }

    /// All that is in work, or failed.
    pub(crate) fn in_work(&self) -> Vec<Arc<Building>> {
        self.held.lock().building.values().cloned().collect()
    }

    /// Forgets a geometry: it can no longer be named. What uses it keeps it.
    pub(crate) fn forget(&self, text: &str) {
        if let Some(id) = parse_id(text) {
            let mut held = self.held.lock();
            held.registered.remove(&id);
            held.drop_building(id);
            held.in_place.remove(&id);
        }
    }

    /// Bytes that the geometries hold now, lazily built structures included, and about what so many shapes hold. Costs a
    /// pass over the geometries.
    pub(crate) fn memory_bytes(&self, shape_count: usize) -> u64 {
        self.held.lock().count_bytes() + shape_bytes(shape_count)
    }

    /// Checks that a world of so many shapes stays within the memory quota.
    ///
    /// # Errors
    /// The memory quota.
    pub(crate) fn check_room(&self, shape_count: usize) -> Checked<()> {
        let mut held = self.held.lock();
        held.check_quota(shape_bytes(shape_count), self.quotas.bytes)
    }
}

fn not_ready(building: &Building) -> Problem {
    let what = match building.stage() {
        Stage::Failed(problem) => format!("failed: {problem}; delete it, and register the mesh again"),
        Stage::InWork(_) | Stage::Ready | Stage::Forgotten => {
            "is still being cut into convex parts: GetGeometry with wait answers when it is READY".to_owned()
        }
    };
    Problem::at("geometry_id", Reason::GeometryNotReady, what)
}

/// How many shapes of a world use each of `geometries`, in the same order. Costs a pass over all shapes.
pub(crate) fn uses(world: &Snapshot, geometries: &[Arc<Geometry>]) -> Vec<u64> {
    let places = geometries.iter().enumerate();
    let places: HashMap<*const Geometry, usize> =
        places.map(|(place, geometry)| (Arc::as_ptr(geometry), place)).collect();
    let mut counts = vec![0; geometries.len()];
    let mut after = None;
    loop {
        let page = world.shapes_after(after, PAGE, None);
        for shape in &page {
            if let Some(&place) = places.get(&Arc::as_ptr(&shape.geometry)) {
                counts[place] += 1;
            }
        }
        match page.last() {
            Some(last) if page.len() == PAGE => after = Some(last.id),
            _ => return counts,
        }
    }
}

/// An id as it is sent: 64 hex digits.
pub(crate) fn id_text(id: GeometryId) -> String {
    blake3::Hash::from_bytes(id.0).to_hex().to_string()
}

/// The id in a text, if it is one.
pub(crate) fn parse_id(text: &str) -> Option<GeometryId> {
    let hash = blake3::Hash::from_hex(text).ok()?;
    Some(GeometryId(*hash.as_bytes()))
}

fn shape_bytes(shape_count: usize) -> u64 {
    u64::try_from(shape_count).unwrap_or(u64::MAX).saturating_mul(SHAPE_BYTES)
}
