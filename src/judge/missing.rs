//! What an analysis did not find to what that means: an impact, an end, a slap-down, a flight.

use crate::data::{Drop, End, Issue, IssueCode, Severity};

/// A record that goes on this long after L left is not cut off before the slap-down, s: that of 5.5 m from 15° takes 65 ms.
const LONG_ENOUGH_S: f64 = 0.3;

/// No channel shows an impact; what was found so far may say why.
#[must_use]
pub fn judge_no_impact(found: &[Issue], drop: &Drop) -> Issue {
    let is_doubt = |i: &&Issue| i.code == IssueCode::Clock && i.severity == Severity::Warning;
    let doubt = found.iter().find(is_doubt).map_or_else(String::new, |issue| {
        let of = issue.channel.as_ref().map_or_else(String::new, |channel| format!(" of {channel}"));
        format!(
            "; the rate{of} is in doubt (clock), and a rate too high makes every velocity too small by as much: clear that up first"
        )
    });
    let message = format!(
        "no impact was found: no transverse channel changes its velocity by {:.1} m/s within 25 ms; check source, unit and that the recording covers the drop{doubt}",
        drop.least_impact_m_s()
    );
    Issue::new(IssueCode::NoImpact, Severity::Error, message)
}

/// No transverse channel on an end; `is_stood_in_for` where the mass properties say what it would have read.
#[must_use]
pub fn judge_missing_end(end: End, is_stood_in_for: bool) -> Issue {
    let effect = match (is_stood_in_for, end) {
        (true, End::First) => {
            "rotation, k and speed rest on the inertia and centre of gravity of the cask file, and first contact is seen a bending wave late; record both ends"
        }
        (true, End::Second) => {
            "rotation and k rest on the inertia and centre of gravity of the cask file, and nothing shows the slap-down; record both ends"
        }
        (false, _) => "rotation, k and slap-down need one on each end",
    };
    let message = format!("no transverse channel on the {end} end: {effect}");
    Issue::new(IssueCode::MissingChannel, Severity::Error, message)
}

/// The second end shows no slap-down in the time that was recorded after the first one left.
#[must_use]
pub fn judge_no_slap_down(after_s: f64) -> Issue {
    let (code, why) = if after_s < LONG_ENOUGH_S {
        (IssueCode::EndsEarly, "the recording ends before it")
    } else {
        (IssueCode::NoSlapDown, "the second end shows no impact")
    };
    let message =
        format!("no slap-down within {:.0} ms after the first end left the target: {why}", 1e3 * after_s);
    Issue::new(code, Severity::Error, message)
}

/// No flight could be had.
#[must_use]
pub fn judge_short_flight() -> Issue {
    let message = "the free flight between the impacts is too short to be told from them and from ringing";
    Issue::new(IssueCode::FlightFit, Severity::Error, message)
}
