//! Every number that decides geometry, each with its reason, what gets worse when it changes, and the test that pins it.
//!
//! Kernels work on a pair scaled so that its extent `S` lies in [1, 2), so these numbers have no unit.

/// Half a unit in the last place of 1: one rounded f64 operation is off by at most this part of its result.
pub const ROUNDING: f64 = f64::EPSILON / 2.0;

/// Widens the exit of a slab test so that no box is lost: `t = fl(fl(wall − origin) · fl(1/d))` has three roundings, so it
/// is off by γ₃ of itself, and so is the `t` it is compared with: `1 + 2γ₃` (Ize 2013), here with one more rounding for
/// the product itself. Smaller loses rays that graze edges; larger only visits more nodes. [`SLAB_SLACK`] covers the
/// same rounding once more as long as it is taken relative to the farthest coordinate of a whole tree, so
/// `tests/broad_static.rs` fails only if both are too small.
pub const SLAB_WIDENING: f64 = 1.0 + 8.0 * ROUNDING;

/// Turns a computed entry (three roundings, as above) or a length that is the root of a sum of three squares (at most
/// four) into a lower bound of the true one. Nearer to 1 it is none; farther from it only visits more nodes. Pinned by
/// `the_bound_of_a_distance_is_never_above_it` in `tests/broad_static.rs`.
pub const SLAB_NARROWING: f64 = 1.0 - 8.0 * ROUNDING;

/// How far the walls of a box are moved out before a slab test, as a part of the largest coordinate that takes part:
/// two roundings of `wall ∓ reach` and four that the caller's path may carry (a position rotated into a frame).
/// Smaller loses rays that lie in a wall; larger only visits more nodes. Pinned by `tests/broad_static.rs`.
pub const SLAB_SLACK: f64 = 8.0 * ROUNDING;

/// A sum of squares above this has all its digits: the smallest normal number, with room for the digits of squares that
/// are 2⁻⁵³ of the largest. Below it a length is taken as 0 where a lower bound is asked: that is lengths of 1e-138 m.
pub const SQUARE_MIN: f64 = 1e-276;

/// A component of `a × b` is off by less than this part of `2·max|a|·max|b|`, the rounding of `a` and `b` themselves as
/// differences included: two factors of one rounding each, a product and a difference make four, and two are spare.
/// Larger: more triangles take the exact test. Smaller: an area might be seen where there is none. Test:
/// `geometry_mesh.rs`, slivers.
pub const CROSS_PRODUCT: f64 = 12.0 * ROUNDING;

/// A coordinate of a rotated point is off by less than this part of the point's reach. The unit quaternion's components
/// are right to 6 roundings, the matrix' entries to 32 (the diagonal, `1 - (yy + zz)`, is the worst), a row has at most
/// √3 of the reach as the sum of absolute values, and the product adds 4 more: 32·√3 + 4·√3 < 64. Larger: boxes are
/// wider. Smaller: a box might not hold its shape. Test: `geometry_bounds.rs`, exact rational rotations.
pub const ROTATED_COORDINATE: f64 = 64.0 * ROUNDING;
