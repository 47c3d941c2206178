//! `ImportWorld`: fills an empty world from an export, all or nothing.
//!
//! # Method
//! The pieces are checked as they come and put together beside the world, with geometries of their own. Only when the last
//! has come, and its hash of the content is that of what was put together, does the world become that, between two edits.
//! Whatever fails before leaves nothing behind.

use std::sync::Arc;

use collision::{
    shape::Geometry,
    world::{Means, Settings as WorldSettings, Shape, Tick, Time, World},
};
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;
use tonic::{Request, Response, Status, Streaming};
use wire::v1::{self as pb, world_piece::Piece};

use super::{
    Caller, Server, WRITER_PATIENCE,
    export_world::{Chain, hex},
};
use crate::{
    building::{Building, Workshop},
    compute::{self, Weight},
    convert::{archive::Intake, number::time, settings::changed, shape::shape},
    gate::the_api_says,
    geometries::{Geometries, Quotas},
    problem::{Checked, Problem, Reason, Under, quoted},
    registry::DEFAULT_SETTINGS,
    session::Session,
    token::Role,
};

/// Takes a world in.
///
/// # Errors
/// What is wrong with it; the world is not empty; a quota.
pub(super) async fn answer(
    server: &Server,
    request: Request<Streaming<pb::ImportWorldRequest>>,
) -> Result<Response<pb::ImportWorldResponse>, Status> {
    let caller = Caller::of(&request);
    let mut messages = request.into_inner();
    let Some(first) = timeout(WRITER_PATIENCE, messages.message())
        .await
        .map_err(|_| torn("no piece came for 30 s"))?
        .map_err(the_api_says)?
    else {
        return Err(torn("no piece came").into());
    };
    let session = server.enter(&caller, &first.session, Role::Writer)?;
    let _lease = session.lease.hold();
    let mut import = Import::begin(Some(Home { session: session.clone(), workshop: server.workshop.clone() }));
    let mut next = Some(first);
    while let Some(message) = next {
        import = compute::run(Weight::Heavy, "importing a world", move || {
            import.take(message.piece.unwrap_or_default())?;
            Ok(import)
        })
        .await?;
        next = tokio::select! {
            biased;
            () = server.drain.cancelled() => {
                return Err(Problem::new(Reason::Stopping, "the server is stopping: import again elsewhere, or later").into());
            }
            () = session.ended.cancelled() => return Err(session.ended_problem().into()),
            message = timeout(WRITER_PATIENCE, messages.message()) => match message {
                Ok(message) => message.map_err(the_api_says)?,
                Err(_) => return Err(torn("no piece came for 30 s").into()),
            },
        };
    }
    let mut writer = session.writer.clone().lock_owned().await;
    let means = writer.world.means();
    let importing = session.clone();
    let response = compute::run(Weight::Heavy, "importing a world", move || {
        let (world, geometries) = import.end(means)?;
        let newest = world.newest();
        importing.import(&mut writer, world, geometries)?;
        Ok(pb::ImportWorldResponse {
            tick: newest.tick().get(),
            shape_count: newest.len() as u64,
            content_hash: hex(newest.content_hash()),
        })
    });
    Ok(Response::new(response.await?))
}

/// Puts an export together outside of any server.
///
/// # Errors
/// What is wrong with it.
pub(crate) fn read_export(pieces: impl Iterator<Item = pb::WorldPiece>) -> Checked<World> {
    let mut import = Import::begin(None);
    for piece in pieces {
        import.take(piece)?;
    }
    Ok(import.end(Means::default())?.0)
}

/// Where an import goes.
struct Home {
    session: Arc<Session>,
    workshop: Arc<Workshop>,
}

/// What has come of an export.
struct Import {
    /// `None` outside of a server.
    home: Option<Home>,
    chain: Chain,
    header: Option<Header>,
    geometries: Geometries,
    intake: Intake,
    shapes: Vec<Shape>,
    /// The content's hash as the export tells it.
    end: Option<String>,
    piece_count: u64,
}

/// What the export says of itself.
struct Header {
    tick: Tick,
    time: Time,
    settings: WorldSettings,
    geometry_count: u64,
    shape_count: u64,
}

impl Import {
    fn begin(home: Option<Home>) -> Self {
        let staging = |home: &Home| home.session.geometries.staging();
        Self {
            geometries: home.as_ref().map_or_else(|| Geometries::new(Quotas::NONE), staging),
            home,
            chain: Chain::new(),
            header: None,
            intake: Intake::default(),
            shapes: Vec::new(),
            end: None,
            piece_count: 0,
        }
    }

