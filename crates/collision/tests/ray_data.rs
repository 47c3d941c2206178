//! All rays of the reference data against their meshes.

mod reference;

use collision::{
    DVec3,
    accuracy::Accuracy,
    answer::{Verdict, Work},
    math::Pose,
    narrow::{Faces, Placed, Ray, RayTouches, raycast},
    shape::Geometry,
};
use serde_json::Value;

struct Case<'a> {
    record: &'a Value,
    direction: DVec3,
    /// Size of the mesh plus the way to it.
    scale: f64,
}

fn cast(mesh: &Geometry, record: &Value) -> RayTouches {
    let direction = reference::vector(record, "d");
    let ray = Ray {
        origin: reference::vector(record, "o"),
        direction,
        min_distance: 0.0,
        max_distance: record["max_t"].as_f64().map_or(4e12, |max_t| max_t * direction.length()),
        hollow: false,
        faces: Faces::Both,
    };
    let target = Placed { geometry: mesh, pose: Pose::at(reference::vector(record, "p")) };
    raycast(&ray, target, &Accuracy::default(), &mut Work::default())
}

/// What is wrong with the answer to a record; the error as a part of what is allowed if nothing is.
fn judge(case: &Case<'_>, touches: RayTouches) -> Result<f64, String> {
    let record = case.record;
    let judged = !reference::is_ambiguous(record);
    if judged && touches.undecided.is_some() {
        return Err(format!("undecided: {:?}", touches.undecided));
    }
    let is_hit = record["hit"].as_bool().expect("hit");
    let Some(touch) = touches.certain else {
        return if is_hit && judged { Err("missed".into()) } else { Ok(0.0) };
    };
    if !is_hit {
        return if judged { Err(format!("hit: {touch:?}")) } else { Ok(0.0) };
    }
    assert_eq!(touch.certificate.verdict, Verdict::Hit);
    let length = case.direction.length();
    let distance = reference::number(record, "t") * length;
    let incidence = record["cos"].as_f64().unwrap_or(1.0).max(1e-2);
    let error = (touch.distance - distance).abs() / (1e-12 * case.scale / incidence);
    let face = touch.feature.face.expect("a face");
    let is_named = record["ids"].as_array().expect("ids").iter().any(|id| id.as_u64() == Some(face.into()));
    // Ambiguous records may be answered by another triangle, with its own distance.
    if !judged {
        return Ok(0.0);
    }
    if !is_named {
        return Err(format!("face {face} at {}, {touch:?}", touch.distance));
    }
    let bound = touch.certificate.bound;
    let slack = 4e-16 * case.scale / incidence;
    if distance < bound.lower - slack || distance > bound.upper + slack {
        return Err(format!("the truth {distance} is not in {bound:?}"));
    }
    if bound.width() > 2e-13 * case.scale / incidence {
        return Err(format!("wide: {bound:?}"));
    }
    if error > 1.0 { Err(format!("off by {error} of the tolerance: {touch:?}")) } else { Ok(error) }
}

#[test]
fn every_ray_of_the_data_is_answered_right() {
    let Some(folder) = reference::folder() else { return };
    for name in ["nav_test", "undulating", "spot", "voxel_mesh_01", "fcl_env"] {
        let mesh = reference::mesh(&folder, &format!("mesh/{name}.obj"));
        let bounds = mesh.local_bounds();
        let diagonal = (bounds.max - bounds.min).length();
        let (mut wrong, mut worst) = (Vec::new(), 0.0_f64);
        let records = reference::records(&folder, &format!("rays_{name}.jsonl"));
        for record in &records {
            let way = reference::vector(record, "o") - bounds.center() - reference::vector(record, "p");
            let case = Case { record, direction: reference::vector(record, "d"), scale: diagonal + way.length() };
            match judge(&case, cast(&mesh, record)) {
                Ok(error) => worst = worst.max(error),
                Err(reason) => wrong.push(format!("{record}\n    {reason}")),
            }
        }
        let shown: Vec<&String> = wrong.iter().take(5).collect();
        assert!(wrong.is_empty(), "{name}: {} of {} are wrong: {shown:#?}", wrong.len(), records.len());
        eprintln!("{name}: {} rays, largest error {worst:.1e} of the tolerance", records.len());
    }
}
