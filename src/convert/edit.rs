//! Edits: wire to checked edits of single shapes, each with its place in the message.

use collision::world::{Edit, EditError, EditFault, EditRule, ShapeId, World};
use wire::v1::{self as pb, edit::Op};

use super::{
    columns::{Poses, VectorColumn},
    number::{shape_id, timestamp},
    place::{position, rotation},
    shape::{like, shape},
};
use crate::{
    geometries::Geometries,
    problem::{Checked, Problem, Reason, Under},
};

/// Most items of all edits of one message.
pub(crate) const ITEMS: usize = 65_536;

/// Where a single edit stands in its message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Which of the message's edits.
    edit: u32,
    /// Which item of it; `None` where it is a single one.
    item: Option<u32>,
}

/// The single edits of a message, in order.
#[derive(Debug, Default)]
pub(crate) struct Expanded {
    pub(crate) edits: Vec<Edit>,
    /// The place of each.
    pub(crate) places: Vec<Place>,
    /// What is wrong, with the places of what was left out for it.
    pub(crate) problems: Vec<Problem>,
}

impl Expanded {
    fn push(&mut self, place: Place, edit: Edit) {
        self.edits.push(edit);
        self.places.push(place);
    }
}

/// Expands a message's edits. What is wrong is left out and told in `problems`.
///
/// # Errors
/// There are too many items.
pub(crate) fn expand(sent: &[pb::Edit], known: &Geometries) -> Checked<Expanded> {
    let item_count: usize = sent.iter().map(item_count).sum();
    if item_count > ITEMS {
        let what = format!("have {item_count} items in all: at most {ITEMS} are allowed in one message");
        return Err(Problem::at("edits", Reason::TooManyItems, what));
    }
    let mut expanded = Expanded::default();
    expanded.edits.reserve(item_count);
    expanded.places.reserve(item_count);
    for (index, edit) in sent.iter().enumerate() {
        if let Err(problem) = expand_one(edit, index, known, &mut expanded).under_item("edits", index) {
            expanded.problems.push(problem);
        }
    }
    Ok(expanded)
}

/// Applies a message's edits as one tick, at the time of the newest; all of them, or none.
///
/// # Errors
/// What is wrong with one of them.
pub(crate) fn apply_whole(sent: &[pb::Edit], known: &Geometries, world: &mut World) -> Checked<()> {
    let expanded = expand(sent, known)?;
    if let Some(problem) = expanded.problems.into_iter().next() {
        return Err(problem);
    }
    let time = world.newest().time();
    let applied = world.apply(expanded.edits, time, EditRule::AllOrNothing);
    applied.map(|_| ()).map_err(|error| refused(error, &expanded.places))
}

/// What a client is told about an edit that the world refuses.
pub(crate) fn fault(fault: EditFault, place: Place) -> Problem {
    let field = match place.item {
        None => format!("edits[{}].move.id", place.edit),
        Some(item) => format!("edits[{}].moves.ids[{item}]", place.edit),
    };
    let what = format!("is {}: there is no such shape to move; insert it first", fault.id);
    Problem::at(field, Reason::ShapeNotFound, what).with_shape(fault.id.get())
}

/// What a client is told about a batch that the world refuses whole.
pub(crate) fn refused(error: EditError, places: &[Place]) -> Problem {
    match error {
        EditError::Fault(edit_fault) => match places.get(edit_fault.index) {
            Some(&place) => fault(edit_fault, place),
            None => Problem::new(Reason::ShapeNotFound, edit_fault.to_string()).with_shape(edit_fault.id.get()),
        },
        EditError::TimeGoesBack { newest, found } => {
            let (found, newest) = (timestamp(found), timestamp(newest));
            let what = format!(
                "is {found}, before that of the newest tick, {newest}: a tick's time never goes back; leave it out for the server's clock"
            );
            Problem::at("time", Reason::OutOfLimits, what)
        }
    }
}

fn item_count(sent: &pb::Edit) -> usize {
    match &sent.op {
        Some(Op::Remove(remove)) => remove.ids.len().max(1),
        Some(Op::Inserts(inserts)) => inserts.ids.len().max(1),
        Some(Op::Moves(moves)) => moves.ids.len().max(1),
        Some(Op::Insert(_) | Op::Move(_) | Op::Clear(_)) | None => 1,
    }
}

fn expand_one(sent: &pb::Edit, index: usize, known: &Geometries, into: &mut Expanded) -> Checked<()> {
    // There are at most `ITEMS` edits, so the number fits.
    let edit = u32::try_from(index).unwrap_or(u32::MAX);
    let single = Place { edit, item: None };
    match &sent.op {
        None => Err(Problem::at(
            "op",
            Reason::Missing,
            "is absent: an edit is one of insert, move, remove, inserts, moves, clear, such as {\"remove\": {\"ids\": [1]}}",
        )),
        Some(Op::Insert(insert)) => {
            into.push(single, Edit::Insert(shape(insert, known).under("insert")?));
            Ok(())
        }
        Some(Op::Move(moved)) => {
            into.push(single, single_move(moved).under("move")?);
            Ok(())
        }
        Some(Op::Remove(remove)) => {
            each_id(&remove.ids, "remove", edit, into, |_, id| Ok(Edit::Remove(id)));
            Ok(())
        }
        Some(Op::Inserts(inserts)) => insert_columns(inserts, edit, known, into).under("inserts"),
        Some(Op::Moves(moves)) => move_columns(moves, edit, into).under("moves"),
        Some(Op::Clear(pb::Clear {})) => {
            into.push(single, Edit::Clear);
            Ok(())
        }
    }
}

