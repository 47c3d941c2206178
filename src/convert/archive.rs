//! Geometries as they are kept outside of a server: each once, whole and exact, and before what is made of it.
//!
//! # Method
//! A geometry is a header and its numbers, as in an upload. Two things differ, so that what comes back is the same geometry
//! bit by bit and has the same id: a compound names its parts by their ids, which come before it, and numbers that single
//! precision does not hold, as those of a form that was scaled, come in double.

use std::{collections::HashSet, ops::Range, sync::Arc};

use collision::{
    DVec3,
    shape::{Asking, Compound, Convex, Core, Form, Geometry, GeometryId, MeshMode, Part},
    world::{Snapshot, Time, World},
};
use tokio_util::sync::CancellationToken;
use wire::v1::{self as pb, geometry::Kind, geometry_piece::Piece};

use super::{
    geometry::{dressed, geometry_out, made, mode_of},
    lists::{Lists, header_out},
    parts::{ToRegister, to_register},
    place::pose_out,
};
use crate::{
    building::Building,
    geometries::Geometries,
    problem::{Checked, Problem, Reason, Under},
};

/// Numbers of a piece: 1 MiB in double precision.
const NUMBERS: usize = 1 << 17;
/// Most values of a geometry: three coordinates for each corner of the largest mesh.
pub(crate) const VALUES: u64 = 36_000_000;
/// Most indices of a geometry: three for each triangle of the largest mesh.
pub(crate) const INDICES: u64 = 12_000_000;
/// Room that is made before the numbers are there; what is only promised takes none.
const ROOM: usize = 1 << 18;

/// All that shapes name by an id of these geometries and of what they are made of, each once and before what is made of it.
pub(crate) fn named_by_id<'a>(geometries: impl IntoIterator<Item = &'a Arc<Geometry>>) -> Vec<Arc<Geometry>> {
    let (mut known, mut found) = (HashSet::new(), Vec::new());
    geometries.into_iter().for_each(|geometry| add(geometry, &mut known, &mut found));
    found
}

/// Goes no deeper than compounds are nested.
fn add(geometry: &Arc<Geometry>, known: &mut HashSet<GeometryId>, found: &mut Vec<Arc<Geometry>>) {
    if !matches!(geometry_out(geometry).kind, Some(Kind::GeometryId(_))) || !known.insert(geometry.id()) {
        return;
    }
    if let Form::Compound(compound) = geometry.form() {
        compound.parts().iter().for_each(|part| add(&part.geometry, known, found));
    }
    found.push(geometry.clone());
}

/// The pieces of a geometry: its header, then all values, then all indices.
pub(crate) fn pieces(geometry: &Arc<Geometry>) -> impl Iterator<Item = pb::GeometryPiece> + use<> {
    let lists = Lists::of(geometry);
    let is_single = lists.is_single(geometry);
    let header = match geometry.form() {
        Form::Compound(compound) => {
            pb::GeometryHeader { geometry: Some(compound_out(compound)), ..pb::GeometryHeader::default() }
        }
        Form::Convex(_) | Form::Mesh(_) | Form::HeightField(_) | Form::HalfSpace(_) => header_out(geometry, lists),
    };
    let values = steps(lists.value_count).map({
        let geometry = geometry.clone();
        move |range| match is_single {
            true => Piece::Chunk(pb::GeometryChunk { values: lists.values(&geometry, range), indices: Vec::new() }),
            false => Piece::Exact(pb::ExactValues { values: lists.exact_values(&geometry, range) }),
        }
    });
    let geometry = geometry.clone();
    let indices = steps(lists.index_count).map(move |range| {
        Piece::Chunk(pb::GeometryChunk { values: Vec::new(), indices: lists.indices(&geometry, range) })
    });
    let all = std::iter::once(Piece::Header(header)).chain(values).chain(indices);
    all.map(|piece| pb::GeometryPiece { piece: Some(piece) })
}

/// Bytes that the pieces of a geometry have at least.
pub(crate) fn least_bytes(geometry: &Geometry) -> u64 {
    let Lists { value_count, index_count } = Lists::of(geometry);
    4 * (value_count + index_count) as u64
}

fn steps(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count).step_by(NUMBERS).map(move |begin| begin..count.min(begin + NUMBERS))
}

