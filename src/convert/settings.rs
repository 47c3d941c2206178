//! Settings of a world, checked on their way in.

use collision::world::Settings;
use wire::v1 as pb;

use super::number::within;
use crate::problem::{Checked, Problem, Reason};

/// Widest margin, metres: the largest size of a form.
const MARGIN_MAX: f64 = 1e9;

/// These settings where `sent` says nothing else.
///
/// # Errors
/// A number out of range.
pub(crate) fn changed(settings: Settings, sent: Option<&pb::WorldSettings>) -> Checked<Settings> {
    let Some(sent) = sent else { return Ok(settings) };
    let mut changed = settings;
    if let Some(ticks) = sent.history_ticks {
        let most = Settings::HISTORY_TICKS_MAX;
        if ticks > most {
            let what = format!("is {ticks}: it must be 0 to {most}");
            return Err(Problem::at("history_ticks", Reason::OutOfLimits, what));
        }
        changed.history_ticks = ticks;
    }
    if let Some(margin) = sent.margin {
        changed.margin = Some(within("margin", margin, 0.0..=MARGIN_MAX, "0 to 1e9 metres")?);
    }
    Ok(changed)
}

/// Settings as they are sent.
pub(crate) fn settings_out(settings: Settings) -> pb::WorldSettings {
    pb::WorldSettings { history_ticks: Some(settings.history_ticks), margin: settings.margin }
}
