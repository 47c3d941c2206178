//! Which sets a folder holds, told by their names.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use super::SetError;

/// What kind of questions a set holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SetKind {
    /// `box_box`, `hull_hull`, `mixed`: signed distances of convex pairs.
    Pairs,
    /// `toi`: first times of touch.
    Toi,
    /// `rays_MESH`.
    Rays {
        /// The mesh.
        mesh: String,
    },
    /// `spherecast_MESH`.
    SphereCast {
        /// The mesh.
        mesh: String,
    },
    /// `capsulemesh_MESH`.
    CapsuleMesh {
        /// The mesh.
        mesh: String,
    },
    /// `mesh_mesh_A_B`.
    MeshMesh {
        /// The mesh that stands at the origin.
        fixed: String,
        /// The mesh that each record places.
        placed: String,
    },
    /// `motion/X_expected`.
    Motion {
        /// What the names of its files begin with.
        stem: String,
    },
    /// `stream/X_expected`.
    Stream {
        /// What the names of its files begin with.
        stem: String,
    },
    /// `aabb/X.f32`.
    Aabb {
        /// The name in `aabb/expected.json`.
        stem: String,
    },
}

/// A set of a folder.
#[derive(Clone, Debug)]
pub struct SetFile {
    /// Its name in reports: the path inside the folder without endings, such as `stream/rl_13c2`.
    pub name: String,
    /// The file with its records.
    pub path: PathBuf,
    /// What it holds.
    pub kind: SetKind,
}

/// A folder of query sets.
#[derive(Debug)]
pub struct Folder {
    root: PathBuf,
    mesh_names: BTreeSet<String>,
    /// The sets that were found, by name.
    pub sets: Vec<SetFile>,
    /// Files that look like sets but are not understood.
    pub strange: Vec<SetError>,
}

impl Folder {
    /// Looks into a folder. A file that looks like a set but has no place in the format is kept in
    /// [`strange`](Self::strange).
    ///
    /// # Errors
    /// The folder cannot be listed.
    pub fn open(root: &Path) -> Result<Self, SetError> {
        let mesh_names = list(&root.join("mesh"))?
            .iter()
            .filter_map(|path| file_name(path).strip_suffix(".obj").map(str::to_owned))
            .collect();
        let mut folder = Self { root: root.to_owned(), mesh_names, sets: Vec::new(), strange: Vec::new() };
        if !root.is_dir() {
            return Err(SetError::file(root, "there is no such folder"));
        }
        for path in list(root)? {
            folder.sort_in_root(&path);
        }
        folder.look_into("motion", Self::sort_in_motion)?;
        folder.look_into("stream", Self::sort_in_stream)?;
        folder.look_into("aabb", Self::sort_in_aabb)?;
        folder.sets.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(folder)
    }

    /// Where a mesh of the folder is.
    #[must_use]
    pub fn mesh_path(&self, name: &str) -> PathBuf {
        self.root.join("mesh").join(format!("{name}.obj"))
    }

    /// The file `name` in a subfolder, plain or gzipped, whichever exists.
    ///
    /// # Errors
    /// Neither exists.
    pub fn companion(&self, sub_folder: &str, name: &str) -> Result<PathBuf, SetError> {
        let plain = self.root.join(sub_folder).join(name);
        if plain.is_file() {
            return Ok(plain);
        }
        let packed = self.root.join(sub_folder).join(format!("{name}.gz"));
        if packed.is_file() {
            return Ok(packed);
        }
        Err(SetError::file(plain, "this file is missing"))
    }

    /// Where the hulls are that records name by id; `None` if the folder has none.
    #[must_use]
    pub fn hulls_path(&self) -> Option<PathBuf> {
        self.companion("", "hulls.jsonl").ok()
    }

    fn look_into(&mut self, sub_folder: &str, sort: fn(&mut Self, &Path)) -> Result<(), SetError> {
        for path in list(&self.root.join(sub_folder))? {
            sort(self, &path);
        }
        Ok(())
    }

    fn sort_in_root(&mut self, path: &Path) {
        let Some(stem) = jsonl_stem(path) else {
            return;
        };
        if stem.starts_with("hulls") {
            return;
        }
        match self.kind_of(&stem) {
            Ok(kind) => self.sets.push(SetFile { name: stem, path: path.to_owned(), kind }),
            Err(reason) => self.strange.push(SetError::file(path, reason)),
        }
    }

    fn kind_of(&self, stem: &str) -> Result<SetKind, String> {
        match stem {
            "box_box" | "hull_hull" | "mixed" => return Ok(SetKind::Pairs),
            "toi" => return Ok(SetKind::Toi),
            _ => {}
        }
        if let Some(names) = stem.strip_prefix("mesh_mesh_") {
            let (fixed, placed) = self.two_meshes(names)?;
            return Ok(SetKind::MeshMesh { fixed, placed });
        }
        if let Some(name) = stem.strip_prefix("rays_") {
            return Ok(SetKind::Rays { mesh: self.mesh(name)? });
        }
        if let Some(name) = stem.strip_prefix("spherecast_") {
            return Ok(SetKind::SphereCast { mesh: self.mesh(name)? });
        }
        if let Some(name) = stem.strip_prefix("capsulemesh_") {
            return Ok(SetKind::CapsuleMesh { mesh: self.mesh(name)? });
        }
        Err("no set of this name is known".to_owned())
    }

