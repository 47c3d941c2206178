//! Every number that decides geometry, each with its reason, what gets worse when it changes, and the test that pins it.
//!
//! Kernels work on a pair scaled so that its extent `S` lies in [1, 2), so these numbers have no unit.

/// Half a unit in the last place of 1: one rounded f64 operation is off by at most this part of its result.
pub const ROUNDING: f64 = f64::EPSILON / 2.0;

/// Widens the exit of a slab test so that no box is lost: `t = fl(fl(wall − origin) · fl(1/d))` has three roundings, so it is off by γ₃ of
/// itself, and so is the `t` it is compared with: `1 + 2γ₃` (Ize 2013), here with one more rounding for the product itself. Smaller loses
/// rays that graze edges; larger only visits more nodes. [`SLAB_SLACK`] covers the same rounding once more as long as it is taken relative
/// to the farthest coordinate of a whole tree, so `tests/broad/fixed.rs` fails only if both are too small.
pub const SLAB_WIDENING: f64 = 1.0 + 8.0 * ROUNDING;

/// Turns a computed entry (three roundings, as above) or a length that is the root of a sum of three squares (at most
/// four) into a lower bound of the true one. Nearer to 1 it is none; farther from it only visits more nodes. Pinned by
/// `the_bound_of_a_distance_is_never_above_it` in `tests/broad/fixed.rs`.
pub const SLAB_NARROWING: f64 = 1.0 - 8.0 * ROUNDING;

/// How far the walls of a box are moved out before a slab test, as a part of the largest coordinate that takes part:
/// two roundings of `wall ∓ reach` and four that the caller's path may carry (a position rotated into a frame).
/// Smaller loses rays that lie in a wall; larger only visits more nodes. Pinned by `tests/broad/fixed.rs`.
pub const SLAB_SLACK: f64 = 8.0 * ROUNDING;

/// A sum of squares above this has all its digits: the smallest normal number, with room for the digits of squares that are 2⁻⁵³ of the
/// largest. Below it a length is taken as 0 where a lower bound is asked, and a vector has no direction: that is lengths of 1e-138 m.
/// Smaller, and unit vectors have another length. Pinned by `what_has_no_exact_square_has_no_unit_vector` in `math/norm.rs`.
pub const SQUARE_MIN: f64 = 1e-276;

/// A component of `a × b` is off by less than this part of `2·max|a|·max|b|`, the rounding of `a` and `b` themselves as differences
/// included: two factors of one rounding each, a product and a difference make four, and two are spare. Larger: more triangles take the
/// exact test. Smaller: an area might be seen where there is none. Test: `geometry_mesh.rs`, slivers.
pub const CROSS_PRODUCT: f64 = 12.0 * ROUNDING;

/// How far the height of a point above a corner, along the unit normal of a triangle or of one of its sides, may be off as a
/// part of their distance: the normal is right to 16 roundings (a cross product of a cross product, each made a unit vector),
/// the product adds 4 and the difference one for each coordinate; 64 are taken. Larger: more points near a surface are
/// undecided. Smaller: a point on the surface might be taken for one inside. Test: `geometry_solid.rs`, balls.
pub const TRIANGLE_PLANE: f64 = 64.0 * ROUNDING;

/// The sine of the angle by which the surface of a mesh may rise along a direction that still counts as its normal there, and by which a
/// triangle may lean that is still touched with its face: 2⁻²⁰, a millionth. Normals of gaps are right to far less, but those of round
/// forms that all but touch are not. Larger: a form may feel an edge of a flat floor. Smaller: where no triangle's normal is right enough,
/// all are taken for those of edges beside it. Pinned by `tests/mesh_floors.rs`.
pub const SURFACE_LEAN: f64 = 1.0 / 1_048_576.0;

/// A triangle's `a × b` that is smaller than this part of `max|a|·max|b|`, 2⁻⁴⁰, is found by exact sums. Where it is larger, the
/// products of two roundings that the first order leaves out are less than 2⁻⁶⁴ of it. Larger: more triangles take exact sums.
/// Smaller: the normals of needles lean. Test: `convex/hull.rs`, needles.
pub const SLIVER_CROSS: f64 = 8192.0 * ROUNDING;

