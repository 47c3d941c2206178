//! Forms and poses as records write them.

use std::{collections::HashMap, path::Path, sync::Arc};

use glam::{DMat3, DQuat, DVec3};
use serde::Deserialize;

use super::{SetError, read_lines};

/// A form in its own frame.
#[derive(Clone, Debug)]
pub enum Form {
    /// A ball about the local origin.
    Sphere {
        /// Metres.
        radius: f64,
    },
    /// All points within `radius` of a segment along local y.
    Capsule {
        /// Half of the segment, metres.
        half_height: f64,
        /// Metres.
        radius: f64,
    },
    /// A box about the local origin.
    Cuboid {
        /// Half of each edge, metres.
        half_extents: DVec3,
    },
    /// The convex hull of points.
    Hull(Arc<PointCloud>),
    /// Triangles, felt from both sides.
    Mesh(Arc<TriangleMesh>),
}

/// Points whose hull is meant.
#[derive(Debug, PartialEq)]
pub struct PointCloud {
    /// The points, each number an f32.
    pub points: Vec<DVec3>,
}

/// Triangles as an OBJ file lists them, degenerate ones included.
#[derive(Debug, PartialEq)]
pub struct TriangleMesh {
    /// Corners, each number an f32.
    pub vertices: Vec<DVec3>,
    /// Corner numbers from 0.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// The corners of a triangle.
    #[must_use]
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.vertices[vertex as usize])
    }

    /// Lower and upper corner of the box about all triangles.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let used = self.triangles.iter().flatten().map(|&vertex| self.vertices[vertex as usize]);
        used.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), point| (min.min(point), max.max(point)))
    }

    /// The diagonal of that box, metres.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        let (min, max) = self.bounds();
        (max - min).length()
    }

    /// Its middle.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        let (min, max) = self.bounds();
        min * 0.5 + max * 0.5
    }

    /// The greatest distance of a vertex from the local origin, metres.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.vertices.iter().map(|vertex| vertex.length()).fold(0.0, f64::max)
    }
}

/// Where a form is: the rotation is of any length but 0, as it was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Metres.
    pub position: DVec3,
    /// Rotation, not normalised.
    pub rotation: DQuat,
}

impl Pose {
    /// Unrotated, at a place.
    #[must_use]
    pub const fn at(position: DVec3) -> Self {
        Self { position, rotation: DQuat::IDENTITY }
    }

    /// From the numbers of a record: position and quaternion x, y, z, w.
    #[must_use]
    pub fn from_arrays(position: [f64; 3], rotation: [f64; 4]) -> Self {
        Self { position: DVec3::from_array(position), rotation: DQuat::from_array(rotation) }
    }

    /// The rotation as a matrix: the quaternion's own polynomial over its squared length, so that nothing is rounded
    /// by taking a root.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        let [x, y, z, w] = self.rotation.to_array();
        let norm_sq = x * x + y * y + z * z + w * w;
        let half = 0.5 * norm_sq;
        DMat3::from_cols(
            DVec3::new(half - y * y - z * z, x * y + z * w, x * z - y * w),
            DVec3::new(x * y - z * w, half - x * x - z * z, y * z + x * w),
            DVec3::new(x * z + y * w, y * z - x * w, half - x * x - y * y),
        ) * (2.0 / norm_sq)
    }
}

/// A form at a pose.
#[derive(Clone, Debug)]
pub struct Placed {
    /// What.
    pub form: Form,
    /// Where.
    pub pose: Pose,
}

/// The form in a record; which of the numbers must be there depends on `k`.
#[derive(Clone, Debug, Deserialize)]
pub struct FormRecord {
    k: String,
    r: Option<f64>,
    h: Option<serde_json::Value>,
    id: Option<String>,
    p: [f64; 3],
    q: [f64; 4],
    /// Displacement over the motion, metres; only in `toi`.
    #[serde(default)]
    pub v: [f64; 3],
    /// Rotation vector over the motion, radians; only in `toi`.
    #[serde(default)]
    pub w: [f64; 3],
}

