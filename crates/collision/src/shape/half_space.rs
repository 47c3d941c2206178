//! Everything on one side of a plane.
//!
//! ```text
//!          ^ normal
//!          |
//!   -------+------- offset metres along the unit normal from the local origin
//!   ///////////////
//! ```

use glam::DVec3;

use super::{
    Limits,
    limits::{AXES, GeometryError, check_finite, out_of_limits},
};

/// All points `p` with `dot(normal / |normal|, p) <= offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Outward, as it was sent, of any length but 0.
    pub normal: DVec3,
    /// Where the plane cuts the line along the unit normal: metres from the local origin.
    pub offset: f64,
}

impl HalfSpace {
    pub(super) fn new(normal: DVec3, offset: f64) -> Result<Self, GeometryError> {
        for (axis, value) in normal.to_array().into_iter().enumerate() {
            check_finite(|| format!("normal.{}", AXES[axis]), value)?;
        }
        if normal == DVec3::ZERO {
            return Err(GeometryError::Bad {
                field: "normal".into(),
                reason: "is 0: it must have a direction, of any length".into(),
            });
        }
        check_finite(|| "offset".into(), offset)?;
        if offset.abs() > Limits::COORDINATE {
            return Err(out_of_limits("offset".into(), offset, "within 1e12 metres of 0"));
        }
        Ok(Self { normal: normal + DVec3::ZERO, offset: offset + 0.0 })
    }

    /// With its plane `by` metres farther out.
    pub(super) fn grown(self, by: f64) -> Result<Self, GeometryError> {
        let offset = self.offset + by;
        if offset > Limits::COORDINATE {
            let allowed = "such that the offset of the half space stays within 1e12 metres of 0";
            return Err(out_of_limits("rounding".into(), by, allowed));
        }
        Ok(Self { offset, ..self })
    }

    /// With its plane `scale` times as far from the local origin.
    pub(super) fn scaled(self, scale: f64) -> Result<Self, GeometryError> {
        let offset = self.offset * scale;
        if offset.abs() > Limits::COORDINATE {
            let allowed = "such that the offset of the half space stays within 1e12 metres of 0";
            return Err(out_of_limits("scale".into(), scale, allowed));
        }
        Ok(Self { offset, ..self })
    }
}
