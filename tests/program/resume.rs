//! A writer behind connections that really break: a proxy cuts them between the client and the server.

use std::net::SocketAddr;
use std::time::Duration;

use calipers::{config::Settings, serve};
use calipers_client::{Client, EditWriter, edit, shape};
use tokio::io::copy_bidirectional;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;

/// Passes bytes on to a server, until the connections are cut.
async fn proxy(server: SocketAddr, cuts: watch::Receiver<u32>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a free port");
    let address = listener.local_addr().expect("a bound address");
    tokio::spawn(async move {
        while let Ok((mut near, _)) = listener.accept().await {
            let mut cuts = cuts.clone();
            cuts.mark_unchanged();
            tokio::spawn(async move {
                let mut far = TcpStream::connect(server).await.expect("the server listens");
                tokio::select! {
                    // Either way both ends are dropped, and so closed.
                    _ = cuts.changed() => {}
                    _ = copy_bidirectional(&mut near, &mut far) => {}
                }
            });
        }
    });
    address
}

#[tokio::test(flavor = "multi_thread")]
async fn cut_connections_lose_no_edit_and_repeat_none() {
    let settings = Settings { listen: "127.0.0.1:0".parse().expect("an address"), ..Settings::default() };
    let running = serve::start(settings).await.expect("the server starts");
    let (cut, cuts) = watch::channel(0);
    let address = proxy(running.local_addr(), cuts).await;
    let client = Client::connect(&address.to_string()).await.expect("the proxy listens");
    let mut writer = EditWriter::open(&client, "arm").await.expect("the stream opens");
    writer.commit([shape::sphere(1, 0.5).insert()]).await.expect("the writer goes on");
    for step in 1..=400 {
        writer.commit([edit::move_to(1, [f64::from(step), 0.0, 0.0])]).await.expect("the writer goes on");
        if step % 50 == 0 {
            // While messages are under way.
            cut.send_modify(|count| *count += 1);
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }
    let tick = writer.flush().await.expect("all of it arrives");
    // The empty world was tick 1; then one tick for each commit: none lost, none applied twice.
    assert_eq!(tick, 402);
    assert!(writer.resumed_count() > 0, "no connection was cut while it mattered");
    assert!(writer.take_report().problems.is_empty());
    let direct = Client::connect(&running.local_addr().to_string()).await.expect("the server listens");
    let at = direct.shape(1).await.expect("it is there").shape.and_then(|shape| shape.pose?.position);
    assert_eq!(at.map(|at| at.x), Some(400.0));
    running.stop().await;
}
