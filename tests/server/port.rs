//! What is served on the one port besides the calls: the page, health, reflection, gRPC-web; and that it stops.

use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::TcpStream,
};
use tonic::Code;
use wire::v1 as pb;

use crate::harness::Bench;

#[tokio::test]
async fn a_plain_get_is_answered_with_a_line_of_text() {
    let server = Bench::start().await.server;
    let mut socket = TcpStream::connect(server.local_addr()).await.unwrap();
    socket
        .write_all(b"GET / HTTP/1.1\r\nhost: calipers\r\nconnection: close\r\n\r\n")
        .await
        .unwrap();
    let mut answer = String::new();
    socket.read_to_string(&mut answer).await.unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    assert!(answer.contains("Calipers 0."), "{answer}");
    server.stop().await;
}

#[tokio::test]
async fn a_client_in_the_process_reaches_the_calls() {
    let mut bench = Bench::start().await;
    let status = bench
        .questions
        .resolve(pb::ResolveRequest::default())
        .await
        .unwrap_err();
    assert_eq!(status.code(), Code::Unimplemented);
    assert!(status.message().contains("ask Penetration"), "{status}");
    bench.server.stop().await;
}
