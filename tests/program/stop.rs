//! The server stops cleanly when it is asked to.

use std::time::Duration;

use calipers_client::{Client, EditWriter, edit, shape};

use crate::binary::Server;

#[test]
fn each_signal_stops_it_with_exit_0() {
    for signal in ["INT", "TERM"] {
        let server = Server::start(&[]);
        server.signal(signal);
        let (code, log) = server.wait(Duration::from_secs(10));
        assert_eq!(code, Some(0), "{log}");
        assert!(log.contains(&format!("SIG{signal}")) && log.contains("\"stopped\""), "{log}");
        // Not on a terminal: every line of the log is JSON.
        for line in log.lines() {
            assert!(serde_json::from_str::<serde_json::Value>(line).is_ok(), "{line:?} is not JSON");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn open_streams_are_told_and_do_not_hold_it_up() {
    let server = Server::start(&["--drain-limit-s", "20"]);
    let client = Client::connect(server.address()).await.expect("the server listens");
    let options = calipers_client::WriterOptions { patience: Duration::from_millis(200), ..Default::default() };
    let mut writer = EditWriter::open_with(&client, "arm", options).await.expect("the stream opens");
    writer.commit([shape::sphere(1, 1.0).insert()]).await.expect("the stream is open");
    writer.flush().await.expect("the tick is made");
    server.signal("TERM");
    let (code, log) = tokio::task::spawn_blocking(move || server.wait(Duration::from_secs(10))).await.expect("it ends");
    assert_eq!(code, Some(0), "{log}");
    let told = loop {
        if let Err(error) = writer.commit([edit::move_to(1, [0.0, 0.0, 1.0])]).await {
            break error;
        }
    };
    assert!(matches!(told, calipers_client::Error::GaveUp { .. }), "{told}");
}

#[test]
fn the_demo_stops_while_it_moves() {
    let server = Server::start(&["--demo"]);
    server.signal("INT");
    let (code, log) = server.wait(Duration::from_secs(10));
    assert_eq!(code, Some(0), "{log}");
    assert!(!log.contains("WARN") && !log.contains("ERROR"), "{log}");
}
