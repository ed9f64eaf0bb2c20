//! The channels that take no part in the motion to a table of what each reads.

use super::document::{Chapter, ChapterPart, Medium, ReportTable, Words};
use super::rounding::{MISSING, optional, optional_fixed, plain, significant};
use super::text::json_word;
use crate::data::{DropResult, Extreme, OtherSummary, SpectralLine};

const CAPTION: &str = "As recorded, each in its unit: but for angular-rate sensors they take no part in the \
                       motion, and findings on them change no number of it. Rest: the median before the \
                       release, or before the first contact where the release is not seen; noise: RMS about \
                       it; smallest and largest of the whole recording. The strongest line is that of the \
                       curve's spectrum.";

/// What each of them reads, and their curves; empty where there are none.
pub(super) fn others(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("Other channels");
    if result.other_channels.is_empty() {
        return chapter;
    }
    let value = |extreme: Option<Extreme>| optional(extreme.map(|e| e.value), 4);
    let at_ms = |extreme: Option<Extreme>| optional_fixed(extreme.map(|e| 1e3 * e.time_s), 2);
    let line = |line: SpectralLine| format!("{} Hz", significant(line.frequency_hz, 3));
    let codes = |other: &OtherSummary| -> Vec<String> { other.findings.iter().map(json_word).collect() };
    let table = ReportTable::of(&result.other_channels)
        .class("")
        .caption(CAPTION)
        .head(Words::or("Channel", "channel"), |c| &c.name[..])
        .text(Words::or("Unit", "unit"), |c| &c.unit[..])
        .code("Source", |c| &c.source[..])
        .only(Medium::Page)
        .number("Rate", |c| format!("{} Hz", plain(c.sample_rate_hz, 6)))
        .only(Medium::Page)
        .number(Words::or("Rest", "rest"), |c| optional(c.rest, 4))
        .number(Words::or("Noise", "noise"), |c| optional(c.noise, 2))
        .number(Words::or("Smallest", "smallest"), |c| value(c.smallest))
        .number("at ms", |c| at_ms(c.smallest))
        .number(Words::or("Largest", "largest"), |c| value(c.largest))
        .number("at ms", |c| at_ms(c.largest))
        .number("Strongest line", |c| c.strongest_line.map_or_else(|| MISSING.to_owned(), line))
        .only(Medium::Page)
        .text("Serial", |c| c.sensor.serial.clone().unwrap_or_else(|| MISSING.to_owned()))
        .only(Medium::Page)
        .code("Findings", |c| if c.findings.is_empty() { MISSING.to_owned() } else { codes(c).join(" ") })
        .only(Medium::Page);
    chapter.with(table).with(ChapterPart::picture("other_channels", ""))
}