/// A coordinate of a rotated point is off by less than this part of the point's reach. The unit quaternion's components
/// are right to 6 roundings, the matrix' entries to 32 (the diagonal, `1 - (yy + zz)`, is the worst), a row has at most
/// √3 of the reach as the sum of absolute values, and the product adds 4 more: 32·√3 + 4·√3 < 64. Larger: boxes are
/// wider. Smaller: a box might not hold its shape. Test: `geometry_bounds.rs`, exact rational rotations.
pub const ROTATED_COORDINATE: f64 = 64.0 * ROUNDING;

/// How far a support value of a pair (in its frame, `S` in [1, 2)) may be from the exact one for the numbers sent:
/// 2⁻⁴⁶, that is 128 roundings of 1.
///
/// The entries of a rotation matrix are right to 32 roundings (see [`ROTATED_COORDINATE`]), those of the relative rotation
/// to 64 and the 3 of the product; a row of three makes at most √3 of that, 116, of a corner's reach, which together with
/// the distance is what `S` sums up. The difference of positions (1), the sum (1), the difference of the two sides (1), the
/// product with a unit vector (3) and that vector's length (2) add 8. Smaller, and intervals would miss the truth;
/// larger, and they would be wider than the arithmetic needs. Pinned by the oracle sets: no interval may miss
/// (the conformance runner).
pub const PAIR_ROUNDING: f64 = 128.0 * ROUNDING;

/// How far the depth along the best of the separating axes may lie above the true depth, beside the rounding of the
/// support values: the computed axis leans by up to 4 roundings over the thickness of the feature it belongs to. Pinned by
/// the oracle sets (the conformance runner), near-parallel edges above all.
pub const AXIS_LEAN: f64 = 4.0 * PAIR_ROUNDING;

/// How far `u × v` may be from the exact one, as a part of `|u| |v|`, where both are differences of corners: each of the
/// two has one rounding, the product and the difference make two more in each component, and a product with a third vector
/// adds three: less than 16, and four times that is taken because it is needed for slivers only. Smaller, and the faces of a
/// sliver might prove a depth that is not there; larger, and more overlaps are left to the separating axes. Pinned by
/// `a_sliver_proves_no_depth_that_is_not_there` in `tests/convex/extremes.rs`.
pub const CROSS_BLUR: f64 = 64.0 * ROUNDING;

/// How far the product of two unit vectors may be from 0 and still leave open on which side of an arc of the Gauss map a
/// face normal lies: both vectors are right to 4 roundings in each component and the sum of three products adds 3. Smaller,
/// and the edge pair of least depth might be passed over; larger, and more pairs are measured in full. Pinned by the
/// conformance runner, parallel and identical boxes above all.
pub const ARC_DOUBT: f64 = 16.0 * ROUNDING;

/// Shortens each step of an advancement, so that the quotient's rounding and the sum's never take it past the plane that
/// proved it free. Nearer to 1 it is no proof; farther from it steps are added. Pinned by
/// `an_impact_lies_between_a_free_and_a_touching_instant` in `tests/convex/laws.rs`.
pub const STEP_SHORTENING: f64 = 1.0 - 16.0 * ROUNDING;

/// How far a gap of a pair in a motion that turns may be off beyond [`PAIR_ROUNDING`]: the turn of each form at a time is
/// one more rotation. Its matrix is made of an axis right to 4 roundings and of a sine and a cosine right to 2, so each
/// entry is right to 32, as those of the rotation at the start are. Four such matrices are multiplied: 4 · 32·√3 for the
/// factors and 9 for the products make 231, a row of three at most √3 of that, 400, of a corner's reach; the place at a time
/// adds a difference, a product and a sum. A turn that is told by where it ends is off by 64 more
/// ([`crate::math::Pose::rotation_vector_to`]). That is within 640, of which [`PAIR_ROUNDING`] is 128. Smaller, and an interval
/// might miss the truth; larger, and intervals are wider. Pinned by `tests/convex/turning.rs` and the conformance runner.
pub const MOTION_ROUNDING: f64 = 512.0 * ROUNDING;

