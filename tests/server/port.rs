//! What is served on the one port besides the calls: the page, health, reflection, gRPC-web; that small calls are fast
//! on a real socket, that large messages are refused, and that the server stops.

use std::time::{Duration, Instant};

use prost::Message;
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
    sync::mpsc,
};
use tokio_stream::{StreamExt, wrappers::ReceiverStream};
use tonic::{Code, transport::Channel};
use tonic_health::pb::{HealthCheckRequest, health_check_response::ServingStatus, health_client::HealthClient};
use wire::v1::{self as pb, query_service_client::QueryServiceClient};

use crate::harness::{Bench, assert_refused, at, insert, ray_along_z, settings, shape, sphere};

const SERVICES: [&str; 4] = [
    "calipers.v1.SessionService",
    "calipers.v1.GeometryService",
    "calipers.v1.WorldService",
    "calipers.v1.QueryService",
];

async fn over_a_socket(bench: &Bench) -> Channel {
    let address = format!("http://{}", bench.server.local_addr());
    Channel::from_shared(address).unwrap().connect().await.unwrap()
}

async fn raw(bench: &Bench, request: &[u8]) -> Vec<u8> {
    let mut socket = TcpStream::connect(bench.server.local_addr()).await.unwrap();
    socket.write_all(request).await.unwrap();
    let mut answer = Vec::new();
    socket.read_to_end(&mut answer).await.unwrap();
    answer
}

#[tokio::test]
async fn a_plain_get_is_answered_with_a_line_of_text() {
    let bench = Bench::start().await;
    let request = b"GET / HTTP/1.1\r\nhost: calipers\r\nconnection: close\r\n\r\n";
    let answer = String::from_utf8(raw(&bench, request).await).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    assert!(answer.contains("Calipers 0."), "{answer}");
}

#[tokio::test]
async fn grpc_web_is_answered_on_the_same_port() {
    let mut bench = Bench::start().await;
    bench.edit(vec![insert(shape(1, sphere(1.0), at(0.0, 0.0, 5.0)))]).await.unwrap();
    let message = ray_along_z().encode_to_vec();
    let mut request = format!(
        "POST /calipers.v1.QueryService/Raycast HTTP/1.1\r\nhost: calipers\r\nconnection: close\r\n\
         content-type: application/grpc-web+proto\r\ncontent-length: {}\r\n\r\n",
        message.len() + 5
    )
    .into_bytes();
    request.push(0);
    request.extend(u32::try_from(message.len()).unwrap().to_be_bytes());
    request.extend(&message);
    let answer = raw(&bench, &request).await;
    let text = String::from_utf8_lossy(&answer);
    assert!(text.starts_with("HTTP/1.1 200"), "{text}");
    assert!(text.contains("application/grpc-web+proto"), "{text}");
    assert!(text.contains("grpc-status:0"), "the trailers are in the body: {text}");
}

#[tokio::test]
async fn reflection_lists_the_services_in_both_versions() {
    let bench = Bench::start().await;
    let channel = over_a_socket(&bench).await;
    {
        use tonic_reflection::pb::v1::{
            ServerReflectionRequest, server_reflection_client::ServerReflectionClient,
            server_reflection_request::MessageRequest, server_reflection_response::MessageResponse,
        };
        let request = ServerReflectionRequest {
            host: String::new(),
            message_request: Some(MessageRequest::ListServices(String::new())),
        };
        let mut client = ServerReflectionClient::new(channel.clone());
        let mut answers = client.server_reflection_info(tokio_stream::once(request)).await.unwrap().into_inner();
        let answer = answers.message().await.unwrap().unwrap().message_response;
        let Some(MessageResponse::ListServicesResponse(list)) = answer else {
            panic!("{answer:?}");
        };
        let names: Vec<_> = list.service.into_iter().map(|service| service.name).collect();
        assert!(SERVICES.iter().all(|service| names.iter().any(|name| name == service)), "{names:?}");
    }
    {
        use tonic_reflection::pb::v1alpha::{
            ServerReflectionRequest, server_reflection_client::ServerReflectionClient,
            server_reflection_request::MessageRequest, server_reflection_response::MessageResponse,
        };
        let request = ServerReflectionRequest {
            host: String::new(),
            message_request: Some(MessageRequest::FileContainingSymbol("calipers.v1.RaycastRequest".to_owned())),
        };
        let mut client = ServerReflectionClient::new(channel);
        let mut answers = client.server_reflection_info(tokio_stream::once(request)).await.unwrap().into_inner();
        let answer = answers.message().await.unwrap().unwrap().message_response;
        let Some(MessageResponse::FileDescriptorResponse(files)) = answer else {
            panic!("{answer:?}");
        };
        assert!(!files.file_descriptor_proto.is_empty());
    }
}

