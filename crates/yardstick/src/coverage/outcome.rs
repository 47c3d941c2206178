//! What came of a question: its answers, each with what is wrong with it.

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Asked {
    /// How far apart.
    Distance,
    /// Whether they touch.
    Overlap,
    /// Contacts, with their depths.
    Penetration,
    /// The same as a distance, from where another pose ended.
    WarmDistance,
    /// The same as contacts, from where another pose ended.
    WarmPenetration,
    /// Where a ray touches first.
    Ray,
    /// The first touch of a motion without turns.
    Impact,
    /// The first touch of a motion with turns.
    TurningImpact,
}

impl Asked {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Distance,
        Self::Overlap,
        Self::Penetration,
        Self::WarmDistance,
        Self::WarmPenetration,
        Self::Ray,
        Self::Impact,
        Self::TurningImpact,
    ];

    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Distance => "distance",
            Self::Overlap => "overlap",
            Self::Penetration => "penetration",
            Self::WarmDistance => "warm_distance",
            Self::WarmPenetration => "warm_penetration",
            Self::Ray => "ray",
            Self::Impact => "impact",
            Self::TurningImpact => "turning_impact",
        }
    }
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultKind {
    /// An interval does not hold the truth.
    Bound,
    /// A wrong yes or no.
    Verdict,
    /// Undecided, though not near touch.
    Undecided,
    /// Wider than was asked, though it says that it is as narrow, or cannot be narrower.
    Width,
    /// A normal that is not of length 1 or not the way out that the bound says.
    Normal,
    /// NaN, bounds in the wrong order, a value outside of them.
    Form,
    /// Nearest points that are not as far apart as the distance.
    Points,
    /// Swapped arguments do not swap the answer.
    Order,
    /// More iterations than the budget of the question allows.
    Work,
    /// A kernel panicked.
    Panic,
}

impl FaultKind {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Bound,
        Self::Verdict,
        Self::Undecided,
        Self::Width,
        Self::Normal,
        Self::Form,
        Self::Points,
        Self::Order,
        Self::Work,
        Self::Panic,
    ];

    /// Its name in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bound => "bound",
            Self::Verdict => "verdict",
            Self::Undecided => "undecided",
            Self::Width => "width",
            Self::Normal => "normal",
            Self::Form => "form",
            Self::Points => "points",
            Self::Order => "order",
            Self::Work => "work",
            Self::Panic => "panic",
        }
    }
}

/// Something wrong with an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// What kind of thing.
    pub kind: FaultKind,
    /// In words and numbers.
    pub what: String,
}

/// What came of one answer.
#[derive(Clone, Debug)]
pub struct Answer {
    /// To what.
    pub asked: Asked,
    /// Nothing, if all is right.
    pub faults: Vec<Fault>,
    /// Neither hit nor miss was proved.
    pub is_undecided: bool,
    /// The budget of the exact tier ended the work on an interval that is wider than rounding makes it, and says so.
    pub is_unfinished: bool,
    /// Width of the interval over s, in the exact tier.
    pub width: Option<f64>,
}

impl Answer {
    /// Nothing is wrong yet.
    #[must_use]
    pub const fn to(asked: Asked) -> Self {
        Self { asked, faults: Vec::new(), is_undecided: false, is_unfinished: false, width: None }
    }

    /// Adds something wrong.
    pub fn fault(&mut self, kind: FaultKind, what: impl Into<String>) {
        self.faults.push(Fault { kind, what: what.into() });
    }
}

/// What came of a question.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Each that was given.
    pub answers: Vec<Answer>,
    /// They overlap, or meet, says the oracle.
    pub overlaps: bool,
    /// How far the oracle's own bounds are apart, over s.
    pub blur: f64,
}

impl Outcome {
    /// One answer.
    #[must_use]
    pub fn of(answer: Answer) -> Self {
        Self { answers: vec![answer], ..Self::default() }
    }

    /// A kernel panicked.
    #[must_use]
    pub fn panicked(asked: Asked) -> Self {
        let mut answer = Answer::to(asked);
        answer.fault(FaultKind::Panic, "a kernel panicked");
        Self::of(answer)
    }

    /// All that is wrong.
    pub fn faults(&self) -> impl Iterator<Item = &Fault> {
        self.answers.iter().flat_map(|answer| &answer.faults)
    }
}