fn compound_out(compound: &Compound) -> pb::Geometry {
    let part = |part: &Part| pb::CompoundPart {
        geometry: Some(geometry_out(&part.geometry)),
        pose: Some(pose_out(&part.pose)),
    };
    let parts = compound.parts().iter().map(part).collect();
    pb::Geometry { kind: Some(Kind::Compound(pb::Compound { parts })), ..pb::Geometry::default() }
}

/// Makes the convex parts of a mesh.
pub(crate) type Cut<'a> = &'a dyn Fn(&Building) -> Checked<Geometry>;

/// Takes geometries in, piece by piece, one after the other.
#[derive(Debug, Default)]
pub(crate) struct Intake {
    arriving: Option<Arriving>,
    count: u64,
}

impl Intake {
    /// Takes a piece. What is whole with it is registered in `known`.
    ///
    /// # Errors
    /// It has no place here; what is wrong with the geometry that it ends or goes on with; the quota.
    pub(crate) fn take(&mut self, piece: pb::GeometryPiece, known: &Geometries, cut: Cut<'_>) -> Checked<()> {
        match (piece.piece, &mut self.arriving) {
            (Some(Piece::Header(header)), _) => {
                self.end(known, cut)?;
                let arriving = Arriving::begin(header)?;
                drop(known.hold_room(arriving.promised_bytes(), &nothing())?);
                self.arriving = Some(arriving);
                Ok(())
            }
            (Some(Piece::Chunk(chunk)), Some(arriving)) => arriving.take(&chunk),
            (Some(Piece::Exact(exact)), Some(arriving)) => arriving.take_exact(&exact),
            (Some(Piece::Chunk(_) | Piece::Exact(_)), None) => {
                let what = "has numbers before its header, such as {\"header\": {\"geometry\": {\"mesh\": {}}, \"value_count\": 9}}";
                Err(Problem::at("geometry", Reason::Missing, what))
            }
            (None, _) => {
                let what =
                    "is absent: it is a header, a chunk or exact values, such as {\"chunk\": {\"values\": [0, 0, 0]}}";
                Err(Problem::at("geometry", Reason::Missing, what))
            }
        }
    }

    /// Ends the last geometry; how many there were.
    ///
    /// # Errors
    /// What is wrong with it; the quota.
    pub(crate) fn end(&mut self, known: &Geometries, cut: Cut<'_>) -> Checked<u64> {
        if let Some(arriving) = self.arriving.take() {
            let geometry = match arriving.end(known)? {
                ToRegister::Whole(geometry) => geometry,
                ToRegister::ToCut(mesh, options) => {
                    let ended = CancellationToken::new();
                    cut(&Building::new(mesh, options, Asking::default(), &ended))?
                }
            };
            known.register(geometry, &nothing())?;
            self.count += 1;
        }
        Ok(self.count)
    }
}

/// No shapes count in what is known yet.
fn nothing() -> Arc<Snapshot> {
    World::new(Time(0)).newest()
}

/// A geometry whose numbers come.
#[derive(Debug)]
struct Arriving {
    form: pb::Geometry,
    value_count: u64,
    index_count: u64,
    values: Vec<f64>,
    indices: Vec<u32>,
}

/// Checks how many numbers a header promises.
///
/// # Errors
/// More than a geometry may have.
pub(crate) fn within(field: &str, count: u64, most: u64) -> Checked<()> {
    if count <= most {
        return Ok(());
    }
    let what = format!("is {count}: at most {most} are allowed, so make several geometries of it");
    Err(Problem::at(field, Reason::TooManyItems, what))
}

/// Numbers that room is made for at once, of so many that a header promises.
pub(crate) fn room(count: u64) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX).min(ROOM)
}

impl Arriving {
    /// With what its header says.
    ///
    /// # Errors
    /// It promises more than a geometry may have.
    fn begin(header: pb::GeometryHeader) -> Checked<Self> {
        within("header.value_count", header.value_count, VALUES)?;
        within("header.index_count", header.index_count, INDICES)?;
        Ok(Self {
            values: Vec::with_capacity(room(header.value_count)),
            indices: Vec::with_capacity(room(header.index_count)),
            form: header.geometry.unwrap_or_default(),
            value_count: header.value_count,
            index_count: header.index_count,
        })
    }

    /// Bytes of the numbers that are to come.
    fn promised_bytes(&self) -> u64 {
        8 * self.value_count + 4 * self.index_count
    }

