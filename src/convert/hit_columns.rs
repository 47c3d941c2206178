//! The answers of many items as columns.

use collision::{
    DVec3,
    answer::{Bound, Certificate, Feature, Verdict},
    world::{Found, Impact, Neighbor, OverlapHit, RayHit},
};
use wire::v1 as pb;

use super::{
    answer::{id_or_none, verdict},
    place::number_out,
};
use crate::problem::Checked;

/// What a hit is made of, for its columns.
#[derive(Debug)]
pub(crate) struct Parts {
    id: u64,
    value: f64,
    point: DVec3,
    normal: Option<DVec3>,
    feature: Feature,
    bound: Bound,
}

/// A hit that has a value.
pub(crate) trait InColumns {
    /// What its value is worth.
    fn certificate(&self) -> &Certificate;
    /// Its parts.
    fn parts(&self) -> Parts;
}

impl InColumns for RayHit {
    fn certificate(&self) -> &Certificate {
        &self.touch.certificate
    }

    fn parts(&self) -> Parts {
        let touch = &self.touch;
        Parts {
            id: id_or_none(self.id),
            value: touch.distance,
            point: touch.point,
            normal: touch.normal,
            feature: touch.feature,
            bound: touch.certificate.bound,
        }
    }
}

impl InColumns for Impact {
    fn certificate(&self) -> &Certificate {
        &self.touch.certificate
    }

    fn parts(&self) -> Parts {
        let touch = &self.touch;
        Parts {
            id: id_or_none(self.id),
            value: touch.fraction,
            point: touch.point,
            normal: touch.normal_b_to_a,
            feature: touch.feature_b,
            bound: touch.certificate.bound,
        }
    }
}

impl InColumns for Neighbor {
    fn certificate(&self) -> &Certificate {
        &self.separation.certificate
    }

    fn parts(&self) -> Parts {
        let separation = &self.separation;
        Parts {
            id: id_or_none(self.id),
            value: separation.distance,
            point: separation.point_on_b,
            normal: separation.normal_b_to_a,
            feature: separation.feature_b,
            bound: separation.certificate.bound,
        }
    }
}

/// The columns of answers that have a value.
#[derive(Debug)]
pub(crate) struct Hits {
    want: pb::ColumnChoice,
    frame_origin: DVec3,
    columns: pb::HitColumns,
}

impl Hits {
    /// Room for `n` answers, of which the columns `want` are returned; points are relative to `frame_origin`.
    pub(crate) fn new(want: Option<&pb::ColumnChoice>, frame_origin: DVec3, n: usize) -> Self {
        let want = want.copied().unwrap_or_default();
        let room = |is_wanted: bool, width: usize| if is_wanted { width * n } else { 0 };
        let columns = pb::HitColumns {
            verdicts: Vec::with_capacity(n),
            ids: Vec::with_capacity(n),
            values: Vec::with_capacity(n),
            points: Vec::with_capacity(room(want.points, 3)),
            normals: Vec::with_capacity(room(want.normals, 3)),
            parts: Vec::with_capacity(room(want.features, 1)),
            faces: Vec::with_capacity(room(want.features, 1)),
            lower: Vec::with_capacity(room(want.intervals, 1)),
            upper: Vec::with_capacity(room(want.intervals, 1)),
            max_width: 0.0,
        };
        Self { want, frame_origin, columns }
    }

    /// Adds the answer of the next item: the closest certain hit, or else the first undecided one. What is undecided before
    /// a certain hit lowers its lower bound. Where nothing was hit the value is `none`.
    ///
    /// # Errors
    /// A number is not finite, which is a fault of the server.
    pub(crate) fn add<H: InColumns>(&mut self, found: &Found<H>, none: f64) -> Checked<()> {
        let verdict_of = |hit: &&H| hit.certificate().verdict;
        let best = found.hits.iter().find(|hit| verdict_of(hit) == Verdict::Hit).or(found.hits.first());
        self.columns.verdicts.push(verdict(found.verdict).into());
        let Some(best) = best else {
            self.add_none(none as f32);
            return Ok(());
        };
        let lower = found.hits.iter().fold(f64::INFINITY, |lower, hit| lower.min(hit.certificate().bound.lower));
        self.add_hit(&best.parts(), lower)
    }

