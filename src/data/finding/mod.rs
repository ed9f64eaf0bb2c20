//! Findings on a recording or a result: each has numbers, and from them follow its code, severity, effect and
//! sentence.

/// Declares an enum of findings: after each arrow its code, its severity and its [`Effect`], then its
/// sentence, in the syntax of `format`. `of` names their kind if they do not belong to a channel.
macro_rules! findings {
    (
        $(#[$of_enum:meta])*
        pub enum $name:ident $(of $kind:ident)? {$(
            $(#[$of_variant:meta])*
            $variant:ident $({ $($field:ident: $type:ty),* $(,)? })? $(($inner:ident: $inner_type:ty))?
                => $row:expr, ($($sentence:tt)*);
        )*}
    ) => {
        $(#[$of_enum])*
        #[derive(Debug, Clone, PartialEq)]
        #[allow(missing_docs, reason = "a field's name says what it is, the variant's words the rest")]
        pub enum $name {$(
            $(#[$of_variant])*
            $variant $({ $($field: $type),* })? $(($inner_type))?,
        )*}

        impl $name {
            /// Check, severity, and effect of the finding.
            #[allow(unused_variables, clippy::match_same_arms, reason = "a variant's fields, one arm each")]
            pub(super) fn row(&self) -> super::FindingRow {
                #[allow(unused_imports, clippy::enum_glob_use, reason = "few need all")]
                use {super::Effect::*, Severity::*};
                let (code, severity, effect) = match self {$(
                    Self::$variant $({ $($field),* })? $(($inner))? => $row,
                )*};
                super::FindingRow(code, severity, effect)
            }
        }

        impl std::fmt::Display for $name {
            #[allow(unused_variables, reason = "not every number of a variant is told")]
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                match self {$(
                    Self::$variant $({ $($field),* })? $(($inner))? => write!(f, $($sentence)*),
                )*}
            }
        }

        $(impl From<$name> for super::Finding {
            fn from(found: $name) -> Self {
                let (row, message) = (found.row(), found.to_string());
                Self::build(super::FindingKind::$kind(found), row, &message)
            }
        })?
    };
}

mod attribute;
mod channel;
mod clock;
mod code;
mod drop;
mod effect;
mod mcap;
mod rest;
mod table;
mod times;

pub use attribute::AttributeFinding;
pub use channel::{ChannelFinding, DropPart, RotationCause};
pub use clock::{ClockFinding, RatesApart, TimeDisagreement, TimesApart};
pub use code::{CODES, IssueCode, Severity};
pub use drop::DropFinding;
pub use effect::{Effect, ResultPart};
pub(crate) use mcap::two_units;
pub use mcap::{FileEnd, McapFinding};
pub use rest::{RestCause, RestFinding};
pub use table::TableFinding;
pub use times::{Jitter, TimesFinding};

use serde::Serialize;
use std::borrow::Cow;

/// Kind of a finding, with the numbers of its check; code, severity and sentence follow from these here
/// alone.
#[derive(Debug, Clone, PartialEq)]
pub enum FindingKind {
    /// About one channel.
    Channel(ChannelFinding),
    /// About the drop, its motion or its prediction.
    Drop(DropFinding),
    /// About the times of a recording.
    Times(TimesFinding),
    /// About the sources of time.
    Clock(ClockFinding),
    /// About an MCAP file, its chunks and its messages.
    Mcap(McapFinding),
    /// About the rows of a table.
    Table(TableFinding),
    /// About the attributes of an HDF5 dataset.
    Attribute(AttributeFinding),
    /// About a recording at rest.
    Rest(RestFinding),
}

/// Row of a finding except its sentence: check, severity, and effect.
struct FindingRow(IssueCode, Severity, Effect);

/// One finding about a recording or a result; a row of `quality` in the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Kind of the finding, with its numbers.
    #[serde(skip)]
    pub what: FindingKind,
    /// Check that reports the finding.
    pub code: IssueCode,
    /// Severity; far from the event it is lower than the finding alone would have.
    pub severity: Severity,
    /// Parts of the result that it removes; for a velocity step fewer if the other channels determine it.
    #[serde(rename = "takes")]
    pub effect: Effect,
    /// Name of the channel in the cask file, if the finding concerns one.
    pub channel: Option<String>,
    /// One sentence: the finding, its size, and the action to take.
    pub message: String,
    /// Start of the span it concerns, s from the recording's first sample.
    pub from_s: Option<f64>,
    /// End of that span, s from the recording's first sample.
    pub to_s: Option<f64>,
}

impl ChannelFinding {
    /// Attributes the finding to the named channel.
    pub fn tag(self, channel: &str) -> Finding {
        let (row, message) = (self.row(), self.sentence(channel));
        Finding::build(FindingKind::Channel(self), row, &message).tag(channel)
    }
}

impl Finding {
    fn build(what: FindingKind, FindingRow(code, severity, effect): FindingRow, message: &str) -> Self {
        let message = shorten(message).into_owned();
        Self { what, code, severity, effect, channel: None, message, from_s: None, to_s: None }
    }

    /// True if the finding removes a part of the result.
    pub fn removes(&self, part: ResultPart) -> bool {
        self.effect.parts().contains(&part)
    }

    /// The sentence, preceded by the name of its channel if the sentence does not contain it.
    pub fn with_channel(&self) -> String {
        let unnamed = self.channel.as_ref().filter(|channel| !self.message.contains(&channel[..]));
        unnamed.map_or_else(|| self.message.clone(), |channel| format!("{channel}: {}", self.message))
    }

    /// Attributes the finding to one channel.
    pub fn tag(mut self, channel: &str) -> Self {
        self.channel = Some(channel.to_owned());
        self
    }

    /// Attributes the finding to a span of time, s from the recording's first sample.
    pub fn span(mut self, from_s: f64, to_s: f64) -> Self {
        self.from_s = Some(from_s);
        self.to_s = Some(to_s);
        self
    }
}

/// Shortens the middle of a message that quotes more of a file than a person reads: 600 characters are eight
/// lines.
pub fn shorten(message: &str) -> Cow<'_, str> {
    const MOST_BYTES: usize = 600;
    if message.len() <= MOST_BYTES {
        return message.into();
    }
    let from = message.floor_char_boundary(MOST_BYTES / 2);
    let to = message.ceil_char_boundary(message.len() - MOST_BYTES / 2);
    format!("{} … {}", &message[..from], &message[to..]).into()
}
