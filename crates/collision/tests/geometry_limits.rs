//! What is accepted as a geometry, and that an error names the number that is wrong.

use collision::{
    DVec3,
    shape::{Geometry, GeometryError},
};

fn said(result: Result<Geometry, GeometryError>) -> String {
    result.expect_err("it is not a geometry").to_string()
}

#[test]
fn errors_name_field_and_component() {
    let v = DVec3::new;
    assert!(
        said(Geometry::sphere(0.0)).starts_with("radius is 0: it must be from 1e-9 to 1e9 metres (for a single point")
    );
    assert!(said(Geometry::sphere(f64::NAN)).starts_with("radius is NaN"));
    assert!(said(Geometry::sphere(-1.0)).starts_with("radius is -1"));
    assert!(said(Geometry::cuboid(v(1.0, -2.0, 1.0))).starts_with("half_extents.y is -2"));
    assert!(said(Geometry::cuboid(v(1.0, 1.0, 1e10))).starts_with("half_extents.z is 10000000000"));
    assert!(said(Geometry::cuboid(v(1e-10, 1.0, 1.0))).starts_with("half_extents.x is 0.0000000001"));
    assert!(said(Geometry::cuboid(DVec3::ZERO)).starts_with("half_extents: all are 0"));
    assert!(said(Geometry::capsule(f64::INFINITY, 1.0)).starts_with("half_height is inf"));
    assert!(said(Geometry::capsule(0.0, 0.0)).starts_with("radius: half_height and radius are both 0"));
    assert!(said(Geometry::hull(&[])).starts_with("points: is empty"));
    assert!(said(Geometry::hull(&[DVec3::ZERO, v(0.0, 0.0, f64::NAN)])).starts_with("points[1].z is NaN"));
    assert!(said(Geometry::hull(&[v(-2e12, 0.0, 0.0)])).starts_with("points[0].x is -2000000000000"));
    assert_eq!(said(Geometry::half_space(DVec3::ZERO, 0.0)), "normal: is 0: it must have a direction, of any length");
    assert!(said(Geometry::half_space(v(0.0, f64::NAN, 1.0), 0.0)).starts_with("normal.y is NaN"));
    assert!(said(Geometry::half_space(DVec3::Y, f64::INFINITY)).starts_with("offset is inf"));
    assert!(
        said(Geometry::half_space(DVec3::Y, -2e12)).starts_with("offset is -2000000000000: it must be within 1e12")
    );
    assert_eq!(said(Geometry::hull(&vec![DVec3::ONE; 65_537])), "points has 65537 items: at most 65536 are allowed");
}

#[test]
fn errors_of_meshes_name_the_index() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 2.0];
    assert_eq!(
        said(Geometry::mesh(&corners, &[[0, 1, 2], [0, 1, 9]])),
        "indices[5]: is 9: there are 4 vertices, so it must be below that"
    );
    assert!(said(Geometry::mesh(&corners, &[])).starts_with("indices: is empty"));
    assert!(said(Geometry::mesh(&corners, &[[0, 1, 3], [1, 1, 2]])).starts_with("indices: no triangle has an area"));
    let bad = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, f64::NEG_INFINITY, 0.0)];
    assert!(said(Geometry::mesh(&bad, &[[0, 1, 2]])).starts_with("vertices[2].y is -inf"));
    assert!(said(Geometry::mesh(&corners, &[[0, 1, 2]]).and_then(|mesh| mesh.rounded(0.5))).starts_with("rounding"));
}

#[test]
fn plates_sticks_segments_and_single_points_are_forms() {
    assert!(Geometry::cuboid(DVec3::new(1.0, 0.0, 2.0)).is_ok());
    assert!(Geometry::cuboid(DVec3::new(1.0, 0.0, 0.0)).is_ok());
    assert!(Geometry::capsule(1.0, 0.0).is_ok());
    assert!(Geometry::hull(&[DVec3::ONE]).is_ok());
    assert!(Geometry::sphere(1e-9).is_ok() && Geometry::sphere(1e9).is_ok());
}

#[test]
fn scaling_and_rounding_stay_within_the_limits() {
    assert!(
        said(Geometry::sphere(1.0).and_then(|ball| ball.scaled(0.0))).starts_with("scale is 0: it must be above 0")
    );
    assert!(said(Geometry::sphere(1.0).and_then(|ball| ball.scaled(1e10))).starts_with("scale is 10000000000"));
    assert!(said(Geometry::sphere(1.0).and_then(|ball| ball.scaled(f64::NAN))).starts_with("scale is NaN"));
    assert!(said(Geometry::hull(&[DVec3::ONE]).and_then(|hull| hull.scaled(1e13))).starts_with("scale"));
    assert!(said(Geometry::point().rounded(-1.0)).starts_with("rounding is -1"));
    assert!(said(Geometry::sphere(9e8).and_then(|ball| ball.rounded(9e8))).starts_with("rounding is 1800000000"));
    let far = || Geometry::half_space(DVec3::Y, 1e12);
    assert!(
        said(far().and_then(|space| space.rounded(1.0))).starts_with("rounding is 1: it must be such that the offset")
    );
    assert!(said(far().and_then(|space| space.scaled(2.0))).starts_with("scale is 2: it must be such that the offset"));
}

#[test]
fn equal_forms_have_equal_ids() -> Result<(), GeometryError> {
    let ball = Geometry::sphere(2.0)?;
    assert_eq!(ball.id(), Geometry::capsule(0.0, 2.0)?.id());
    assert_eq!(ball.id(), Geometry::point().rounded(2.0)?.id());
    assert_eq!(ball.id(), Geometry::sphere(1.0)?.scaled(2.0)?.id());
    assert_ne!(ball.id(), Geometry::sphere(2.0_f64.next_up())?.id());
    assert_eq!(Geometry::cuboid(DVec3::new(1.0, 0.0, 1.0))?.id(), Geometry::cuboid(DVec3::new(1.0, -0.0, 1.0))?.id());
    assert_ne!(Geometry::cuboid(DVec3::new(1.0, 2.0, 1.0))?.id(), Geometry::cuboid(DVec3::new(2.0, 1.0, 1.0))?.id());
    let floor = Geometry::half_space(DVec3::Y * 2.0, 1.5)?;
    assert_eq!(floor.id(), Geometry::half_space(DVec3::new(-0.0, 2.0, 0.0), 1.0)?.rounded(0.5)?.id());
    assert_eq!(floor.id(), Geometry::half_space(DVec3::Y * 2.0, 3.0)?.scaled(0.5)?.id());
    assert_ne!(floor.id(), Geometry::half_space(DVec3::Y, 1.5)?.id(), "the normal counts as it was sent");
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let signed = [-DVec3::ZERO, DVec3::X, DVec3::Y];
    let mesh = Geometry::mesh(&corners, &[[0, 1, 2]])?;
    assert_eq!(mesh.id(), Geometry::mesh(&signed, &[[0, 1, 2]])?.id());
    assert_ne!(mesh.id(), Geometry::mesh(&corners, &[[0, 2, 1]])?.id());
    assert_ne!(mesh.id(), Geometry::mesh(&corners, &[[0, 0, 1], [0, 1, 2]])?.id(), "faces are numbered otherwise");
    assert_ne!(mesh.id(), Geometry::hull(&corners)?.id());
    Ok(())
}
