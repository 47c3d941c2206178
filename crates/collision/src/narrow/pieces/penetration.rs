//! How deep the pieces of a concave form are in another form.

use std::ops::ControlFlow;

use super::{Next, Ordered, Side, next};
use crate::{
    accuracy::Accuracy,
    answer::Work,
    narrow::{Contact, Contacts, NeedsDecomposition, Placed, convex},
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
    let mut found = Touching { contacts: Contacts::new(), max_gap };
    found.search(first, second, accuracy, work);
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

struct Touching {
    contacts: Contacts,
    max_gap: f64,
}

impl Touching {
    fn search(&mut self, a: Side<'_>, b: Side<'_>, accuracy: &Accuracy, work: &mut Work) {
        match next(a, b) {
            Next::Ask(a, b) => {
                let found = convex::penetration(a.placed(), b.placed(), self.max_gap, accuracy, work);
                self.contacts.extend(found.map(|found| Contact {
                    feature_a: a.feature,
                    feature_b: b.feature,
                    ..found
                }));
            }
            Next::AskSpace(pair, feature) => {
                self.contacts.extend(pair.penetration(self.max_gap, work).into_iter().map(|mut found| {
                    found.feature_a.part = feature.part;
                    found
                }));
            }
            Next::SplitFirst(a, b) => a.in_box(a.box_of(&b).inflated(self.max_gap), work, |piece, work| {
                self.search(piece, b, accuracy, work);
                ControlFlow::Continue(())
            }),
            Next::SplitSecond(a, b) => b.in_box(b.box_of(&a).inflated(self.max_gap), work, |piece, work| {
                self.search(a, piece, accuracy, work);
                ControlFlow::Continue(())
            }),
        }
    }
}
