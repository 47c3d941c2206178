//! Calls of later versions: each answers UNIMPLEMENTED, and says what it will do and what to use meanwhile.

use tonic::Code;
use wire::v1 as pb;

use crate::harness::{Bench, assert_refused};

macro_rules! refused {
    ($bench:ident, $($client:ident.$call:ident($request:expr) says $name:literal, $meanwhile:literal;)*) => {
        $(
            let status = $bench.$client.$call($request).await.map(|_| ()).unwrap_err();
            assert_refused(&status, Code::Unimplemented, "NOT_YET", "", &[$name, "is not served yet", "meanwhile", $meanwhile]);
        )*
    };
}

#[tokio::test]
async fn calls_of_later_versions_say_what_to_use_meanwhile() {
    let mut bench = Bench::start().await;
    refused! { bench,
        worlds.export_world(pb::ExportWorldRequest::default()) says "ExportWorld", "ListShapes";
        worlds.import_world(tokio_stream::once(pb::ImportWorldRequest::default())) says "ImportWorld", "EditStream";
    }
}
