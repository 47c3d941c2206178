//! Parts as they are cut and joined.
//!
//! # Method
//! What is asked is tightened in steps, from coarse to what the caller wants. In each, parts that are not near enough are cut,
//! the worst first. Then parts are joined where the hull of both is near enough: the pair whose hull adds the least volume
//! first. The finest step of which that leaves few enough is the result. The cuts of a step are the same however many
//! parts there may be, so a run that may have more gets at least as far.

use std::{ops::ControlFlow, sync::Arc};

use super::{
    Cancelled, Options, Part, Progress,
    beyond_mesh::Subject,
    cell::simplices,
    cut::best_cut,
    farthest::{Farthest, Field, Goal, farthest},
    join::joined,
    meter::Meter,
    piece::{IsClosed, Piece},
};
use crate::{
    answer::{Bound, Stop},
    shape::{Geometry, Hull},
    tolerance::{DECOMPOSE_ERROR, DECOMPOSE_ERROR_MIN},
};

/// Parts where none is said.
const PARTS_USUAL: u32 = 32;

/// Most parts, whatever is said.
const PARTS_MAX: u32 = 1024;

/// How many times as many parts there may be before some are joined.
const OVERSHOOT: usize = 8;

/// What is asked in a step, as a part of what was asked in the one before.
const TIGHTENING: f64 = 0.75;

/// What is asked first is at least this part of the diagonal, unless the caller asks for less than that anyway.
const COARSEST: f64 = 0.125;

/// To which part of itself the error of a part is known that is to be cut.
const CUT_SHARE: f64 = 0.125;

/// How many parts there may be if so many are named.
pub(super) fn parts_most(named: u32) -> u32 {
    if named == 0 { PARTS_USUAL } else { named.min(PARTS_MAX) }
}

/// A part under way.
#[derive(Clone)]
pub(super) struct Growing {
    pub(super) hull: Arc<Hull>,
    /// What it is the hull of.
    pub(super) piece: Arc<Piece>,
    error: Farthest,
    /// What was enough when that was measured.
    asked: f64,
    pub(super) volume: f64,
    /// No plane cuts it.
    is_whole: bool,
}

impl Growing {
    pub(super) fn finished(&self) -> Part {
        let geometry = Geometry::of_hull(Arc::clone(&self.hull));
        Part { geometry, volume: self.volume, inside: self.error.bound }
    }
}

/// A decomposition under way.
pub(super) struct Growth<'a> {
    subject: &'a Subject<'a>,
    pub(super) parts: Vec<Arc<Growing>>,
    /// Cuts that led to them.
    pub(super) cut_count: usize,
    max_parts: usize,
    budget: u64,
    max_error: f64,
    /// What is asked in this step.
    pub(super) asked: f64,
    pub(super) stop: Stop,
    pub(super) meter: Meter<'a>,
}

