//! Tokens: what each role may do, and what only the operator may.

use tonic::Code;
use wire::v1 as pb;

use crate::harness::{Bench, assert_refused, edit, get, ray, settings, with_token};

async fn token(bench: &mut Bench, own: &str, session: &str, role: pb::Role) -> Result<String, tonic::Status> {
    let request = pb::CreateTokenRequest { session: session.to_owned(), role: role.into() };
    let made = bench.sessions.create_token(with_token(own, request)).await?;
    Ok(made.into_inner().token)
}

#[tokio::test]
async fn each_role_may_do_its_part_and_no_more() {
    let mut bench = Bench::start().await;
    let owner = bench.create_session("arena").await.token;
    let writer = token(&mut bench, &owner, "arena", pb::Role::Writer).await.unwrap();
    let reader = token(&mut bench, &writer, "arena", pb::Role::Reader).await.unwrap();

    let status = bench.questions.raycast(ray("arena")).await.unwrap_err();
    assert_refused(&status, Code::Unauthenticated, "NO_TOKEN", "", &["authorization: Bearer"]);
    let status = bench.questions.raycast(with_token("guess", ray("arena"))).await.unwrap_err();
    assert_refused(&status, Code::Unauthenticated, "NO_TOKEN", "", &["not one of session"]);

    for token in [&reader, &writer, &owner] {
        bench.questions.raycast(with_token(token, ray("arena"))).await.unwrap();
    }
    let status = bench.worlds.edit(with_token(&reader, edit("arena"))).await.unwrap_err();
    assert_refused(&status, Code::PermissionDenied, "ROLE_TOO_LOW", "", &["reader", "writer"]);
    bench.worlds.edit(with_token(&writer, edit("arena"))).await.unwrap();
    let status = bench.sessions.get_session(with_token(&writer, get("arena"))).await.unwrap_err();
    assert_refused(&status, Code::PermissionDenied, "ROLE_TOO_LOW", "", &["owner"]);
    bench.sessions.get_session(with_token(&owner, get("arena"))).await.unwrap();

    let status = token(&mut bench, &reader, "arena", pb::Role::Writer).await.unwrap_err();
    assert_refused(&status, Code::PermissionDenied, "ROLE_TOO_LOW", "role", &["or less"]);
    let same = token(&mut bench, &reader, "arena", pb::Role::Unspecified).await.unwrap();
    let status = bench.worlds.edit(with_token(&same, edit("arena"))).await.unwrap_err();
    assert_eq!(status.code(), Code::PermissionDenied, "an unspecified role is the caller's own");

    bench.create_session("other").await;
    let status = bench.questions.raycast(with_token(&owner, ray("other"))).await.unwrap_err();
    assert_eq!(status.code(), Code::Unauthenticated, "a token is one session's");
}

#[tokio::test]
async fn only_the_operator_lists_sessions_page_by_page() {
    let mut settings = settings();
    settings.operator_token = Some("operator's own".to_owned());
    let mut bench = Bench::start_with(settings).await;
    for id in ["a", "b", "c"] {
        bench.create_session(id).await;
    }
    let status = bench.sessions.list_sessions(pb::ListSessionsRequest::default()).await.unwrap_err();
    assert_eq!(status.code(), Code::Unauthenticated, "{status}");
    let wrong = with_token("guess", pb::ListSessionsRequest::default());
    let status = bench.sessions.list_sessions(wrong).await.unwrap_err();
    assert_eq!(status.code(), Code::PermissionDenied, "{status}");
    let mut ids = Vec::new();
    let mut request = pb::ListSessionsRequest { page_size: 3, page_token: String::new() };
    loop {
        let page = bench.sessions.list_sessions(with_token("operator's own", request.clone())).await;
        let page = page.unwrap().into_inner();
        ids.extend(page.sessions.into_iter().map(|session| session.session));
        request.page_token = page.next_page_token;
        if request.page_token.is_empty() {
            break;
        }
    }
    assert_eq!(ids, ["a", "b", "c", "default"]);
    let mut without = Bench::start().await;
    let request = with_token("any", pb::ListSessionsRequest::default());
    let status = without.sessions.list_sessions(request).await.unwrap_err();
    assert_refused(&status, Code::PermissionDenied, "ROLE_TOO_LOW", "", &["operator_token"]);
}

