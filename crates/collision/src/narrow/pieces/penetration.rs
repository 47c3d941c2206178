//! How deep the pieces of a concave form are in another form.
//!
//! # Method
//! Triangles have no depth among each other, nor has what is deep in a solid mesh any that its surface tells: then convex parts stand
//! in for the meshes. Depths are those of the parts, verdicts those of the meshes.

use std::ops::ControlFlow;

use super::{
    Next, Ordered, Piece, Side,
    concave::Concave,
    facet,
    inside::{Held, middle_held},
    matter::{self, AcrossGaps, Met},
    next, overlap,
    rod::Rod,
    stand_in::StandIns,
};
use crate::{
    accuracy::Accuracy,
    answer::{Model, Representation, Verdict, Work},
    narrow::{Contact, Contacts, NeedsDecomposition, Placed},
    shape::{MeshMode, Standing},
};

/// Contacts of all pairs of pieces whose gap is not proved to be above `max_gap` metres, by piece.
///
/// # Errors
/// [`NeedsDecomposition`] if both have surfaces, or if the middle of a form lies in a solid mesh (or may do so), or all that it
/// touches of one faces away from its middle; and there are no convex parts for that ([`StandIns`]).
pub(in crate::narrow) fn penetration(
    a: Placed<'_>,
    b: Placed<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Result<Contacts, NeedsDecomposition> {
    let ask = Ask { a, b, max_gap, accuracy };
    [StandIns::Nothing, StandIns::Brought, StandIns::Made(accuracy)]
        .into_iter()
        .find_map(|stand_ins| ask.contacts(stand_ins, work))
        .ok_or(NeedsDecomposition)
}

struct Ask<'a> {
    a: Placed<'a>,
    b: Placed<'a>,
    max_gap: f64,
    accuracy: &'a Accuracy,
}

impl Ask<'_> {
    /// The contacts, where what stands in for meshes is enough to tell them.
    fn contacts(&self, stand_ins: StandIns<'_>, work: &mut Work) -> Option<Contacts> {
        let Self { a, b, max_gap, accuracy } = *self;
        let [of_a, of_b] = [a, b].map(|placed| stand_ins.census(placed.geometry));
        let is_enough = match stand_ins {
            StandIns::Nothing => !of_a.has_surface || !of_b.has_surface,
            StandIns::Brought => (of_a.has_parts || of_b.has_parts) && !(of_a.has_surface && of_b.has_surface),
            StandIns::Made(_) => accuracy.may_stand_in() && !of_a.has_surface && !of_b.has_surface,
        };
        if !is_enough {
            return None;
        }
        let (outside, inside) = (sum_up(of_a.outside, of_b.outside), sum_up(of_a.inside, of_b.inside));
        let Ordered { first, second, is_swapped, origin } = Ordered::new(a, b);
        let mut found = Touching {
            stand_ins,
            contacts: Contacts::new(),
            // Parts may be farther apart than their meshes.
            max_gap: sum_up(max_gap, outside),
            accuracy,
            is_deep: false,
            is_touched_from_back: false,
            across_gaps: AcrossGaps::LeaveOut,
        };
        found.search(&first, &second, work);
        if found.is_deep {
            return None;
        }
        let mut contacts = found.contacts;
        if is_swapped {
            contacts.iter_mut().for_each(Contact::swap);
        }
        for point in contacts.iter_mut().flat_map(|contact| &mut contact.points) {
            point.point_on_a += origin;
            point.point_on_b += origin;
        }
        contacts.sort_by_key(|contact| (contact.feature_a, contact.feature_b));
        self.judge_parts(&mut contacts, Model { representation: Representation::Decomposition, outside, inside }, work);
        Some(contacts)
    }

    /// What contacts of parts say of meshes: these are apart if the parts are farther apart than the meshes lie outside of them. That
    /// meshes touch only they tell themselves.
    fn judge_parts(&self, contacts: &mut Contacts, model: Model, work: &mut Work) {
        // Only what may touch needs to be asked.
        let mut touch = None;
        let of_parts = |contact: &&mut Contact| contact.certificate.model.representation == model.representation;
        for contact in contacts.iter_mut().filter(of_parts) {
            let certificate = &mut contact.certificate;
            // Both sides of the comparison are rounded once.
            let is_apart = certificate.bound.upper.next_up() < -model.outside.next_up();
            certificate.verdict = match is_apart {
                true => Verdict::Miss,
                false => touch.get_or_insert_with(|| overlap(self.a, self.b, self.accuracy, work)).verdict,
            };
            certificate.model = model;
        }
    }
}

/// Rounded up; exact if one is 0.
fn sum_up(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { a + b } else { (a + b).next_up() }
}

