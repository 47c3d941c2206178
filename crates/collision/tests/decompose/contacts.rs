//! Two surfaces in contact, told by their convex parts.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Representation, Verdict, Work},
    decompose::Options,
    math::Pose,
    narrow::{Contacts, NeedsDecomposition, Placed, overlap, penetration},
    shape::{Geometry, GeometryError},
};

use crate::{
    cubes::{Cubes, Noise},
    sampled::{mesh_of, parts_of},
};

const EXACT: Accuracy = Accuracy::of(Tier::Exact);

/// An L of three cubes, and the same with its parts.
fn l_shape() -> [Geometry; 2] {
    let mut cubes = vec![false; 64];
    [0, 1, 4].into_iter().for_each(|cell| cubes[cell] = true);
    let (vertices, triangles) = Cubes(cubes).surface();
    let bare = Geometry::mesh(&vertices, &triangles).expect("a mesh");
    let options = Options::default();
    let parted = parts_of(&bare, &options).attached(&bare, &options).expect("a mesh");
    [bare, parted]
}

fn at(geometry: &Geometry, pose: Pose) -> Placed<'_> {
    Placed { geometry, pose }
}

fn contacts(a: Placed<'_>, b: Placed<'_>, max_gap: f64) -> Result<Contacts, NeedsDecomposition> {
    penetration(a, b, max_gap, &EXACT, &mut Work::default())
}

#[test]
fn parts_tell_how_deep_and_meshes_whether() {
    let [bare, parted] = l_shape();
    let parts = parted.parts().expect("parts");
    assert_eq!(parts.part_count, 2);
    let mut noise = Noise(0x1234);
    let (mut hits, mut apart, mut around) = (0, 0, 0);
    for _ in 0..300 {
        let rotation = DQuat::from_xyzw(noise.share(), noise.share() - 0.5, noise.share() - 0.5, noise.share());
        let pose = Pose::new(DVec3::splat(0.5) + noise.vector() * 2.0, rotation);
        let (here, there) = (at(&parted, Pose::IDENTITY), at(&parted, pose));
        let found = contacts(here, there, 0.25).expect("parts");
        let of_parts = contacts(at(&parts.whole, Pose::IDENTITY), at(&parts.whole, pose), 0.25).expect("no surfaces");
        let touch = overlap(at(&bare, Pose::IDENTITY), at(&bare, pose), &EXACT, &mut Work::default()).verdict;
        assert_eq!(found.len(), of_parts.len());
        for (contact, other) in found.iter().zip(&of_parts) {
            assert_eq!((contact.depth, contact.certificate.bound), (other.depth, other.certificate.bound));
            assert_eq!((contact.feature_a, contact.feature_b), (other.feature_a, other.feature_b));
            let model = contact.certificate.model;
            assert_eq!(model.representation, Representation::Decomposition, "it was measured on parts");
            let is_apart = contact.certificate.bound.upper < -model.outside;
            assert_eq!(contact.certificate.verdict, if is_apart { Verdict::Miss } else { touch });
            assert!(model.outside >= 2.0 * parts.outside.upper && model.inside < 1e-9);
        }
        let swapped = contacts(there, here, 0.25).expect("parts");
        assert_eq!(swapped.len(), found.len());
        // Parts are exact here: meshes that touch have parts that do.
        let is_deep = found.iter().any(|contact| contact.depth > 1e-9);
        assert!(touch != Verdict::Hit || found.iter().any(|contact| contact.depth > -1e-9));
        hits += u32::from(touch == Verdict::Hit);
        around += u32::from(touch == Verdict::Miss && is_deep);
        apart += u32::from(found.is_empty());
    }
    assert!(hits > 60 && apart > 30 && around == 0, "{hits} {apart} {around}");
}

#[test]
fn one_of_the_two_is_enough() {
    let [bare, parted] = l_shape();
    let pose = Pose::at(DVec3::new(0.9, 0.9, 0.1));
    let ask = |a, b| contacts(at(a, Pose::IDENTITY), at(b, pose), 0.0);
    assert_eq!(ask(&bare, &bare).err(), Some(NeedsDecomposition));
    for (a, b) in [(&bare, &parted), (&parted, &bare)] {
        let found = ask(a, b).expect("one has parts");
        assert!(found.iter().any(|contact| contact.certificate.verdict == Verdict::Hit && contact.depth > 0.0));
        let bears_parts = |contact: &collision::narrow::Contact| match std::ptr::eq(a, &parted) {
            true => contact.feature_a.part.is_some() && contact.feature_b.face.is_some(),
            false => contact.feature_b.part.is_some() && contact.feature_a.face.is_some(),
        };
        assert!(found.iter().all(bears_parts));
    }
}

/// A surface that lies within another without touching it: the parts are deep in each other, and the surfaces do not touch.
#[test]
fn what_lies_within_does_not_touch_the_surface() {
    let [_, parted] = l_shape();
    let mut cubes = vec![false; 64];
    cubes[0] = true;
    let (vertices, triangles) = Cubes(cubes).surface();
    let small: Vec<DVec3> = vertices.iter().map(|&vertex| 0.25 + 0.5 * vertex).collect();
    let small = Geometry::mesh(&small, &triangles).expect("a mesh");
    let options = Options::default();
    let small = parts_of(&small, &options).attached(&small, &options).expect("a mesh");
    let found = contacts(at(&parted, Pose::IDENTITY), at(&small, Pose::IDENTITY), 0.0).expect("parts");
    let deepest = found.first().expect("the parts overlap");
    assert!(deepest.depth > 0.5 && deepest.certificate.verdict == Verdict::Miss, "{deepest:?}");
}

#[test]
fn a_mesh_with_parts_is_another_geometry() {
    let [bare, parted] = l_shape();
    let asked = Options::default().asked();
    assert_eq!(asked, Options { max_parts: 32, ..Options::default() }.asked());
    assert_eq!(parted.id(), bare.id_with_parts(&asked));
    assert_ne!(parted.id(), bare.id());
    assert_ne!(parted.id(), bare.id_with_parts(&Options { max_parts: 7, ..Options::default() }.asked()));
    assert_ne!(parted.id(), bare.id_with_parts(&Options { max_error: 0.5, ..Options::default() }.asked()));
    assert!(bare.parts().is_none() && mesh_of(&parted).triangles() == mesh_of(&bare).triangles());
    assert!(parted.memory_bytes() > bare.memory_bytes());
    let scaled = parted.scaled(2.0);
    assert!(matches!(scaled, Err(GeometryError::Bad { field, .. }) if field == "scale"));
    let ball = Geometry::sphere(1.0).expect("a ball");
    let options = Options::default();
    assert!(parts_of(&bare, &options).attached(&ball, &options).is_err());
}