    fn add_hit(&mut self, hit: &Parts, lower: f64) -> Checked<()> {
        let (lower, upper) = (rounded_down(number_out(lower)?), rounded_up(number_out(hit.bound.upper)?));
        let Self { want, columns, .. } = self;
        columns.ids.push(hit.id);
        columns.values.push(number_out(hit.value)? as f32);
        columns.max_width = columns.max_width.max(f64::from(upper) - f64::from(lower));
        if want.points {
            add_vector(&mut columns.points, hit.point - self.frame_origin)?;
        }
        if want.normals {
            add_vector(&mut columns.normals, hit.normal.unwrap_or(DVec3::ZERO))?;
        }
        if want.features {
            columns.parts.push(hit.feature.part.unwrap_or(0));
            columns.faces.push(hit.feature.face.unwrap_or(0));
        }
        if want.intervals {
            columns.lower.push(lower);
            columns.upper.push(upper);
        }
        Ok(())
    }

    fn add_none(&mut self, value: f32) {
        let Self { want, columns, .. } = self;
        columns.ids.push(0);
        columns.values.push(value);
        if want.points {
            columns.points.extend([0.0; 3]);
        }
        if want.normals {
            columns.normals.extend([0.0; 3]);
        }
        if want.features {
            columns.parts.push(0);
            columns.faces.push(0);
        }
        if want.intervals {
            columns.lower.push(0.0);
            columns.upper.push(0.0);
        }
    }

    /// All of them.
    pub(crate) fn finish(self) -> pb::HitColumns {
        self.columns
    }
}

/// The columns of answers that are lists of shapes.
#[derive(Debug)]
pub(crate) struct Touching(pb::OverlapBatchResponse);

impl Touching {
    /// Room for `n` answers.
    pub(crate) fn new(n: usize) -> Self {
        let mut offsets = Vec::with_capacity(n + 1);
        offsets.push(0);
        Self(pb::OverlapBatchResponse { offsets, ..pb::OverlapBatchResponse::default() })
    }

    /// Adds the answer of the next place.
    pub(crate) fn add(&mut self, found: &Found<OverlapHit>) {
        let Self(columns) = self;
        if found.truncated {
            columns.truncated.push(count(columns.offsets.len() - 1));
        }
        columns.ids.extend(found.hits.iter().map(|hit| id_or_none(hit.id)));
        columns.verdicts.extend(found.hits.iter().map(|hit| i32::from(verdict(hit.certificate.verdict))));
        columns.offsets.push(count(columns.ids.len()));
    }

    /// All of them; who sends it adds what was read.
    pub(crate) fn finish(self) -> pb::OverlapBatchResponse {
        self.0
    }
}

/// A count of what fits into one message.
fn count(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

fn add_vector(column: &mut Vec<f32>, vector: DVec3) -> Checked<()> {
    for component in vector.to_array() {
        column.push(number_out(component)? as f32);
    }
    Ok(())
}

/// The nearest single that is not above a number.
fn rounded_down(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value { near.next_down() } else { near }
}

/// The nearest single that is not below a number.
fn rounded_up(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_outwards_and_exact_ones_stay() {
        for value in [0.1, 1e-50, 4e12, -0.1, 16_777_217.0] {
            let (down, up) = (f64::from(rounded_down(value)), f64::from(rounded_up(value)));
            assert!(down < value && value < up, "{value}: {down} to {up}");
            assert!(up - down <= value.abs() * 1.2e-7 + 3e-45, "{value}: {down} to {up}");
        }
        for value in [0.0, 0.5, -3.25, 16_777_216.0] {
            assert_eq!((f64::from(rounded_down(value)), f64::from(rounded_up(value))), (value, value));
        }
    }
}
