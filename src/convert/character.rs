//! Characters: how far they are asked to go, and how far they got.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use collision::{
    DVec3,
    shape::Limits,
    world::{MoveCharacter, MovedCharacter},
};
use wire::v1 as pb;

use super::{
    answer::{all_out, contact, impact, verdict},
    number::{FROM_ZERO_TO_REACH, REACH, count, within},
    place::{direction, position, vec3_out},
    question::subject,
};
use crate::{
    geometries::Geometries,
    problem::{Checked, Under},
};

/// Distance that a character keeps if it names none, metres.
const SKIN: f64 = 0.01;

/// A character's question.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn move_character(sent: &pb::MoveCharacterRequest, known: &Geometries) -> Checked<MoveCharacter> {
    let up = match &sent.up {
        Some(up) => direction("up", Some(up))?,
        None => DVec3::Y,
    };
    let length = |field, length| within(field, length, 0.0..=REACH, FROM_ZERO_TO_REACH);
    Ok(MoveCharacter {
        subject: subject(sent.subject.as_ref(), known)?,
        translation: position(sent.translation.as_ref(), DVec3::ZERO).under("translation")?,
        up,
        max_slope: within("max_slope", sent.max_slope.unwrap_or(FRAC_PI_4), 0.0..=FRAC_PI_2, "0 to pi/2 radians")?,
        step_height: length("step_height", sent.step_height)?,
        snap_distance: length("snap_distance", sent.snap_distance)?,
        skin: within("skin", sent.skin.unwrap_or(SKIN), 0.0..=Limits::SIZE_MAX, "0 to 1e9 metres")?,
        max_push: length("max_push", sent.max_push)?,
        max_slides: count("max_slides", sent.max_slides, 4, 32)?,
    })
}

/// A character's answer; who sends it adds what was read.
///
/// # Errors
/// A number is not finite, which is a fault of the server.
pub(crate) fn moved_character(moved: &MovedCharacter) -> Checked<pb::MoveCharacterResponse> {
    Ok(pb::MoveCharacterResponse {
        verdict: verdict(moved.verdict).into(),
        position: Some(vec3_out(moved.position)?),
        ground: moved.ground.as_ref().map(contact).transpose()?,
        hits: all_out(&moved.hits, impact)?,
        info: None,
        pushed: (moved.pushed != DVec3::ZERO).then(|| vec3_out(moved.pushed)).transpose()?,
    })
}
