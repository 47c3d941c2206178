//! `load`: meshes arrive as they are in the file, and broken files are told apart from whole ones.

use std::fmt::Write;

use crate::binary::{Scratch, Server, run, run_well};

/// A square pyramid: base from -1 to 1 at y = 0, apex at y = 3; its base is a polygon of four corners.
const PYRAMID: &str = "# made by hand\nmtllib nowhere.mtl\no pyramid\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 3 0\n\
                       usemtl stone\nf 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n";

#[test]
fn a_mesh_is_loaded_and_answers() {
    let server = Server::start(&[]);
    let of = |arguments: &[&str]| run_well(&[arguments, &["--server", server.address()]].concat());
    let file = Scratch::new(".obj", PYRAMID);
    let said = of(&["load", file.path(), "--id", "7", "--at", "10,-1,0"]);
    assert!(said.contains("6 triangles in the file, 0 of them without area"), "{said}");
    assert!(said.contains("geometry ") && said.contains("shape 7, seen from tick 2"), "{said}");
    let hit = of(&["raycast", "10,10,0", "0,-1,0"]);
    assert!(hit.contains("shape 7 at 8 m"), "{hit}");
    let face = of(&["raycast", "10.5,-9,0.25", "0,1,0"]);
    assert!(face.contains("shape 7 at 8 m"), "{face}");
}

#[test]
fn a_factor_scales_the_shape() {
    let server = Server::start(&[]);
    let of = |arguments: &[&str]| run_well(&[arguments, &["--server", server.address()]].concat());
    let file = Scratch::new(".obj", PYRAMID);
    of(&["load", file.path(), "--scale", "0.5"]);
    let hit = of(&["raycast", "0,10,0", "0,-1,0"]);
    assert!(hit.contains("shape 1 at 8.5 m"), "{hit}");
}

#[test]
fn a_body_is_full_and_what_is_open_is_none() {
    let server = Server::start(&[]);
    let file = Scratch::new(".obj", PYRAMID);
    let load = |mode: &str, file: &Scratch| run(&["load", file.path(), "--mode", mode, "--server", server.address()]);
    let inside = || run_well(&["raycast", "0,1,0", "1,0,0", "--server", server.address()]);
    assert_eq!(load("solid", &file).code, Some(0));
    assert!(inside().contains("at 0 m"), "{}", inside());
    assert_eq!(load("one-sided", &file).code, Some(0));
    assert!(!inside().contains("shape 1"), "{}", inside());
    // With its tip below the base its faces look inwards.
    let inwards = load("solid", &Scratch::new(".obj", PYRAMID.replace("v 0 3 0", "v 0 -3 0")));
    assert!(inwards.code == Some(1) && inwards.err.contains("wound inwards"), "{inwards:?}");
    let open = load("solid", &Scratch::new(".obj", PYRAMID.replace("f 4 5 1\n", "")));
    assert!(open.code == Some(1) && open.err.contains("is open at the edge between vertices"), "{open:?}");
}

#[test]
fn a_geometry_alone_makes_no_shape_and_the_same_file_the_same_id() {
    let server = Server::start(&[]);
    let of = |arguments: &[&str]| run_well(&[arguments, &["--server", server.address()]].concat());
    let file = Scratch::new(".obj", PYRAMID);
    let first = of(&["load", file.path(), "--geometry-only"]);
    assert!(!first.contains("shape"), "{first}");
    assert_eq!(first, of(&["load", file.path(), "--geometry-only"]));
    assert!(of(&["describe"]).contains("0 shapes"));
}

#[test]
fn triangles_without_area_are_counted() {
    let server = Server::start(&[]);
    let file = Scratch::new(".obj", format!("{PYRAMID}v 0 0 0\nf 1 1 2\nf 1 6 3\n"));
    let said = run_well(&["load", file.path(), "--server", server.address()]);
    assert!(said.contains("8 triangles in the file, 2 of them without area"), "{said}");
    assert!(said.contains("warning: "), "{said}");
}

#[test]
fn a_broken_file_is_exit_1_with_file_and_line_and_changes_nothing() {
    let server = Server::start(&[]);
    for (contents, said) in [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "line 4: corner \"9\" names a vertex that does not exist"),
        ("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "line 2: \"nan\" is not a finite number"),
        ("v 0 0 0\nv 1 zero 0\nv 0 1 0\nf 1 2 3\n", "line 2: \"zero\" is not a finite number"),
        ("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", "line 2: a vertex has three coordinates"),
        ("", "no faces"),
    ] {
        let file = Scratch::new(".obj", contents);
        let answer = run(&["load", file.path(), "--server", server.address()]);
        assert_eq!(answer.code, Some(1), "{answer:?}");
        assert!(answer.err.contains(file.path()) && answer.err.contains(said), "{answer:?}");
    }
    let missing = run(&["load", "nowhere.obj", "--server", server.address()]);
    assert!(missing.code == Some(1) && missing.err.contains("nowhere.obj cannot be read"), "{missing:?}");
    assert!(run_well(&["describe", "--server", server.address()]).contains("0 shapes"));
}

#[test]
fn a_file_beyond_one_message_goes_up_in_chunks() {
    let server = Server::start(&[]);
    let mut text = String::new();
    let side = 500;
    for row in 0..side {
        for column in 0..side {
            writeln!(text, "v {column} 0 {row}").expect("a string takes all");
        }
    }
    for row in 1..side {
        for column in 1..side {
            let corner = row * side + column + 1;
            writeln!(text, "f {corner} {} {}", corner - 1, corner - side).expect("a string takes all");
        }
    }
    let file = Scratch::new(".obj", text);
    let said = run_well(&["load", file.path(), "--unit", "cm", "--server", server.address()]);
    assert!(said.contains("249001 triangles in the file, 0 of them without area"), "{said}");
    let hit = run_well(&["raycast", "4.986,8,4.985", "0,-1,0", "--server", server.address()]);
    assert!(hit.contains("shape 1 at 8 m"), "{hit}");
}

#[test]
fn a_file_of_another_format_is_turned_upright() {
    let server = Server::start(&[]);
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_index\nelement edge 1\nproperty int a\nend_header\n\
                -1 -1 3\n1 -1 3\n1 1 3\n-1 1 3\n4 0 1 2 3\n7\n";
    let file = Scratch::new(".ply", text);
    let said = run_well(&["load", file.path(), "--up", "z", "--server", server.address()]);
    assert!(said.contains("note: 1 of edge passed over") && said.contains("2 triangles in the file"), "{said}");
    let hit = run_well(&["raycast", "0.5,10,0.25", "0,-1,0", "--server", server.address()]);
    assert!(hit.contains("shape 1 at 7 m"), "{hit}");
    let wrong = run(&["load", "level.fbx", "--server", server.address()]);
    assert!(wrong.code == Some(1) && wrong.err.contains(".obj, .stl, .ply, .gltf or .glb"), "{wrong:?}");
}
