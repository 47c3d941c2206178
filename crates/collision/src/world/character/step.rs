//! Steps, and what a character comes to stand on.

use glam::DVec3;

use super::{Near, Rule, Stride, Walk};
use crate::{
    math::{Norm, try_unit},
    tolerance::STRIDE_MIN,
    world::QuestionError,
};

impl Walk<'_, '_> {
    /// Up, ahead and down onto a floor, if that leads on.
    pub(super) fn step(&mut self, left: DVec3, is_on_floor: bool) -> Result<Option<Stride>, QuestionError> {
        let ahead = left - self.up * left.dot(self.up);
        let least = self.question.translation.norm() * STRIDE_MIN;
        if self.question.step_height <= 0.0 || !is_on_floor || ahead.norm() <= least {
            return Ok(None);
        }
        let from = self.pose.position;
        let contacts = self.contacts(from)?;
        let raised = self.stride(from, self.up * self.question.step_height, &contacts, Rule::IsStraight)?;
        let contacts = self.contacts(raised.to)?;
        let over = self.stride(raised.to, ahead, &contacts, Rule::Slides)?;
        if (over.to - raised.to).norm() <= least {
            return Ok(None);
        }
        let drop = (raised.to - from).dot(self.up);
        let Some(landed) = self.land(over.to, drop)? else { return Ok(None) };
        let up = self.up;
        let leads_up = |place: DVec3| (place - from).dot(up) > 0.0;
        // A round sole meets the edge of a step before it stands on it: what lies a little further on tells whether it will.
        let stands = self.is_level_at(landed)? || {
            let bounds = self.geometry.local_bounds();
            let sole = (bounds.max - bounds.min).min_element() * 0.5;
            let further = try_unit(ahead).unwrap_or(DVec3::ZERO) * sole;
            let contacts = self.contacts(over.to)?;
            let probe = self.stride(over.to, further, &contacts, Rule::IsStraight)?;
            match self.land(probe.to, drop)? {
                Some(place) => leads_up(place) && self.is_level_at(place)?,
                None => false,
            }
        };
        Ok((leads_up(landed) && stands).then_some(Stride { to: landed, left: over.left, touched: over.touched }))
    }

    /// Where it comes to rest if it goes down by up to `drop` from a place; `None` if nothing is there.
    fn land(&mut self, from: DVec3, drop: f64) -> Result<Option<DVec3>, QuestionError> {
        let contacts = self.contacts(from)?;
        let down = self.stride(from, -self.up * drop, &contacts, Rule::IsStraight)?;
        Ok(down.touched.map(|_| down.to))
    }

    /// Whether something level is below a place.
    fn is_level_at(&mut self, place: DVec3) -> Result<bool, QuestionError> {
        let contacts = self.contacts(place)?;
        Ok(contacts.iter().any(|near| self.is_level(Some(near.contact.normal))))
    }

    /// Down onto a floor within reach, if there is one.
    pub(super) fn put_down(&mut self, contacts: Vec<Near>) -> Result<Vec<Near>, QuestionError> {
        let Some(place) = self.land(self.pose.position, self.question.snap_distance)? else { return Ok(contacts) };
        let landed = self.contacts(place)?;
        if self.floor(&landed).is_none() {
            return Ok(contacts);
        }
        self.pose.position = place;
        Ok(landed)
    }
}
