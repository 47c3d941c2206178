//! A world goes out and comes in whole, bit by bit, or not at all.

use prost::Message;
use tonic::{Code, Status};
use wire::v1::{self as pb, answer::Answer as Kind, read_at::At, world_piece::Piece};

use crate::{
    explain::questions,
    harness::{Bench, assert_refused, at, geometry, insert, remove, settings, shape, sphere, with_token},
    replays::zoo,
};

async fn export(
    bench: &mut Bench,
    session: &str,
    token: &str,
    read_at: Option<pb::ReadAt>,
) -> Result<Vec<pb::WorldPiece>, Status> {
    let request = pb::ExportWorldRequest { session: session.to_owned(), read_at };
    let request = if token.is_empty() { tonic::Request::new(request) } else { with_token(token, request) };
    let mut stream = bench.worlds.export_world(request).await?.into_inner();
    let mut pieces = Vec::new();
    while let Some(response) = stream.message().await? {
        assert!(response.encoded_len() < 3 << 20, "pieces are bounded");
        pieces.push(response.piece.expect("a piece"));
    }
    Ok(pieces)
}

async fn import(
    bench: &mut Bench,
    session: &str,
    token: &str,
    pieces: &[pb::WorldPiece],
) -> Result<pb::ImportWorldResponse, Status> {
    let name = session.to_owned();
    let messages: Vec<_> = pieces
        .iter()
        .enumerate()
        .map(|(number, piece)| pb::ImportWorldRequest {
            session: if number == 0 { name.clone() } else { String::new() },
            piece: Some(piece.clone()),
        })
        .collect();
    let stream = tokio_stream::iter(messages);
    let request = if token.is_empty() { tonic::Request::new(stream) } else { with_token(token, stream) };
    Ok(bench.worlds.import_world(request).await?.into_inner())
}

/// A session of its own and its owner's token.
async fn session(bench: &mut Bench, id: &str) -> String {
    bench.create_session(id).await.token
}

/// The pieces with chains that hold, as `WorldPiece.chain` says they are made.
fn chained(pieces: Vec<pb::WorldPiece>) -> Vec<pb::WorldPiece> {
    let mut chain = blake3::hash(b"calipers world export 1");
    let link = |piece: pb::WorldPiece| {
        let bare = pb::WorldPiece { chain: String::new(), ..piece };
        chain = blake3::hash(&[chain.as_bytes().as_slice(), &bare.encode_to_vec()].concat());
        pb::WorldPiece { chain: chain.to_hex().to_string(), ..bare }
    };
    pieces.into_iter().map(link).collect()
}

/// All answers to questions in a session, as bytes, but for what they say of themselves.
async fn answers(bench: &mut Bench, session: &str, token: &str) -> Vec<Vec<u8>> {
    let questions = questions().into_iter().map(|asked| pb::Question { question: Some(asked) }).collect();
    let request = pb::BatchRequest { session: session.to_owned(), questions, ..pb::BatchRequest::default() };
    let request = if token.is_empty() { tonic::Request::new(request) } else { with_token(token, request) };
    let answers = bench.questions.batch(request).await.unwrap().into_inner().answers;
    assert!(answers.iter().all(|answer| !matches!(answer.answer, Some(Kind::Problem(_)))), "{answers:?}");
    answers.into_iter().map(|answer| answer.encode_to_vec()).collect()
}

async fn describe(bench: &mut Bench, session: &str, token: &str) -> pb::DescribeWorldResponse {
    let request = pb::DescribeWorldRequest { session: session.to_owned() };
    let request = if token.is_empty() { tonic::Request::new(request) } else { with_token(token, request) };
    bench.worlds.describe_world(request).await.unwrap().into_inner()
}

async fn geometry_ids(bench: &mut Bench, session: &str, token: &str) -> Vec<String> {
    let request = pb::ListGeometriesRequest { session: session.to_owned(), ..pb::ListGeometriesRequest::default() };
    let request = if token.is_empty() { tonic::Request::new(request) } else { with_token(token, request) };
    let found = bench.geometries.list_geometries(request).await.unwrap().into_inner().geometries;
    found.into_iter().map(|info| info.geometry_id).collect()
}

