//! Everything found on the way to issues and a verdict: what speaks against the result.

mod channels;
mod result;

pub use channels::judge_channels;
pub use result::{judge_comparison, judge_motion};

use crate::data::{Issue, Severity, Verdict};

/// Sorts the findings, errors first, and says what they amount to: any error fails, any warning asks for a review.
#[must_use]
pub fn verdict(issues: &mut [Issue]) -> Verdict {
    issues.sort_by(|a, b| b.severity.cmp(&a.severity).then(a.code.cmp(&b.code)));
    match issues.first().map(|i| i.severity) {
        Some(Severity::Error) => Verdict::Fail,
        Some(Severity::Warning) => Verdict::Review,
        _ => Verdict::Pass,
    }
}
