//! What speaks against a recording or a result, with its numbers, to its code, its severity, its effect and
//! its sentence.

/// An enum of findings: behind the arrow of each its code, its severity and its [`Effect`], then its
/// sentence, as `format` takes it. `of` names their kind where they are not of one channel.
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
            /// The check that speaks, its severity, and what it takes away.
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
                Self::made(super::FindingKind::$kind(found), row, &message)
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
pub use channel::{ChannelFinding, During, RotationCause};
pub use clock::{ClockFinding, HowApart, RatesApart, TimesApart};
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

/// What was found: the check's numbers. Code, severity and sentence are made of them here alone.
#[derive(Debug, Clone, PartialEq)]
pub enum FindingKind {
    /// About one channel.
    Channel(ChannelFinding),
    /// About the drop, its motion or its prediction.
    Drop(DropFinding),
    /// About the times of a recording.
    Times(TimesFinding),
    /// About what says when samples were taken.
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

/// A finding's row but for its sentence: the check that speaks, the severity, and the effect.
struct FindingRow(IssueCode, Severity, Effect);

/// One finding about a recording or a result; a row of `quality` in the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What it is, with its numbers.
    #[serde(skip)]
    pub what: FindingKind,
    /// Which check speaks.
    pub code: IssueCode,
    /// How much it weighs; far from the event less than what was found would by itself.
    pub severity: Severity,
    /// What it takes away; of a velocity step less where the other channels determine it.
    #[serde(rename = "takes")]
    pub effect: Effect,
    /// The channel's name in the cask file, where it concerns one.
    pub channel: Option<String>,
    /// One sentence: what was found, its size, and what to do.
    pub message: String,
    /// Start of the span it concerns, s from the recording's first sample.
    pub from_s: Option<f64>,
    /// End of that span, s from the recording's first sample.
    pub to_s: Option<f64>,
}

impl ChannelFinding {
    /// The finding, about the channel of that name.
    pub fn on(self, channel: &str) -> Finding {
        let (row, message) = (self.row(), self.sentence(channel));
        Finding::made(FindingKind::Channel(self), row, &message).on(channel)
    }
}

impl Finding {
    fn made(what: FindingKind, FindingRow(code, severity, effect): FindingRow, message: &str) -> Self {
        let message = shortened(message).into_owned();
        Self { what, code, severity, effect, channel: None, message, from_s: None, to_s: None }
    }

    /// True if it takes a part of the result away.
    pub fn takes(&self, part: ResultPart) -> bool {
        self.effect.takes().contains(&part)
    }

    /// Its sentence, behind the name of its channel where the sentence does not name it.
    pub fn with_channel(&self) -> String {
        let unnamed = self.channel.as_ref().filter(|channel| !self.message.contains(&channel[..]));
        unnamed.map_or_else(|| self.message.clone(), |channel| format!("{channel}: {}", self.message))
    }

    /// The same, about one channel.
    pub fn on(mut self, channel: &str) -> Self {
        self.channel = Some(channel.to_owned());
        self
    }

    /// The same, about a span of time, s from the recording's first sample.
    pub fn between(mut self, from_s: f64, to_s: f64) -> Self {
        self.from_s = Some(from_s);
        self.to_s = Some(to_s);
        self
    }
}

/// A message with its middle left out where it quotes more of a file than a person reads: 600 characters are
/// eight lines.
pub fn shortened(message: &str) -> Cow<'_, str> {
    const MOST_BYTES: usize = 600;
    if message.len() <= MOST_BYTES {
        return message.into();
    }
    let from = message.floor_char_boundary(MOST_BYTES / 2);
    let to = message.ceil_char_boundary(message.len() - MOST_BYTES / 2);
    format!("{} … {}", &message[..from], &message[to..]).into()
}