#[tokio::test]
async fn what_comes_in_is_what_went_out() {
    let mut bench = zoo().await;
    let update = pb::WorldSettings { history_ticks: Some(5), margin: Some(0.25) };
    let update = pb::UpdateWorldRequest { settings: Some(update), ..pb::UpdateWorldRequest::default() };
    bench.worlds.update_world(update).await.unwrap();
    bench.edit(vec![remove(&[100])]).await.unwrap();
    let pieces = export(&mut bench, "", "", None).await.unwrap();
    assert_eq!(chained(pieces.clone()), pieces, "chains are made as the contract says");
    let Some(Piece::End(end)) = &pieces.last().unwrap().piece else { panic!("{pieces:?}") };
    let Some(Piece::Header(header)) = &pieces[0].piece else { panic!("{pieces:?}") };
    assert_eq!((header.tick, header.shape_count), (3, 27));

    let token = session(&mut bench, "copy").await;
    let response = import(&mut bench, "copy", &token, &pieces).await.unwrap();
    assert_eq!((response.tick, response.shape_count), (3, 27));
    assert_eq!(response.content_hash, end.content_hash);
    assert_eq!(answers(&mut bench, "copy", &token).await, answers(&mut bench, "", "").await);
    assert_eq!(export(&mut bench, "copy", &token, None).await.unwrap(), pieces, "time and settings come along");
    let described = describe(&mut bench, "copy", &token).await;
    assert_eq!((described.tick, described.oldest_tick, described.shape_count), (3, 3, 27));
    assert_eq!(described.settings.unwrap().margin, Some(0.25));
    // All that shapes and compounds name by an id is registered, and can be named.
    let named = geometry_ids(&mut bench, "copy", &token).await;
    assert_eq!(named.len() as u64, header.geometry_count);

    // A fork is the same world.
    let fork = pb::ForkSessionRequest { fork: "fork".to_owned(), ..pb::ForkSessionRequest::default() };
    let fork = bench.sessions.fork_session(fork).await.unwrap().into_inner().token;
    assert_eq!(export(&mut bench, "fork", &fork, None).await.unwrap(), pieces);

    // The world goes on from there.
    let edit =
        pb::EditRequest { session: "copy".to_owned(), edits: vec![remove(&[101])], ..pb::EditRequest::default() };
    assert_eq!(bench.worlds.edit(with_token(&token, edit)).await.unwrap().into_inner().tick, 4);
    let status = import(&mut bench, "copy", &token, &pieces).await.unwrap_err();
    assert_refused(&status, Code::FailedPrecondition, "WORLD_NOT_EMPTY", "", &["26 shapes", "CreateSession", "clear"]);
    // Empty again, but later than the export: its tick would go back.
    let edits = vec![pb::Edit { op: Some(pb::edit::Op::Clear(pb::Clear {})) }];
    let edit = pb::EditRequest { session: "copy".to_owned(), edits, ..pb::EditRequest::default() };
    bench.worlds.edit(with_token(&token, edit)).await.unwrap();
    let status = import(&mut bench, "copy", &token, &pieces).await.unwrap_err();
    assert_refused(&status, Code::FailedPrecondition, "WORLD_NOT_EMPTY", "", &["ticks never go back", "CreateSession"]);
}

#[tokio::test]
async fn a_past_tick_goes_out_and_a_moment_between_two_does_not() {
    let mut bench = zoo().await;
    let then = answers(&mut bench, "", "").await;
    bench.edit(vec![remove(&[1, 2, 3])]).await.unwrap();
    assert_ne!(answers(&mut bench, "", "").await, then, "vacuous");
    let read_at = |fraction| Some(pb::ReadAt { at: Some(At::Tick(2)), tick_fraction: fraction });
    let pieces = export(&mut bench, "", "", read_at(0.0)).await.unwrap();
    let token = session(&mut bench, "then").await;
    assert_eq!(import(&mut bench, "then", &token, &pieces).await.unwrap().tick, 2);
    assert_eq!(answers(&mut bench, "then", &token).await, then);
    let status = export(&mut bench, "", "", read_at(0.5)).await.unwrap_err();
    let field = "read_at.tick_fraction";
    assert_refused(&status, Code::InvalidArgument, "OUT_OF_LIMITS", field, &["such as {\"tick\": 7}"]);
}

