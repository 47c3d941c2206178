//! The questions as Calipers answers them: in f64, exactly, with proof.

use std::{hint::black_box, time::Duration};

use collision::{
    DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Verdict, Work},
    math::Pose,
    narrow::{self, Faces, Motion, Placed, Ray},
    shape::{Form, Geometry},
};

use super::workload::{CAST_LENGTH, Line, Triangles};
use crate::{
    errors::Proof,
    forms::{Place, pose, vector},
    timing::spent,
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);
/// Of rays, metres: farther than any level is wide.
pub(super) const RAY_LENGTH: f32 = 1000.0;

/// A mesh with all that a question may need of it: its tree, and which triangles are neighbours, which touches of edges and
/// corners ask for.
pub(super) fn build((vertices, indices): &(Vec<DVec3>, Vec<[u32; 3]>)) -> Geometry {
    let geometry = Geometry::mesh(vertices, indices).expect("nothing is wrong with the level");
    let Form::Mesh(mesh) = geometry.form() else { unreachable!("it is a mesh") };
    black_box((mesh.tree(), mesh.adjacency()));
    let [a, b, c] = mesh.corners(0);
    black_box(mesh.looks_along(0, (a + a - b - c).normalize()));
    geometry
}

/// What [`build`] wants.
pub(super) fn input(mesh: &Triangles) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    (mesh.vertices.iter().copied().map(vector).collect(), mesh.indices.clone())
}

/// A mesh that does not move, and the form that is asked about.
pub(super) struct Side<'a> {
    pub(super) mesh: Placed<'a>,
    pub(super) form: &'a Geometry,
}

/// A form at a pose, and its way.
pub(super) struct Cast {
    pose: Pose,
    way: DVec3,
}

pub(super) fn rays(lines: &[Line]) -> Vec<Ray> {
    let ray = |line: &Line| {
        let direction = vector(line.direction);
        Ray {
            origin: vector(line.origin.position),
            direction,
            min_distance: 0.0,
            max_distance: f64::from(RAY_LENGTH) * direction.length(),
            hollow: false,
            faces: Faces::Both,
        }
    };
    lines.iter().map(ray).collect()
}

pub(super) fn casts(lines: &[Line]) -> Vec<Cast> {
    let cast =
        |line: &Line| Cast { pose: pose(&line.origin), way: vector(line.direction.map(|part| part * CAST_LENGTH)) };
    lines.iter().map(cast).collect()
}

impl Cast {
    /// Metres.
    pub(super) fn length(&self) -> f64 {
        self.way.length()
    }
}

impl Side<'_> {
    pub(super) fn raycast(&self, ray: &Ray) -> Proof {
        let found = narrow::raycast(ray, self.mesh, &EXACT, &mut Work::default());
        let touch = found.undecided.or(found.certain);
        touch.map_or(Proof::NONE, |touch| Proof::of_value(&touch.certificate, touch.distance, 1.0))
    }

    pub(super) fn overlap(&self, pose: &Pose) -> Proof {
        Proof::of_verdict(&self.overlapping(pose))
    }

    pub(super) fn is_free(&self, place: &Place) -> bool {
        self.overlapping(&pose(place)).verdict == Verdict::Miss
    }

    fn overlapping(&self, pose: &Pose) -> collision::answer::Certificate {
        narrow::overlap(Placed { geometry: self.form, pose: *pose }, self.mesh, &EXACT, &mut Work::default())
    }

    pub(super) fn cast(&self, cast: &Cast) -> Proof {
        let touch = self.touch(cast);
        touch.map_or(Proof::NONE, |touch| Proof::of_value(&touch.certificate, touch.fraction, cast.length()))
    }

    fn touch(&self, cast: &Cast) -> Option<narrow::ImpactTouch> {
        let motion = Motion { displacement_a: cast.way, ..Motion::default() };
        let form = Placed { geometry: self.form, pose: cast.pose };
        narrow::impact(form, self.mesh, &motion, &EXACT, &mut Work::default())
    }

    /// CPU time of the first `count`.
    pub(super) fn time_rays(&self, rays: &[Ray], count: usize) -> Duration {
        spent(rays[..count].iter(), |ray| narrow::raycast(ray, self.mesh, &EXACT, &mut Work::default()))
    }

    pub(super) fn time_overlaps(&self, poses: &[Pose], count: usize) -> Duration {
        spent(poses[..count].iter(), |pose| self.overlapping(pose))
    }

    pub(super) fn time_casts(&self, casts: &[Cast], count: usize) -> Duration {
        spent(casts[..count].iter(), |cast| self.touch(cast))
    }
}
