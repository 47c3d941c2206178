//! `motion/X`: two meshes along a recorded motion, frame by frame.

use std::{path::Path, sync::Arc};

use glam::{DMat3, DQuat, DVec3};
use serde::Deserialize;

use super::{Folder, Form, Placed, Pose, SetError, meshes::MeshPairRecord, read_lines, read_obj, read_text};

#[derive(Deserialize)]
struct Line {
    i: u64,
    cat: String,
    #[serde(default)]
    amb: u8,
    frame: usize,
    d: f64,
    tri_pairs: u64,
}

/// Position and rotation matrix of both meshes in a frame.
type Frame = [(DVec3, DMat3); 2];

/// Columns before the positions: id and time.
const LEADING_COLUMNS: usize = 2;
/// Numbers after those: two positions, two matrices.
const FRAME_NUMBERS: usize = 24;

/// Reads the expected distances of a motion, its frames and both meshes.
///
/// # Errors
/// A file is missing, or a line is not understood.
pub fn read(path: &Path, folder: &Folder, stem: &str) -> Result<Vec<MeshPairRecord>, SetError> {
    let frames_path = folder.companion("motion", &format!("{stem}_frames.csv"))?;
    let frames = parse_frames(&frames_path, &read_text(&frames_path)?)?;
    let mesh = |number: u32| {
        folder.companion("motion", &format!("{stem}_obj{number}.obj")).and_then(|path| read_obj(&path)).map(Arc::new)
    };
    let meshes = [mesh(1)?, mesh(2)?];
    let diagonal = meshes[0].diagonal().max(meshes[1].diagonal());
    let lines = read_lines::<Line>(path)?;
    lines
        .into_iter()
        .map(|(number, line)| {
            let frame = frames
                .get(line.frame)
                .ok_or_else(|| SetError::line(path, number, format!("there is no frame {}", line.frame)))?;
            let place = |side: usize| {
                let (position, matrix) = frame[side];
                let pose = Pose { position, rotation: quaternion_of(&matrix) };
                let error = frobenius(&(matrix - pose.matrix())) * meshes[side].reach();
                (Placed { form: Form::Mesh(Arc::clone(&meshes[side])), pose }, error)
            };
            let ((a, error_a), (b, error_b)) = (place(0), place(1));
            Ok(MeshPairRecord {
                index: line.i,
                category: line.cat,
                ambiguous: line.amb != 0,
                scale: diagonal + (b.pose.position - a.pose.position).length(),
                a,
                b,
                distance: line.d,
                crossing_count: line.tri_pairs,
                pose_error: error_a + error_b,
            })
        })
        .collect()
}

fn parse_frames(path: &Path, text: &str) -> Result<Vec<Frame>, SetError> {
    let mut frames = Vec::new();
    for (index, line) in text.lines().enumerate().skip(1) {
        let wrong = |reason: String| SetError::line(path, index + 1, reason);
        let numbers = line
            .split(',')
            .skip(LEADING_COLUMNS)
            .map(|word| word.trim().parse::<f64>().map_err(|_| wrong(format!("`{word}` is no number"))))
            .collect::<Result<Vec<f64>, SetError>>()?;
        if numbers.len() != FRAME_NUMBERS {
            return Err(wrong(format!("{FRAME_NUMBERS} numbers are needed, here are {}", numbers.len())));
        }
        let side = |position: usize, matrix: usize| {
            let rows = &numbers[matrix..matrix + 9];
            let matrix = DMat3::from_cols_slice(rows).transpose();
            (DVec3::from_slice(&numbers[position..position + 3]), matrix)
        };
        frames.push([side(0, 6), side(3, 15)]);
    }
    Ok(frames)
}

/// The quaternion of a rotation matrix. Of the four ways to compute it, the one that divides by the largest component
/// is taken (Shepperd 1978), so that no digit is lost to cancellation. Of a matrix that is a rotation only up to the
/// decimals it was written with, it is a rotation as near as those decimals.
fn quaternion_of(m: &DMat3) -> DQuat {
    let (xx, yy, zz) = (m.x_axis.x, m.y_axis.y, m.z_axis.z);
    let squares = [1.0 + xx - yy - zz, 1.0 - xx + yy - zz, 1.0 - xx - yy + zz, 1.0 + xx + yy + zz];
    let (yz, zx, xy) = (m.z_axis.y + m.y_axis.z, m.x_axis.z + m.z_axis.x, m.y_axis.x + m.x_axis.y);
    let (wx, wy, wz) = (m.y_axis.z - m.z_axis.y, m.z_axis.x - m.x_axis.z, m.x_axis.y - m.y_axis.x);
    let largest = (0..4).fold(0, |best, index| if squares[index] > squares[best] { index } else { best });
    let [x, y, z, w] = match largest {
        0 => [squares[0], xy, zx, wx],
        1 => [xy, squares[1], yz, wy],
        2 => [zx, yz, squares[2], wz],
        _ => [wx, wy, wz, squares[3]],
    };
    DQuat::from_xyzw(x, y, z, w).normalize()
}

fn frobenius(m: &DMat3) -> f64 {
    m.to_cols_array().iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_become_quaternions_and_back() {
        for rotation in [[0.1, 0.2, 0.3, 0.9], [0.9, -0.1, 0.2, 1e-9], [0.0, 1.0, 0.0, 0.0], [0.1, 0.2, -0.9, 0.0]] {
            let pose = Pose::from_arrays([0.0; 3], rotation);
            let back = Pose { rotation: quaternion_of(&pose.matrix()), ..pose };
            assert!(frobenius(&(back.matrix() - pose.matrix())) < 2e-15, "{rotation:?}");
        }
    }

    #[test]
    fn rows_are_rows() {
        let text = "head\n1,0,1,2,3,4,5,6,0,-1,0,1,0,0,0,0,1,1,0,0,0,1,0,0,0,1\n";
        let frames = parse_frames(Path::new("m.csv"), text).expect("frames");
        let (position, matrix) = frames[0][0];
        assert_eq!(position, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(matrix * DVec3::X, DVec3::Y);
        assert!(
            parse_frames(Path::new("m.csv"), "head\n1,0,x\n").is_err_and(|e| e.to_string().starts_with("m.csv:2:"))
        );
    }
}
