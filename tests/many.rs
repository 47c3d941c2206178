//! One world, used by many: the example's writers and readers, for some seconds of ticks.

#[path = "../examples/many.rs"]
#[expect(dead_code, reason = "an example has a main, which a test does not call")]
mod many;

use calipers::{config::Settings, serve};
use many::Plan;

#[tokio::test(flavor = "multi_thread")]
async fn at_every_tick_readers_see_what_was_written() {
    let settings = Settings { listen: "127.0.0.1:0".parse().expect("an address"), ..Settings::default() };
    let running = serve::start(settings).await.expect("the server starts");
    let plan = Plan { commit_count: 120, rate: 30.0 };
    let seen = many::run(&running.local_addr().to_string(), plan).await.expect("every answer is in step");
    // Session, tick 1; two writers of 120 commits each.
    assert_eq!(seen.last_tick, 241);
    // A reader may miss ticks on a busy machine, but it must have looked often enough for the law to mean something.
    assert!(seen.tick_count > 24, "{seen:?}");
    running.stop().await;
}