/// What the angle of a turn may be off by, as a part of itself: 5 roundings for the length of the rotation vector, one for
/// the part of the time. Points go astray by that much of the way that turning took them, however many turns it is.
/// Pinned by `many_turns_end_where_they_should` in `tests/convex/turning.rs`.
pub const ANGLE_ROUNDING: f64 = 8.0 * ROUNDING;

/// Widens bounds of speeds and of their changes: what a few dozen roundings may take off them is a millionth of this.
/// Larger: shorter steps. Smaller than those roundings: a step might be no proof. Pinned by
/// `the_way_is_free_before_and_closed_after` in `tests/convex/turning.rs`.
pub const BEND_WIDENING: f64 = 1.0 + 1.0 / 1_048_576.0;

/// Sine of the angle within which a face counts as lying flat on the other shape, when contact points are chosen. Larger,
/// and tilted faces get points of a touch they do not have; smaller, and the rounding of a normal splits a resting face
/// into single points. It changes which points are shown, never a depth. Pinned by `tests/convex/contact.rs`.
pub const FLAT_CONTACT_SINE: f64 = 1.0 / 1_048_576.0;

/// Makes a computed length an upper bound: three squares, two sums and a root are off by less than 4 roundings, and the
/// scale taken out of them by 2 more. Larger: wider boxes. Smaller: a reach that is too short. Test: `geometry_bounds.rs`.
pub const LENGTH_WIDENING: f64 = 1.0 + 8.0 * ROUNDING;

/// Parts of exact sums may be from this to [`EXACT_PART_MAX`] in size: products of four of them, and the errors of those,
/// which are 2⁻¹⁰⁶ of them, then stay far from both ends of f64. Outside of that nothing is decided exactly.
pub const EXACT_PART_MIN: f64 = 1e-60;

/// See [`EXACT_PART_MIN`].
pub const EXACT_PART_MAX: f64 = 1e60;

/// A ray's direction, made a unit vector, is off by less than this: two roundings in a square root's argument count half,
/// with the root, the quotient and the scale they are under four, along the vector; √3 for three components. Larger: more
/// rays near an edge stay undecided. Smaller: a wrong verdict there. Test: `ray_exact.rs`.
pub const RAY_DIRECTION: f64 = 8.0 * ROUNDING;

/// The same in the axes of a turned target: [`ROTATED_COORDINATE`] for each of three components, √3 · 64 = 111, and 8.
pub const RAY_TURNED_DIRECTION: f64 = 128.0 * ROUNDING;

/// What turning a ray into its target's frame costs, as a part of its way from the target's position to where it may touch:
/// 111 roundings for the origin, 119 for the direction over the whole way, and 4 for the difference of positions. Test: `ray_exact.rs`, turned forms.
pub const RAY_TURNED_FRAME: f64 = 256.0 * ROUNDING;

/// What the kernels for rays cost, as a part of the ray's extent about the target's centre: 8 roundings for the direction, 3
/// for the foot, 2 for the distance counted from it, at most 12 for an edge, a plane or a chord relative to it. All of
/// these are under 32; twice that is taken, since bounds are themselves computed with rounding. Larger: more undecided
/// rays. Smaller: wrong verdicts. Test: `ray_exact.rs`, `ray_forms.rs`, `ray_rounded.rs` and the ray sets of the data.
pub const RAY_KERNEL: f64 = 64.0 * ROUNDING;

/// How far a corner seen along a ray may be off in f32, as a part of its distance from the ray's foot: 5 roundings of products that are
/// at most the distance in all, and 8 are taken, so that those of f64 do not matter. Larger: more triangles are asked in f64. Smaller: a
/// touch might be passed over. Pinned by `nothing_that_is_touched_is_passed_by` in `narrow/ray/sieve.rs`.
pub const SIEVE_CORNER: f64 = 4.0 * f32::EPSILON as f64;

/// The same of an area of two such corners, as a part of the square of the larger coordinate: 4 roundings, and 8 are taken.
pub const SIEVE_AREA: f32 = 4.0 * f32::EPSILON;

