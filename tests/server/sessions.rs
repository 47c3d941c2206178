//! Sessions: names, tokens and their roles, leases, retries, and that worlds are apart.

use std::time::Duration;

use tonic::Code;
use wire::v1 as pb;

use crate::harness::{Bench, assert_refused, edit, get, ray, ray_along_z, settings, with_token};

fn seconds(seconds: i64) -> prost_types::Duration {
    prost_types::Duration { seconds, nanos: 0 }
}

#[tokio::test]
async fn the_open_session_needs_neither_token_nor_lease() {
    let mut bench = Bench::start().await;
    let session = bench.sessions.get_session(get("")).await.unwrap().into_inner().session.unwrap();
    assert_eq!((session.session.as_str(), session.tick), ("default", 1));
    assert!(session.lease.is_none() && session.expire_time.is_none());
    let renew = pb::RenewSessionRequest { session: String::new(), lease: Some(seconds(5)) };
    let status = bench.sessions.renew_session(renew).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "lease", &["as long as the server"]);
}

#[tokio::test]
async fn without_the_open_session_an_empty_name_is_refused() {
    let mut settings = settings();
    settings.default_session = calipers::config::DefaultSession::Off;
    let mut bench = Bench::start_with(settings).await;
    let status = bench.questions.raycast(ray_along_z()).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "session", &["CreateSession"]);
}

#[tokio::test]
async fn a_name_is_chosen_or_wished_for_and_taken_once() {
    let mut bench = Bench::start().await;
    let chosen = bench.create_session("").await.session.unwrap();
    assert!(chosen.session.starts_with("s-"), "{chosen:?}");
    assert_eq!(chosen.lease.unwrap().seconds, 3600);
    assert!(chosen.expire_time.is_some());
    let wished = bench.create_session("arena-7").await.session.unwrap();
    assert_eq!(wished.session, "arena-7");
    let again = pb::CreateSessionRequest { session: "arena-7".to_owned(), ..pb::CreateSessionRequest::default() };
    let status = bench.sessions.create_session(again).await.unwrap_err();
    assert_refused(&status, Code::AlreadyExists, "SESSION_EXISTS", "", &["taken"]);
    let malformed = pb::CreateSessionRequest { session: "Arena 7".to_owned(), ..pb::CreateSessionRequest::default() };
    let status = bench.sessions.create_session(malformed).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "session", &["a-z, 0-9 and -"]);
}

#[tokio::test]
async fn a_retry_gets_the_first_answer_and_makes_no_second_session() {
    let mut bench = Bench::start().await;
    let request = pb::CreateSessionRequest { request_id: "once".to_owned(), ..pb::CreateSessionRequest::default() };
    let first = bench.sessions.create_session(request.clone()).await.unwrap().into_inner();
    let second = bench.sessions.create_session(request.clone()).await.unwrap().into_inner();
    assert_eq!(first.token, second.token);
    assert_eq!(first.session.unwrap().session, second.session.unwrap().session);
    let other = pb::CreateSessionRequest { session: "other".to_owned(), ..request };
    let status = bench.sessions.create_session(other).await.unwrap_err();
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "request_id", &["another request"]);
}

#[tokio::test]
async fn leases_and_settings_out_of_range_are_refused_by_name() {
    let mut bench = Bench::start().await;
    for length in [0, -1, 30 * 24 * 3600 + 1] {
        let request = pb::CreateSessionRequest { lease: Some(seconds(length)), ..pb::CreateSessionRequest::default() };
        let status = bench.sessions.create_session(request).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", "lease", &["1 second to 30 days"]);
    }
    for (settings, field, allowed) in [
        (pb::WorldSettings { history_ticks: Some(65_537), margin: None }, "settings.history_ticks", "0 to 65536"),
        (pb::WorldSettings { history_ticks: Some(0), margin: Some(-0.1) }, "settings.margin", "0 to 1e9 metres"),
    ] {
        let request = pb::CreateSessionRequest { settings: Some(settings), ..pb::CreateSessionRequest::default() };
        let status = bench.sessions.create_session(request).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", field, &[allowed]);
        let request = pb::UpdateWorldRequest { settings: Some(settings), ..pb::UpdateWorldRequest::default() };
        let status = bench.worlds.update_world(request).await.unwrap_err();
        assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", field, &[allowed]);
    }
}