    /// Takes numbers in.
    ///
    /// # Errors
    /// More than were promised.
    fn take(&mut self, chunk: &pb::GeometryChunk) -> Checked<()> {
        self.values.extend(chunk.values.iter().copied().map(f64::from));
        self.indices.extend_from_slice(&chunk.indices);
        self.check_promise()
    }

    /// The same of exact ones.
    ///
    /// # Errors
    /// More than were promised.
    fn take_exact(&mut self, exact: &pb::ExactValues) -> Checked<()> {
        self.values.extend_from_slice(&exact.values);
        self.check_promise()
    }

    fn check_promise(&self) -> Checked<()> {
        let (values, indices) = (self.values.len() as u64, self.indices.len() as u64);
        if values <= self.value_count && indices <= self.index_count {
            return Ok(());
        }
        let what = format!(
            "brings the numbers to {values} values and {indices} indices: the header said {} and {}, so send as many",
            self.value_count, self.index_count
        );
        Err(Problem::at("geometry", Reason::TooManyItems, what))
    }

    /// The geometry, whole; `known` holds those that it is made of.
    ///
    /// # Errors
    /// Numbers are missing; what is wrong with it.
    fn end(self, known: &Geometries) -> Checked<ToRegister> {
        let Self { mut form, value_count, index_count, values, indices } = self;
        let found = (values.len() as u64, indices.len() as u64);
        if found != (value_count, index_count) {
            let what = format!(
                "is incomplete: {} of {value_count} values and {} of {index_count} indices came before the next, so send all",
                found.0, found.1
            );
            return Err(Problem::at("geometry", Reason::UploadIncomplete, what));
        }
        let made = match &mut form.kind {
            Some(Kind::Hull(_)) => {
                let hull = made("hull", Geometry::hull(&points(&values)?));
                hull.and_then(|hull| dressed(hull, &form)).map(ToRegister::Whole)
            }
            Some(Kind::Mesh(sent)) => mesh(mode_of(sent).under("mesh")?, &points(&values)?, &indices, sent, known),
            Some(Kind::HeightField(field)) => {
                field.heights = values.iter().map(|&value| value as f32).collect();
                field.holes = indices;
                to_register(&form, known)
            }
            Some(_) | None => to_register(&form, known),
        };
        made.under("geometry")
    }
}

fn mesh(
    mode: MeshMode,
    points: &[DVec3],
    indices: &[u32],
    sent: &pb::TriangleMesh,
    known: &Geometries,
) -> Checked<ToRegister> {
    let (triangles, rest) = indices.as_chunks::<3>();
    if !rest.is_empty() {
        let what = format!("has {} numbers: it must have three for each triangle, such as 0, 1, 2", indices.len());
        return Err(Problem::at("mesh.indices", Reason::ColumnLength, what));
    }
    let mesh = made("mesh", Geometry::mesh_as(mode, points, triangles))?;
    ToRegister::of_mesh(mesh, sent, known)
}

fn points(values: &[f64]) -> Checked<Vec<DVec3>> {
    let (points, rest) = values.as_chunks::<3>();
    match rest.is_empty() {
        true => Ok(points.iter().map(|&point| DVec3::from_array(point)).collect()),
        false => {
            let what =
                format!("has {} numbers: it must have three (x, y, z) for each point, such as 0, 0, 0", values.len());
            Err(Problem::at("values", Reason::ColumnLength, what))
        }
    }
}

impl Lists {
    /// Whether single precision holds all values.
    fn is_single(self, geometry: &Geometry) -> bool {
        let number = |value: f64| f64::from(value as f32).to_bits() == value.to_bits();
        let all = |points: &[DVec3]| points.iter().all(|point| point.to_array().into_iter().all(number));
        match geometry.form() {
            Form::Convex(Convex { core: Core::Hull(hull), .. }) => all(hull.vertices()),
            Form::Mesh(mesh) => all(mesh.vertices()),
            Form::Convex(_) | Form::HeightField(_) | Form::Compound(_) | Form::HalfSpace(_) => true,
        }
    }

    /// Some of the coordinates, as they are.
    fn exact_values(self, geometry: &Geometry, range: Range<usize>) -> Vec<f64> {
        let points = match geometry.form() {
            Form::Convex(Convex { core: Core::Hull(hull), .. }) => hull.vertices(),
            Form::Mesh(mesh) => mesh.vertices(),
            Form::Convex(_) | Form::HeightField(_) | Form::Compound(_) | Form::HalfSpace(_) => &[],
        };
        range.map(|number| points[number / 3][number % 3]).collect()
    }
}
