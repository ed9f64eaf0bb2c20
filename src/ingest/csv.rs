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
use layout::Layout;
use plan::ColumnPlan;
use table::{Refused, Table};
use wanted::Wanted;

/// The channels of `cask_file` from a text.
///
/// # Errors
/// A column that is not there or holds words, rows that are no table, times that are none.
pub(super) fn read(request: ReadRequest, cask_file: &CaskFile) -> Result<RawRecording, IngestError> {
    let path = request.file.path;
    let text = Text::open(request.file, request.limits)?;
    let layout = Layout::of(&text).ok_or_else(|| complaint::no_table(path))?;
    let plan = |spec: &ChannelSpec| {
        let plan = ColumnPlan::of(path, spec, cask_file.time_source(spec), &layout);
        plan.map_err(|refusal| error::of_channel(path, &spec.name, refusal))
    };
    let plans: Vec<ColumnPlan> = cask_file.channels.iter().map(plan).collect::<Result<_, _>>()?;
    let wanted = Wanted::of(&plans, &layout, false);
    let mut table = Table::new(&layout, &plans, &wanted);
    let mut issues = Vec::from_iter(table.read(text, request)?.map(Finding::from));
    table.drop_blank().map_err(|refusal| error::of_file(path, refusal.at("the rows")))?;
    let name = |plan: usize| cask_file.channels[plan].name.as_str();
    let refused = |refused: Refused| error::of_channel(path, name(refused.plan), refused.refusal);
    issues.extend(table.settle().map_err(refused)?);
    let (rows, factors) = (table.rows(), std::mem::take(&mut table.factors));
    let mut channels = Vec::with_capacity(plans.len());
    for (spec, uniform) in table.uniforms().into_iter().enumerate() {
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