/// Where a triangle's plane is met only to within this many times the ray's error, exact sums are used if they can be: at grazing
/// incidence, and for slivers. Larger: wider intervals (`ray_data.rs` bounds them); smaller: more time. Never a verdict.
pub const RAY_GRAZING: f64 = 32.0;

/// A quotient of two exact sums, each estimated to 3 roundings, times a length (4) and by another quotient and product: 12; twice that and
/// some for sums whose parts overlap in no bit but round upwards together. As a part of the distance. Larger: wider intervals. Smaller: one
/// might not hold the truth. Test: `ray_exact.rs`, grazing rays, to within the rounding of its own truth.
pub const EXACT_MEETING: f64 = 32.0 * ROUNDING;

/// Widens a length that is turned into a `t` of a search by dividing it by the length of the direction (root of a sum of
/// three squares, four roundings; the division, this product, and as many on the way back): a shape that is passed over
/// because its `t` is beyond the limit must be beyond it in metres as well, or answers would depend on the tree. Larger
/// only visits more nodes. Pinned by `what_ends_at_the_limit_is_still_offered` in `world/raycast.rs`.
pub const LIMIT_WIDENING: f64 = 1.0 + 64.0 * ROUNDING;

/// How far the height of a point above a plane may be from the exact one, as a part of the sum of the sizes that make it up (the components
/// of the difference of positions, and the offset), before it is rounded to one f64: 256·2⁻¹⁰⁶. Each operation in numbers of twice the
/// length is off by 16·2⁻¹⁰⁶ at most, most by 3 to 5. A turned normal is the product of 3 of them in a row and 5 sums, a unit one of a root
/// and a quotient more: 100 in all; the height adds a product and 3 sums. Larger: wider intervals, at heights below 2⁻⁹⁸ of the way only.
/// Smaller: one might miss the truth. Pinned by `a_turned_normal_is_right_to_twice_the_digits` in `narrow/half_space/plane.rs`.
pub const TWOFOLD_HEIGHT: f64 = 256.0 * ROUNDING * ROUNDING;

/// What the lowest point of an unturned form along a unit normal costs, as a part of its reach: the normal is the nearest to the true one
/// (1, as a vector), the dot product has 3 roundings, and so has the comparison that chose the corner; the point of a round core has 6.
/// Larger: wider intervals. Smaller: one might miss the truth. Pinned by `intervals_hold_the_exact_height` in `tests/convex/half_space.rs`.
pub const LOWEST_POINT: f64 = 16.0 * ROUNDING;

/// The same for a turned form: the entries of its rotation are right to 32 roundings, 3 of √3 of them make 104 as a vector,
/// with the roundings of the product; 16 more as in [`LOWEST_POINT`]. Pinned likewise.
pub const TURNED_LOWEST_POINT: f64 = 128.0 * ROUNDING;

/// What the height of a point above a plane may be off by for its own rounding, as a part of the plane's axis and of the lengths in
/// play: a difference, three products and two sums make 5, the reach of a form along the axis as many, its length 2; 16 are taken.
/// Larger: more triangles come to a kernel. Smaller: a touch might be passed over. Test: `narrow/pieces/rod.rs`, touches.
pub const AXIS_ROUNDING: f64 = 16.0 * ROUNDING;

/// One form's pose in the frame of another is off by less than this part of their distance and reach: 111 roundings for a position turned
/// into the frame, and 4 · 30 · √3 for the product of two rounded unit quaternions as a rotation, 319 together. The pose of a part of a
/// compound is off by as much, counted as a length. Larger: more triangles are looked at, and intervals of parts are wider; smaller: one
/// might not be, or miss the truth. Test: `pieces_laws.rs`, exact touch, and `compounds.rs`, whole rotations.
pub const RELATIVE_POSE: f64 = 512.0 * ROUNDING;

/// How far the axes of a part may lean from where its pose puts them: a product of two rotations leans by less than 208
/// roundings, as in [`RELATIVE_POSE`], and compounds are in each other four deep at most; twice that is taken. Larger: more
/// rays that graze a triangle of a part are undecided. Smaller: a triangle might be seen from the wrong side. Test:
/// `compounds.rs`, rays.
pub const PART_LEAN: f64 = 2048.0 * ROUNDING;

