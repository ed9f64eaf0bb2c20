//! `[simulation]` to the file of a calculation and the column of each channel in it.

use super::section::Section;
use crate::data::{ChannelSpec, SimulationSpec, Source, Unit};
use crate::ingest::IngestError;
use std::path::Path;

const UNITS: &str = "unit = \"m/s^2\" or \"g\"";

/// The table, if there is one; its file is looked for in `folder`.
pub(super) fn simulation(
    root: &Section,
    folder: &Path,
    channels: &[ChannelSpec],
) -> Result<Option<SimulationSpec>, IngestError> {
    if root.value("simulation").is_none() {
        return Ok(None);
    }
    let table = root.table("simulation")?;
    let path = folder.join(table.required_text("file")?);
    let unit = table.word("unit", &[("g", Unit::G), ("m/s^2", Unit::MetrePerSecondSquared)], UNITS)?;
    unit.ok_or_else(|| table.without("unit"))?;
    let columns = table.table_as("channels", "columns")?;
    let mut named: Vec<ChannelSpec> = Vec::new();
    for (name, column) in columns.own_names()? {
        let Some(measured) = channels.iter().find(|channel| channel.name == name) else {
            let there: Vec<&str> = channels.iter().map(|channel| &channel.name[..]).collect();
            let message = format!("channels names {name}, which is no accelerometer of this file");
            return Err(columns.refuse(&name, message, &format!("there is: {}", there.join(", "))));
        };
        let source = Source::Path(column);
        if let Some(first) = named.iter().find(|first| first.source == source) {
            let message = format!("{name} has the same column as {}, {source}", first.name);
            return Err(columns.refuse(&name, message, "name each channel's own column"));
        }
        let ChannelSpec { end, axis, position_m, offset_m, .. } = *measured;
        let plain = ChannelSpec::new(&name, end, "", position_m);
        named.push(ChannelSpec { axis, source, unit, offset_m, ..plain });
    }
    if named.is_empty() {
        return Err(table.without("channels"));
    }
    Ok(Some(SimulationSpec { path, time: table.text("time")?, channels: named }))
}
