//! A channel of the cask file to what it takes from the table.

use super::super::{clock::Claims, error, number, refusal::Refusal, times::Scale};
use super::header::TableColumn;
use super::layout::Layout;
use super::time_column;
use crate::data::{ChannelSpec, RowsOf, Source};
use std::path::Path;

/// What one channel takes from the table.
#[derive(Debug, Clone)]
pub(super) struct ColumnPlan {
    pub column: usize,
    pub time_column: Option<usize>,
    /// The column and the word that tell its rows from those of other sensors.
    pub rows: Option<(usize, String)>,
    /// When it begins where no times say it, s.
    pub start_s: f64,
    /// Whether it may end before others, at a rate of its own.
    pub ends_alone: bool,
    /// What is said of its rate apart from its times.
    pub claims: Claims,
}

impl ColumnPlan {
    /// A column with its times, of which the cask file says nothing.
    pub(super) fn of_column(column: usize, time_column: Option<usize>, layout: &Layout) -> Self {
        let Layout { preamble, .. } = layout;
        Self {
            column,
            time_column,
            rows: None,
            start_s: preamble.start_s(column),
            ends_alone: preamble.has_several_rates(),
            claims: Claims { stated: preamble.statements(column), ..Claims::default() },
        }
    }

    /// What `spec` asks for, with the `time` that the cask file names for it.
    pub(super) fn of(
        path: &Path,
        spec: &ChannelSpec,
        time: Option<&str>,
        layout: &Layout,
    ) -> Result<Self, Refusal> {
        let Source::Path(source) = &spec.source else {
            let mend = "write the column's header: source = \"A1\"";
            return Err(Refusal::new(
                "source gives a topic and a field, but this recording is a table",
                mend,
            ));
        };
        let column = find(path, source, layout)?;
        let time_column = match time {
            Some(name) => Some(find(path, name, layout)?),
            None => layout.time_of(column),
        };
        let of_rows = |rows: &RowsOf| Ok((find(path, &rows.column, layout)?, rows.is.clone()));
        let rows = spec.rows.as_ref().map(of_rows).transpose()?;
        let taken = [Some(column), time_column].into_iter().flatten().collect::<Vec<_>>();
        let own = rows.as_ref().map(|(column, is)| (*column, is.as_str()));
        if let Some((header, named)) = layout.mixed(own, &taken) {
            let choice = RowsOf { column: header.to_owned(), is: named[0].to_owned() };
            return Err(Refusal::new(
                format!(
                    "its rows are of several sensors: the column {header:?} holds {}",
                    error::handful(&named)
                ),
                match own {
                    None => format!("take those of one: {choice}"),
                    Some(_) => "write the rows of each sensor into a file of its own".into(),
                },
            ));
        }
        let plan = Self::of_column(column, time_column, layout);
        let (cask_hz, are_times_named) = (spec.sample_rate_hz, time.is_some());
        let claims = Claims { cask_hz, are_times_named, ..plan.claims };
        if time_column.is_none() && claims.is_empty() {
            let (why, mend) = match no_times(layout) {
                Some(why) => (format!(": {why}"), "correct it in a copy"),
                None => (
                    format!(" among {}", layout.names().join(", ")),
                    "name it under [recording]: time = \"…\"",
                ),
            };
            let problem = format!("no column of times was found{why}");
            return Err(Refusal::new(problem, format!("{mend}, or give this channel sample_rate_hz")));
        }
        Ok(Self { rows, claims, ..plan })
    }

    /// Whether the cask file says what to go by: a rate, or which column holds the times.
    pub(super) fn is_decided(&self) -> bool {
        self.claims.cask_hz.is_some() || self.claims.are_times_named
    }
}

/// The column with that header, with or without its unit, or with that number where there are no headers.
fn find(path: &Path, wanted: &str, layout: &Layout) -> Result<usize, Refusal> {
    let found = layout.find(wanted);
    match found.as_slice() {
        [one] => Ok(*one),
        [] => Err(Refusal::new(
            match &layout.header {
                Ok(line) => format!("no column is headed {wanted:?} (the header is line {line})"),
                Err(unfit) => format!(
                    "there is no column {wanted:?}: the table has no header of {} cells, as its rows \
                     have{unfit}; its columns count 1, 2, …",
                    layout.columns.len()
                ),
            },
            error::near_names(path, wanted, "column", &layout.names()),
        )),
        several => Err(Refusal::new(
            format!("{} columns are headed {wanted:?}", several.len()),
            "rename all but one of them in a copy of the recording",
        )),
    }
}

/// No row is of the sensor `is`.
pub(super) fn no_such_sensor(layout: &Layout, column: usize, is: &str) -> Refusal {
    let named = layout.sensors.iter().find(|it| it.column == column).map_or(Vec::new(), |it| it.named(None));
    let header = &layout.columns[column].header;
    let problem = format!("no row has {is:?} in the column {header:?}");
    let Some(first) = named.first() else { return Refusal::new(problem, "write a word that stands there") };
    let choice = RowsOf { column: header.clone(), is: (*first).to_owned() };
    let mend = format!("write a word that stands there, as {choice}");
    Refusal::new(format!("{problem}, which holds {}", error::handful(&named)), mend)
}

/// That no column holds times, with the one that looks most like it.
pub(super) fn no_times(layout: &Layout) -> Option<String> {
    let is_like = |(at, column): &(usize, &TableColumn)| {
        time_column::is_headed(column) && layout.times.taken != Some(*at)
    };
    let (_, column) = layout.columns.iter().enumerate().find(is_like)?;
    let TableColumn { header, example, .. } = column;
    match &column.unit {
        _ if !column.is_numeric && example.is_empty() => None,
        _ if !column.is_numeric => {
            let decimal = layout.dialect.decimal;
            let why = if number::is_grouped(example, Some(decimal)) {
                "a number whose thousands are marked too"
            } else if number::of_cell(example.as_bytes(), if decimal == b',' { b'.' } else { b',' }).is_some()
            {
                "whose decimal mark is not that of the samples"
            } else {
                "which is no time known here"
            };
            Some(format!("{header:?} holds {example:?}, {why}"))
        }
        Some(unit) if time_column::scale(column) == Scale::Unknown => Some(format!(
            "{header:?} is in {unit}, which is none of time known here ([s], [ms], [µs] and [ns] are)"
        )),
        _ => Some(format!("{header:?} does not rise from row to row")),
    }
}
