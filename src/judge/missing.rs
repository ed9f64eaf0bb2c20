//! What an analysis did not find to what that means: an impact, an end, a slap-down, a flight.

use crate::data::{Drop, DropFinding, Finding, IssueCode, Severity};

/// A record that goes on this long after L left is not cut off before the slap-down, s: that of 5.5 m from 15° takes 65 ms.
const LONG_ENOUGH_S: f64 = 0.3;

/// No channel shows an impact; what was found so far may say why.
#[must_use]
pub fn judge_no_impact(found: &[Finding], drop: &Drop) -> Finding {
    let is_doubt = |f: &&Finding| f.code == IssueCode::Clock && f.severity == Severity::Warning;
    let doubt = found.iter().find(is_doubt).cloned().map(Box::new);
    DropFinding::NoImpact { least_m_s: drop.least_impact_m_s(), doubt }.into()
}

/// The second end shows no slap-down in the time that was recorded after the first one left.
#[must_use]
pub fn judge_no_slap_down(after_s: f64) -> Finding {
    let found = if after_s < LONG_ENOUGH_S {
        DropFinding::EndsEarly { after_s }
    } else {
        DropFinding::NoSlapDown { after_s }
    };
    found.into()
}