    /// Takes the next piece.
    ///
    /// # Errors
    /// It is damaged or in no place of an export; what is wrong in it; a quota.
    fn take(&mut self, piece: pb::WorldPiece) -> Checked<()> {
        let number = self.piece_count;
        self.piece_count += 1;
        self.chain = self.chain.after(&piece);
        if piece.chain != self.chain.text() {
            let what = format!(
                "is {}, and follows from the pieces up to number {number} as {}: a piece was lost, damaged or moved; send the pieces \
                 of ExportWorld as they came",
                quoted(&piece.chain),
                self.chain.text()
            );
            return Err(Problem::at("piece.chain", Reason::ExportDamaged, what));
        }
        match piece.piece {
            Some(Piece::Header(header)) if number == 0 => {
                self.header = Some(self.checked(&header).under("piece.header")?);
                Ok(())
            }
            None => {
                let what = "is absent: it is one of header, geometry, shapes, end, as ExportWorld sends them";
                Err(Problem::at("piece", Reason::Missing, what))
            }
            Some(_) if number == 0 => Err(out_of_place("piece", "comes before the header, which is the first")),
            Some(_) if self.end.is_some() => Err(out_of_place("piece", "comes after the end, which is the last")),
            Some(Piece::Header(_)) => {
                Err(out_of_place("piece.header", "comes a second time: an export is of one world"))
            }
            Some(Piece::Geometry(piece)) if self.shapes.is_empty() => {
                self.intake.take(piece, &self.geometries, &cut(self.home.as_ref())).under("piece")
            }
            Some(Piece::Geometry(_)) => {
                Err(out_of_place("piece.geometry", "comes after shapes: geometries come before"))
            }
            Some(Piece::Shapes(list)) => {
                if self.shapes.is_empty() {
                    self.end_geometries()?;
                }
                self.take_shapes(&list).under("piece.shapes")
            }
            Some(Piece::End(end)) => {
                self.end_geometries()?;
                self.end = Some(end.content_hash);
                Ok(())
            }
        }
    }

    /// What a header says, if the session has room for that.
    fn checked(&self, sent: &pb::WorldHeader) -> Checked<Header> {
        let Some(tick) = Tick::new(sent.tick) else {
            return Err(Problem::at("tick", Reason::OutOfLimits, "is 0: ticks begin at 1, such as {\"tick\": 7}"));
        };
        if let Some(Home { session, .. }) = &self.home {
            session.check_importable(tick)?;
            session.check_shape_count(usize::try_from(sent.shape_count).unwrap_or(usize::MAX))?;
        }
        Ok(Header {
            tick,
            time: sent.time.as_ref().map_or(Ok(Time(0)), |sent| time("time", sent))?,
            settings: changed(DEFAULT_SETTINGS, sent.settings.as_ref()).under("settings")?,
            geometry_count: sent.geometry_count,
            shape_count: sent.shape_count,
        })
    }

    /// Ends the geometries, of which there must be as many as were promised.
    fn end_geometries(&mut self) -> Checked<()> {
        let found = self.intake.end(&self.geometries, &cut(self.home.as_ref())).under("piece")?;
        let promised = self.header.as_ref().map_or(0, |header| header.geometry_count);
        match found == promised {
            true => Ok(()),
            false => {
                Err(damaged("piece", format!("ends the geometries: {found} came, and the header said {promised}")))
            }
        }
    }

    fn take_shapes(&mut self, list: &pb::ShapeList) -> Checked<()> {
        let promised = self.header.as_ref().map_or(0, |header| header.shape_count);
        if (self.shapes.len() + list.shapes.len()) as u64 > promised {
            let count = self.shapes.len() + list.shapes.len();
            return Err(damaged("shapes", format!("bring the shapes to {count}: the header said {promised}")));
        }
        for (index, sent) in list.shapes.iter().enumerate() {
            let made = shape(sent, &self.geometries).under_item("shapes", index)?;
            if self.shapes.last().is_some_and(|last| last.id >= made.id) {
                let what = format!("is {}, which is not above the one before: shapes come by id, each once", made.id);
                return Err(damaged("id", what)).under_item("shapes", index);
            }
            self.shapes.push(made);
        }
        Ok(())
    }

    /// The world that came, and its geometries.
    ///
    /// # Errors
    /// It is not whole, or not what was exported.
    fn end(self, means: Means) -> Checked<(World, Geometries)> {
        let (Some(header), Some(content_hash)) = (self.header, self.end) else {
            let came = format!("{} pieces and {} shapes came, and no end", self.piece_count, self.shapes.len());
            return Err(torn(&came));
        };
        if self.shapes.len() as u64 != header.shape_count {
            let what = format!("{} of {} shapes came before the end", self.shapes.len(), header.shape_count);
            return Err(torn(&what));
        }
        let Header { tick, time, settings, .. } = header;
        let world = World::holding(self.shapes, tick, time, settings, means);
        let found = hex(world.newest().content_hash());
        if found != content_hash {
            let what =
                format!("is {}, and that of what came is {found}: the export is not whole", quoted(&content_hash));
            return Err(damaged("piece.end.content_hash", what));
        }
        Ok((world, self.geometries))
    }
}

/// Makes convex parts as they are made for all others.
fn cut(home: Option<&Home>) -> impl Fn(&Building) -> Checked<Geometry> {
    move |building| match home {
        Some(Home { workshop, .. }) => workshop.made(building).map(|made| Geometry::clone(&made)),
        None => building.cut(&CancellationToken::new()),
    }
}

fn damaged(field: &str, what: String) -> Problem {
    let what = format!("{what}; send the pieces of ExportWorld as they came");
    Problem::at(field, Reason::ExportDamaged, what)
}

fn out_of_place(field: &str, what: &str) -> Problem {
    damaged(field, what.to_owned())
}

fn torn(what: &str) -> Problem {
    let what = format!(
        "the import is incomplete: {what}; send all pieces of ExportWorld, the end included, and nothing is changed yet"
    );
    Problem::new(Reason::UploadIncomplete, what)
}
