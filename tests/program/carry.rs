//! `export` and `import`: what goes through a file comes back the same, and a file that is not whole changes nothing.

use std::fs;

use crate::binary::{Scratch, Server, run, run_well};

#[test]
fn a_world_goes_through_a_file() {
    let server = Server::start(&["--demo"]);
    let other = Server::start(&[]);
    let file = Scratch::new(".world", "");
    let said = run_well(&["export", file.path(), "--tick", "2", "--server", server.address()]);
    assert!(said.contains("tick 2, ") && said.contains("geometries by id"), "{said}");
    let bytes = fs::read(file.path()).expect("it was written");
    // Torn anywhere, or with a bit changed.
    for wrong in [&bytes[..bytes.len() - 1], &bytes[..bytes.len() / 2], &bytes[..1], b"not an export at all", b""] {
        let torn = Scratch::new(".world", wrong);
        let said = run(&["import", torn.path(), "--server", other.address()]);
        assert!(said.code == Some(1) && said.err.starts_with("calipers: "), "{said:?}");
    }
    let mut damaged = bytes.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    let said = run(&["import", Scratch::new(".world", damaged).path(), "--server", other.address()]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert!(run_well(&["describe", "--server", other.address()]).contains("0 shapes"));

    let said = run_well(&["import", file.path(), "--server", other.address()]);
    assert!(said.contains("at tick 2, content "), "{said}");
    let again = Scratch::new(".world", "");
    run_well(&["export", again.path(), "--server", other.address()]);
    assert_eq!(fs::read(again.path()).expect("it was written"), bytes);
    let said = run(&["import", file.path(), "--server", other.address()]);
    assert!(said.code == Some(1) && said.err.contains("import into a new session"), "{said:?}");
    let said = run(&["export", file.path(), "--tick", "99999", "--server", server.address()]);
    assert!(said.code == Some(1) && said.err.contains("not made yet"), "{said:?}");
    assert_eq!(fs::read(file.path()).expect("it is there"), bytes, "an export that fails leaves the file");
}