/// Pieces that are torn, lost, doubled, swapped or damaged anywhere are refused, and nothing of them stays.
#[tokio::test]
async fn what_is_not_whole_is_refused_and_leaves_nothing() {
    let mut bench = zoo().await;
    let pieces = export(&mut bench, "", "", None).await.unwrap();
    assert!(pieces.len() > 12, "vacuous: {}", pieces.len());
    let token = session(&mut bench, "copy").await;
    let mut wrong: Vec<(&str, Vec<pb::WorldPiece>)> = Vec::new();
    for number in 0..pieces.len() {
        wrong.push(("UPLOAD_INCOMPLETE", pieces[..number].to_vec()));
        let mut lost = pieces.clone();
        lost.remove(number);
        wrong.push((if number + 1 < pieces.len() { "EXPORT_DAMAGED" } else { "UPLOAD_INCOMPLETE" }, lost));
        let mut doubled = pieces.clone();
        doubled.insert(number, pieces[number].clone());
        wrong.push(("EXPORT_DAMAGED", doubled));
        if number + 1 < pieces.len() {
            let mut swapped = pieces.clone();
            swapped.swap(number, number + 1);
            wrong.push(("EXPORT_DAMAGED", swapped));
        }
        // A bit here and there that leaves whole messages.
        let bytes = pieces[number].encode_to_vec();
        for place in (3..bytes.len()).step_by(1 + bytes.len() / 7) {
            let mut flipped = bytes.clone();
            flipped[place] ^= 4;
            let Ok(piece) = pb::WorldPiece::decode(flipped.as_slice()) else { continue };
            if piece != pieces[number] {
                let mut damaged = pieces.clone();
                damaged[number] = piece;
                wrong.push(("EXPORT_DAMAGED", damaged));
            }
        }
    }
    assert!(wrong.len() > 80, "vacuous: {}", wrong.len());
    for (reason, pieces) in wrong {
        let status = import(&mut bench, "copy", &token, &pieces).await.unwrap_err();
        let code = if reason == "EXPORT_DAMAGED" { Code::DataLoss } else { Code::FailedPrecondition };
        assert_refused(&status, code, reason, "", &["ExportWorld"]);
    }
    let described = describe(&mut bench, "copy", &token).await;
    assert_eq!((described.tick, described.shape_count), (1, 0));
    assert!(geometry_ids(&mut bench, "copy", &token).await.is_empty());
    import(&mut bench, "copy", &token, &pieces).await.unwrap();
}

/// Who makes the chain anew is told by what is wrong with the world itself.
#[tokio::test]
async fn a_chain_that_holds_is_not_enough() {
    let mut bench = zoo().await;
    let pieces = export(&mut bench, "", "", None).await.unwrap();
    let token = session(&mut bench, "copy").await;
    let shapes_at = pieces.iter().position(|piece| matches!(piece.piece, Some(Piece::Shapes(_)))).unwrap();
    let changed = |change: &dyn Fn(&mut Vec<pb::WorldPiece>)| {
        let mut changed = pieces.clone();
        change(&mut changed);
        chained(changed)
    };
    let with_shapes = |change: &dyn Fn(&mut Vec<pb::Shape>)| {
        changed(&|pieces| match &mut pieces[shapes_at].piece {
            Some(Piece::Shapes(list)) => change(&mut list.shapes),
            _ => panic!("shapes"),
        })
    };
    let wrong: Vec<(Vec<pb::WorldPiece>, Code, &str, &str)> = vec![
        (
            with_shapes(&|shapes| shapes[0].pose = Some(at(9.0, 0.0, 0.0))),
            Code::DataLoss,
            "EXPORT_DAMAGED",
            "piece.end.content_hash",
        ),
        (with_shapes(&|shapes| shapes.swap(0, 1)), Code::DataLoss, "EXPORT_DAMAGED", "piece.shapes.shapes[1].id"),
        (
            with_shapes(&|shapes| shapes.push(shapes[3].clone())),
            Code::DataLoss,
            "EXPORT_DAMAGED",
            "piece.shapes.shapes",
        ),
        (with_shapes(&|shapes| shapes.truncate(3)), Code::FailedPrecondition, "UPLOAD_INCOMPLETE", ""),
        (with_shapes(&|shapes| shapes[2].id = 0), Code::InvalidArgument, "OUT_OF_LIMITS", "piece.shapes.shapes[2].id"),
        (changed(&|pieces| pieces.swap(0, 1)), Code::DataLoss, "EXPORT_DAMAGED", "piece"),
        (
            changed(&|pieces| drop(pieces.remove(shapes_at - 1))),
            Code::FailedPrecondition,
            "UPLOAD_INCOMPLETE",
            "piece.geometry",
        ),
        (changed(&|pieces| pieces.insert(1, pieces[0].clone())), Code::DataLoss, "EXPORT_DAMAGED", "piece.header"),
        (changed(&|pieces| pieces.push(pieces[1].clone())), Code::DataLoss, "EXPORT_DAMAGED", "piece"),
        (
            changed(&|pieces| pieces.insert(shapes_at + 1, pieces[1].clone())),
            Code::DataLoss,
            "EXPORT_DAMAGED",
            "piece.geometry",
        ),
        (changed(&|pieces| pieces[0].piece = None), Code::InvalidArgument, "MISSING", "piece"),
    ];
    for (pieces, code, reason, field) in wrong {
        let status = import(&mut bench, "copy", &token, &pieces).await.unwrap_err();
        assert_refused(&status, code, reason, field, &[]);
    }
    assert_eq!(describe(&mut bench, "copy", &token).await.shape_count, 0);
    assert!(geometry_ids(&mut bench, "copy", &token).await.is_empty());
}

