//! Laws of the edit writer, on a server that breaks streams on purpose: whatever breaks, every edit is applied once
//! and in order.

mod breaking_server;

use std::time::Duration;

use breaking_server::{BreakingServer, Plan};
use calipers_client::{Client, EditWriter, Error, WriterOptions, edit, proto};

fn ids_of(edits: &[proto::Edit]) -> Vec<u64> {
    let id = |edit: &proto::Edit| match &edit.op {
        Some(proto::edit::Op::Move(change)) => change.id,
        other => panic!("only moves were sent, not {other:?}"),
    };
    edits.iter().map(id).collect()
}

async fn writer_on(server: &BreakingServer, patience: Duration) -> EditWriter {
    let client = Client::connect(&server.address()).await.expect("the server listens");
    let options = WriterOptions { patience, ..WriterOptions::default() };
    EditWriter::open_with(&client, "arm", options).await.expect("the stream opens")
}

#[tokio::test]
async fn every_edit_is_applied_once_and_in_order_whatever_breaks() {
    // Streams that break after 1, 3, 0, 7, … messages, in the middle of ticks as well as between them.
    let server = BreakingServer::start(Plan { window: 8, breaks_after: vec![1, 3, 0, 7, 2, 5] }).await;
    let mut writer = writer_on(&server, Duration::from_secs(20)).await;
    for id in 1..=60 {
        let moved = [edit::move_to(id, [0.0, 0.0, 0.0])];
        // Ticks of three messages each, so that breaks leave open ticks behind.
        if id % 3 == 0 { writer.commit(moved).await } else { writer.send(moved).await }.expect("the writer goes on");
    }
    assert_eq!(writer.flush().await.expect("all of it arrives"), 20);
    assert_eq!(writer.resumed_count(), 6);
    assert_eq!(writer.acked_sequence(), 60);
    let ticks = server.ticks();
    assert_eq!(ticks.iter().flat_map(|tick| ids_of(tick)).collect::<Vec<_>>(), (1..=60).collect::<Vec<_>>());
    assert!(ticks.iter().all(|tick| tick.len() == 3), "a tick is whole or not there");
}

#[tokio::test]
async fn the_window_is_never_overrun() {
    let server = BreakingServer::start(Plan { window: 4, breaks_after: vec![9, 9] }).await;
    let mut writer = writer_on(&server, Duration::from_secs(20)).await;
    for id in 1..=40 {
        writer.commit([edit::move_to(id, [0.0, 0.0, 0.0])]).await.expect("the writer goes on");
    }
    writer.flush().await.expect("all of it arrives");
    let most = server.most_unacknowledged();
    assert!((1..=4).contains(&most), "{most} messages were unacknowledged");
}

#[tokio::test]
async fn a_tick_larger_than_the_window_is_an_error_and_no_standstill() {
    let server = BreakingServer::start(Plan { window: 4, breaks_after: vec![] }).await;
    let mut writer = writer_on(&server, Duration::from_secs(20)).await;
    for id in 1..=4 {
        writer.send([edit::move_to(id, [0.0, 0.0, 0.0])]).await.expect("the window has room");
    }
    let refused = writer.send([edit::move_to(5, [0.0, 0.0, 0.0])]).await;
    assert!(matches!(refused, Err(Error::WindowFull { window: 4 })), "{refused:?}");
}

#[tokio::test]
async fn flush_commits_what_is_open() {
    let server = BreakingServer::start(Plan { window: 4, breaks_after: vec![] }).await;
    let mut writer = writer_on(&server, Duration::from_secs(20)).await;
    assert_eq!(writer.flush().await.expect("nothing was sent"), 0);
    writer.send([edit::move_to(1, [0.0, 0.0, 0.0])]).await.expect("the window has room");
    assert_eq!(writer.flush().await.expect("it is committed"), 1);
    assert_eq!(server.ticks().len(), 1);
}

