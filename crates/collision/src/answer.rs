//! What every answer says of itself: the interval that holds the truth, the verdict, and why the work ended.

/// Bounds between which the true value lies, rounding included. A side nothing is known about is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// The true value is not below this.
    pub lower: f64,
    /// The true value is not above this.
    pub upper: f64,
}

impl Bound {
    /// Nothing is known.
    pub const UNBOUNDED: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// From `lower` to `upper`.
    #[must_use]
    pub const fn new(lower: f64, upper: f64) -> Self {
        Self { lower, upper }
    }

    /// How wide it is; infinite if a side is open.
    #[must_use]
    pub fn width(self) -> f64 {
        self.upper - self.lower
    }

    /// What it proves of two forms if it bounds their signed distance: exact touch is a hit, NaN proves nothing.
    #[must_use]
    pub fn touch_verdict(self) -> Verdict {
        if self.upper <= 0.0 {
            Verdict::Hit
        } else if self.lower > 0.0 {
            Verdict::Miss
        } else {
            Verdict::Undecided
        }
    }

    /// Whether `value` lies in it. NaN does not.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }
}

/// What is proved. A limit or a degeneracy gives `Undecided`, never a guess.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Proved: it touches.
    Hit,
    /// Proved: it does not.
    Miss,
    /// Neither is proved.
    Undecided,
}

/// How a value was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// From bounding volumes alone.
    Bounds,
    /// A formula.
    ClosedForm,
    /// Separating axes.
    SeparatingAxes,
    /// Gilbert-Johnson-Keerthi distance or ray cast.
    Gjk,
    /// Expanding polytope.
    Epa,
    /// Conservative advancement.
    Advancement,
}

/// Why the work on a value ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The interval cannot get narrower in the arithmetic used.
    Converged,
    /// The interval is as narrow as was asked, or the verdict is proved and no value was asked.
    Tolerance,
    /// The iteration budget was spent.
    Budget,
}

/// What of a geometry a value was found on, from coarse to fine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Representation {
    /// A ball around it.
    Ball,
    /// A box around it, along its own axes.
    OrientedBox,
    /// The convex hull of few of its points.
    SimplifiedHull,
    /// The convex parts that a mesh brings along. Depths are those of the parts; what touches is told by the mesh.
    Decomposition,
    /// The geometry itself.
    Exact,
}

/// What stood in for two geometries, and how far they may differ from it. The interval beside it allows for that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// The coarser of the two.
    pub representation: Representation,
    /// How far the geometries may lie outside of what stood in for them, both summed, metres.
    pub outside: f64,
    /// How far what stood in may lie outside of the geometries, both summed, metres.
    pub inside: f64,
}

impl Model {
    /// The geometries themselves.
    pub const EXACT: Self = Self { representation: Representation::Exact, outside: 0.0, inside: 0.0 };
}

/// What a value is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certificate {
    /// What is proved about this item.
    pub verdict: Verdict,
    /// Bounds of the value beside it: metres, or a fraction of the motion for times. For a ray or a motion that is
    /// undecided: bounds of the value should it touch.
    pub bound: Bound,
    /// What it was found on.
    pub model: Model,
    /// How the value was found.
    pub method: Method,
    /// Why the work ended.
    pub stop: Stop,
    /// Iterations spent on it.
    pub iterations: u32,
}

/// Where on a geometry. In order of parts, then of faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Feature {
    /// Leaf of a compound, depth first, or convex part of a mesh.
    pub part: Option<u32>,
    /// Triangle of a mesh (numbered as sent), face of a hull or box (−x, +x, −y, +y, −z, +z).
    pub face: Option<u32>,
}

/// What an answer cost: counts, never times. They may differ with what is already built; answers may not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Tree nodes visited.
    pub nodes_visited: u64,
    /// Shapes whose geometry was looked at.
    pub shapes_tested: u64,
    /// Pairs of convex pieces that were tested.
    pub pairs_tested: u64,
    /// Iterations of all of them.
    pub iterations: u64,
}

impl Work {
    /// All of it, each node, shape, pair and iteration a step.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.nodes_visited + self.shapes_tested + self.pairs_tested + self.iterations
    }

    /// What was done since the counters showed `before`.
    #[must_use]
    pub fn since(&self, before: &Self) -> Self {
        Self {
            nodes_visited: self.nodes_visited - before.nodes_visited,
            shapes_tested: self.shapes_tested - before.shapes_tested,
            pairs_tested: self.pairs_tested - before.pairs_tested,
            iterations: self.iterations - before.iterations,
        }
    }
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.nodes_visited += other.nodes_visited;
        self.shapes_tested += other.shapes_tested;
        self.pairs_tested += other.pairs_tested;
        self.iterations += other.iterations;
    }
}
