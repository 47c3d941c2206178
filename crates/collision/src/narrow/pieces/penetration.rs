//! How deep the pieces of a concave form are in another form.

use std::ops::ControlFlow;

use super::{
    Next, Ordered, Piece, Side,
    concave::Concave,
    matter::{self, Met},
    next,
};
use crate::{
    accuracy::Accuracy,
    answer::Work,
    narrow::{Contact, Contacts, NeedsDecomposition, Placed, convex},
    shape::Standing,
};

/// Contacts of all pairs of pieces whose gap is not proved to be above `max_gap` metres, by piece.
///
/// # Errors
/// [`NeedsDecomposition`] if both have surfaces.
pub(in crate::narrow) fn penetration(
    a: Placed<'_>,
    b: Placed<'_>,
    max_gap: f64,
    accuracy: &Accuracy,
    work: &mut Work,
) -> Result<Contacts, NeedsDecomposition> {
    let Ordered { first, second, is_swapped, origin } = Ordered::new(a, b);
    if let (Side::Concave(a), Side::Concave(b)) = (&first, &second)
        && a.has_surface()
        && b.has_surface()
    {
        return Err(NeedsDecomposition);
    }
    let mut found = Touching { contacts: Contacts::new(), max_gap, accuracy };
    found.search(&first, &second, work);
    let mut contacts = found.contacts;
    if is_swapped {
        contacts = contacts.into_iter().map(Contact::swapped).collect();
    }
    for point in contacts.iter_mut().flat_map(|contact| &mut contact.points) {
        point.point_on_a += origin;
        point.point_on_b += origin;
    }
    contacts.sort_by_key(|contact| (contact.feature_a, contact.feature_b));
    Ok(contacts)
}

struct Touching<'a> {
    contacts: Contacts,
    max_gap: f64,
    accuracy: &'a Accuracy,
}

impl Touching<'_> {
    fn search(&mut self, a: &Side<'_>, b: &Side<'_>, work: &mut Work) {
        let known = self.contacts.len();
        match next(a, b) {
            Next::Ask(a, b) => self.contacts.extend(self.contact(a, b, work)),
            Next::AskSpace(form, space) => {
                if let Some((pair, feature)) = space.below(form) {
                    self.contacts.extend(pair.penetration(self.max_gap, work).into_iter().map(|mut found| {
                        found.feature_a.part = feature.part;
                        found
                    }));
                }
            }
            Next::SplitFirst(a, b) => {
                a.in_box(a.box_of(b).inflated(self.max_gap), work, |piece, work| {
                    self.search(&piece, b, work);
                    ControlFlow::Continue(())
                });
                if self.contacts.len() == known {
                    self.contacts.extend(deep_inside(a, b, work).map(Contact::swapped));
                }
            }
            Next::SplitSecond(a, b) => {
                b.in_box(b.box_of(a).inflated(self.max_gap), work, |piece, work| {
                    self.search(a, &piece, work);
                    ControlFlow::Continue(())
                });
                if self.contacts.len() == known {
                    self.contacts.extend(deep_inside(b, a, work));
                }
            }
        }
    }

    fn contact(&self, a: &Piece<'_>, b: &Piece<'_>, work: &mut Work) -> Option<Contact> {
        let found = convex::penetration(a.placed(), b.placed(), self.max_gap, self.accuracy, work)?;
        let found = Contact { feature_a: a.feature, feature_b: b.feature, ..found };
        match (a.skin, b.skin) {
            (_, true) => matter::out_of(a, b, found, work),
            (true, false) => matter::out_of(b, a, found.swapped(), work).map(Contact::swapped),
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