#[tokio::test]
async fn quotas_and_roles_hold() {
    let mut bench = zoo().await;
    let pieces = export(&mut bench, "", "", None).await.unwrap();
    let mut small = Bench::start_with(calipers::config::Settings { session_shapes: 20, ..settings() }).await;
    let status = import(&mut small, "", "", &pieces).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["28 shapes", "may hold 20"]);
    let mut poor = Bench::start_with(calipers::config::Settings { session_memory_bytes: 12_000, ..settings() }).await;
    let status = import(&mut poor, "", "", &pieces).await.unwrap_err();
    assert_refused(&status, Code::ResourceExhausted, "QUOTA_EXCEEDED", "", &["session_memory_bytes"]);
    for bench in [&mut small, &mut poor] {
        assert_eq!(describe(bench, "", "").await.shape_count, 0);
        assert!(geometry_ids(bench, "", "").await.is_empty());
    }
    let owner = session(&mut bench, "arena").await;
    let request = pb::CreateTokenRequest { session: "arena".to_owned(), role: pb::Role::Reader.into() };
    let reader = bench.sessions.create_token(with_token(&owner, request)).await.unwrap().into_inner().token;
    assert_eq!(
        export(&mut bench, "arena", &reader, None).await.unwrap().len(),
        2,
        "an empty world is a header and an end"
    );
    let status = import(&mut bench, "arena", &reader, &pieces).await.unwrap_err();
    assert_refused(&status, Code::PermissionDenied, "ROLE_TOO_LOW", "", &[]);
}

/// Whoever watches the world sees it come.
#[tokio::test]
async fn those_who_watch_see_it_come() {
    let mut bench = zoo().await;
    let pieces = export(&mut bench, "", "", None).await.unwrap();
    let mut other = Bench::start().await;
    let mut viewer = other.worlds.watch_world(pb::WatchWorldRequest::default()).await.unwrap().into_inner();
    assert!(viewer.message().await.unwrap().unwrap().snapshot);
    let region = pb::Region { id: 1, geometry: Some(sphere(9.0)), ..pb::Region::default() };
    let request = pb::WatchOverlapsRequest { regions: vec![region], ..pb::WatchOverlapsRequest::default() };
    let mut watcher = other.worlds.watch_overlaps(request).await.unwrap().into_inner();
    assert!(watcher.message().await.unwrap().unwrap().snapshot);
    import(&mut other, "", "", &pieces).await.unwrap();
    let mut inserted = 0;
    while inserted < 28 {
        inserted += viewer.message().await.unwrap().unwrap().inserted.len();
    }
    loop {
        let message = watcher.message().await.unwrap().unwrap();
        let entered = message.entered.unwrap_or_default();
        if !entered.b.is_empty() {
            assert_eq!(entered.b.len(), 8, "{entered:?}");
            break;
        }
    }
}

#[tokio::test]
async fn a_hundred_thousand_shapes_go_out_and_come_in() {
    let mut bench = Bench::start().await;
    let hull = geometry(pb::geometry::Kind::Hull(pb::ConvexHull {
        points: vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
    }));
    for batch in 0..2_u64 {
        let ids: Vec<u64> = (1..=50_000).map(|number| batch * 50_000 + number).collect();
        let positions = ids.iter().flat_map(|&id| [(id % 317) as f32, (id / 317) as f32, batch as f32]).collect();
        let inserts = pb::InsertColumns {
            like: Some(shape(0, hull.clone(), at(0.0, 0.0, 0.0))),
            ids,
            poses: Some(pb::PoseColumns { positions, ..pb::PoseColumns::default() }),
        };
        bench.edit(vec![pb::Edit { op: Some(pb::edit::Op::Inserts(inserts)) }]).await.unwrap();
    }
    let pieces = export(&mut bench, "", "", None).await.unwrap();
    let token = session(&mut bench, "copy").await;
    let response = import(&mut bench, "copy", &token, &pieces).await.unwrap();
    assert_eq!((response.tick, response.shape_count), (3, 100_000));
    let Some(Piece::End(end)) = &pieces.last().unwrap().piece else { panic!("an end") };
    assert_eq!(response.content_hash, end.content_hash);
    assert_eq!(pieces.len(), 2 + 2 + 100, "a header and an end, a hull, and a thousand shapes each");
    let one = insert(shape(7, sphere(1.0), at(0.0, 0.0, 0.0)));
    let edit = pb::EditRequest { session: "copy".to_owned(), edits: vec![one], ..pb::EditRequest::default() };
    bench.worlds.edit(with_token(&token, edit)).await.unwrap();
}