impl<'a> Growth<'a> {
    pub(super) fn new(
        subject: &'a Subject<'a>,
        options: &Options,
        progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Self {
        let max_parts = parts_most(options.max_parts);
        let asked = if options.max_error > 0.0 { options.max_error } else { subject.diagonal * DECOMPOSE_ERROR };
        let max_error = asked.clamp((subject.diagonal * DECOMPOSE_ERROR_MIN).max(4.0 * subject.slack()), f64::MAX);
        let mut first = max_error;
        while first < subject.diagonal * COARSEST {
            first /= TIGHTENING;
        }
        let state = Progress {
            part_count: 1,
            done_count: 0,
            max_parts,
            inside_upper: subject.diagonal,
            steps: 0,
            max_steps: options.budget,
        };
        Self {
            subject,
            parts: Vec::new(),
            cut_count: 0,
            max_parts: max_parts as usize,
            budget: options.budget,
            max_error,
            asked: first,
            stop: Stop::Budget,
            // The other half is for joining.
            meter: Meter::new(options.budget / 2, state, progress),
        }
    }

    pub(super) fn run(mut self) -> Result<Self, Cancelled> {
        let piece = Arc::new(Piece::whole(self.subject.mesh));
        let hull = corners_of(&piece.points);
        let whole = self.part(piece, hull, self.goal(f64::INFINITY))?;
        self.parts.push(Arc::new(whole));
        let mut steps = vec![(f64::INFINITY, self.parts.clone())];
        while self.subject.is_measurable() && self.step()? {
            steps.push((self.asked, self.parts.clone()));
            if self.asked <= self.max_error {
                break;
            }
            self.asked = (self.asked * TIGHTENING).max(self.max_error);
        }
        self.meter.set_limit(self.budget);
        while let Some((asked, parts)) = steps.pop() {
            self.asked = asked;
            self.cut_count = parts.len() - 1;
            self.parts = joined(&mut self, parts)?;
            if self.parts.len() <= self.max_parts {
                break;
            }
        }
        if self.asked <= self.max_error {
            self.stop = self.end();
        }
        Ok(self)
    }

    /// Cuts until all parts are as near as is asked in this step; says whether that was reached.
    fn step(&mut self) -> Result<bool, Cancelled> {
        while let Some(worst) = self.worst() {
            self.tell();
            if self.meter.is_spent() || self.parts.len() > OVERSHOOT * self.max_parts {
                return Ok(false);
            }
            let part = Arc::clone(&self.parts[worst]);
            if part.asked > self.asked {
                let goal = self.goal(f64::INFINITY);
                let measured = self.measured(&part, goal)?;
                self.parts[worst] = Arc::new(measured);
            } else {
                self.cut(worst)?;
            }
        }
        Ok(true)
    }

    pub(super) fn goal(&self, hopeless: f64) -> Goal {
        Goal { enough: self.asked, share: CUT_SHARE, hopeless }
    }

    /// Of the parts that are not near enough and that can be cut, the one of greatest error.
    fn worst(&self) -> Option<usize> {
        let is_open = |index: &usize| !self.is_done(&self.parts[*index]) && !self.parts[*index].is_whole;
        (0..self.parts.len()).filter(is_open).max_by(|&a, &b| {
            let upper = |index: usize| self.parts[index].error.bound.upper;
            upper(a).total_cmp(&upper(b)).then(b.cmp(&a))
        })
    }

    pub(super) fn is_done(&self, part: &Growing) -> bool {
        part.error.bound.upper <= self.asked
    }

    fn end(&self) -> Stop {
        if self.parts.iter().all(|part| self.is_done(part)) { Stop::Tolerance } else { Stop::Converged }
    }

    fn tell(&mut self) {
        let state = &mut self.meter.state;
        state.part_count = self.parts.len() as u32;
        state.inside_upper = self.parts.iter().map(|part| part.error.bound.upper).fold(0.0, f64::max);
        state.done_count = self.parts.iter().filter(|part| part.error.bound.upper <= self.max_error).count() as u32;
    }

    /// Cuts a part in two.
    fn cut(&mut self, index: usize) -> Result<(), Cancelled> {
        let part = Arc::clone(&self.parts[index]);
        let is_closed = if self.subject.is_solid { IsClosed::Yes } else { IsClosed::No };
        let cut = best_cut(self.subject, &part.piece, &part.error, &mut self.meter)?;
        let Some(halves) = cut.and_then(|cut| part.piece.halves(&cut, is_closed)) else {
            self.parts[index] = Arc::new(Growing { is_whole: true, ..(*part).clone() });
            return Ok(());
        };
        self.parts.remove(index);
        for half in halves {
            let hull = corners_of(&half.points);
            self.meter.add(half.points.len());
            let made = self.part(Arc::new(half), hull, self.goal(f64::INFINITY))?;
            self.parts.push(Arc::new(made));
        }
        Ok(())
    }

    pub(super) fn part(&mut self, piece: Arc<Piece>, hull: Hull, goal: Goal) -> Result<Growing, Cancelled> {
        let known = self.subject.surely_within(hull.vertices());
        let error = if self.subject.is_measurable() {
            farthest(self.subject, simplices(&hull), known, goal, &mut self.meter)?
        } else {
            Farthest { bound: Bound::new(0.0, known), point: hull.center(), item: 0 }
        };
        let volume = hull.volume();
        Ok(Growing { hull: Arc::new(hull), piece, error, asked: goal.enough, volume, is_whole: false })
    }

    /// The same part, measured again.
    fn measured(&mut self, part: &Growing, goal: Goal) -> Result<Growing, Cancelled> {
        let known = part.error.bound.upper;
        let error = farthest(self.subject, simplices(&part.hull), known, goal, &mut self.meter)?;
        Ok(Growing { error, asked: goal.enough, ..part.clone() })
    }
}

/// The hull of points, of its corners alone.
pub(super) fn corners_of(points: &[glam::DVec3]) -> Hull {
    let hull = Hull::new(points);
    let corners = hull.corners();
    if corners.len() == hull.vertices().len() {
        return hull;
    }
    let corners: Vec<_> = corners.into_iter().map(|corner| hull.vertex(corner)).collect();
    Hull::new(&corners)
}