struct Touching<'a> {
    stand_ins: StandIns<'a>,
    contacts: Contacts,
    max_gap: f64,
    accuracy: &'a Accuracy,
    /// A solid mesh is not only touched: a contact with its surface does not tell how to part from it.
    is_deep: bool,
    /// Some triangle of the form that is being asked is touched, but not from its front.
    is_touched_from_back: bool,
    /// How the form that is being asked about stands to matter that it may be in without a touch.
    across_gaps: AcrossGaps,
}

impl Touching<'_> {
    fn search(&mut self, a: &Side<'_>, b: &Side<'_>, work: &mut Work) {
        match self.stand_ins {
            StandIns::Nothing => self.search_pieces(a, b, work),
            StandIns::Brought | StandIns::Made(_) => {
                self.search_pieces(&a.or_parts(self.stand_ins), &b.or_parts(self.stand_ins), work);
            }
        }
    }

    fn search_pieces(&mut self, a: &Side<'_>, b: &Side<'_>, work: &mut Work) {
        let known = self.contacts.len();
        match next(a, b) {
            Next::Ask(a, b) => {
                let found = self.contact(a, b, work);
                self.contacts.extend(found);
            }
            Next::AskSpace(form, space) => {
                if let Some((pair, feature)) = space.below(form) {
                    self.contacts.extend(pair.penetration(self.max_gap, work).into_iter().map(|mut found| {
                        found.feature_a.part = feature.part;
                        found
                    }));
                }
            }
            Next::SplitFirst(a, b) => {
                self.begin(a, b, work);
                a.in_box(a.box_of(b).inflated(self.max_gap), work, |piece, work| {
                    self.search(&piece, b, work);
                    ControlFlow::Continue(())
                });
                self.end(a, known);
                if self.contacts.len() == known {
                    self.contacts.extend(deep_inside(a, b, work).map(Contact::swapped));
                }
            }
            Next::SplitSecond(a, b) => {
                self.begin(b, a, work);
                let rod = Rod::of(a, b).map(|rod| rod.grown(self.max_gap));
                let query = rod.as_ref().map_or_else(|| b.box_of(a).inflated(self.max_gap), Rod::bounds);
                b.in_box(query, work, |piece, work| {
                    if rod.as_ref().is_some_and(|rod| rod.is_clear_of(&piece, 1.0)) {
                        work.pairs_tested += 1;
                    } else {
                        self.search(a, &piece, work);
                    }
                    ControlFlow::Continue(())
                });
                self.end(b, known);
                if self.contacts.len() == known {
                    self.contacts.extend(deep_inside(b, a, work));
                }
            }
        }
    }

    /// Before the pieces of a concave form are asked.
    fn begin(&mut self, concave: &Concave<'_>, other: &Side<'_>, work: &mut Work) {
        self.is_touched_from_back = false;
        if self.max_gap > 0.0 {
            let is_in =
                matches!(Met::of_pair(concave, other, work), Some(met) if matches!(met.standing, Standing::Inside(_)));
            self.across_gaps = if is_in { AcrossGaps::PushOut } else { AcrossGaps::LeaveOut };
        }
        if let Side::Convex(piece) = other {
            self.is_deep |= middle_held(piece, concave, work) != Held::No;
        }
    }

    /// After that, where so many contacts were known: a form that touches a solid only from behind its surface is deep in it.
    fn end(&mut self, concave: &Concave<'_>, known: usize) {
        let is_solid = concave.as_mesh().is_some_and(|mesh| mesh.mode() == MeshMode::Solid);
        let mut touching = self.contacts[known..].iter().filter(|found| found.certificate.verdict != Verdict::Miss);
        self.is_deep |= is_solid && self.is_touched_from_back && touching.next().is_none();
    }

    fn contact(&mut self, a: &Piece<'_>, b: &Piece<'_>, work: &mut Work) -> Option<Contact> {
        let felt = facet::contact(a, b, self.max_gap, self.accuracy, work);
        self.is_touched_from_back |= felt.is_from_back;
        let mut found = Contact { feature_a: a.feature, feature_b: b.feature, ..felt.contact? };
        if a.is_of_parts || b.is_of_parts {
            found.certificate.model.representation = Representation::Decomposition;
        }
        match (a.skin, b.skin) {
            (_, true) => matter::out_of(a, b, found, self.across_gaps, work),
            (true, false) => matter::out_of(b, a, found.swapped(), self.across_gaps, work).map(Contact::swapped),
            (false, false) => Some(found),
        }
    }
}

/// The contact of a convex form, the first, that lies in matter and touches no skin: with the triangle above it.
fn deep_inside(matter: &Concave<'_>, form: &Side<'_>, work: &mut Work) -> Option<Contact> {
    let Side::Convex(piece) = form else { return None };
    let Standing::Inside(leaf) = Met::of_pair(matter, form, work)?.standing else { return None };
    matter.with_piece(leaf as u32, |skin| match skin {
        Side::Convex(skin) => matter::below(piece, &skin, work),
        Side::Concave(_) | Side::Space(_) => None,
    })
}