#[tokio::test]
async fn a_new_writer_of_a_known_name_goes_on_counting() {
    let server = BreakingServer::start(Plan { window: 4, breaks_after: vec![] }).await;
    let mut first = writer_on(&server, Duration::from_secs(20)).await;
    first.commit([edit::move_to(1, [0.0, 0.0, 0.0])]).await.expect("the window has room");
    first.close().await.expect("it is committed");
    let mut second = writer_on(&server, Duration::from_secs(20)).await;
    assert_eq!(second.acked_sequence(), 1);
    assert_eq!(second.commit([edit::move_to(2, [0.0, 0.0, 0.0])]).await.expect("the window has room"), 2);
    second.flush().await.expect("it is committed");
    assert_eq!(server.ticks().len(), 2);
}

#[tokio::test]
async fn problems_are_reported_and_do_not_end_the_stream() {
    let server = BreakingServer::start(Plan { window: 4, breaks_after: vec![] }).await;
    let mut writer = writer_on(&server, Duration::from_secs(20)).await;
    writer.commit([edit::move_to(0, [0.0, 0.0, 0.0])]).await.expect("the window has room");
    writer.commit([edit::move_to(1, [0.0, 0.0, 0.0])]).await.expect("the window has room");
    writer.flush().await.expect("the stream goes on");
    let report = writer.take_report();
    assert_eq!(report.problems.len(), 1);
    assert_eq!(report.problems[0].sequence, 1);
    assert!(writer.take_report().problems.is_empty(), "a report is taken once");
}

#[tokio::test]
async fn a_refused_stream_is_not_tried_again() {
    let server = BreakingServer::start(Plan { window: 4, breaks_after: vec![] }).await;
    let mut writer = writer_on(&server, Duration::from_secs(20)).await;
    writer.commit([edit::move_to(1, [0.0, 0.0, 0.0])]).await.expect("the window has room");
    writer.flush().await.expect("it is committed");
    server.refuse("WRITER_REPLACED: another client took the name over");
    let ended = loop {
        if let Err(error) = writer.commit([edit::move_to(2, [0.0, 0.0, 0.0])]).await {
            break error;
        }
    };
    assert_eq!(ended.code(), Some(tonic::Code::Aborted), "{ended}");
    assert_eq!(writer.resumed_count(), 0);
}

#[tokio::test]
async fn a_server_that_stays_away_is_given_up_in_time() {
    let server = BreakingServer::start(Plan { window: 4, breaks_after: vec![] }).await;
    let mut writer = writer_on(&server, Duration::from_millis(300)).await;
    server.stop().await;
    let ended = loop {
        if let Err(error) = writer.commit([edit::move_to(1, [0.0, 0.0, 0.0])]).await {
            break error;
        }
    };
    assert!(matches!(ended, Error::GaveUp { .. }), "{ended}");
}

#[tokio::test]
async fn a_server_that_lost_the_writer_is_told_apart_from_a_break() {
    let server = BreakingServer::start(Plan { window: 4, breaks_after: vec![] }).await;
    let mut writer = writer_on(&server, Duration::from_secs(20)).await;
    writer.commit([edit::move_to(1, [0.0, 0.0, 0.0])]).await.expect("the window has room");
    writer.flush().await.expect("it is committed");
    server.forget_and_break();
    let ended = loop {
        if let Err(error) = writer.commit([edit::move_to(2, [0.0, 0.0, 0.0])]).await {
            break error;
        }
    };
    assert!(matches!(ended, Error::Forgotten { known: 0, acked: 1 }), "{ended}");
}

#[tokio::test]
async fn a_send_that_is_given_up_sends_nothing_and_leaves_no_gap() {
    let server = BreakingServer::start(Plan { window: 1000, breaks_after: vec![] }).await;
    let mut writer = writer_on(&server, Duration::from_secs(20)).await;
    let mut sent = Vec::new();
    for id in 1..=200 {
        // Given up at once where it has to wait: nothing yields here, so that the queue fills up.
        tokio::select! {
            biased;
            done = writer.commit([edit::move_to(id, [0.0, 0.0, 0.0])]) => {
                done.expect("the writer goes on");
                sent.push(id);
            }
            () = std::future::ready(()) => {}
        }
    }
    assert!((1..200).contains(&sent.len()), "{} of 200 were sent", sent.len());
    let flushed = tokio::time::timeout(Duration::from_secs(10), writer.flush()).await;
    flushed.expect("nothing is waited for in vain").expect("all of it arrives");
    let applied: Vec<u64> = server.ticks().iter().flat_map(|tick| ids_of(tick)).collect();
    assert_eq!(applied, sent);
}
