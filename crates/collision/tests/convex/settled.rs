//! Gaps beside round forms, where vertices crowd together before the last digits are known.

use collision::{
    DQuat, DVec3,
    accuracy::{Accuracy, Tier},
    answer::{Certificate, Stop, Work},
    math::Pose,
    narrow::{self, Warm},
    shape::{Geometry, GeometryError},
};

use crate::random::{Body, Noise};

fn body(geometry: Result<Geometry, GeometryError>, position: [f64; 3], rotation: [f64; 4]) -> Body {
    let geometry = geometry.expect("a form");
    Body { geometry, pose: Pose::new(DVec3::from_array(position), DQuat::from_array(rotation)) }
}

fn hull(points: &[[f64; 3]]) -> Result<Geometry, GeometryError> {
    Geometry::hull(&points.iter().copied().map(DVec3::from_array).collect::<Vec<_>>())
}

/// The interval holds the truth and is as narrow as the arithmetic allows.
fn assert_settled(certificate: &Certificate, truth: f64, extent: f64, name: &str) {
    let bound = certificate.bound;
    let is_held = bound.lower - 1e-15 * extent <= truth && truth <= bound.upper + 1e-15 * extent;
    let is_narrow = bound.width() <= 5e-13 * extent;
    assert!(is_held && is_narrow && certificate.stop == Stop::Converged, "{name}: {truth:e}, {certificate:?}");
}

fn assert_distance(a: &Body, b: &Body, truth: f64, extent: f64, name: &str) {
    let exact = Accuracy::of(Tier::Exact);
    let found = narrow::distance(a.placed(), b.placed(), f64::INFINITY, &exact, &mut Work::default());
    assert_settled(&found.expect("no limit").certificate, truth, extent, name);
    let depth = narrow::depth(a.placed(), b.placed(), f64::INFINITY, &exact, &mut Work::default());
    assert_settled(&depth.expect("no limit").certificate, -truth, extent, name);
}

/// On a grid, where planes touch whole edges and faces: the gap of an upright cylinder and a box is that of a disc and a
/// rectangle beside the one between their heights; the base of a cone above the box is such a disc too.
#[test]
fn rims_beside_edges_are_measured_to_the_last_digits() {
    let noise = &mut Noise(71);
    let mut count = 0;
    for number in 0..30_000 {
        let mut eighths = |low: f64, high: f64| noise.between(low, high).floor() / 8.0;
        let half = DVec3::new(eighths(1.0, 7.0), eighths(1.0, 7.0), eighths(1.0, 7.0));
        let (half_height, radius) = (eighths(1.0, 9.0), eighths(1.0, 9.0));
        let at = DVec3::new(eighths(-12.0, 13.0), eighths(-12.0, 13.0), eighths(-12.0, 13.0));
        let above = at.y.abs() - half.y - half_height;
        let is_cone = number % 2 == 0;
        let beside = DVec3::new(at.x.abs() - half.x, 0.0, at.z.abs() - half.z).max(DVec3::ZERO).length() - radius;
        if above.max(beside) <= 0.0 || is_cone && (above < 0.0 || at.y < 0.0) {
            continue;
        }
        let round = if is_cone { Geometry::cone(half_height, radius) } else { Geometry::cylinder(half_height, radius) };
        let a = body(round, at.to_array(), [0.0, 0.0, 0.0, 1.0]);
        let b = body(Geometry::cuboid(half), [0.0; 3], [0.0, 0.0, 0.0, 1.0]);
        let truth = above.max(0.0).hypot(beside.max(0.0));
        assert_distance(&a, &b, truth, 4.0, &format!("{half_height} {radius} at {at} beside {half}"));
        count += 1;
    }
    assert!(count > 9_000, "only {count} are apart");
}

