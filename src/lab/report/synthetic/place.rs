//! Channel names to places in a recording: topics, datasets, columns, and what a cask file calls them.

use crate::lab::data::SyntheticRecording;

/// How a synthetic recording is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SyntheticFormat {
    /// MCAP with blocks in JSON.
    McapJson,
    /// MCAP with blocks in protobuf.
    McapProtobuf,
    /// HDF5, a dataset a channel.
    Hdf5,
    /// CSV, a column a channel.
    Csv,
}

/// Where a channel stands.
pub(super) struct SyntheticPlace {
    /// Name within the format: of the topic or dataset below `/daq/`, or of the column.
    pub name: String,
    /// The source as the cask file writes it.
    pub source: String,
    /// Times of its own, as the cask file writes them, where the format does not tell.
    pub time: Option<String>,
}

/// A place for every channel.
pub(super) fn places(recording: &SyntheticRecording, format: SyntheticFormat) -> Vec<SyntheticPlace> {
    let mut taken: Vec<String> = vec!["time".into(), "time_s".into()];
    let mut places = Vec::new();
    for channel in &recording.channels {
        let name = unused(&channel.name, &taken);
        taken.push(name.to_lowercase());
        let has_own_times = channel.start_s > 0.0;
        let has_gaps = channel.samples.iter().any(|x| x.is_nan());
        let (source, time) = match format {
            SyntheticFormat::McapJson | SyntheticFormat::McapProtobuf => {
                (format!("/daq/{name}.samples"), None)
            }
            SyntheticFormat::Hdf5 => (format!("/daq/{name}"), has_gaps.then(|| format!("/time_s/{name}"))),
            SyntheticFormat::Csv => {
                let time = if has_own_times { format!("time_{name}_s") } else { "time_s".into() };
                (name.clone(), Some(time))
            }
        };
        places.push(SyntheticPlace { name, source, time });
    }
    places
}

/// The name with only letters, digits, `_` and `-`, in no case like another's.
fn unused(name: &str, taken: &[String]) -> String {
    let mut name: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
    // A bare number would count columns, and a spreadsheet would compute with a minus in front.
    if name.bytes().all(|b| b.is_ascii_digit()) || name.starts_with('-') {
        name.insert(0, 'A');
    }
    while taken.contains(&name.to_lowercase()) {
        name.push('_');
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_channels_share_a_place() {
        assert_eq!(unused("left.side", &[]), "left_side");
        assert_eq!(unused("Left side", &["left_side".into()]), "Left_side_");
        assert_eq!(unused("12", &[]), "A12");
        assert_eq!(unused("time_s", &["time_s".into()]), "time_s_");
    }
}