/// Asks each call with a token, and gives the least role that was not refused for its role.
macro_rules! least_roles {
    ($bench:ident, $tokens:ident, $($client:ident.$call:ident($request:expr) needs $role:ident;)*) => {
        $(
            let without = $bench.$client.$call($request).await.map(|_| ()).unwrap_err();
            assert_eq!(without.code(), Code::Unauthenticated, "{} without a token: {without}", stringify!($call));
            for (role, token) in &$tokens {
                let answer = $bench.$client.$call(with_token(token, $request)).await.map(|_| ());
                let refused = answer.is_err_and(|status| status.code() == Code::PermissionDenied);
                let too_low = (*role as i32) < (pb::Role::$role as i32);
                assert_eq!(refused, too_low, "{} as {role:?}", stringify!($call));
            }
        )*
    };
}

#[tokio::test]
async fn every_call_of_a_session_needs_its_token_and_its_role() {
    let mut bench = Bench::start().await;
    let owner = bench.create_session("arena").await.token;
    let mut tokens = Vec::new();
    for role in [pb::Role::Reader, pb::Role::Writer, pb::Role::Owner] {
        tokens.push((role, token(&mut bench, &owner, "arena", role).await.unwrap()));
    }
    let session = || "arena".to_owned();
    least_roles! { bench, tokens,
        sessions.get_session(get("arena")) needs Owner;
        sessions.renew_session(pb::RenewSessionRequest { session: session(), ..Default::default() }) needs Owner;
        sessions.create_token(pb::CreateTokenRequest { session: session(), ..Default::default() }) needs Reader;
        geometries.create_geometry(pb::CreateGeometryRequest { session: session(), ..Default::default() }) needs Writer;
        geometries.get_geometry(pb::GetGeometryRequest { session: session(), ..Default::default() }) needs Reader;
        geometries.list_geometries(pb::ListGeometriesRequest { session: session(), ..Default::default() }) needs Reader;
        geometries.delete_geometry(pb::DeleteGeometryRequest { session: session(), ..Default::default() }) needs Writer;
        worlds.edit(edit("arena")) needs Writer;
        worlds.get_shape(pb::GetShapeRequest { session: session(), ..Default::default() }) needs Reader;
        worlds.list_shapes(pb::ListShapesRequest { session: session(), ..Default::default() }) needs Reader;
        worlds.describe_world(pb::DescribeWorldRequest { session: session() }) needs Reader;
        questions.raycast(ray("arena")) needs Reader;
        questions.overlap(pb::OverlapRequest { session: session(), ..Default::default() }) needs Reader;
        questions.penetration(pb::PenetrationRequest { session: session(), ..Default::default() }) needs Reader;
        questions.time_of_impact(pb::TimeOfImpactRequest { session: session(), ..Default::default() }) needs Reader;
        questions.distance(pb::DistanceRequest { session: session(), ..Default::default() }) needs Reader;
        questions.batch(pb::BatchRequest { session: session(), ..Default::default() }) needs Reader;
        sessions.delete_session(pb::DeleteSessionRequest { session: session() }) needs Owner;
    }
    // A stream says so in the stream.
    let reader = bench.create_session("other").await.token;
    let reader = token(&mut bench, &reader, "other", pb::Role::Reader).await.unwrap();
    let hello = pb::EditStreamRequest { session: "other".to_owned(), ..pb::EditStreamRequest::default() };
    let stream = bench.worlds.edit_stream(with_token(&reader, tokio_stream::once(hello))).await;
    let status = stream.unwrap().into_inner().message().await.unwrap_err();
    assert_refused(&status, Code::PermissionDenied, "ROLE_TOO_LOW", "", &["reader", "writer"]);
}