/// How far the height of a height field's surface at a point may be from the exact one, and the place of the point from
/// the computed one, as a part of all coordinates that take part: a sample's place has one rounding, a share along the cell
/// four, a height on a triangle eight more; twice that is taken. Larger: more points close to the surface are open. Smaller: a
/// point might be said to be in it that is not. Test: `concave/fields.rs`.
pub const STANDING: f64 = 32.0 * ROUNDING;

/// How far corners of one triangle may differ in height along its normal, and how far a point must lie above a plane to
/// see it, while a polytope expands: 16 roundings, since three products and two sums of values below 2 are off by at most 8,
/// and the normal by as much again. Smaller, and planes that are one in truth are split by rounding into slivers; larger,
/// and the last expansions, which bring less than this, are left out. Pinned by the coverage runner (widths of depths).
pub const FACE_HEIGHT: f64 = 16.0 * ROUNDING;

/// An expanding polytope that ends wider than this leaves polytopes to the separating axes: 16 errors of a support value,
/// where it ends within 4 unless slivers are in the way. Smaller, and exact answers are sought twice; larger, and depths
/// are known to less than the arithmetic can tell. A gap that settles wider than this is searched on along the normals of
/// straight features. Pinned by the coverage runner (widths of depths), and by `tests/convex/settled.rs`.
pub const DEPTH_WIDTH: f64 = 16.0 * PAIR_ROUNDING;

/// How far two heights `v · d`, or the height of a difference of corners, may be from the exact ones, as a part of what
/// their three products could sum up to: three roundings each for two heights, or one for the difference, one for the
/// product and two for the sum; 8 are taken. Larger: more walks over a hull end with exact signs. Smaller: a walk might
/// end below the highest corner. Test: `convex/support.rs`, bends and nearly equal corners.
pub const CLIMB_DOUBT: f64 = 8.0 * ROUNDING;

/// How far the depth of a contact point may be from that of the two surfaces there: each of its two points lies on its
/// surface to within a support value's error, and clipping and projecting add as much again. Smaller, and a point's interval
/// might miss; larger, and it would be wider than need be. Pinned by `tests/convex/contact.rs` and `tests/convex/points.rs`.
pub const POINT_DEPTH: f64 = 4.0 * PAIR_ROUNDING;

/// How far the length of `Σ wᵢ(p − vᵢ)` may be from that of `Σ wᵢ(p − vᵢ) / Σ wᵢ`, as a part of `Σ wᵢ|p − vᵢ|`, where
/// `Σ wᵢ` is 1 but for rounding: 4 for that, one for each difference, one for the product and two for the sum of three;
/// twice that is taken, for the rounding of this bound itself. Larger: wider bounds. Smaller: a simplified hull might state
/// less than what it leaves out. Test: `convex/simplify.rs`.
pub const WITNESS_ROUNDING: f64 = 16.0 * ROUNDING;

/// How far the distance between a point of a stand-in and a point of a geometry may be from the exact one beyond its own
/// rounding, as a part of the geometry's reach: a point that is strewn on a triangle, or turned with a part, is off by at most
/// 64 roundings four compounds deep each, and one that steps towards a corner 32 times by 4 each time; 512 cover both. Larger:
/// wider intervals. Smaller: an upper bound might be none. Test: `ladder/rungs.rs`.
pub const STAND_IN_ROUNDING: f64 = 512.0 * ROUNDING;

/// A triangle of an expanding polytope of less than half this area (2⁻¹⁸) is a sliver or a crumb: its plane may lean by
/// 2⁻²⁶ and more, so its distance is taken along the way to its nearest point as well, and on which side of it the origin lies
/// is asked exactly. Smaller, and a crumb's plane might pass close to the origin, so that it is expanded for nothing; larger,
/// and more is computed for each triangle. Pinned by the coverage runner (widths of depths).
pub const SMALL_AREA: f64 = 1.0 / 262_144.0;

