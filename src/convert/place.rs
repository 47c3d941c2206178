//! Vectors, rotations, poses and boxes.

use collision::{
    DQuat, DVec3,
    math::{Aabb, Pose},
};
use wire::v1 as pb;

use super::number::{coordinate, finite, not_finite};
use crate::problem::{Checked, Problem, Reason, Under};

/// A position or displacement, metres; absent is `default`.
pub(crate) fn position(sent: Option<&pb::Vec3>, default: DVec3) -> Checked<DVec3> {
    let Some(sent) = sent else { return Ok(default) };
    Ok(DVec3::new(coordinate("x", sent.x)?, coordinate("y", sent.y)?, coordinate("z", sent.z)?))
}

/// A direction: of any length but 0.
pub(crate) fn direction(field: &'static str, sent: Option<&pb::Vec3>) -> Checked<DVec3> {
    let Some(sent) = sent else {
        let what = "is absent: a direction is required, such as {\"z\": 1}";
        return Err(Problem::at(field, Reason::Missing, what));
    };
    let components = || Ok([finite("x", sent.x)?, finite("y", sent.y)?, finite("z", sent.z)?]);
    let direction = DVec3::from_array(components().under(field)?);
    if direction == DVec3::ZERO {
        let what = "is (0, 0, 0): it may have any length but 0, such as {\"z\": 1}";
        return Err(Problem::at(field, Reason::OutOfLimits, what));
    }
    Ok(direction)
}

/// A rotation: a quaternion of any length but 0; absent is none.
pub(crate) fn rotation(field: &'static str, sent: Option<&pb::Quat>) -> Checked<Option<DQuat>> {
    let Some(sent) = sent else { return Ok(None) };
    let components = || Ok([finite("x", sent.x)?, finite("y", sent.y)?, finite("z", sent.z)?, finite("w", sent.w)?]);
    let [x, y, z, w] = components().under(field)?;
    if is_zero_quat([x, y, z, w]) {
        let what = "is (0, 0, 0, 0): it may have any length but 0; {\"w\": 1} is no rotation";
        return Err(Problem::at(field, Reason::OutOfLimits, what));
    }
    Ok(Some(DQuat::from_xyzw(x, y, z, w)))
}

/// Whether a quaternion is no rotation at all.
pub(crate) fn is_zero_quat(components: [f64; 4]) -> bool {
    components == [0.0; 4]
}

/// A pose; what is absent is that of `default`.
pub(crate) fn pose(sent: Option<&pb::Pose>, default: Pose) -> Checked<Pose> {
    let Some(sent) = sent else { return Ok(default) };
    let position = position(sent.position.as_ref(), default.position).under("position")?;
    let rotation = rotation("rotation", sent.rotation.as_ref())?;
    Ok(Pose::new(position, rotation.unwrap_or(default.rotation)))
}

/// A box.
pub(crate) fn aabb(sent: &pb::Aabb) -> Checked<Aabb> {
    let corner = |field: &'static str, sent: Option<&pb::Vec3>| {
        let Some(sent) = sent else {
            return Err(Problem::at(
                field,
                Reason::Missing,
                "is absent: a box needs both, such as {\"min\": {}, \"max\": {\"x\": 1, \"y\": 1, \"z\": 1}}",
            ));
        };
        position(Some(sent), DVec3::ZERO).under(field)
    };
    let (min, max) = (corner("min", sent.min.as_ref())?, corner("max", sent.max.as_ref())?);
    for (field, low, high) in [("max.x", min.x, max.x), ("max.y", min.y, max.y), ("max.z", min.z, max.z)] {
        if low > high {
            let what = format!("is {high}, below that of min, {low}: it must be at least that");
            return Err(Problem::at(field, Reason::OutOfLimits, what));
        }
    }
    Ok(Aabb::new(min, max))
}

/// A vector as it is sent: finite, and +0 for −0.
///
/// # Errors
/// A component is not finite, which is a fault of the server.
pub(crate) fn vec3_out(vector: DVec3) -> Checked<pb::Vec3> {
    Ok(pb::Vec3 { x: number_out(vector.x)?, y: number_out(vector.y)?, z: number_out(vector.z)? })
}

/// A number as it is sent: finite, and +0 for −0.
///
/// # Errors
/// It is not finite, which is a fault of the server.
pub(crate) fn number_out(value: f64) -> Checked<f64> {
    if value.is_finite() {
        // The sum of −0 and +0 is +0.
        return Ok(value + 0.0);
    }
    tracing::error!(value, "an answer held a number that is not finite");
    let what = "the server found no finite number for this answer; this is a fault of the server";
    Err(Problem::new(Reason::Internal, what))
}

/// A pose as it was sent: −0 stays what it was, because this is no answer but the client's own numbers.
pub(crate) fn pose_out(pose: &Pose) -> pb::Pose {
    let (position, rotation) = (pose.position, pose.rotation);
    pb::Pose {
        position: Some(pb::Vec3 { x: position.x, y: position.y, z: position.z }),
        rotation: (rotation != DQuat::IDENTITY).then_some(pb::Quat {
            x: rotation.x,
            y: rotation.y,
            z: rotation.z,
            w: rotation.w,
        }),
    }
}

/// A box as it is sent.
///
/// # Errors
/// A corner is not finite, which is a fault of the server.
pub(crate) fn aabb_out(bounds: Aabb) -> Checked<pb::Aabb> {
    Ok(pb::Aabb { min: Some(vec3_out(bounds.min)?), max: Some(vec3_out(bounds.max)?) })
}

/// A finite single number of a column, in double.
pub(crate) fn column_number(column: &str, index: usize, value: f32) -> Checked<f64> {
    let value = f64::from(value);
    if value.is_finite() { Ok(value) } else { Err(not_finite(format!("{column}[{index}]"), value)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_hold_no_negative_zero_and_nothing_that_is_not_finite() {
        assert!(number_out(-0.0).unwrap().is_sign_positive());
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            number_out(value).unwrap_err();
        }
    }

    #[test]
    fn what_a_pose_leaves_out_is_that_of_the_default() {
        let default = Pose::new(DVec3::new(1.0, 2.0, 3.0), DQuat::from_xyzw(0.0, 0.0, 2.0, 0.0));
        assert_eq!(pose(None, default).unwrap(), default);
        let sent = pb::Pose { position: Some(pb::Vec3 { x: 0.0, y: 5.0, z: 0.0 }), rotation: None };
        let moved = pose(Some(&sent), default).unwrap();
        assert_eq!(moved.position, DVec3::new(0.0, 5.0, 0.0));
        assert_eq!(moved.rotation, default.rotation);
    }
}
