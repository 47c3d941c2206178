//! Style as a test: what each room may use, how long things may be, and that every call of the API has its file, its test
//! and its example.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

/// What the domain may depend on, and nothing else.
const COLLISION_DEPENDENCIES: [&str; 6] = ["blake3", "glam", "prefetch-index", "robust", "smallvec", "thiserror"];

/// The layers of the domain: each uses only those before it (`shape` and `narrow` may ask trees of boxes).
const LAYERS: [&str; 7] = ["math", "broad", "shape", "narrow", "decompose", "response", "world"];

/// Lines of a function, and of a file.
const FUNCTION_LINES_MAX: usize = 70;
const FILE_LINES_MAX: usize = 400;

/// What is longer, with how long it may be. This list only shrinks: an entry that is no longer needed fails the test.
const LONGER: &[(&str, usize)] = &[];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// All files with an ending below a folder of the repository, as paths from its root, in order.
fn files(folder: &str, ending: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for entry in entries {
            let path: PathBuf = entry.expect("a readable folder").path();
            if path.is_dir() {
                if path.file_name().is_none_or(|name| name != "target") {
                    folders.push(path);
                }
            } else if path.to_string_lossy().ends_with(ending) {
                let relative = path.strip_prefix(root()).expect("below the root");
                found.push(relative.to_string_lossy().into_owned());
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "no {ending} below {folder}");
    found
}

fn rust_files() -> Vec<String> {
    let folders = ["src", "crates", "clients", "tests", "benches", "examples", "fuzz"];
    folders.into_iter().filter(|folder| root().join(folder).is_dir()).flat_map(|folder| files(folder, ".rs")).collect()
}

/// Code without comments, without what strings say, and without what follows `#[cfg(test)]`.
fn code(text: &str) -> String {
    let shipped = text.split("#[cfg(test)]").next().unwrap_or(text);
    let unquoted = |line: &str| line.split('"').step_by(2).collect::<Vec<_>>().join("\"");
    let lines = shipped.lines().map(unquoted).map(|line| line.split("//").next().unwrap_or("").to_owned());
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn the_domain_depends_on_what_it_may() {
    let manifest = read("crates/collision/Cargo.toml");
    let section = manifest.split("[dependencies]").nth(1).and_then(|rest| rest.split("\n[").next()).expect("a section");
    let named = |line: &str| line.split(['.', ' ', '=']).next().map(str::to_owned);
    let names: Vec<String> = section.lines().filter(|line| line.contains('=')).filter_map(named).collect();
    assert_eq!(names, COLLISION_DEPENDENCIES);
}

#[test]
fn the_domain_never_touches_the_outside() {
    const OUTSIDE: [&str; 8] =
        ["std::net", "std::fs", "std::thread", "std::time", "std::env", "tokio", "println!", "std::process"];
    for file in files("crates/collision/src", ".rs") {
        let code = code(&read(&file));
        for outside in OUTSIDE {
            assert!(!code.contains(outside), "{file} uses {outside}");
        }
    }
}

#[test]
fn layers_use_only_those_before_them() {
    for (rank, layer) in LAYERS.iter().enumerate() {
        for file in files(&format!("crates/collision/src/{layer}"), ".rs") {
            let code = code(&read(&file));
            for later in &LAYERS[rank + 1..] {
                for statement in code.split("use crate::").skip(1) {
                    let statement = statement.split(';').next().unwrap_or_default();
                    let uses =
                        statement.split(['{', '}', ',', ' ', '\n']).any(|part| part.starts_with(&format!("{later}::")));
                    assert!(!uses, "{file} in {layer} uses {later}");
                }
                assert!(!code.contains(&format!("crate::{later}::")), "{file} in {layer} names crate::{later}");
            }
        }
    }
}

#[test]
fn the_server_knows_no_geometry() {
    const GEOMETRY: [&str; 6] =
        [".dot(", ".cross(", ".normalize(", ".length_squared(", "from_quat(", "from_axis_angle("];
    for file in files("src", ".rs").iter().filter(|file| !file.starts_with("src/program/demo/")) {
        let code = code(&read(file));
        for sign in GEOMETRY {
            assert!(!code.contains(sign), "{file} computes geometry: {sign}");
        }
    }
}

#[test]
fn tolerances_stand_in_one_file() {
    // Limits of what is accepted, and what a question asks for, decide no geometry.
    const EXEMPT: [&str; 3] = [
        "crates/collision/src/tolerance.rs",
        "crates/collision/src/shape/limits.rs",
        "crates/collision/src/accuracy.rs",
    ];
    for file in files("crates/collision/src", ".rs").iter().filter(|file| !EXEMPT.contains(&file.as_str())) {
        for (number, line) in code(&read(file)).lines().enumerate() {
            let is_small = line.match_indices("e-").any(|(at, _)| {
                let before = line[..at].chars().next_back();
                let after = line[at + 2..].chars().next();
                before.is_some_and(|c| c.is_ascii_digit()) && after.is_some_and(|c| c.is_ascii_digit())
            });
            assert!(!is_small && !line.contains("EPSILON"), "{file}:{}: a tolerance outside tolerance.rs", number + 1);
        }
    }
}

/// glam takes its roots from software, for the sake of equal bytes; the processor's have the same bytes in a fraction of the time.
#[test]
fn lengths_are_taken_by_the_processors_root() {
    for file in files("crates/collision/src", ".rs") {
        for (number, line) in code(&read(&file)).lines().enumerate() {
            let is_soft = [".length()", ".normalize()"].iter().any(|call| line.contains(call));
            assert!(!is_soft, "{file}:{}: `math::Norm` has that with the processor's root", number + 1);
        }
    }
}

#[test]
fn files_and_functions_fit_a_screen() {
    let mut found: BTreeMap<String, usize> = BTreeMap::new();
    for file in rust_files() {
        let text = read(&file);
        let lines: Vec<&str> = text.lines().collect();
        if lines.len() > FILE_LINES_MAX {
            found.insert(file.clone(), lines.len());
        }
        for (start, line) in lines.iter().enumerate() {
            let trimmed = line.trim_start();
            let is_function = trimmed.split('(').next().is_some_and(|head| head.split(' ').any(|word| word == "fn"));
            if !is_function || trimmed.starts_with("//") {
                continue;
            }
            let close = format!("{}}}", &line[..line.len() - trimmed.len()]);
            let length = lines[start..].iter().position(|&l| l == close || l.ends_with(';')).map_or(0, |at| {
                let ends_at_once = lines[start + at].ends_with(';') && lines[start + at] != close;
                if ends_at_once && at > 0 {
                    lines[start..].iter().position(|&l| l == close).unwrap_or(0) + 1
                } else {
                    at + 1
                }
            });
            if length > FUNCTION_LINES_MAX {
                let name = trimmed.split("fn ").nth(1).and_then(|rest| rest.split(['(', '<']).next()).unwrap_or("?");
                found.insert(format!("{file}:{name}"), length);
            }
        }
    }
    let allowed: BTreeMap<String, usize> = LONGER.iter().map(|&(name, most)| (name.to_owned(), most)).collect();
    let is_grown = |(name, length): &(&String, &usize)| allowed.get(*name).is_none_or(|most| *length > most);
    let grown: Vec<_> = found.iter().filter(is_grown).collect();
    assert!(grown.is_empty(), "split these (files {FILE_LINES_MAX} lines, functions {FUNCTION_LINES_MAX}): {grown:#?}");
    for name in allowed.keys() {
        assert!(found.contains_key(name), "{name} fits now: take it off the list");
    }
}

#[test]
fn no_file_is_named_for_nothing() {
    const EMPTY_NAMES: [&str; 6] = ["utils.rs", "util.rs", "common.rs", "helpers.rs", "misc.rs", "manager.rs"];
    for file in rust_files() {
        let name = file.rsplit('/').next().unwrap_or(&file);
        assert!(!EMPTY_NAMES.contains(&name), "{file}: a name that says what the file answers");
    }
}

/// The calls of the API: service and name.
fn calls() -> Vec<(String, String)> {
    let mut calls = Vec::new();
    for file in files("proto", ".proto") {
        let text = read(&file);
        let mut service = String::new();
        for line in text.lines().map(str::trim) {
            if let Some(rest) = line.strip_prefix("service ") {
                service = rest.trim_end_matches(" {").to_owned();
            }
            if let Some(rest) = line.strip_prefix("rpc ") {
                calls.push((service.clone(), rest.split('(').next().unwrap_or(rest).to_owned()));
            }
        }
    }
    assert!(calls.len() > 30, "{calls:?}");
    calls
}

fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for character in name.chars() {
        if character.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(character.to_lowercase());
    }
    snake
}

#[test]
fn every_call_is_answered_tested_and_shown() {
    let answered: String = files("src/rpc", ".rs").iter().map(read).collect();
    let tested: String = files("tests/server", ".rs").iter().map(read).collect();
    let shown = read("docs/api.md");
    for (service, name) in calls() {
        let function = snake_case(&name);
        assert!(answered.contains(&format!("fn {function}")), "{name} has no function in src/rpc");
        assert!(tested.contains(&format!(".{function}(")), "{name} has no test in tests/server");
        assert!(shown.contains(&format!("{service}/{name}")), "{name} has no example in docs/api.md");
    }
}

#[test]
fn every_field_of_the_api_is_documented() {
    for file in files("proto", ".proto") {
        let text = read(&file);
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        for (number, line) in lines.iter().enumerate() {
            let is_item = (line.ends_with(';') && line.contains(" = "))
                || ["message ", "enum ", "service ", "rpc ", "oneof "].iter().any(|start| line.starts_with(start));
            if is_item && !line.starts_with("//") && !line.starts_with("syntax") {
                assert!(lines[number - 1].starts_with("//"), "{file}:{}: no comment above {line}", number + 1);
            }
        }
    }
}