/// A lying cylinder beside an upright one, an ellipsoid beside a capsule, a stick beside a cylinder: the normal stands on an
/// edge. The truths are those of the oracle.
#[test]
fn normals_that_stand_on_an_edge() {
    let a = body(Geometry::cylinder(0.125, 0.5), [-1.0, -0.25, 0.125], [1.0, 0.0, 0.0, 1.0]);
    let b = body(Geometry::cylinder(0.5, 0.625), [0.25, -0.75, -0.625], [0.0, 0.0, 1.0, 0.0]);
    assert_distance(&a, &b, 0.3512812094883318, 1.0, "cylinders");

    let a = body(Geometry::ellipsoid(DVec3::new(5.0, 4.0, 1.0)), [-7.0, 3.0, 3.0], [0.0, 0.0, 0.0, 1.0]);
    let b = body(Geometry::capsule(3.0, 8.0), [2.0, 6.0, -5.0], [0.0, 0.0, 0.0, 1.0]);
    assert_distance(&a, &b, 6417.052219256093 / 8192.0, 16.0, "ellipsoid and capsule");

    let stick = hull(&[[-8.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [4.0, 0.0, 0.0]]).and_then(|stick| stick.rounded(1.0));
    let a = body(stick, [2.0, 1.0, -8.0], [1.0, 0.0, 0.0, 1.0]);
    let b = body(Geometry::cylinder(3.0, 1.0), [6.0, -3.0, 4.0], [0.0, 0.0, 1.0, 0.0]);
    assert_distance(&a, &b, 0.0012262403585433668 * 8192.0, 16.0, "stick and cylinder");
}

/// A ball about the corner of a rounded hull that is flat but for 1e-10 of it: not the corner is nearest but its face.
#[test]
fn a_hull_that_is_all_but_flat() {
    let corners = hull(&[
        [0.0, -3.733170636515601e-7, 0.0],
        [225.53232274109928, -2.0597905301427338e-7, 0.0],
        [0.0, 0.0, 426.74230803345836],
        [925.6631408460705, 0.0, 0.0],
        [384.7876606327595, 0.0, 197.10758113864404],
    ]);
    let turn = [-0.36380649922896424, -0.03746731951936704, -0.644505931863743, 0.6714559813414782];
    let a = body(Geometry::sphere(793.5146832774124), [0.0; 3], [0.0, 0.0, 0.0, 1.0]);
    let b = body(corners.and_then(|corners| corners.rounded(0.176000844805872)), [0.0; 3], turn);
    let exact = Accuracy::of(Tier::Exact);
    let found = narrow::depth(a.placed(), b.placed(), 0.0, &exact, &mut Work::default()).expect("they overlap");
    assert_settled(&found.certificate, 793.6906837489012, 1e3, "ball and hull");
}

/// Forms of which one is 1e10 times as large, or that are long and thin: to the search their gap is none, until a depth is
/// asked and turns out to be one.
#[test]
fn gaps_that_were_lost_among_slivers() {
    let large = hull(&[
        [-73.72174928874412, 6.533496035222214, 8.419343460014673],
        [13.575266588009129, -57.05202652982414, 86.92616231119152],
        [-96.65836631550891, 36.41624230714501, -3.001696247366894],
        [-80.64128092997196, 17.118359662563194, 98.14787200249603],
        [-0.1532275911087595, -34.391581999822975, -104.88647911734928],
    ]);
    let small = Geometry::ellipsoid(DVec3::new(2.4216707371691782e-8, 3.358179057323034e-8, 2.6008109191821512e-8));
    let turn = [-0.05356452697122332, 0.14293336886235997, 0.32036856029857563, -0.9349143699228414];
    let a = body(large, [47.29728223436689, -49.188260903991896, 87.93682538366652], turn);
    let turn = [-0.580318274984693, -0.07826193062458603, -0.7116918361110582, -0.3880728028947319];
    let b = body(small, [22.288304492146366, -8.301652098872722, 33.05878552575986], turn);
    assert_distance(&a, &b, 2.75042731882579e-9, 128.0, "hull and ellipsoid");

    let needle = hull(&[
        [0.2457878645001932, 9.60858720492688e-6, 9.301498605798574e-7],
        [-0.3415998495587289, -3.459727305835517e-5, -1.2915549279163176e-6],
        [0.3184164244017248, 9.917292494629146e-6, 1.2303232613020976e-6],
        [-0.10727498507712036, -8.084776543448993e-5, -1.031549268200909e-6],
    ]);
    let other = hull(&[
        [-0.21308713461689127, 1.0337839452656765, 0.09048615197374416],
        [0.5704072790482462, -0.5677689067282132, -0.013956336580179307],
        [0.33964027187140244, 1.137121826924147, -0.18973391738551654],
        [0.21392835406888727, -0.5193728783124985, 0.873671230957503],
        [0.4644970667566938, 1.1396849767795905, 0.9873726099936537],
        [1.2190141865770259, -0.252598511250491, 0.20844025854295328],
    ]);
    let turn = [-0.07689549409097934, 0.031961294234746813, -0.08296756111113278, -0.02807505097666377];
    let a = body(needle, [-0.255277027533511, -1.3720117898465143, 0.6843230050578714], turn);
    let turn = [-0.6362640891178015, 0.26445044752628416, -0.6864952235205638, -0.2322892115137798];
    let b = body(other, [-0.6902114800694276, -0.4554143734523249, 0.5623218484403718], turn);
    let exact = Accuracy::of(Tier::Exact);
    let found = narrow::depth(a.placed(), b.placed(), 1.0, &exact, &mut Work::default()).expect("near");
    assert_settled(&found.certificate, 1.9503396219618254e-14, 1.5, "needle and hull");
}

/// A needle whose width is a rounding of what it lies across, and a rod: a search that began with what was nearest at another pose
/// ended beside the needle, though the cores cross.
#[test]
fn a_warm_contact_of_needles_is_as_narrow_as_a_cold_one() {
    let needle = hull(&[
        [0.0, 2.982599465413215e-13, -5e-324],
        [-0.0, 2.557979727583808e-173, -5e-324],
        [8.8092133174e-314, 5e-324, 5e-324],
        [-5.633916905907569e-164, 1.6521486649871223e-12, 0.0],
        [-5e-324, -8.060819950939724e-13, -2.801571983281584e-164],
        [-6.045272535036245e-164, -1.1893562041176087e-12, -0.0],
        [-1.0673940297711057e-163, 7.549574261201007e-13, 0.0007712933326366133],
    ]);
    let rod = hull(&[[0.0005466646424781524, 0.0, 0.0], [5e-324, 0.0, 0.0], [-0.00043109262605134206, 0.0, 0.0]]);
    let rod = rod.and_then(|rod| rod.rounded(1.459434380204321e-5));
    let turn_a = [-0.24975748017695168, -0.6726638511650104, 0.6955724298787926, -0.03638047861186321];
    let turn_b = [-0.7734594253545455, -0.8782449716855545, 0.6325993342459572, -1.2029998325081588];
    let (a, b) = (body(needle, [0.0; 3], turn_a), body(rod, [0.0; 3], turn_b));
    let exact = Accuracy::of(Tier::Exact);
    let noise = &mut Noise(83);
    for _ in 0..20_000 {
        let nearness = 10.0_f64.powf(noise.between(-16.0, -3.0));
        let before =
            Pose::new(noise.vector() * nearness, if noise.signed() > 0.0 { noise.rotation() } else { b.pose.rotation });
        let (warm, work) = (&mut Warm::default(), &mut Work::default());
        let there = narrow::Placed { pose: before, ..b.placed() };
        narrow::penetration_warm(a.placed(), there, 0.0, &exact, warm, work).expect("convex forms");
        let found = narrow::penetration_warm(a.placed(), b.placed(), 0.0, &exact, warm, work).expect("convex forms");
        assert_settled(&found[0].certificate, 1.459434380204321e-5, 1.5e-3, &format!("from {before:?}"));
    }
}

/// A depth of a tiny cylinder in a large hull, for which the standard budget is too little: it said to have converged.
#[test]
fn a_depth_that_the_budget_leaves_wide_says_so() {
    let hull = hull(&[
        [-0.6608998359883911, 0.49329299573435526, -0.6839608427554782],
        [-0.6608998359883911, -0.7632205134774608, 0.12989780037166643],
        [-0.6608998359883911, 0.17997598354907907, -0.41607546357607905],
        [-0.6608998359883911, -0.1957127484516208, -0.946885546074963],
    ]);
    let cylinder = Geometry::cylinder(7.817209796867917e-6, 1.696781025133732e-5);
    let turn = [0.8463699582566698, 0.12188463017169744, 0.2697885838877439, 0.4427371123955584];
    let a = body(cylinder, [-0.8521323392241408, 0.299200057621296, -0.0821729948245794], turn);
    let turn = [0.002443444886636884, 0.543996175142993, -0.5577651621775549, 0.6268653881559628];
    let b = body(hull, [-0.8373083785396392, -0.4829581583987469, -0.25625396867836225], turn);
    let mut wide = 0;
    for budget in [8, 16, 32, 64, 128, 256, 512, 4096] {
        for max_error_relative in [0.0, 1e-6] {
            let accuracy = Accuracy { max_error: 0.0, max_error_relative, budget, ..Accuracy::of(Tier::Standard) };
            let found =
                narrow::depth(a.placed(), b.placed(), 0.0, &accuracy, &mut Work::default()).expect("they overlap");
            let Certificate { bound, stop, .. } = found.certificate;
            let is_wide = bound.width() > 1e-11 && bound.width() > max_error_relative * bound.lower;
            wide += u32::from(is_wide);
            assert!(!is_wide || stop == Stop::Budget, "{budget} iterations, {max_error_relative}: {found:?}");
        }
    }
    assert!(wide > 2, "{wide} are wide");
}

/// A point beside the tip of a needle, which no plane of the needle's faces is across.
#[test]
fn the_gap_to_the_tip_of_a_needle_is_as_narrow_as_rounding() {
    let point = hull(&[[0.5790621674429848, -0.5813867075239215, 0.537537601724321]; 4]);
    let needle = hull(&[
        [0.8411748920990103, 7.284930665235909e-8, -2.9015343592217633e-6],
        [-0.9933607103268896, 1.8192632542812264e-6, -7.178237347944273e-6],
        [0.280456795965091, -2.9621918907532115e-7, 2.0571423422528617e-5],
        [0.03711999250760356, -1.681514972333932e-6, -1.589525620778112e-5],
    ]);
    let turn = [0.7970329851242953, 0.4582541144943291, 0.39307589972831747, -0.01526185524917667];
    let a = body(point, [-6749219.057960756, -10100720.400204962, 11405758.960864672], turn);
    let turn = [1.932970163801554, 3.2529078031764773, 0.34499646901748626, 0.5095753734878906];
    let b = body(needle, [-6749218.61967935, -10100720.180393733, 11405758.87872449], turn);
    for (a, b) in [(&a, &b), (&b, &a)] {
        assert_distance(a, b, 4.664680728758247e-10, 10.0, "the tip");
    }
}
