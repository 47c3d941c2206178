//! How wrong answers are at the extremes: Calipers, parry3d and parry3d-f64 on the same pairs, as a part of `docs/accuracy.md`.
//!
//! # Method
//! Pairs of convex shapes near contact are made in f64 at a size, an offset from the origin and an aspect. The truth is the interval of Calipers' exact
//! tier (`yardstick coverage` holds those to an oracle of 32 digits). Errors are relative to the size of the pair.
//!
//! # Limits
//! parry3d holds its numbers in f32, so it is asked about numbers that were rounded: what its user would get.

mod ask;
mod parry;
mod workload;

use std::io::{self, Write};

use self::{
    ask::{Asker, Tally},
    workload::{EXTREMES, pairs},
};

/// Pairs at each extreme.
const PAIRS: usize = 4000;

const HEAD: &str = "## Beside others, at the extremes

The same pairs (a box with a box, a capsule with a box, a hull of 16 points with a hull, a cylinder with a box; half of them overlap by up to a tenth of their size, half are \
apart by as much) asked of Calipers' exact tier, of `parry3d` 0.31.1 and of `parry3d-f64` 0.31.1. The truth is the certified interval of the exact tier, which `yardstick coverage` holds to an oracle of 32 digits; errors are parts of the \
size of the pair (those of Calipers what its own intervals allow), the largest and what 999 of 1,000 do not exceed; *wrong* is a touch told where there is a gap, or the other way round; *failed* is no answer, a value that \
is no number, or a panic. `parry3d` holds numbers in f32: at an offset of a million sizes it is asked about rounded places, as its users are.

| pairs | engine | distance p99.9 | distance max | depth p99.9 | depth max | wrong | failed |
|---|---|---|---|---|---|---|---|
";

const OTHERS: &str = "
Published figures, not measured here (float builds; see `benches/README.md` for how they were taken): Jolt with its default radius does not report 15.5 % of \
overlapping box pairs, and with world transforms at 1e6 m 1,097 of 10,000 verdicts are wrong; its linear casts miss 536 of 89,000 hits of boxes. Box3D's distance is the best of those in \
f32 (p99.9 5e-7, max 1.6e-6); its casts sink about 5 mm and lose 0.5 to 0.7 % of hits, boxes are clamped to 1 mm, and hulls of more than 128 faces are refused.
";

fn main() -> io::Result<()> {
    // Panics of a peer are counted; their text would only be in the way.
    std::panic::set_hook(Box::new(|_| {}));
    let mut out = io::stdout().lock();
    write!(out, "{HEAD}")?;
    for extreme in EXTREMES {
        let pairs = pairs(&extreme, PAIRS);
        for asker in Asker::ALL {
            let mut tally = Tally::default();
            pairs.iter().for_each(|pair| tally.add(asker, pair));
            tally.print(extreme.name, asker, &mut out)?;
        }
    }
    write!(out, "{OTHERS}")
}