#[tokio::test]
async fn health_says_serving_and_then_not_serving() {
    let bench = Bench::start().await;
    let mut client = HealthClient::new(bench.server.connect_in_process());
    for service in SERVICES.into_iter().chain([""]) {
        let request = HealthCheckRequest { service: service.to_owned() };
        let answer = client.check(request).await.unwrap().into_inner();
        assert_eq!(answer.status(), ServingStatus::Serving, "{service}");
    }
    let request = HealthCheckRequest { service: String::new() };
    let mut watch = client.watch(request).await.unwrap().into_inner();
    assert_eq!(watch.message().await.unwrap().unwrap().status(), ServingStatus::Serving);
    let stopping = tokio::spawn(bench.server.stop());
    assert_eq!(watch.message().await.unwrap().unwrap().status(), ServingStatus::NotServing);
    // The watch is still open, and must not hold up the stop.
    let status = watch.message().await.unwrap_err();
    assert_eq!(status.code(), Code::Unavailable, "{status}");
    stopping.await.unwrap();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn small_calls_on_a_real_socket_do_not_wait_for_nagle() {
    let bench = Bench::start().await;
    let mut questions = QueryServiceClient::new(over_a_socket(&bench).await);
    let mut times = Vec::new();
    for _ in 0..200 {
        let begin = Instant::now();
        questions.raycast(ray_along_z()).await.unwrap();
        times.push(begin.elapsed());
    }
    times.sort();
    let median = times[times.len() / 2];
    assert!(median < Duration::from_millis(10), "the median call took {median:?}; Nagle's algorithm costs 40 ms");
}

#[tokio::test]
async fn a_message_over_4_mib_is_refused_as_a_passed_quota() {
    let mut bench = Bench::start().await;
    let request = pb::EditRequest { request_id: "x".repeat(4 * 1024 * 1024 + 1), ..pb::EditRequest::default() };
    let status = bench.worlds.edit(request).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["4 MiB"]);
    let on_a_stream =
        pb::EditStreamRequest { writer: "x".repeat(4 * 1024 * 1024 + 1), ..pb::EditStreamRequest::default() };
    let mut answers = bench.worlds.edit_stream(tokio_stream::once(on_a_stream)).await.unwrap().into_inner();
    let status = answers.message().await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["4 MiB"]);
}

#[tokio::test]
async fn an_answer_over_4_mib_is_refused_with_what_to_do() {
    let mut bench = Bench::start().await;
    let inserts = pb::InsertColumns {
        like: Some(shape(0, sphere(1.0), at(0.0, 0.0, 0.0))),
        ids: (1..=60_000).collect(),
        poses: None,
    };
    let edit = pb::Edit { op: Some(pb::edit::Op::Inserts(inserts)) };
    bench.edit(vec![edit]).await.unwrap();
    let request =
        pb::OverlapRequest { subject: Some(pb::Subject::default()), max_hits: 65_536, ..pb::OverlapRequest::default() };
    let batch = pb::BatchRequest {
        questions: vec![pb::Question { question: Some(pb::question::Question::Overlap(Box::new(request.clone()))) }; 3],
        ..pb::BatchRequest::default()
    };
    let status = bench.questions.batch(batch).await.map(|_| ()).unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["fewer hits", "several batches"]);
    let few = pb::OverlapRequest { max_hits: 10, ..request };
    let answer = bench.questions.overlap(few).await.unwrap().into_inner();
    assert_eq!(answer.hits.iter().map(|hit| hit.id).collect::<Vec<_>>(), (1..=10).collect::<Vec<_>>());
    assert!(answer.truncated);
}

