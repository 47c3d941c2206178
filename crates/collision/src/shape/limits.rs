//! Which numbers a form may be made of, and the errors that name one that may not.

use glam::DVec3;

use super::SolidFault;

/// The limits within which numbers are accepted.
#[derive(Debug)]
pub struct Limits;

impl Limits {
    /// Coordinates lie within this of 0, metres.
    pub const COORDINATE: f64 = 1e12;
    /// Sizes are at least this, metres, or 0 where that is a form.
    pub const SIZE_MIN: f64 = 1e-9;
    /// Sizes are at most this, metres.
    pub const SIZE_MAX: f64 = 1e9;
    /// How far the box of a half space goes to its open sides, metres from the origin of the world: farther than any point
    /// of what can be placed, wherever it moves within [`Limits::COORDINATE`], and than rays of 4e12 metres from there.
    pub const HALF_SPACE_BOX: f64 = 8e12;
    /// Longest half axis of an ellipsoid over its shortest.
    pub const ELLIPSOID_RATIO: f64 = 1e6;
    /// Most points of a hull.
    pub const HULL_POINTS: usize = 65_536;
    /// Most triangles of a mesh.
    pub const MESH_TRIANGLES: usize = 4_000_000;
    /// Most samples of a height field.
    pub const HEIGHT_FIELD_SAMPLES: usize = 33_554_432;
    /// Most parts of a compound, those of compounds in it counted one by one.
    pub const COMPOUND_PARTS: usize = 65_536;
    /// Most compounds in each other.
    pub const COMPOUND_DEPTH: u32 = 4;
}

/// Why a form is refused. `field` names it as the API does, such as `half_extents.y` or `points[7]`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GeometryError {
    /// NaN or infinite.
    #[error("{field} is {value}: it must be a finite number")]
    NotFinite {
        /// Which number.
        field: String,
        /// What was found.
        value: f64,
    },
    /// Outside the limits.
    #[error("{field} is {value}: it must be {allowed}")]
    OutOfLimits {
        /// Which number.
        field: String,
        /// What was found.
        value: f64,
        /// What would be right.
        allowed: &'static str,
    },
    /// The length of a list is wrong.
    #[error("{field} has {found} numbers: {expected}")]
    ColumnLength {
        /// Which list.
        field: String,
        /// How many there were.
        found: usize,
        /// What would be right.
        expected: String,
    },
    /// Too many items.
    #[error("{field} has {found} items: at most {most} are allowed")]
    TooMany {
        /// Which list.
        field: String,
        /// How many there were.
        found: usize,
        /// How many may be.
        most: usize,
    },
    /// A solid mesh that is no body.
    #[error("{field} {fault}")]
    NotSolid {
        /// Which part.
        field: String,
        /// What is wrong and what would be right.
        fault: SolidFault,
    },
    /// An index that names nothing, or a form that is none.
    #[error("{field}: {reason}")]
    Bad {
        /// Which part.
        field: String,
        /// What is wrong and what would be right.
        reason: String,
    },
}

pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// Whether a size above 0 is within the limits; NaN is not.
pub(super) fn is_size(value: f64) -> bool {
    (Limits::SIZE_MIN..=Limits::SIZE_MAX).contains(&value)
}

pub(super) fn out_of_limits(field: String, value: f64, allowed: &'static str) -> GeometryError {
    GeometryError::OutOfLimits { field, value, allowed }
}

pub(super) fn check_finite(field: impl FnOnce() -> String, value: f64) -> Result<(), GeometryError> {
    if value.is_finite() { Ok(()) } else { Err(GeometryError::NotFinite { field: field(), value }) }
}

pub(super) fn check_size(field: &str, value: f64, allowed: &'static str) -> Result<(), GeometryError> {
    check_finite(|| field.into(), value)?;
    if is_size(value) { Ok(()) } else { Err(out_of_limits(field.into(), value, allowed)) }
}

pub(super) fn check_size_or_zero(
    field: impl Fn() -> String,
    value: f64,
    allowed: &'static str,
) -> Result<(), GeometryError> {
    check_finite(&field, value)?;
    if value == 0.0 || is_size(value) { Ok(()) } else { Err(out_of_limits(field(), value, allowed)) }
}

pub(super) fn check_count(field: &str, found: usize, most: usize, hint: &str) -> Result<(), GeometryError> {
    let field = field.into();
    match found {
        0 => Err(GeometryError::Bad { field, reason: format!("is empty: {hint}") }),
        _ if found > most => Err(GeometryError::TooMany { field, found, most }),
        _ => Ok(()),
    }
}

pub(super) fn check_coordinates(field: &str, points: &[DVec3]) -> Result<(), GeometryError> {
    let most = DVec3::splat(Limits::COORDINATE);
    let Some(index) = points.iter().position(|point| !point.abs().cmple(most).all()) else {
        return Ok(());
    };
    for (axis, value) in points[index].to_array().into_iter().enumerate() {
        let name = || format!("{field}[{index}].{}", AXES[axis]);
        check_finite(name, value)?;
        if value.abs() > Limits::COORDINATE {
            return Err(out_of_limits(name(), value, "within 1e12 metres of 0"));
        }
    }
    Ok(())
}
