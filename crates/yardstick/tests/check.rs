//! The runner as it is run: the built binary over small folders whose answers are known in closed form.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use tempfile::TempDir;

/// A folder of small sets, all of them right: balls, unrotated boxes, rays at a cube, boxes that overlap.
fn right_folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    write(&folder, "box_box.jsonl", &(boxes(0, "apart", 0.5) + &boxes(1, "deep", -0.25)));
    write(&folder, "mixed.jsonl", &(balls(0, 0.75) + &balls(1, -1.5)));
    write(&folder, "toi.jsonl", &(flight(0, 3.0) + &flight(1, 0.5)));
    write(&folder, "mesh/cube.obj", CUBE);
    write(&folder, "rays_cube.jsonl", &(ray(0, 0.25) + &ray(1, 4.0)));
    let list = r#"{"two":{"boxes":2,"overlap_pairs":1,"pair_hash":"HASH"}}"#;
    write(&folder, "aabb/expected.json", &list.replace("HASH", &yardstick::sets::aabb::pair_hash(0, 1).to_string()));
    let corners: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0];
    let bytes: Vec<u8> = corners.iter().flat_map(|number| number.to_le_bytes()).collect();
    fs::write(folder.path().join("aabb/two.f32"), bytes).expect("written");
    folder
}

/// A cube from -1 to 1; the faces 2 and 3 are at z = 1.
const CUBE: &str = "\
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 4 8 7\nf 4 7 3\nf 1 5 8\nf 1 8 4\nf 2 3 7\nf 2 7 6\n";

/// Two unrotated boxes, `gap` apart along x.
fn boxes(index: u64, category: &str, gap: f64) -> String {
    let x = 1.0 + 0.5 + gap;
    format!(
        "{{\"i\":{index},\"cat\":\"{category}\",\"a\":{{\"k\":\"box\",\"h\":[1,2,3],\"p\":[0,0,0],\"q\":[0,0,0,1]}},\
         \"b\":{{\"k\":\"box\",\"h\":[0.5,0.5,0.5],\"p\":[{x},0.25,0],\"q\":[0,0,0,2]}},\"d\":{gap},\"s\":4}}\n"
    )
}

/// Two balls of radius 1 and 0.5, `gap` apart along z; at a gap of -1.5 they are concentric.
fn balls(index: u64, gap: f64) -> String {
    let z = 1.5 + gap;
    format!(
        "{{\"i\":{index},\"cat\":\"balls\",\"a\":{{\"k\":\"sphere\",\"r\":1,\"p\":[0,0,0],\"q\":[0,0,0,1]}},\
         \"b\":{{\"k\":\"sphere\",\"r\":0.5,\"p\":[0,0,{z}],\"q\":[1,0,0,0]}},\"d\":{gap},\"s\":2}}\n"
    )
}

/// A ball that flies `way` towards another that is 1 away: it hits if it comes so far.
fn flight(index: u64, way: f64) -> String {
    let t = if way >= 1.0 { format!("true,\"t\":{},\"rate\":{way}", 1.0 / way) } else { "false,\"t\":null".to_owned() };
    format!(
        "{{\"i\":{index},\"cat\":\"flight\",\
         \"a\":{{\"k\":\"sphere\",\"r\":1,\"p\":[0,0,0],\"q\":[0,0,0,1],\"v\":[{way},0,0]}},\
         \"b\":{{\"k\":\"sphere\",\"r\":1,\"p\":[3,0,0],\"q\":[0,0,0,1],\"v\":[0,0,0]}},\
         \"hit\":{t},\"start\":false,\"s\":3,\"speed\":{way}}}\n"
    )
}

/// A ray down at the cube from 2 above it; beside it at `x` above 1.
fn ray(index: u64, x: f64) -> String {
    let hit = if x < 1.0 { "true,\"t\":0.5,\"ids\":[2],\"cos\":1" } else { "false,\"t\":null" };
    format!("{{\"i\":{index},\"cat\":\"down\",\"o\":[{x},-0.5,3],\"d\":[0,0,-4],\"hit\":{hit}}}\n")
}

fn write(folder: &TempDir, name: &str, text: &str) {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
    fs::write(path, text).expect("written");
}