#[tokio::test]
async fn overload_is_refused_quickly_and_passes() {
    let mut settings = settings();
    settings.max_in_flight = 1;
    let bench = Bench::start_with(settings).await;
    // Waits for a tick that never comes, and so holds the only place.
    let waiting = pb::RaycastRequest {
        options: Some(Box::new(crate::harness::read_at(pb::read_at::At::MinTick(9)))),
        ..ray_along_z()
    };
    let mut questions = bench.questions.clone();
    let holder = tokio::spawn(async move { questions.raycast(waiting).await });
    tokio::time::sleep(Duration::from_millis(50)).await;
    let mut questions = bench.questions.clone();
    let begin = Instant::now();
    let status = questions.raycast(ray_along_z()).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "OVERLOADED", "", &["limit of 1"]);
    assert!(begin.elapsed() < Duration::from_millis(500));
    holder.abort();
    let _ = holder.await;
    tokio::time::sleep(Duration::from_millis(50)).await;
    questions.raycast(ray_along_z()).await.unwrap();
}

#[tokio::test]
async fn a_stop_ends_open_streams_and_refuses_new_calls() {
    let mut bench = Bench::start().await;
    let (messages, outgoing) = mpsc::channel(1);
    messages.send(pb::EditStreamRequest::default()).await.unwrap();
    let mut answers = bench.worlds.edit_stream(ReceiverStream::new(outgoing)).await.unwrap().into_inner();
    assert_eq!(answers.message().await.unwrap().unwrap().acked_sequence, 0);
    let address = bench.server.local_addr();
    let begin = Instant::now();
    let stopping = tokio::spawn(bench.server.stop());
    let status = answers.next().await.unwrap().unwrap_err();
    assert_eq!(status.code(), Code::Unavailable, "{status}");
    assert!(status.message().contains("after acked_sequence"), "{status}");
    drop((messages, answers));
    stopping.await.unwrap();
    assert!(begin.elapsed() < Duration::from_secs(5));
    TcpStream::connect(address).await.unwrap_err();
}

#[tokio::test]
async fn a_stop_cuts_off_what_still_runs_at_the_drain_limit() {
    let mut settings = settings();
    settings.drain_limit = Duration::from_millis(100);
    let bench = Bench::start_with(settings).await;
    let waiting = pb::RaycastRequest {
        options: Some(Box::new(crate::harness::read_at(pb::read_at::At::MinTick(9)))),
        ..ray_along_z()
    };
    let mut questions = bench.questions.clone();
    let call = tokio::spawn(async move { questions.raycast(waiting).await });
    tokio::time::sleep(Duration::from_millis(50)).await;
    let begin = Instant::now();
    bench.server.stop().await;
    assert!(begin.elapsed() < Duration::from_secs(2));
    let status = call.await.unwrap().unwrap_err();
    assert_eq!(status.code(), Code::Unavailable, "{status}");
}

#[tokio::test]
async fn listening_beyond_loopback_is_refused_without_insecure() {
    let settings =
        calipers::config::Settings { listen: "0.0.0.0:0".parse().unwrap(), ..calipers::config::Settings::default() };
    let error = calipers::serve::start(settings).await.unwrap_err();
    assert!(error.to_string().contains("--insecure"), "{error}");
}
