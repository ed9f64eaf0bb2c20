//! A channel of the cask file to what it takes from the table.

use super::super::clock::Claims;
use super::super::error::{self, IngestError};
use super::layout::Layout;
use super::time_column;
use crate::data::{ChannelSpec, Source};
use std::path::Path;

/// What one channel takes from the table.
pub(super) struct ColumnPlan {
    pub column: usize,
    pub time_column: Option<usize>,
    /// What is said of its rate apart from its times.
    pub claims: Claims,
}

impl ColumnPlan {
    /// What `spec` asks for, with the times that the cask file names for all channels.
    pub(super) fn of(
        path: &Path,
        spec: &ChannelSpec,
        time: Option<&str>,
        layout: &Layout,
    ) -> Result<Self, IngestError> {
        let Source::Path(source) = &spec.source else {
            return Err(error::source(
                path,
                &spec.name,
                "source gives a topic and a field, but this recording is a table",
                "write the column's header: source = \"A1\"",
            ));
        };
        let column = find(path, spec, source, layout)?;
        let named = spec.time.as_deref().or(time);
        let time_column = match named {
            Some(name) => Some(find(path, spec, name, layout)?),
            None => layout.time_of(column),
        };
        let claims = Claims {
            cask_hz: spec.sample_rate_hz,
            are_times_named: named.is_some(),
            stated: layout.preamble.statements(column),
        };
        if time_column.is_none() && claims.is_empty() {
            return Err(error::source(
                path,
                &spec.name,
                no_times(layout),
                "name it under [recording]: time = \"…\", or give this channel sample_rate_hz",
            ));
        }
        Ok(Self { column, time_column, claims })
    }

    /// Whether the cask file says what to go by: a rate, or which column holds the times.
    pub(super) fn is_decided(&self) -> bool {
        self.claims.cask_hz.is_some() || self.claims.are_times_named
    }
}

/// The column with that header, with or without its unit, or with that number where there are no headers.
fn find(path: &Path, spec: &ChannelSpec, wanted: &str, layout: &Layout) -> Result<usize, IngestError> {
    let found = layout.find(wanted);
    match found.as_slice() {
        [one] => Ok(*one),
        [] => Err(error::source(
            path,
            &spec.name,
            if layout.header_line > 0 {
                format!("no column is headed {wanted:?} (the header is line {})", layout.header_line)
            } else {
                format!(
                    "there is no column {wanted:?}: the table has no header of {} cells, as its rows have; its columns count 1, 2, …",
                    layout.columns.len()
                )
            },
            error::near_names(path, wanted, "column", &layout.names()),
        )),
        several => Err(error::source(
            path,
            &spec.name,
            format!("{} columns are headed {wanted:?}", several.len()),
            "rename all but one of them in a copy of the recording",
        )),
    }
}

/// That no column holds times, with the one that looks most like it.
fn no_times(layout: &Layout) -> String {
    let headed = layout.columns.iter().find(|column| time_column::is_headed(column));
    match headed.filter(|column| !column.is_numeric && !column.example.is_empty()) {
        Some(column) => {
            format!(
                "no column of times was found: {:?} holds {:?}, which is no time known here",
                column.header, column.example
            )
        }
        None => format!("no column of times was found among {}", layout.names().join(", ")),
    }
}