    fn mesh(&self, name: &str) -> Result<String, String> {
        if self.mesh_names.contains(name) { Ok(name.to_owned()) } else { Err(format!("mesh/{name}.obj is missing")) }
    }

    /// Splits `A_B` where both sides are meshes of the folder: names may contain underscores themselves. Of several
    /// ways that a name such as `fcl_env_rob` can be read, the second mesh may leave out the prefix it shares with
    /// the first (`fcl_env`, `fcl_rob`).
    fn two_meshes(&self, names: &str) -> Result<(String, String), String> {
        let mut found = BTreeSet::new();
        for (at, _) in names.match_indices('_') {
            let (first, second) = (&names[..at], &names[at + 1..]);
            if !self.mesh_names.contains(first) {
                continue;
            }
            if self.mesh_names.contains(second) {
                found.insert((first.to_owned(), second.to_owned()));
                continue;
            }
            for (prefix_end, _) in first.match_indices('_') {
                let with_prefix = format!("{}_{second}", &first[..prefix_end]);
                if self.mesh_names.contains(&with_prefix) {
                    found.insert((first.to_owned(), with_prefix));
                }
            }
        }
        let count = found.len();
        match found.pop_first() {
            Some(pair) if count == 1 => Ok(pair),
            Some(_) => Err(format!("`{names}` can be read as two meshes in {count} ways")),
            None => Err(format!("`{names}` does not name two meshes of the folder mesh")),
        }
    }

    fn sort_in_motion(&mut self, path: &Path) {
        self.sort_expected("motion", path, |stem| SetKind::Motion { stem });
    }

    fn sort_in_stream(&mut self, path: &Path) {
        self.sort_expected("stream", path, |stem| SetKind::Stream { stem });
        let name = file_name(path);
        let trace = name.strip_suffix(".csv.gz").or_else(|| name.strip_suffix(".csv"));
        if let Some(stem) = trace
            && let Err(error) = self.companion("stream", &format!("{stem}_expected.jsonl"))
        {
            self.strange.push(error);
        }
    }

    fn sort_expected(&mut self, sub_folder: &str, path: &Path, kind: impl Fn(String) -> SetKind) {
        let Some(stem) = jsonl_stem(path) else {
            return;
        };
        match stem.strip_suffix("_expected") {
            Some(stem) => self.sets.push(SetFile {
                name: format!("{sub_folder}/{stem}"),
                path: path.to_owned(),
                kind: kind(stem.to_owned()),
            }),
            None => self.strange.push(SetError::file(path, "its name does not end in _expected")),
        }
    }

    fn sort_in_aabb(&mut self, path: &Path) {
        if let Some(stem) = file_name(path).strip_suffix(".f32") {
            self.sets.push(SetFile {
                name: format!("aabb/{stem}"),
                path: path.to_owned(),
                kind: SetKind::Aabb { stem: stem.to_owned() },
            });
        } else if jsonl_stem(path).is_some() {
            self.strange.push(SetError::file(path, "no set of this name is known"));
        }
    }
}

/// The files of a folder by name; none if there is no such folder.
fn list(folder: &Path) -> Result<Vec<PathBuf>, SetError> {
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let io = |source| SetError::Io { path: folder.to_owned(), source };
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        if path.is_file() {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

fn file_name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

fn jsonl_stem(path: &Path) -> Option<String> {
    let name = file_name(path);
    name.strip_suffix(".jsonl").or_else(|| name.strip_suffix(".jsonl.gz")).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(meshes: &[&str]) -> Folder {
        Folder {
            root: PathBuf::new(),
            mesh_names: meshes.iter().map(|&name| name.to_owned()).collect(),
            sets: Vec::new(),
            strange: Vec::new(),
        }
    }

    #[test]
    fn mesh_names_may_contain_underscores() {
        let folder = folder_with(&["a_b", "c_d"]);
        let kind = folder.kind_of("mesh_mesh_a_b_c_d");
        assert_eq!(kind, Ok(SetKind::MeshMesh { fixed: "a_b".to_owned(), placed: "c_d".to_owned() }));
    }

    #[test]
    fn the_second_mesh_may_leave_out_a_shared_prefix() {
        let folder = folder_with(&["fcl_env", "fcl_rob"]);
        let kind = folder.kind_of("mesh_mesh_fcl_env_rob");
        assert_eq!(kind, Ok(SetKind::MeshMesh { fixed: "fcl_env".to_owned(), placed: "fcl_rob".to_owned() }));
    }

    #[test]
    fn two_readings_of_a_name_are_refused() {
        let folder = folder_with(&["a", "a_b", "b_c", "c"]);
        assert!(folder.kind_of("mesh_mesh_a_b_c").is_err_and(|reason| reason.contains("2 ways")));
    }

    #[test]
    fn unknown_names_and_missing_meshes_are_refused() {
        let folder = folder_with(&["level"]);
        assert_eq!(folder.kind_of("rays_level"), Ok(SetKind::Rays { mesh: "level".to_owned() }));
        assert!(folder.kind_of("rays_other").is_err());
        assert!(folder.kind_of("box_bax").is_err());
    }
}
