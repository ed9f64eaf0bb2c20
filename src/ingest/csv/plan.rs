//! A channel of the cask file to what it takes from the table.

use super::super::error::{self, IngestError};
use super::super::stated_rate::StatedRate;
use super::complaint;
use super::layout::Layout;
use crate::data::{ChannelSpec, Source};
use crate::ingest::time_reading::Scale;
use std::path::Path;

/// What one channel takes from the table.
pub(super) struct Plan {
    pub column: usize,
    pub time_column: Option<usize>,
    /// Hz.
    pub declared_rate_hz: Option<f64>,
    /// What the header states, whether or not it is taken.
    pub stated: Option<StatedRate>,
    /// Whether the cask file says what to go by: a rate, or which column holds the times.
    pub is_settled: bool,
}

impl Plan {
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
        let time_column = match spec.time.as_deref().or(time) {
            Some(name) => Some(find(path, spec, name, layout)?),
            None => layout.time_of(column),
        };
        if let Some(found) = time_column
            && layout.time_scale(found) == Scale::Unknown
        {
            return Err(error::source(
                path,
                &spec.name,
                format!(
                    "the times in column {:?} are in {:?}, which is no unit of time known here",
                    layout.columns[found].header,
                    layout.columns[found].unit.as_deref().unwrap_or("")
                ),
                "head the column with [s], [ms], [µs] or [ns], or give sample_rate_hz and another time column",
            ));
        }
        if spec.sample_rate_hz.is_none()
            && let Some(found) = time_column
            && let Scale::Twofold(..) = layout.time_scale(found)
        {
            let (problem, mend) = complaint::twofold(&layout.columns[found]);
            return Err(error::source(path, &spec.name, problem, mend));
        }
        let stated = layout.stated_rate(column).cloned();
        let stated_hz = stated.as_ref().filter(|_| time_column.is_none()).map(|stated| stated.rate_hz);
        let declared_rate_hz = spec.sample_rate_hz.or(stated_hz);
        if time_column.is_none() && declared_rate_hz.is_none() {
            return Err(error::source(
                path,
                &spec.name,
                complaint::no_times(layout),
                "name it under [recording]: time = \"…\", or give this channel sample_rate_hz",
            ));
        }
        let is_settled = spec.sample_rate_hz.is_some() || spec.time.is_some() || time.is_some();
        Ok(Self { column, time_column, declared_rate_hz, stated, is_settled })
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
            if layout.has_header {
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