impl FormRecord {
    /// The form and its pose.
    ///
    /// # Errors
    /// An unknown kind, a number that its kind needs is missing, an unknown hull, a quaternion of zeros.
    pub fn resolve(&self, hulls: &HullTable) -> Result<Placed, String> {
        if self.q.iter().all(|&component| component == 0.0) {
            return Err("q is all zeros: it is no rotation".to_owned());
        }
        let form = match self.k.as_str() {
            "sphere" => Form::Sphere { radius: self.radius()? },
            "capsule" => Form::Capsule { half_height: self.h_as::<f64>()?, radius: self.radius()? },
            "box" => Form::Cuboid { half_extents: DVec3::from_array(self.h_as::<[f64; 3]>()?) },
            "hull" => {
                let id = self.id.as_ref().ok_or("a hull without id")?;
                Form::Hull(hulls.get(id).ok_or_else(|| format!("hull {id} is not in hulls.jsonl"))?)
            }
            kind => return Err(format!("`{kind}` is no kind of shape that is known")),
        };
        Ok(Placed { form, pose: Pose::from_arrays(self.p, self.q) })
    }

    fn radius(&self) -> Result<f64, String> {
        self.r.ok_or_else(|| format!("a {} without r", self.k))
    }

    fn h_as<T: serde::de::DeserializeOwned>(&self) -> Result<T, String> {
        let value = self.h.clone().ok_or_else(|| format!("a {} without h", self.k))?;
        serde_json::from_value(value).map_err(|error| format!("h of a {}: {error}", self.k))
    }
}

/// The hulls that records name by id.
#[derive(Debug, Default)]
pub struct HullTable {
    by_id: HashMap<String, Arc<PointCloud>>,
}

#[derive(Deserialize)]
struct HullRecord {
    id: String,
    v: Vec<[f64; 3]>,
}

impl HullTable {
    /// Reads `hulls.jsonl`.
    ///
    /// # Errors
    /// The file cannot be read, a line is malformed, a hull has no points, or an id comes twice.
    pub fn read(path: &Path) -> Result<Self, SetError> {
        let mut by_id = HashMap::new();
        for (line, record) in read_lines::<HullRecord>(path)? {
            if record.v.is_empty() {
                return Err(SetError::line(path, line, format!("hull {} has no points", record.id)));
            }
            let points = record.v.into_iter().map(DVec3::from_array).collect();
            if by_id.insert(record.id.clone(), Arc::new(PointCloud { points })).is_some() {
                return Err(SetError::line(path, line, format!("hull {} is there twice", record.id)));
            }
        }
        Ok(Self { by_id })
    }

    /// A hull; the same `Arc` for the same id.
    #[must_use]
    pub fn get(&self, id: &str) -> Option<Arc<PointCloud>> {
        self.by_id.get(id).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resolve(json: &str) -> Result<Placed, String> {
        serde_json::from_str::<FormRecord>(json).expect("a record").resolve(&HullTable::default())
    }

    #[test]
    fn forms_are_told_by_their_kind() {
        let capsule = resolve(r#"{"k":"capsule","h":0.5,"r":0.25,"p":[1,2,3],"q":[0,0,0,2]}"#).expect("a capsule");
        assert!(matches!(capsule.form, Form::Capsule { half_height: 0.5, radius: 0.25 }));
        assert_eq!(capsule.pose.matrix(), DMat3::IDENTITY);
        let cuboid = resolve(r#"{"k":"box","h":[1,2,3],"p":[0,0,0],"q":[0,0,0,1]}"#).expect("a box");
        assert!(matches!(cuboid.form, Form::Cuboid { half_extents } if half_extents == DVec3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        for (json, part) in [
            (r#"{"k":"torus","p":[0,0,0],"q":[0,0,0,1]}"#, "torus"),
            (r#"{"k":"sphere","p":[0,0,0],"q":[0,0,0,1]}"#, "without r"),
            (r#"{"k":"box","h":1,"p":[0,0,0],"q":[0,0,0,1]}"#, "h of a box"),
            (r#"{"k":"hull","id":"none","p":[0,0,0],"q":[0,0,0,1]}"#, "none"),
            (r#"{"k":"sphere","r":1,"p":[0,0,0],"q":[0,0,0,0]}"#, "zeros"),
        ] {
            assert!(resolve(json).is_err_and(|reason| reason.contains(part)), "{json}");
        }
    }

    #[test]
    fn the_matrix_turns_as_the_quaternion_does() {
        let pose = Pose::from_arrays([0.0; 3], [0.3, -0.8, 1.1, 0.4]);
        let glam = DMat3::from_quat(pose.rotation.normalize());
        assert!((pose.matrix() - glam).to_cols_array().iter().all(|error| error.abs() < 4e-16));
    }
}