/// A volume `a × b · c` of vectors shorter than 2 is off by less than this: 3 roundings for each product of two and its
/// difference, 3 for the sum, on values of up to 8 each, make 144 roundings; 512 are taken. Larger: more exact signs are
/// asked. Smaller: a sign might be wrong. Pinned by the coverage runner.
pub const VOLUME_DOUBT: f64 = 512.0 * ROUNDING;

/// Axes of two bodies of revolution that lean from each other by less than this (the sine) are measured as if they were
/// parallel. What that may be off by is added to the bounds, so a larger one is never wrong, only of no use: beyond it the
/// expanding polytope is nearly always narrower. Smaller, and the depths of nearly parallel forms stay wide. Pinned by
/// `a_lean_widens_the_depth_by_no_more_than_itself` in `tests/convex/revolved.rs`.
pub const NEARLY_PARALLEL_SINE: f64 = 1.0 / 1024.0;

/// What the ball about a point inside an ellipsoid costs: `Σ pᵢ²/dᵢ`, which is at most 1, has terms right to 8 roundings (4
/// for `dᵢ`, 3 for square and quotient, 1 for the sum), and the difference to 1 one more; 16 are taken. As a part of the depth
/// that is half of this over the point's share, at most 8 roundings of the greatest radius, far below [`PAIR_ROUNDING`]:
/// larger: wider depths. Smaller: a depth might be claimed that is not there. Pinned by the coverage runner (depths of
/// points in ellipsoids).
pub const BALL_INSIDE: f64 = 16.0 * ROUNDING;

/// Coordinates of a point below this, in the pair's frame, are taken for 0 beside an ellipsoid: 128 times below the rounding
/// of the position. Smaller would do down to where squares leave the range of f64. Pinned by
/// `a_point_all_but_on_an_axis` in `tests/convex/ellipsoid.rs`.
pub const ON_AXIS: f64 = ROUNDING / 128.0;

/// How far a number that was rounded to f32 is moved outwards, as a part of itself: one unit in the last place or more, where
/// rounding moved it by half of one. Smaller loses boxes that touch; larger only visits more nodes. Pinned by
/// `a_local_box_holds_what_it_stands_for` in `broad/local.rs`.
pub const TREE_WIDENING: f32 = f32::EPSILON;

/// How far a path is widened before it is tested against boxes in f32, as a part of where it begins, its reach and its length
/// within the box of the cell: one rounding of the origin and the reach, one of the direction times the length, and as much
/// again. Smaller loses boxes that are grazed; larger only visits more nodes. Pinned by
/// `a_path_through_a_point_of_a_box_meets_it` in `tests/broad/fixed.rs`.
pub const TREE_SLACK: f64 = f32::EPSILON as f64 * 2.0;

/// As [`SLAB_WIDENING`], in f32.
pub const TREE_SLAB_WIDENING: f32 = 1.0 + 4.0 * f32::EPSILON;

/// Turns a squared distance of boxes in f32 (three roundings of gaps and squares, two of the sum) into a lower bound.
/// Nearer to 1 it is none; farther from it only visits more nodes. Pinned by
/// `a_limit_that_shrinks_still_finds_the_first_and_the_nearest` in `tests/broad/fixed.rs`.
pub const TREE_NARROWING: f32 = 1.0 - 8.0 * f32::EPSILON;

/// Widens a limit that is rounded to f32, and the square of one, so that it is not below the true one. Larger only visits
/// more nodes. Pinned with [`TREE_NARROWING`].
pub const TREE_LIMIT_WIDENING: f64 = 1.0 + 4.0 * f32::EPSILON as f64;

/// How far off the place of a box along a subject's turned axes may be, as a part of the sum of all coordinates that take
/// part: the entries of the rotation are right to 32 roundings, which count for the middle of the box and again for its
/// half extents, and the differences and products add 8. Larger looks at more shapes; smaller might pass over one that
/// touches. Pinned by `what_touches_the_surface_is_looked_at` in `world/outline.rs`.
pub const OUTLINE: f64 = 128.0 * ROUNDING;

