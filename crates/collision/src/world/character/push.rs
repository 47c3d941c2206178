//! Out of what a character overlaps before it goes.

use glam::DVec3;

use super::Walk;
use crate::world::{Depenetrate, QuestionError, Subject};

/// Passes of a push.
const PASSES: usize = 8;

impl Walk<'_, '_> {
    /// Moves it out of what it overlaps, as far as it may be pushed; says how.
    pub(super) fn push(&mut self) -> Result<DVec3, QuestionError> {
        if self.question.max_push <= 0.0 {
            return Ok(DVec3::ZERO);
        }
        let question = Depenetrate {
            subject: Subject::Geometry { geometry: self.geometry.clone(), pose: self.pose },
            against: None,
            gap: 0.0,
            max_distance: self.question.max_push,
            max_passes: PASSES,
        };
        let out = self.world.depenetrate(&question, &self.filter, self.accuracy, self.meter)?;
        self.pose.position = out.position;
        Ok(out.translation)
    }
}
