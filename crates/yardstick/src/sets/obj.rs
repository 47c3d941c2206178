//! Triangle meshes from OBJ files: `v` and `f` lines, everything else is passed over.

use std::path::Path;

use glam::DVec3;

use super::{SetError, TriangleMesh, read_text};

/// Reads a mesh.
///
/// # Errors
/// The file cannot be read or a line is malformed.
pub fn read_obj(path: &Path) -> Result<TriangleMesh, SetError> {
    let text = read_text(path)?;
    parse_obj(&text).map_err(|(line, reason)| SetError::line(path, line, reason))
}

/// Reads the text of an OBJ file. Vertices are rounded to f32: the decimals are the shortest that give back the f32
/// that is meant, and read as f64 they would lie up to 6e-8 of their size beside it. Triangles keep their order, as
/// records number them so.
///
/// # Errors
/// The number of the line, and what is wrong with it: a number that is none, a face that is no triangle (it would
/// shift the numbers of all after it), a corner that does not exist. Line 0 means that there is no triangle at all.
pub fn parse_obj(text: &str) -> Result<TriangleMesh, (usize, String)> {
    let mut vertices: Vec<DVec3> = Vec::new();
    let mut triangles = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let keyword = words.next();
        let numbers: Vec<&str> = words.collect();
        let result = match keyword {
            Some("v") => vertex(&numbers).map(|point| vertices.push(point)),
            Some("f") => triangle(&numbers, vertices.len()).map(|corners| triangles.push(corners)),
            _ => Ok(()),
        };
        result.map_err(|reason| (index + 1, reason))?;
    }
    if triangles.is_empty() {
        return Err((0, "there is no triangle in it".to_owned()));
    }
    Ok(TriangleMesh { vertices, triangles })
}

fn vertex(numbers: &[&str]) -> Result<DVec3, String> {
    let [x, y, z, ..] = numbers else {
        return Err(format!("a vertex needs three numbers, here are {}", numbers.len()));
    };
    let coordinate = |word: &str| match word.parse::<f32>() {
        Ok(number) if number.is_finite() => Ok(f64::from(number)),
        _ => Err(format!("`{word}` is no finite number")),
    };
    Ok(DVec3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?))
}

fn triangle(numbers: &[&str], vertex_count: usize) -> Result<[u32; 3], String> {
    let &[a, b, c] = numbers else {
        return Err(format!("a face needs three corners, here are {}", numbers.len()));
    };
    Ok([corner(a, vertex_count)?, corner(b, vertex_count)?, corner(c, vertex_count)?])
}

/// A corner such as `7`, `7/1/2` or `-1` (the last vertex so far).
fn corner(word: &str, vertex_count: usize) -> Result<u32, String> {
    let number = word.split('/').next().unwrap_or(word);
    let written: i64 = number.parse().map_err(|_| format!("`{word}` is no corner"))?;
    let count = i64::try_from(vertex_count).map_err(|error| error.to_string())?;
    let index = if written < 0 { count + written } else { written - 1 };
    if (0..count).contains(&index) {
        u32::try_from(index).map_err(|error| error.to_string())
    } else {
        Err(format!("corner {written} does not exist: there are {vertex_count} vertices so far"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_rounded_to_f32_and_triangles_keep_their_order() {
        let mesh =
            parse_obj("# made\nv 0.1 0 0\nv 1 0 0\nvn 0 0 1\nv 0 1 0\nf 1/1 2/2 3/3\nf -1 -2 -3\n").expect("a mesh");
        assert_eq!(mesh.vertices[0].x, f64::from(0.1_f32));
        assert_eq!(mesh.triangles, vec![[0, 1, 2], [2, 1, 0]]);
    }

    #[test]
    fn errors_name_their_line() {
        let line_of = |text: &str| parse_obj(text).expect_err("an error").0;
        assert_eq!(line_of("v 0 0 0\nv 1 0\n"), 2);
        assert_eq!(line_of("v 0 0 0\nf 1 2 3\n"), 2);
        assert_eq!(line_of("v 0 0 nan\n"), 1);
        assert_eq!(line_of("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"), 5);
        assert_eq!(line_of("v 0 0 0\n"), 0);
    }
}