fn check(folder: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_yardstick")).arg("check").arg(folder).args(more).output().expect("it runs")
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

#[track_caller]
fn expect(folder: &TempDir, more: &[&str], code: i32, part: &str) {
    let output = check(folder.path(), more);
    let said = text(&output);
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(said.contains(part), "{part} is not in: {said}");
}

/// Alters text in a file, which must be there.
fn alter(folder: &TempDir, name: &str, from: &str, to: &str) {
    let path = folder.path().join(name);
    let before = fs::read_to_string(&path).expect("read");
    assert!(before.contains(from), "{from} is not in {before}");
    fs::write(&path, before.replacen(from, to, 1)).expect("written");
}

#[test]
fn right_answers_are_exit_0() {
    expect(&right_folder(), &[], 0, "9 records: all as expected");
}

#[test]
fn one_altered_value_is_exit_1() {
    for (name, from, to) in [
        ("box_box.jsonl", "\"d\":0.5,", "\"d\":0.50000002,"),
        ("box_box.jsonl", "\"d\":-0.25,", "\"d\":-0.24999998,"),
        ("mixed.jsonl", "\"d\":-1.5,", "\"d\":-1.4,"),
        ("toi.jsonl", "0.3333333333333333", "0.3333333433333333"),
        ("rays_cube.jsonl", "\"ids\":[2]", "\"ids\":[4]"),
        ("rays_cube.jsonl", "\"t\":0.5", "\"t\":0.50000000001"),
        ("aabb/expected.json", "\"overlap_pairs\":1", "\"overlap_pairs\":2"),
    ] {
        let folder = right_folder();
        alter(&folder, name, from, to);
        expect(&folder, &[], 1, "shortfall: ");
    }
}

#[test]
fn an_altered_yes_is_exit_1_unless_it_is_ambiguous() {
    let folder = right_folder();
    alter(&folder, "rays_cube.jsonl", "\"hit\":false", "\"hit\":true");
    alter(&folder, "rays_cube.jsonl", "\"t\":null", "\"t\":0.5,\"cos\":1");
    expect(&folder, &[], 1, "shortfall: rays_cube down: 1 short");
    alter(&folder, "rays_cube.jsonl", "{\"i\":1,", "{\"i\":1,\"amb\":1,");
    expect(&folder, &[], 0, "all as expected");
}

#[test]
fn gzipped_sets_and_subsets_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = fs::File::create(folder.path().join("mixed.jsonl.gz")).expect("a file");
    let mut packed = flate2::write::GzEncoder::new(file, flate2::Compression::default());
    std::io::Write::write_all(&mut packed, balls(0, 0.75).as_bytes()).expect("packed");
    packed.finish().expect("packed");
    expect(&folder, &[], 0, "1 records: all as expected");
}

#[test]
fn what_is_not_understood_is_exit_2() {
    let empty = tempfile::tempdir().expect("a folder");
    expect(&empty, &[], 2, "0 records");
    for (name, content, part) in [
        ("box_bax.jsonl", "{}\n", "box_bax.jsonl: no set of this name"),
        ("rays_ball.jsonl", "{}\n", "mesh/ball.obj is missing"),
        ("mixed.jsonl", "{\"i\":0}\n", "mixed.jsonl:1: "),
        ("mixed.jsonl", &(balls(0, 0.75) + "not json\n"), "mixed.jsonl:2: "),
        ("mixed.jsonl", &balls(0, 0.75).replace("sphere", "torus"), "mixed.jsonl:1: a: `torus`"),
        ("stream/x.csv", "frame\n", "x_expected.jsonl"),
        ("aabb/three.f32", "", "three.f32: "),
        ("mesh/cube.obj", "v 0 0 0\nf 1 2 3\n", "cube.obj:2: "),
    ] {
        let folder = right_folder();
        write(&folder, name, content);
        expect(&folder, &[], 2, part);
    }
    expect(&right_folder(), &["--known", "no/such/file.toml"], 2, "no/such/file.toml");
}

#[test]
fn known_shortfalls_must_be_true_both_ways() {
    let list = |count: &str| {
        format!(
            "[[shortfall]]\nfile = \"mixed\"\ncategory = \"balls\"\ncount = {count}\npart = \"Part 9\"\nreason = \"a test\"\n"
        )
    };
    let folder = right_folder();
    let known = folder.path().join("known.toml");
    let arguments = ["--known", known.to_str().expect("a path")];
    fs::write(&known, list("1")).expect("written");
    expect(&folder, &arguments, 1, "out of date");
    alter(&folder, "mixed.jsonl", "\"d\":0.75,", "\"d\":0.7,");
    expect(&folder, &arguments, 0, "a test (Part 9)");
    alter(&folder, "mixed.jsonl", "\"d\":-1.5,", "\"d\":-1.4,");
    expect(&folder, &arguments, 1, "2 short, 1 known");
    fs::write(&known, list("\"all\"")).expect("written");
    expect(&folder, &arguments, 0, "all as expected");
    fs::write(&known, "[[shortfalls]]\n").expect("written");
    expect(&folder, &arguments, 2, "known.toml");
}
