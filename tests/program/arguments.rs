//! Wrong arguments and settings get a sentence and an exit code of 2, or 1 where only a try shows that they are wrong.

use crate::binary::{Scratch, Server, run};

#[test]
fn a_command_line_that_is_not_understood_is_exit_2_with_a_sentence() {
    for (arguments, said) in [
        (&["raycast", "1,2", "0,0,1"][..], "2 numbers found, three wanted: X,Y,Z"),
        (&["raycast", "1,2,x", "0,0,1"], "\"x\" is not a number"),
        (&["raycast", "1,2,inf", "0,0,1"], "\"inf\" is not a finite number"),
        (&["raycast", "1,2,3"], "<DX,DY,DZ>"),
        (&["overlap", "sphere"], "a form is sphere:RADIUS"),
        (&["overlap", "torus:1,2"], "\"torus\" is no form"),
        (&["overlap", "box:1,2"], "2 numbers do not make a box"),
        (&["play", "trace.csv"], "--kind"),
        (&["play", "trace.csv", "--kind", "car"], "a kind is NAME=FORM"),
        (&["play", "trace.csv", "--kind", "car=sphere:1", "--speed", "-1"], "a speed is a number above 0"),
        (&["load", "level.obj", "--id", "0"], "0 is not in 1.."),
        (&["serve", "--seed", "2"], "--demo"),
        (&["survey"], "unrecognized subcommand 'survey'"),
        (&[], "Usage: calipers <COMMAND>"),
    ] {
        let answer = run(arguments);
        assert_eq!(answer.code, Some(2), "{arguments:?}: {answer:?}");
        assert!(answer.err.contains(said), "{arguments:?}: {answer:?}");
    }
}

#[test]
fn help_names_every_command_and_the_exit_codes() {
    let help = run(&["--help"]);
    assert_eq!(help.code, Some(0));
    for word in ["serve", "load", "play", "raycast", "overlap", "describe", "Exit codes"] {
        assert!(help.out.contains(word), "{word} is not in the help");
    }
    for command in ["serve", "load", "play", "raycast", "overlap", "describe"] {
        let help = run(&[command, "--help"]);
        assert!(help.code == Some(0) && help.out.contains("Usage: calipers"), "{help:?}");
    }
}

#[test]
fn no_server_is_exit_1_and_names_the_address() {
    for arguments in [&["describe"][..], &["raycast", "0,0,0", "-1,0,0"], &["overlap", "sphere:1", "--at", "-1,0,0"]] {
        // Port 1 of this machine: nothing listens there.
        let answer = run(&[arguments, &["--server", "127.0.0.1:1"]].concat());
        assert_eq!(answer.code, Some(1), "{answer:?}");
        assert!(answer.err.contains("no Calipers server answers at 127.0.0.1:1"), "{answer:?}");
    }
}

#[test]
fn an_unknown_session_and_a_wrong_question_are_exit_1_with_the_servers_sentence() {
    let server = Server::start(&[]);
    let of = |arguments: &[&str]| run(&[arguments, &["--server", server.address()]].concat());
    let unknown = of(&["describe", "--session", "nowhere"]);
    assert_eq!(unknown.code, Some(1), "{unknown:?}");
    assert!(unknown.err.contains("nowhere"), "{unknown:?}");
    let still = of(&["raycast", "0,0,0", "0,0,0"]);
    assert_eq!(still.code, Some(1), "{still:?}");
    assert!(still.err.contains("INVALID_ARGUMENT") && still.err.contains("direction"), "{still:?}");
}

#[test]
fn settings_that_are_refused_are_exit_1_with_the_reason() {
    let unknown = Scratch::new(".toml", "colour = 3\n");
    let first = Server::start(&[]);
    for (arguments, said) in [
        (&["--listen", "0.0.0.0:0"][..], "--insecure"),
        (&["--listen", first.address()], "cannot listen on"),
        (&["--config", unknown.path()], "colour"),
        (&["--config", "nowhere.toml"], "nowhere.toml"),
        (&["--max-sessions", "0"], "max_sessions is 0"),
        (&["--log-filter", "a=b=c"], "log_filter"),
    ] {
        let answer = run(&[&["serve"], arguments].concat());
        assert_eq!(answer.code, Some(1), "{arguments:?}: {answer:?}");
        assert!(answer.err.contains(said), "{arguments:?}: {answer:?}");
    }
}

#[test]
fn a_settings_file_is_read_and_flags_win_over_it() {
    let file = Scratch::new(".toml", "listen = \"127.0.0.1:1\"\ndrain_limit_s = 5\n");
    // Port 1 would be refused; the flag that the harness gives asks for a free port.
    let server = Server::start(&["--config", file.path()]);
    assert!(server.address().starts_with("127.0.0.1:"));
}