fn single_move(sent: &pb::Move) -> Checked<Edit> {
    let optional = |field: &'static str, vector: Option<&pb::Vec3>| match vector {
        None => Ok(None),
        Some(_) => position(vector, collision::DVec3::ZERO).under(field).map(Some),
    };
    let pose = sent.pose.as_ref();
    Ok(Edit::Move {
        id: shape_id("id", sent.id)?,
        position: optional("pose.position", pose.and_then(|pose| pose.position.as_ref()))?,
        rotation: rotation("pose.rotation", pose.and_then(|pose| pose.rotation.as_ref()))?,
        velocity: optional("velocity", sent.velocity.as_ref())?,
        angular_velocity: optional("angular_velocity", sent.angular_velocity.as_ref())?,
        teleport: sent.teleport,
    })
}

fn insert_columns(sent: &pb::InsertColumns, edit: u32, known: &Geometries, into: &mut Expanded) -> Checked<()> {
    let Some(template) = &sent.like else {
        let what = "is absent: it says what the shapes have in common, at least their geometry, such as {\"geometry\": {\"sphere\": {\"radius\": 1}}}";
        return Err(Problem::at("like", Reason::Missing, what));
    };
    let template = like(template, known).under("like")?;
    let poses = Poses::new(sent.poses.as_ref(), sent.ids.len()).under("poses")?;
    each_id(&sent.ids, "inserts", edit, into, |index, id| {
        let mut shape = template.clone();
        shape.id = id;
        shape.pose.position = poses.position(index).under("poses")?.unwrap_or(poses.frame_origin());
        shape.pose.rotation = poses.rotation(index).under("poses")?.unwrap_or(shape.pose.rotation);
        Ok(Edit::Insert(shape))
    });
    Ok(())
}

fn move_columns(sent: &pb::MoveColumns, edit: u32, into: &mut Expanded) -> Checked<()> {
    let n = sent.ids.len();
    let poses = Poses::new(sent.poses.as_ref(), n).under("poses")?;
    let velocities = VectorColumn::new("velocities", &sent.velocities, n)?;
    let angular_velocities = VectorColumn::new("angular_velocities", &sent.angular_velocities, n)?;
    each_id(&sent.ids, "moves", edit, into, |index, id| {
        Ok(Edit::Move {
            id,
            position: poses.position(index).under("poses")?,
            rotation: poses.rotation(index).under("poses")?,
            velocity: velocities.item(index)?,
            angular_velocity: angular_velocities.item(index)?,
            teleport: sent.teleport,
        })
    });
    Ok(())
}

/// Makes an edit for each id; what is wrong with one leaves out that one only.
fn each_id(
    ids: &[u64],
    op: &str,
    edit: u32,
    into: &mut Expanded,
    mut make: impl FnMut(usize, ShapeId) -> Checked<Edit>,
) {
    for (index, &id) in ids.iter().enumerate() {
        let made = match ShapeId::new(id) {
            Some(id) => make(index, id),
            None => shape_id("", 0).map_err(|problem| problem.at_field(format!("ids[{index}]"))).map(Edit::Remove),
        };
        match made.under(op).under_item("edits", edit as usize) {
            Ok(single) => into.push(Place { edit, item: u32::try_from(index).ok() }, single),
            Err(problem) => into.problems.push(problem.with_shape(id)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometries::Quotas;

    fn moves(ids: &[u64], positions: &[f32]) -> pb::Edit {
        pb::Edit {
            op: Some(Op::Moves(pb::MoveColumns {
                ids: ids.to_vec(),
                poses: Some(pb::PoseColumns { positions: positions.to_vec(), ..pb::PoseColumns::default() }),
                ..pb::MoveColumns::default()
            })),
        }
    }

    #[test]
    fn a_wrong_item_is_left_out_and_named_and_the_others_stay() {
        let known = Geometries::new(Quotas::NONE);
        let edits = [pb::Edit::default(), moves(&[1, 0, 3], &[0.0; 9])];
        let expanded = expand(&edits, &known).unwrap();
        assert_eq!(expanded.edits.len(), 2);
        let fields: Vec<_> = expanded.problems.into_iter().map(|problem| problem.into_wire().field).collect();
        assert_eq!(fields, ["edits[0].op", "edits[1].moves.ids[1]"]);
        let item = Place { edit: 1, item: Some(2) };
        assert_eq!(expanded.places[1], item);
    }

    #[test]
    fn a_wrong_column_leaves_out_the_whole_edit() {
        let known = Geometries::new(Quotas::NONE);
        let expanded = expand(&[moves(&[1, 2, 3], &[0.0; 8])], &known).unwrap();
        assert!(expanded.edits.is_empty());
        let problem = expanded.problems[0].clone().into_wire();
        assert_eq!(problem.field, "edits[0].moves.poses.positions");
    }

    #[test]
    fn more_than_65536_items_are_refused_whole() {
        let known = Geometries::new(Quotas::NONE);
        let many = moves(&vec![1; ITEMS], &[0.0; 3]);
        assert_eq!(expand(std::slice::from_ref(&many), &known).unwrap().edits.len(), ITEMS);
        let problem = expand(&[many, moves(&[1], &[])], &known).unwrap_err().into_wire();
        assert_eq!(problem.reason, "TOO_MANY_ITEMS");
    }
}
