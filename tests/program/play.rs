//! `play`: a trace drives a world, one tick for each frame.

use std::fmt::Write;
use std::io::Write as _;
use std::time::{Duration, Instant};

use calipers_client::Client;
use flate2::{Compression, write::GzEncoder};

use crate::binary::{Scratch, Server, run, run_interrupted, run_well};

const HEADER: &str = "frame,time,op,actor,kind,px,py,pz,qx,qy,qz,qw\n";
const KINDS: [&str; 4] = ["--kind", "car=box:2,1,4", "--kind", "ball=sphere:0.5"];

/// Two actors for `frame_count` frames, 10 a second; the car of number 9 is gone in the last of them.
fn trace(frame_count: u32) -> String {
    let mut text = format!("{HEADER}0,0,N,4,ball,,,,,,,\n0,0,N,9,car,,,,,,,\n0,0,N,8,tree,,,,,,,\n");
    for frame in 0..frame_count {
        let time = 0.1 * f64::from(frame);
        writeln!(text, "{frame},{time},M,4,ball,{frame},0.1,0,0,0,0,1").expect("a string takes all");
        writeln!(text, "{frame},{time},M,8,tree,0,0,0,0,0,0,1").expect("a string takes all");
        if frame + 1 < frame_count {
            writeln!(text, "{frame},{time},M,9,car,0,{frame},0,0,0,0.5,0.5").expect("a string takes all");
        } else {
            writeln!(text, "{frame},{time},D,9,,,,,,,,").expect("a string takes all");
        }
    }
    text
}

#[tokio::test(flavor = "multi_thread")]
async fn every_frame_is_a_tick_and_the_last_one_stays() {
    let server = Server::start(&[]);
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(trace(50).as_bytes()).expect("a vector takes all");
    let file = Scratch::new(".csv.gz", packed.finish().expect("a vector takes all"));
    let arguments = ["play", file.path(), "--speed", "max", "--server", server.address()];
    let said = run_well(&[&arguments[..], &KINDS].concat());
    // Tick 1 is the empty world; 2 inserts, 48 + 49 moves, 1 removal.
    assert!(said.contains("50 frames, one tick each, the last is tick 51; 100 edits"), "{said}");
    let client = Client::connect(server.address()).await.expect("the server listens");
    let ball = client.shape(4).await.expect("the ball is there").shape.expect("it is told");
    let at = ball.pose.and_then(|pose| pose.position).expect("it has a place");
    // Rounded to single precision after parsing.
    assert_eq!([at.x, at.y, at.z], [49.0, f64::from(0.1_f32), 0.0]);
    assert!(client.shape(9).await.is_err(), "the car is gone");
    assert!(client.shape(8).await.is_err(), "trees were not asked for");
}

#[test]
fn real_time_is_real_and_a_factor_shortens_it() {
    let server = Server::start(&[]);
    let file = Scratch::new(".csv", trace(9));
    let took = |speed: &str| {
        let arguments = ["play", file.path(), "--speed", speed, "--server", server.address()];
        let began = Instant::now();
        run_well(&[&arguments[..], &KINDS].concat());
        began.elapsed()
    };
    // The last of nine frames is due after 0.8 s.
    let (real, fourfold, most) = (took("1"), took("4"), took("max"));
    assert!(real >= Duration::from_millis(800), "{real:?}");
    assert!(fourfold >= Duration::from_millis(200), "{fourfold:?}");
    assert!(most < real, "{most:?} at most speed, {real:?} in real time");
}

#[test]
fn a_loop_goes_on_until_it_is_interrupted_and_then_sums_up() {
    let server = Server::start(&[]);
    let file = Scratch::new(".csv", trace(5));
    let arguments = ["play", file.path(), "--loop", "--speed", "max", "--server", server.address()];
    let answer = run_interrupted(&[&arguments[..], &KINDS].concat(), Duration::from_secs(2));
    assert_eq!(answer.code, Some(0), "{answer:?}");
    let frame_count = answer.out.split(' ').next().and_then(|word| word.parse::<u64>().ok());
    assert!(frame_count > Some(10), "{answer:?}");
}

#[test]
fn a_wrong_trace_is_exit_1_with_its_line() {
    let server = Server::start(&[]);
    for (rows, said) in [
        ("0,0,M,1,car,1,2,x,0,0,0,1\n", "line 2: pz is \"x\""),
        ("0,0,M,1,car,1,2\n", "line: 2"),
        ("0,0,Z,1,car,1,2,3,0,0,0,1\n", "op is \"Z\", it must be N, M or D"),
        ("0,0,M,0,car,1,2,3,0,0,0,1\n", "no shape can have the id 0"),
    ] {
        let file = Scratch::new(".csv", format!("{HEADER}{rows}"));
        let answer = run(&[&["play", file.path(), "--server", server.address()], &KINDS[..]].concat());
        assert_eq!(answer.code, Some(1), "{answer:?}");
        assert!(answer.err.contains(said), "{answer:?}");
    }
    let missing = run(&[&["play", "nowhere.csv"], &KINDS[..]].concat());
    assert!(missing.code == Some(1) && missing.err.contains("nowhere.csv cannot be read"), "{missing:?}");
}

#[test]
fn edits_that_the_server_leaves_out_are_a_failure() {
    let server = Server::start(&[]);
    let file = Scratch::new(".csv", trace(3));
    // A sphere of a negative radius can be written, but is none.
    let arguments = ["play", file.path(), "--kind", "ball=sphere:-1", "--speed", "max", "--server", server.address()];
    let answer = run(&arguments);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    assert!(answer.err.contains("left") && answer.err.contains("radius"), "{answer:?}");
}
