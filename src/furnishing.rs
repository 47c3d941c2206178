//! Convex parts that questions need of meshes: made once however many ask, by the worker that cuts meshes.
//!
//! # Method
//! A question whose parts are missing is refused at once and told how far they are; asked again, it is answered as soon as they
//! are there. It does not wait: parts take seconds to minutes, longer than most deadlines. A mesh that nobody but the worker holds any
//! more is let go.

use std::{
    collections::HashMap,
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
};

use collision::{
    decompose::{Progress, furnish},
    narrow::PartsWanted,
    shape::{Asking, Fineness, Mesh},
};
use parking_lot::Mutex;

use crate::{
    building::{Workshop, share_done},
    fence::fenced,
};

/// Parts that are being made, and how far they are, 0 to 1. A mesh is known by where it is, for the worker holds it meanwhile.
#[derive(Debug, Default)]
pub(crate) struct Furnishings(Mutex<HashMap<Key, Arc<Share>>>);

type Key = (usize, Fineness);

/// A number from 0 to 1.
#[derive(Debug, Default)]
struct Share(AtomicU32);

impl Share {
    fn get(&self) -> f32 {
        f32::from_bits(self.0.load(Ordering::Relaxed))
    }

    fn set(&self, share: f32) {
        self.0.store(share.to_bits(), Ordering::Relaxed);
    }
}

fn key(wanted: &PartsWanted) -> Key {
    (Arc::as_ptr(&wanted.mesh).addr(), wanted.fineness)
}

impl Workshop {
    /// Has parts made for who asks, when their turns come; how far those are that are least far, from 0 to 1.
    pub(crate) fn furnish(self: &Arc<Self>, asking: Asking, wanted: &[PartsWanted]) -> f32 {
        let mut least = 1.0_f32;
        for parts in wanted {
            let mut known = self.furnishings.0.lock();
            let share = known.entry(key(parts)).or_insert_with(|| {
                let share = Arc::<Share>::default();
                tokio::spawn(self.clone().make(asking, parts.clone(), share.clone()));
                share
            });
            least = least.min(share.get());
        }
        least
    }

    async fn make(self: Arc<Self>, asking: Asking, wanted: PartsWanted, share: Arc<Share>) {
        let place = tokio::select! {
            biased;
            () = self.drain.cancelled() => return,
            place = self.place.clone().acquire_owned() => place,
        };
        let (at_work, key) = (self.clone(), key(&wanted));
        let making = tokio::task::spawn_blocking(move || {
            // What is wrong is in the log, and the next question has it tried again.
            let _ = fenced("making the convex parts that a question needs", || {
                asking.during(|| at_work.made_of(&wanted, &share));
            });
            wanted
        });
        let held = making.await;
        drop(place);
        self.furnishings.0.lock().remove(&key);
        // Only now may another mesh be where this one is.
        drop(held);
    }

    fn made_of(&self, wanted: &PartsWanted, share: &Share) {
        let mut farthest = 0.0_f32;
        let mut tell = |progress: Progress| {
            farthest = farthest.max(share_done(&progress));
            share.set(farthest);
            let is_unwanted = Arc::strong_count(&wanted.mesh) == 1;
            match is_unwanted || self.drain.is_cancelled() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let mesh: &Mesh = &wanted.mesh;
        // Called off: nobody asks for it, or it will be asked for again.
        let _ = furnish(mesh, wanted.fineness, &mut tell);
    }
}