#[tokio::test]
async fn a_session_ends_with_its_lease_unless_calls_renew_it() {
    let mut bench = Bench::start().await;
    let request = pb::CreateSessionRequest {
        session: "short".to_owned(),
        lease: Some(seconds(2)),
        ..pb::CreateSessionRequest::default()
    };
    let owner = bench.sessions.create_session(request).await.unwrap().into_inner().token;
    for _ in 0..3 {
        tokio::time::sleep(Duration::from_millis(800)).await;
        bench.questions.raycast(with_token(&owner, ray("short"))).await.unwrap();
    }
    tokio::time::sleep(Duration::from_millis(2600)).await;
    let status = bench.questions.raycast(with_token(&owner, ray("short"))).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "session", &["lease"]);
    bench.create_session("short").await;
}

#[tokio::test]
async fn an_open_stream_keeps_its_session() {
    let mut bench = Bench::start().await;
    let request = pb::CreateSessionRequest {
        session: "streamed".to_owned(),
        lease: Some(seconds(1)),
        ..pb::CreateSessionRequest::default()
    };
    let owner = bench.sessions.create_session(request).await.unwrap().into_inner().token;
    let (messages, outgoing) = tokio::sync::mpsc::channel(1);
    let hello = pb::EditStreamRequest { session: "streamed".to_owned(), ..pb::EditStreamRequest::default() };
    messages.send(hello).await.unwrap();
    let outgoing = tokio_stream::wrappers::ReceiverStream::new(outgoing);
    let mut answers = bench.worlds.edit_stream(with_token(&owner, outgoing)).await.unwrap().into_inner();
    answers.message().await.unwrap().unwrap();
    tokio::time::sleep(Duration::from_millis(1600)).await;
    bench.questions.raycast(with_token(&owner, ray("streamed"))).await.unwrap();
}

#[tokio::test]
async fn two_sessions_do_not_see_each_other() {
    let mut bench = Bench::start().await;
    let here = bench.create_session("here").await.token;
    let there = bench.create_session("there").await.token;
    bench.worlds.edit(with_token(&here, edit("here"))).await.unwrap();
    let hit = bench.questions.raycast(with_token(&here, ray("here"))).await.unwrap().into_inner();
    let miss = bench.questions.raycast(with_token(&there, ray("there"))).await.unwrap().into_inner();
    assert_eq!((hit.verdict(), miss.verdict()), (pb::Verdict::Hit, pb::Verdict::Miss));
}

#[tokio::test]
async fn a_deleted_session_is_gone_and_deleting_it_again_is_no_error() {
    let mut bench = Bench::start().await;
    let owner = bench.create_session("brief").await.token;
    let delete = pb::DeleteSessionRequest { session: "brief".to_owned() };
    let status = bench.sessions.delete_session(delete.clone()).await.unwrap_err();
    assert_eq!(status.code(), Code::Unauthenticated, "{status}");
    bench.sessions.delete_session(with_token(&owner, delete.clone())).await.unwrap();
    let status = bench.questions.raycast(with_token(&owner, ray("brief"))).await.unwrap_err();
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "session", &["\"brief\""]);
    bench.sessions.delete_session(delete).await.unwrap();
}

#[tokio::test]
async fn the_open_session_is_emptied_but_stays() {
    let mut bench = Bench::start().await;
    bench.worlds.edit(edit("")).await.unwrap();
    bench.sessions.delete_session(pb::DeleteSessionRequest::default()).await.unwrap();
    let description = bench.describe().await;
    assert_eq!((description.tick, description.shape_count), (1, 0));
}

#[tokio::test]
async fn waiting_calls_end_with_their_session() {
    let mut bench = Bench::start().await;
    let owner = bench.create_session("brief").await.token;
    let waiting = pb::RaycastRequest {
        options: Some(Box::new(crate::harness::read_at(pb::read_at::At::MinTick(9)))),
        ..ray("brief")
    };
    let (mut questions, token) = (bench.questions.clone(), owner.clone());
    let call = tokio::spawn(async move { questions.raycast(with_token(&token, waiting)).await });
    tokio::time::sleep(Duration::from_millis(50)).await;
    let delete = pb::DeleteSessionRequest { session: "brief".to_owned() };
    bench.sessions.delete_session(with_token(&owner, delete)).await.unwrap();
    let status = call.await.unwrap().unwrap_err();
    assert_refused(&status, Code::NotFound, "SESSION_NOT_FOUND", "", &["has ended"]);
}

#[tokio::test]
async fn there_is_a_most_of_sessions() {
    let mut settings = settings();
    settings.max_sessions = 2;
    let mut bench = Bench::start_with(settings).await;
    bench.create_session("one").await;
    let status = bench.sessions.create_session(pb::CreateSessionRequest::default()).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["2 sessions"]);
}