/// What a box on the way between two poses is widened by beyond what the arc takes, as a part of the farthest coordinate
/// that takes part: an interpolated rotation is right to 64 roundings in its vector, 32 in its matrix and as many in the
/// box made of that, a position to three. Smaller loses shapes that are asked for between two ticks; larger only visits
/// more nodes. Pinned by `the_box_of_a_track_holds_it_at_every_moment` in `world/history/track.rs`.
pub const ON_THE_WAY: f64 = 1024.0 * ROUNDING;

/// How far an arc is from the straight way between its ends, in radii, for the square of the distance of the two unit
/// quaternions: an eighth of the square of `4·1.1107/2`, rounded up. Smaller loses shapes that turn; larger only visits
/// more nodes. Pinned by `the_box_of_a_track_holds_it_at_every_moment` in `world/history/track.rs`.
pub const ARC_HEIGHT: f64 = 0.617;

/// Axes of two round forms that lean from each other by less than this (the sine) are one in a search over directions: points
/// that go round on the one stay on the other's form to within this part of their reach, a quarter of [`PAIR_ROUNDING`]. Larger: a depth might be claimed that is not there.
/// Smaller: forms turned alike by different roundings have a circle of equal ways out that cannot be followed. Pinned by
/// `a_capsule_on_the_axis_of_an_ellipsoid_is_as_deep_as_both_are_wide` in `tests/convex/directions.rs`.
pub const PARALLEL_LEAN: f64 = 16.0 * ROUNDING;

/// How far a normal that stands on an edge is tilted to either side, so that support points are those of the edge's two ends:
/// 2⁻³⁰, far above the rounding of a unit vector, and the square of it, which is what a round form on the other side loses
/// by the tilt, is far below. Larger or smaller by a few thousand changes little. Pinned by
/// `rims_beside_edges_are_measured_to_the_last_digits` in `tests/convex/settled.rs`.
pub const EDGE_TILT: f64 = 1.0 / 1_073_741_824.0;

/// Two unit normals of planes that a character must not go into are taken for the same plane if they are nearer than this.
/// Larger: it slides off a bend by as much of its way. Smaller: the triangles of a flat floor are many planes, which costs
/// time. Pinned by `world/character.rs`, the floor of triangles.
pub const SAME_PLANE: f64 = 1e-9;

/// A way goes into a plane if more than this part of its length does. A shadow of a way on a plane is off by some roundings
/// of the way. Larger: a character sinks by as much of its way in each stride. Smaller: it sticks to planes it slides
/// along. Pinned by `no_way_that_is_allowed_is_nearer_to_the_wish`.
pub const SLIDE_SLACK: f64 = 1e-14;

/// How much thinner than its skin, as a part of it, a character is swept, and how much farther out than its skin, twice this, it looks
/// for planes. Larger: planes bend its way before they are reached. Smaller: sweeps along a wall begin so near to touching it
/// that rounding leaves open whether they do. Pinned by `world/character.rs`, walls, stairs and the floor of triangles.
pub const SKIN_MARGIN: f64 = 1.0 / 128.0;

/// The skin that a character without one has for that margin, as a part of its reach: 2⁻²⁰. Larger and smaller: as for
/// [`SKIN_MARGIN`]. Pinned by `world/character.rs`, no skin.
pub const SKIN_MIN: f64 = 1.0 / 1_048_576.0;

/// Whatever is asked, the interval of a first touch is no wider than this part of its time, 2⁻⁶. Larger: what is known less well hides
/// more of what may be touched later, and looking there costs more than is spared here. Smaller: a step in twenty more for a
/// decade, measured among columns, needles and coins. Pinned by `convex/turning.rs`, whatever is asked.
pub const WIDEST_OF_TIME: f64 = 1.0 / 64.0;

/// The same as a part of the motion, 2⁻⁸, for touches soon after its start. Larger and smaller: as for [`WIDEST_OF_TIME`]. Pinned by
/// the same test.
pub const WIDEST_OF_MOTION: f64 = 1.0 / 256.0;

/// What is left of a way is not gone if it is less than this part of the whole, 2⁻⁴⁰. Larger: ways end short. Smaller:
/// strides are spent on roundings. Pinned by `world/character.rs`, corners.
pub const STRIDE_MIN: f64 = 8192.0 * ROUNDING;

