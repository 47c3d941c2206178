//! Real meshes, and what their parts say of distances that are known.

use std::ops::ControlFlow;

use collision::{
    accuracy::{Accuracy, Tier},
    answer::{Stop, Work},
    decompose::{Options, decompose},
    math::Pose,
    narrow::{Placed, distance},
    shape::Geometry,
};

use crate::{
    cubes::Noise,
    reference::{self, number},
    sampled::{assert_certified, diagonal, mesh_of, parts_of},
};

#[test]
fn real_meshes() {
    let Some(folder) = reference::folder() else { return };
    for (name, share) in
        [("teddy", 0.02), ("spot", 0.03), ("not_convex", 0.01), ("featuretype", 0.05), ("stairs", 0.01)]
    {
        let geometry = reference::mesh(&folder, &format!("mesh/{name}.obj"));
        let max_error = share * diagonal(&geometry);
        let found = parts_of(&geometry, &Options { max_error, ..Options::default() });
        let shown = assert_certified(&geometry, &found, &mut Noise(1), 200);
        eprintln!(
            "{name}: {} parts, inside {:?}, outside {:?}, excess {:?}, {:?}, {} steps, seen {shown:?}",
            found.parts.len(),
            found.errors.inside,
            found.errors.outside,
            found.volume_excess,
            found.stop,
            found.steps
        );
        assert_eq!(found.volume_excess.is_some(), mesh_of(&geometry).is_closed());
        assert_ne!(found.stop, Stop::Converged, "{name}");
        assert!(name == "featuretype" || found.errors.inside.upper <= max_error, "{name}: {:?}", found.errors);
    }
}

/// Of surfaces parts give lower bounds only: their distance, less what the mesh may lie outside of them.
#[test]
fn no_distance_of_parts_is_above_that_of_the_meshes() {
    let Some(folder) = reference::folder() else { return };
    let parts = |name: &str, max_parts: u32| {
        let mesh = reference::mesh(&folder, &format!("mesh/{name}.obj"));
        let options = Options { max_parts, budget: 20_000_000, ..Options::default() };
        let found =
            decompose(mesh_of(&mesh), &options, &mut |_| ControlFlow::Continue(())).expect("nobody calls it off");
        eprintln!("{name}: {} parts, {:?}", found.parts.len(), found.errors);
        let outside = found.errors.outside.upper;
        (found.parts.into_iter().map(|part| part.geometry).collect::<Vec<Geometry>>(), outside)
    };
    let (environment, outside_of_it) = parts("fcl_env", 512);
    let (robot, outside_of_robot) = parts("fcl_rob", 32);
    let records = reference::records(&folder, "mesh_mesh_fcl_env_rob.jsonl");
    let (mut proved, mut apart, mut lost) = (0, 0, 0.0);
    for record in &records {
        let (pose, truth) = (reference::pose(record), number(record, "d"));
        let mut lower = f64::INFINITY;
        for part in &robot {
            for other in &environment {
                let (part, other) = (Placed { geometry: part, pose }, Placed { geometry: other, pose: Pose::IDENTITY });
                let found = distance(part, other, lower, &Accuracy::of(Tier::Standard), &mut Work::default());
                lower = found.map_or(lower, |found| lower.min(found.certificate.bound.lower));
            }
        }
        let lower = lower - outside_of_it - outside_of_robot;
        assert!(lower <= truth + 1e-12 * pose.position.length(), "{record}: {lower}");
        apart += u32::from(truth > 0.0);
        proved += u32::from(lower > 0.0);
        lost += (truth - lower.max(0.0)) / truth.max(1.0);
    }
    let mean_lost = lost / records.len() as f64;
    eprintln!("{proved} of {apart} are proved apart; on average {:.1} % of the distance is lost", 100.0 * mean_lost);
    assert!(2 * proved > apart, "{proved} of {apart}");
}
