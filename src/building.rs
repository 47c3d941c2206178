//! Geometries in work: meshes that are cut into convex parts, one at a time, on another thread.
//!
//! # Method
//! A mesh whose parts are asked for is told of at once, under the id that it will have, and is BUILDING until a worker has cut
//! it. One worker serves all sessions; what one has made, the others get as long as somebody holds it. Whoever deletes the geometry,
//! ends the session or stops the server calls the worker off.

use std::{
    collections::HashMap,
    ops::ControlFlow,
    sync::{Arc, Weak},
};

use collision::{
    decompose::{Options, Progress, decompose},
    shape::{Asking, Form, Geometry, GeometryError, GeometryId},
};
use parking_lot::Mutex;
use tokio::sync::{Semaphore, watch};
use tokio_util::sync::CancellationToken;

use crate::{
    fence::fenced,
    furnishing::Furnishings,
    problem::{Checked, Problem, Reason},
    session::Session,
};

/// How a geometry in work stands.
#[derive(Clone, Debug)]
pub(crate) enum Stage {
    /// It is worked on, or waits for that; how far it is, from 0 to 1.
    InWork(f32),
    /// It is registered.
    Ready,
    /// It cannot be made.
    Failed(Problem),
    /// Nobody wants it any more.
    Forgotten,
}

/// A mesh that is to be cut into parts.
#[derive(Debug)]
pub(crate) struct Building {
    /// The id it will have.
    pub(crate) id: GeometryId,
    /// Without its parts.
    pub(crate) mesh: Geometry,
    options: Options,
    /// Who asked for the parts.
    asking: Asking,
    promised_bytes: u64,
    stage: watch::Sender<Stage>,
    stop: CancellationToken,
}

impl Building {
    /// A mesh, and what who asks wants of its parts; it is called off when `ended` is cancelled.
    pub(crate) fn new(mesh: Geometry, options: Options, asking: Asking, ended: &CancellationToken) -> Self {
        Self {
            id: mesh.id_with_parts(&options.asked()),
            promised_bytes: mesh.memory_bytes(),
            mesh,
            options,
            asking,
            stage: watch::Sender::new(Stage::InWork(0.0)),
            stop: ended.child_token(),
        }
    }

    /// The same for another session, called off when that has `ended`.
    pub(crate) fn again(&self, ended: &CancellationToken) -> Self {
        Self::new(self.mesh.clone(), self.options, self.asking, ended)
    }

    /// Room that is held for it until its parts are made.
    pub(crate) fn promised_bytes(&self) -> u64 {
        self.promised_bytes
    }

    /// How it stands.
    pub(crate) fn stage(&self) -> Stage {
        self.stage.borrow().clone()
    }

    /// Says how it stands now.
    pub(crate) fn set(&self, stage: Stage) {
        if matches!(stage, Stage::Forgotten) {
            self.stop.cancel();
        }
        self.stage.send_replace(stage);
    }

    /// Waits until it is no longer in work.
    pub(crate) async fn settled(&self) {
        let mut stages = self.stage.subscribe();
        // It ends with an error only if this is dropped, which it is not while it is asked.
        let _ = stages.wait_for(|stage| !matches!(stage, Stage::InWork(_))).await;
    }

    /// Cuts it. Takes seconds to minutes.
    ///
    /// # Errors
    /// It was called off.
    pub(crate) fn cut(&self, drain: &CancellationToken) -> Checked<Geometry> {
        let Form::Mesh(mesh) = self.mesh.form() else {
            return Err(Problem::new(Reason::Internal, "what is to be cut is no mesh"));
        };
        let mut farthest = 0.0_f32;
        let mut tell = |progress: Progress| {
            farthest = farthest.max(share_done(&progress));
            self.stage.send_replace(Stage::InWork(farthest));
            match self.stop.is_cancelled() || drain.is_cancelled() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let made = self.asking.during(|| decompose(mesh, &self.options, &mut tell));
        let made = made.map_err(|_| {
            Problem::new(
                Reason::Stopping,
                "the decomposition was called off: register the mesh again, elsewhere or later",
            )
        })?;
        let failed = |error: GeometryError| Problem::new(Reason::Internal, format!("parts were not taken: {error}"));
        made.attached(&self.mesh, &self.options).map_err(failed)
    }
}

/// How far a decomposition is, from 0 to less than 1.
pub(crate) fn share_done(progress: &Progress) -> f32 {
    let by_parts = progress.done_count as f32 / (progress.part_count.max(1) as f32 + 1.0);
    let by_steps = progress.steps as f32 / (progress.max_steps as f32 + 1.0);
    by_parts.max(by_steps.min(1.0 - f32::EPSILON))
}

/// Where meshes are cut.
#[derive(Debug)]
pub(crate) struct Workshop {
    pub(crate) place: Arc<Semaphore>,
    made: Mutex<HashMap<GeometryId, Weak<Geometry>>>,
    /// For questions.
    pub(crate) furnishings: Furnishings,
    /// Cancelled when the server stops.
    pub(crate) drain: CancellationToken,
}

impl Workshop {
    /// One with nothing to do.
    pub(crate) fn new(drain: CancellationToken) -> Self {
        Self { place: Arc::new(Semaphore::new(1)), made: Mutex::default(), furnishings: Furnishings::default(), drain }
    }

    /// Has a mesh cut for a session, when its turn comes.
    pub(crate) fn start(self: &Arc<Self>, session: Arc<Session>, building: Arc<Building>) {
        let workshop = self.clone();
        tokio::spawn(async move {
            let place = workshop.place.clone().acquire_owned();
            let place = tokio::select! {
                biased;
                () = workshop.drain.cancelled() => return,
                () = building.stop.cancelled() => return,
                place = place => place,
            };
            let (at_work, in_work) = (workshop.clone(), building.clone());
            let cutting = tokio::task::spawn_blocking(move || at_work.made(&in_work));
            let made = cutting.await.unwrap_or_else(|_| {
                Err(Problem::new(
                    Reason::Stopping,
                    "the server is stopping: register the mesh again elsewhere, or later",
                ))
            });
            drop(place);
            session.geometries.finish(&building, made, &session.newest());
        });
    }

    /// The geometry, found or cut here and now, which takes seconds to minutes.
    ///
    /// # Errors
    /// It was called off.
    pub(crate) fn made(&self, building: &Building) -> Checked<Arc<Geometry>> {
        if let Some(known) = self.made.lock().get(&building.id).and_then(Weak::upgrade) {
            return Ok(known);
        }
        let geometry = Arc::new(fenced("cutting a mesh into convex parts", || building.cut(&self.drain))??);
        let mut made = self.made.lock();
        made.retain(|_, geometry| geometry.strong_count() > 0);
        made.insert(building.id, Arc::downgrade(&geometry));
        Ok(geometry)
    }
}