/// How much farther than the width of an overlap, as a part of the coordinates and sizes it is found with, a way out leads: 2⁻⁴⁴,
/// some hundred roundings of the place where it ends. Larger: ways are longer by as much. Smaller: what was parted may be found
/// to touch by rounding, which costs another pass. Pinned by `world/depenetrate.rs`, far out.
pub const CLEARANCE: f64 = 512.0 * ROUNDING;

/// How far beside an edge, as a part of its reach, a character looks for the surface that the edge belongs to. Larger: ledges
/// that are narrower than this are no floors. Smaller: rounding of the contact point may miss the surface. Pinned by
/// `world/character.rs`, stairs.
pub const BESIDE_EDGE: f64 = 1.0 / 1024.0;

/// How far the length of `Σ wᵢ(vᵢ − p)` and the height of the lowest corner along it may be from those of the true point of a
/// triangle, as a part of the sum over the axes of how far its corners are from `p` at most. For the length: one rounding for
/// each difference, one for the product, two for the sum, and 8 for weights whose sum is 1 but for the rounding of three
/// quotients; for the height 3 for the product, 4 for the unit vector and one for the difference. 32 are taken. Larger: wider
/// bounds. Smaller: a decomposition might state less than its error. Test: `a_foot_is_bounded_on_both_sides` in `shape/foot.rs`.
pub const FOOT_ROUNDING: f64 = 32.0 * ROUNDING;

/// What the bounds of a search over a part are widened by, as a part of the farthest coordinate of the mesh: each of up to 128
/// halvings moves a point by one rounding of a sum of halves, √3 of it as a vector, heights above faces are off by 16, and 512 are
/// taken. Larger: wider bounds of decompositions. Smaller: one might state less than its error. Pinned by
/// `what_is_certified_is_not_exceeded` in `tests/decompose/laws.rs`.
pub const CELL_ROUNDING: f64 = 512.0 * ROUNDING;

/// How far, as a part of a mesh's diagonal, a triangle may reach into a simplex that counts as inside but for that: 2⁻³³. What it
/// may cut off is bounded and counted. Larger: more triangles are let in, for wider bounds. Smaller: hulls that share faces with the
/// mesh to within rounding are searched all along those. Pinned by `a_convex_mesh_is_one_exact_part` in `tests/decompose/laws.rs`.
pub const LID_DEPTH: f64 = 1_048_576.0 * ROUNDING;

/// Corners of a piece within this part of its farthest coordinate of the plane of a cut are in it: 2⁻⁴³, beyond the roundings of a
/// normal, which a small triangle makes larger, and of a height. Larger: [`CUT_OUTSIDE`] as well. Smaller: of faces that are one but
/// for rounding slivers are cut. Pinned by `an_l_is_two_exact_parts` in `tests/decompose/laws.rs`.
pub const CUT_SNAP: f64 = 1024.0 * ROUNDING;

/// What each cut of a mesh may leave outside of its parts at most, as a part of the farthest coordinate: the border of a lid strays from
/// its plane by [`CUT_SNAP`] to both sides, or, as a point on an edge, by 8 roundings; twice that is taken. Larger: wider bounds.
/// Smaller: a decomposition might state less than what it leaves out. Pinned by `what_is_certified_is_not_exceeded` in
/// `tests/decompose/laws.rs`.
pub const CUT_OUTSIDE: f64 = 4.0 * (CUT_SNAP + 8.0 * ROUNDING);

/// How near convex parts are to be to their mesh where nothing is asked, as a part of its diagonal: 1 %, where a figure of an animal takes
/// some dozens of parts. It is a default, documented in the API, and decides no answer.
pub const DECOMPOSE_ERROR: f64 = 0.01;

/// Convex parts need not be nearer to their mesh than this part of its diagonal, 2⁻²⁴: along a face that is within that of the mesh, a
/// search takes as many cells as there are squares of it on the face. Larger: finer parts cannot be asked for. Smaller: the budget
/// ends such searches instead. Pinned by `what_is_asked_too_fine_still_ends` in `tests/decompose/laws.rs`.
pub const DECOMPOSE_ERROR_MIN: f64 = 1.0 / 16_777_216.0;
