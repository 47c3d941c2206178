//! What is built when a question first needs it, what that took, and at which tick it was.
//!
//! # Method
//! Forms and kernels know nothing of worlds or clocks. Whoever asks says once, around a question, at which tick it asks and by
//! which clock time is told ([`Asking`]); what is built meanwhile on the same thread notes both. Only a first build looks at
//! that, so it costs nothing where all is built, and no answer depends on it.
//!
//! What something has built for itself counts there alone: a simplified hull that needs the tree of its mesh does not say again
//! what that took. So times add up.
//!
//! # Limits
//! A geometry that several worlds share says at which tick of the first of them it was.

use std::{cell::Cell, sync::OnceLock};

/// A clock: nanoseconds since any moment. Only how long things took is told from it, no answer.
pub type Clock = fn() -> i64;

thread_local! {
    /// Who asks on this thread.
    static ASKING: Cell<Asking> = const { Cell::new(Asking::NOBODY) };
    /// What was built for what is being built now, nanoseconds.
    static INNER_NS: Cell<u64> = const { Cell::new(0) };
}

/// Who asks: for what is built meanwhile.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asking {
    /// The tick that is asked; `None` outside of any world.
    pub tick: Option<u64>,
    /// How time is told, if it is.
    pub clock: Option<Clock>,
}

/// Until it is dropped, what is built on this thread is built for whom it was made for.
#[derive(Debug)]
#[must_use = "it ends when it is dropped"]
pub(crate) struct AskingNow(Asking);

impl Asking {
    const NOBODY: Self = Self { tick: None, clock: None };

    /// Does something, and has what is built meanwhile on this thread note that it was for this one.
    ///
    /// ```
    /// use collision::{DVec3, shape::{Asking, Geometry}};
    /// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    /// let mesh = Geometry::mesh(&corners, &[[0, 1, 2]]).unwrap();
    /// assert!(mesh.structures_built().is_empty());
    /// let asking = Asking { tick: Some(7), clock: None };
    /// asking.during(|| mesh.stand_in(collision::answer::Representation::Ball));
    /// let ball = mesh.stand_ins_built().next().unwrap();
    /// assert_eq!((ball.receipt().first_tick, ball.receipt().build_ns), (Some(7), None));
    /// ```
    pub fn during<T>(self, work: impl FnOnce() -> T) -> T {
        let _asking = self.now();
        work()
    }

    /// The same until what this returns is dropped.
    pub(crate) fn now(self) -> AskingNow {
        AskingNow(ASKING.replace(self))
    }
}

impl Drop for AskingNow {
    fn drop(&mut self) {
        ASKING.set(self.0);
    }
}

/// What building something took, and at which tick it was first needed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Receipt {
    /// What it took, nanoseconds, without what else was built for it; `None` where nobody had a clock.
    pub build_ns: Option<u64>,
    /// The tick that was asked by whoever first needed it; `None` outside of any world.
    pub first_tick: Option<u64>,
}

impl Receipt {
    /// That of several together: the sum of what they took, and the earliest tick.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        fn both(a: Option<u64>, b: Option<u64>, merge: fn(u64, u64) -> u64) -> Option<u64> {
            a.zip(b).map_or(a.or(b), |(a, b)| Some(merge(a, b)))
        }
        Self {
            build_ns: both(self.build_ns, other.build_ns, u64::saturating_add),
            first_tick: both(self.first_tick, other.first_tick, u64::min),
        }
    }
}

/// Builds something, and says for whom and how long that took.
pub(crate) fn receipted<T>(build: impl FnOnce() -> T) -> (T, Receipt) {
    let Asking { tick: first_tick, clock } = ASKING.get();
    let Some(clock) = clock else { return (build(), Receipt { build_ns: None, first_tick }) };
    let (inner_before, begin) = (INNER_NS.replace(0), clock());
    let built = build();
    let took = u64::try_from(clock().saturating_sub(begin)).unwrap_or(0);
    let inner = INNER_NS.replace(inner_before.saturating_add(took));
    (built, Receipt { build_ns: Some(took.saturating_sub(inner)), first_tick })
}

/// Something that is built when it is first needed, once.
#[derive(Clone, Debug)]
pub(super) struct Lazy<T>(OnceLock<(T, Receipt)>);

impl<T> Default for Lazy<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> Lazy<T> {
    /// What it is; the first call builds it.
    #[inline]
    pub(super) fn get_or_build(&self, build: impl FnOnce() -> T) -> &T {
        &self.0.get_or_init(|| receipted(build)).0
    }

    /// What it is, if it is built.
    #[inline]
    pub(super) fn built(&self) -> Option<&T> {
        self.0.get().map(|(built, _)| built)
    }

    /// What building it took, if it is built.
    pub(super) fn receipt(&self) -> Option<Receipt> {
        self.0.get().map(|(_, receipt)| *receipt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_asks_inside_is_who_asks_until_that_ends() {
        let tick = |tick| Asking { tick: Some(tick), clock: Some(|| 5) };
        let inner = Lazy::default();
        let outer = Lazy::default();
        tick(3).during(|| {
            tick(8).during(|| inner.get_or_build(|| 1));
            outer.get_or_build(|| 2);
        });
        assert_eq!(inner.receipt().and_then(|receipt| receipt.first_tick), Some(8));
        assert_eq!(outer.receipt(), Some(Receipt { build_ns: Some(0), first_tick: Some(3) }));
        let alone = Lazy::default();
        alone.get_or_build(|| 3);
        assert_eq!(alone.receipt(), Some(Receipt::default()), "nobody asks any more");
    }

    #[test]
    fn what_is_built_for_something_else_counts_once() {
        thread_local!(static NOW: Cell<i64> = const { Cell::new(0) });
        let spend = |nanoseconds| NOW.set(NOW.get() + nanoseconds);
        let (outer, inner, later) = (Lazy::default(), Lazy::default(), Lazy::default());
        Asking { tick: None, clock: Some(|| NOW.get()) }.during(|| {
            outer.get_or_build(|| {
                spend(3);
                inner.get_or_build(|| spend(40));
                spend(2);
            });
            later.get_or_build(|| spend(7));
        });
        let took = [&outer, &inner, &later].map(|lazy| lazy.receipt().and_then(|receipt| receipt.build_ns));
        assert_eq!(took, [Some(5), Some(40), Some(7)]);
    }

    #[test]
    fn receipts_add_up_to_the_sum_and_the_earliest() {
        let receipt = |build_ns, first_tick| Receipt { build_ns, first_tick };
        let sum = receipt(Some(3), None).and(receipt(Some(4), Some(9))).and(receipt(None, Some(2)));
        assert_eq!(sum, receipt(Some(7), Some(2)));
    }
}
