//! How far an answer may be off: the format's "good" tolerances for f64, and the reference's own error.

/// Signed distances and depths: this part of the record's scale.
pub const DISTANCE: f64 = 1e-9;

/// Times of linear motion: the way covered in the error is within `DISTANCE` of the scale and this part of the speed.
pub const SPEED: f64 = 1e-13;

/// Times of rotating motion: distance at the claimed time, as a part of the scale.
pub const ROTATING: f64 = 1e-6;

/// Rays: error of the way, as a part of scale over cosine.
pub const RAY: f64 = 1e-12;

/// Rays: at grazing incidence the cosine counts as this.
pub const RAY_COS_MIN: f64 = 1e-2;

/// Sphere casts: distance from the mesh at the claimed time less the radius, as a part of the scale.
pub const SPHERE_CAST: f64 = 1e-10;

/// Meshes along a motion and mesh pairs: part of the diagonal and the distance of the origins.
pub const MESH: f64 = 1e-9;

/// Normals of impacts: the gap along the claimed normal at the claimed time, as a part of the scale. The format names no
/// tolerance for them; this tells a normal that parts the forms from one that does not.
pub const IMPACT_NORMAL: f64 = 1e-6;

/// Streams: expected distances have six decimals.
pub const STREAM_DECIMALS: f64 = 1e-6;

/// An interval may miss the reference by this part of the scale, because the reference itself is an f64 number: it was
/// found to be within 4e-16 (50-digit arithmetic) to 7e-16 (full Minkowski hulls) of the scale.
pub const REFERENCE: f64 = 2e-15;

/// Metres by which the reference's times of impact may be off besides: it stops where the gap is that small. At scales of
/// 1e-4 m that shows: 50-digit arithmetic found up to 6.4e-16 m there.
pub const REFERENCE_IMPACT_GAP: f64 = 1e-15;

/// A unit vector may be this much longer or shorter than 1.
pub const UNIT: f64 = 1e-12;

/// Points are given in the world frame: an f64 there is off by this part of its coordinates.
pub const WORLD_POINT: f64 = 8.0 * f64::EPSILON;
