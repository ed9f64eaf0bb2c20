//! Delimited text to the channels that a cask file names, whatever its delimiter, decimal mark, encoding and
//! preamble.

mod cells;
mod columns;
mod complaint;
mod dialect;
mod even;
mod header;
mod layout;
mod list;
mod pieces;
mod plan;
mod preamble;
mod rows;
mod sensors;
mod stamp;
mod table;
mod time_column;
mod wanted;

pub(super) use list::list;

use super::error::{self, IngestError};
use super::lines::Text;
use super::{RawChannel, RawRecording, ReadRequest};
use crate::data::{CaskFile, ChannelSpec, Finding};
use columns::HeldColumn;
use layout::Layout;
use pieces::Sizes;
use plan::ColumnPlan;
use table::{Refused, Table};
use wanted::Wanted;

/// The channels of `cask_file` from a text.
///
/// # Errors
/// A column that is not there or holds words, rows that are no table, times that are none.
pub(super) fn read(request: ReadRequest, cask_file: &CaskFile) -> Result<RawRecording, IngestError> {
    let ReadRequest { file, limits, .. } = request;
    let (path, text) = (file.path, Text::open(file, limits)?);
    let layout = Layout::of(&text).ok_or_else(|| complaint::no_table(path))?;
    let plan = |spec: &ChannelSpec| {
        let plan = ColumnPlan::of(path, spec, cask_file.time_source(spec), &layout);
        plan.map_err(|refusal| error::of_channel(path, &spec.name, refusal))
    };
    let plans: Vec<ColumnPlan> = cask_file.channels.iter().map(plan).collect::<Result<_, _>>()?;
    let wanted = Wanted::of(&plans, &layout);
    // What is set aside is a guess from the first rows; more is taken as it comes.
    let most_rows = limits.samples_bytes() / (8 * wanted.columns.len().max(1) as u64);
    let rows = layout.rows_expected(text.bytes).min(usize::try_from(most_rows).unwrap_or(usize::MAX));
    let columns = wanted.columns.iter().map(|_| HeldColumn::with_capacity(rows)).collect();
    let mut table = Table::new(&layout, &plans, &wanted, columns);
    let sizes = Sizes::of(limits, text.bytes);
    let ending = rows::read(text, (&layout, &wanted), &mut table, sizes, request.progress)
        .map_err(|error| complaint::row_error(request, (&layout, &wanted), error))?;
    let mut issues = Vec::from_iter(ending.map(Finding::from));
    table.drop_blank().map_err(|refusal| error::of_file(path, refusal.at("the rows")))?;
    let name = |plan: usize| cask_file.channels[plan].name.as_str();
    let refused = |refused: Refused| error::of_channel(path, name(refused.plan), refused.refusal);
    issues.extend(table.settle_times().map_err(refused)?);
    issues.extend(table.place_by_counter().map_err(refused)?);
    let own_rows = table.own_rows().map_err(refused)?;
    let (rows, factors) = (table.rows(), std::mem::take(&mut table.factors));
    let mut channels = Vec::with_capacity(plans.len());
    for (spec, uniform) in table.uniforms(&own_rows).into_iter().enumerate() {
        let uniform = uniform.map_err(|error| error::of_channel(path, name(spec), error))?;
        let unit = layout.columns[plans[spec].column].unit.clone();
        channels.push(RawChannel { uniform, unit, factors: [layout.factors(), factors.clone()].concat() });
    }
    let with_missing = channels.iter().map(|channel| channel.uniform.samples.len()).max().unwrap_or_default();
    issues.extend(layout.preamble.of_rows(rows, with_missing));
    Ok(RawRecording { channels, zero_unix_ns: table.stamps.zero_unix_ns(), issues })
}

#[cfg(test)]
mod piece_tests;
#[cfg(test)]
pub(super) mod tests;
