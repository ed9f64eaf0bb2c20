//! Head of the report from the test record in the cask file, its sensors and other channels, its settings,
//! its photographs and its lines to sign.

use super::document::{Chapter, ChapterPart, Fact, PartContent, ReportTable, TableCell};
use super::rounding::{MISSING, interval, optional, optional_fixed, plain, significant};
use super::text::{Style, json_word, or_unknown};
use super::words::contact_words;
use crate::data::keys::quantity_words;
use crate::data::{
    CaskFile, Contact, Contribution, DropResult, Extreme, Limit, LimitState, ObservedBeside, OtherSummary,
    Photo, Program, Setting, SpectralLine, TOLERANCES, TestRecord,
};

/// Heading of the report: the test's number and title, or cask and drop if they are not stated.
pub(super) fn heading(test: &TestRecord, cask: &str, is_slap_down: bool) -> String {
    let usual = if is_slap_down { "slap-down drop test" } else { "drop test" };
    let title = test.title.as_deref().unwrap_or(usual);
    format!("{}: {title}", test.id.as_deref().unwrap_or(cask))
}

/// Formats "2026-11-22, 18:04 +01:00" from a date in the form of RFC 3339.
fn date_words(date: &str) -> String {
    let Some((day, time)) = date.split_once(['T', 't', ' ']) else { return date.to_owned() };
    let zone = time.find(['Z', 'z', '+', '-']).map_or("", |at| &time[at..]);
    format!("{day}, {} {zone}", time.get(..5).unwrap_or(time)).trim_end().to_owned()
}

/// Chapter on persons, specimen, place, date and limits; it names entries that the cask file lacks.
pub(super) fn head(result: &DropResult) -> Chapter {
    let test = &result.test;
    let date = test.date.as_deref().map(date_words);
    let temperature = test.temperature_c.map(|t| format!("{} °C", plain(t, 4)));
    let not_stated = |words: &Option<String>| Some(words.clone().unwrap_or_else(|| "not stated".to_owned()));
    let no_limits = result.limits.is_empty().then(|| "none stated".to_owned());
    let words = [
        ("Date of the test", not_stated(&date)),
        ("Place", test.place.clone()),
        ("Carried out by", not_stated(&test.operator)),
        ("Customer", not_stated(&test.customer)),
        ("Specimen", not_stated(&test.specimen)),
        ("Temperature of the specimen", temperature),
        ("Target", test.target.clone()),
        ("Limits", no_limits),
        ("Remarks", test.remarks.clone()),
        ("Analysed", Some(program(result))),
    ];
    let stated = words.into_iter().filter_map(|(name, words)| Some(Fact::words(name, words?)));
    let more = test.more.iter().map(|(name, words)| Fact::words(name, words));
    let part = |i: usize| move |row: &String| row.splitn(3, ',').nth(i).unwrap_or(MISSING).trim().to_owned();
    let revisions = ReportTable::from_rows(&test.revisions)
        .caption("Revisions of this report")
        .head("Date", part(0))
        .text("Program", part(1))
        .text("What changed", part(2));
    Chapter::new("The test").then(ChapterPart::facts("", stated.chain(more).collect())).then(revisions)
}

/// Formats "dropcheck 0.1.0 (0123abc), 2026-11-24T02:00:00Z".
pub(super) fn program(result: &DropResult) -> String {
    let program = result.program.as_ref();
    let words = program.map_or_else(|| format!("dropcheck {}", result.version), Program::words);
    result.analysed.as_ref().map_or_else(|| words.clone(), |when| format!("{words}, {when}"))
}

/// Chapter on the independent observations beside the result.
pub(super) fn observed(all: &[ObservedBeside]) -> Chapter {
    let agrees = |seen: &ObservedBeside| match seen.e_n {
        None => MISSING,
        Some(e_n) if e_n.abs() <= 1.0 => "yes",
        Some(_) => "no",
    };
    let table = ReportTable::from_rows(all)
        .class("")
        .caption("E_n: the difference over both half-widths together; within ±1 they agree.")
        .head("Quantity", |seen| quantity_words(seen.name))
        .number("Observed", |seen| interval(Some(&seen.observed)))
        .text("By", |seen| seen.by.as_deref().unwrap_or(MISSING))
        .number("Result", |seen| interval(seen.result.as_ref()))
        .number("E_n", |seen| optional_fixed(seen.e_n, 2))
        .text("Agree", agrees);
    Chapter::new("Observed otherwise").then(table)
}

/// The word for a limit that is exceeded.
pub(super) const LIMIT_EXCEEDED: &str = "LIMIT EXCEEDED";

/// The decision rule by which a limit is kept or exceeded.
const GUARD_BAND: &str = "Rule: guard band of ± (JCGM 106:2012, 8.3)";

const LIMITS_CAPTION: &str = "Exceeded: the whole interval lies beyond the customer's limit. Kept: all of it \
                              lies within. Undecided: it holds the limit, or the quantity is not determined. \
                              Deceleration (at the centre of gravity), force, crush, energy: the larger of \
                              both impacts'.";

/// Lists the limits that are exceeded, then those undecided, up to `most` in full, then the number of those
/// kept and the rule that decided; `None` without limits.
pub(super) fn limits_sentence(all: &[Limit], most: usize) -> Option<String> {
    let words = |limit: &Limit| {
        let bounds = [limit.least.map(|of| ("at least", of)), limit.most.map(|of| ("at most", of))];
        let bounds = bounds.into_iter().flatten().map(|(word, of)| format!("{word} {}", plain(of, 6)));
        let bounds = bounds.collect::<Vec<_>>().join(", ");
        let unit = limit.measured.map_or("", |of| of.unit).trim_matches('1');
        let measured = or_unknown(interval(limit.measured.as_ref()));
        format!("{} {measured} ({})", quantity_words(limit.name), format!("{bounds} {unit}").trim_end())
    };
    let in_state = |state| all.iter().filter(move |limit| limit.state == state);
    let undecided = in_state(LimitState::Undecided).map(|limit| format!("undecided: {}", words(limit)));
    let mut sentences: Vec<String> = in_state(LimitState::Exceeded).map(words).chain(undecided).collect();
    let (more, kept) = (sentences.len().saturating_sub(most), in_state(LimitState::Kept).count());
    sentences.truncate(most);
    sentences.extend((more > 0).then(|| format!("{more} more (`--full`)")));
    sentences.extend((kept > 0).then(|| format!("{kept} kept")));
    (!sentences.is_empty()).then(|| format!("{}. {GUARD_BAND}.", sentences.join("; ")))
}

/// Chapter on the measured values and the customer's limits.
pub(super) fn limits(all: &[Limit]) -> Chapter {
    let state = |row: &Limit| {
        let style = [Style::Green, Style::Red, Style::Yellow][row.state as usize];
        TableCell::tone(style, json_word(row.state))
    };
    let bound = |bound: Option<f64>| bound.map_or_else(|| MISSING.to_owned(), |bound| plain(bound, 6));
    let table = ReportTable::from_rows(all)
        .class("")
        .caption(format!("{GUARD_BAND}. {LIMITS_CAPTION}"))
        .head("Quantity", |row| quantity_words(row.name))
        .number("Measured", |row| interval(row.measured.as_ref()))
        .number("Least", |row| bound(row.least))
        .number("Most", |row| bound(row.most))
        .text("Limit", state);
    Chapter::new("Limits").then(table)
}

/// The settings that the chapter has already.
pub(super) const TOLD: [&str; 9] = [
    "mass",
    "length",
    "section in the plane of the drop",
    "centre of gravity from the first end",
    "inertia",
    "drop angle",
    "impact velocity",
    "gravity",
    "contact law of the first end",
];

/// Chapter on the cask, the drop and the contact, with defaults marked.
pub(super) fn test_chapter(file: &CaskFile, heading: &str) -> Chapter {
    let (cask, drop) = (&file.cask, &file.drop);
    let fact = |name: &str, key: &str, value: String, unit: &str| Fact {
        is_default: file.defaults.iter().any(|d| d == key),
        ..Fact::number(name, value).note(unit)
    };
    let is_rod = cask.height_m <= 0.0;
    let section = if is_rod { "thin rod".into() } else { plain(cask.height_m, 5) };
    let velocity =
        if drop.impact_velocity_given { "Impact velocity, as stated" } else { "Impact velocity, √(2 g h)" };
    let mut of_cask = vec![
        fact("Mass", "cask.mass_kg", plain(cask.mass_kg, 6), "kg"),
        fact("Length between the ends that strike", "cask.length_m", plain(cask.length_m, 6), "m"),
        fact("Section in the plane of the drop", "cask.height_m", section, if is_rod { "" } else { "m" }),
        fact("Centre of gravity from the first end", "cask.cog_m", plain(cask.cog_m, 6), "m"),
        fact(
            "Inertia about the centre of gravity",
            "cask.inertia_kg_m2",
            plain(cask.inertia_kg_m2, 6),
            "kg\u{a0}m²",
        ),
    ];
    if let Some(width_m) = cask.width_m {
        of_cask.insert(3, fact("Section across that plane", "cask.width_m", plain(width_m, 6), "m"));
    }
    let mut of_drop = vec![
        fact("Free-fall height", "drop.height_m", plain(drop.height_m, 6), "m"),
        fact("Inclination of the axis", "drop.angle_deg", plain(drop.angle_rad.to_degrees(), 6), "°"),
        fact(velocity, "drop.impact_velocity", plain(drop.impact_velocity_m_s, 5), "m/s"),
        fact("Gravity", "drop.gravity_m_s2", plain(drop.gravity_m_s2, 6), "m/s²"),
        fact("Contact of the first end", "contact.friction", contact_words(file.contact), ""),
    ];
    if drop.contact_duration_s > 0.0 {
        let lasts_ms = plain(1e3 * drop.contact_duration_s, 5);
        of_drop.push(fact("First impact lasts", "contact.duration_s", lasts_ms, "ms"));
    }
    Chapter::new(heading).then(PartContent::Beside([
        vec![ChapterPart::facts(format!("Cask {}", cask.name), of_cask)],
        vec![ChapterPart::facts("Drop and contact", of_drop)],
    ]))
}

/// Table of the sensors: place, direction of reading, and calibration papers.
pub(super) fn sensors(file: &CaskFile) -> ChapterPart {
    let stated = |words: &Option<String>| words.clone().unwrap_or_else(|| MISSING.to_owned());
    ReportTable::from_rows(&file.channels)
        .class("")
        .caption(
            "Sensors: places from the first end along the axis and off it, the sign of a reading away \
                  from the target or towards the second end.",
        )
        .head("Channel", |s| &s.name[..])
        .text("End, axis", |s| format!("{}, {}", json_word(s.end), json_word(s.axis)))
        .number("Place, m", |s| plain(s.position_m, 5))
        .number("Off axis, m", |s| plain(s.offset_m, 5))
        .text("Sign", |s| if s.polarity < 0.0 { "−" } else { "+" })
        .text("Serial", |s| stated(&s.sensor.serial))
        .text("Certificate", |s| stated(&s.sensor.certificate))
        .text("Calibrated", |s| stated(&s.sensor.calibrated))
        .number("Calibration ± 95 %", |s| format!("{} %", plain(100.0 * file.scale_half_width(&s.name), 3)))
        .into()
}

/// The photographs that the cask file names, if they could be read.
pub(super) fn photographs(test: &TestRecord) -> impl Iterator<Item = Photo> {
    test.photos.iter().filter(|photo| !photo.bytes.is_empty()).cloned()
}

/// Lines for a pen.
pub(crate) fn signatures<S: AsRef<str>>(who: &[S]) -> ChapterPart {
    ReportTable::from_rows(who)
        .class("signatures")
        .head("", |who| who.as_ref().to_owned())
        .text("name", |_| "")
        .text("date", |_| "")
        .text("signature", |_| "")
        .into()
}

/// True if the cask file leaves this key of `[tolerance]` to its default.
fn is_default(file: &CaskFile, key: &str) -> bool {
    file.defaults.iter().any(|d| d.strip_prefix("tolerance.") == Some(key))
}

/// Value assumed for an input that nobody stated.
#[derive(PartialEq)]
pub(super) struct Assumption {
    /// "drop angle".
    pub(super) name: &'static str,
    /// "drop angle ± 0.4°".
    pub(super) words: String,
    /// Table of the cask file that states the input.
    pub(super) table: &'static str,
    /// True if the input has no usual value: it counts even with a small contribution.
    pub(super) is_unknown: bool,
}

/// Assumption on an input of the budget; `None` if the cask file states it.
pub(super) fn assumption(file: &CaskFile, input: &Contribution) -> Option<Assumption> {
    let (key, cask, known) = (input.tolerance?, &file.cask, &file.tolerances);
    let is_left_out = |key: &str| file.defaults.iter().any(|default| default == key);
    let row = TOLERANCES.iter().find(|row| row.key == key)?;
    let name = if key == "friction_percent" { "friction" } else { row.name };
    let unknown = |table, words| Some(Assumption { name, words, table, is_unknown: true });
    match (key, file.contact) {
        ("cog_m", _) if is_left_out("cask.cog_m") => unknown(
            "[cask]",
            format!("centre of gravity {} ± {} m", plain(cask.cog_m, 4), plain(known.cog_m, 2)),
        ),
        ("inertia_percent", _) if is_left_out("cask.inertia_kg_m2") => {
            unknown("[cask]", format!("inertia of a uniform block ± {} %", plain(100.0 * known.inertia, 2)))
        }
        ("friction_percent", Contact::Unknown) => {
            unknown("[contact]", "friction from none to sticking".to_owned())
        }
        ("friction_percent", Contact::Coulomb(most)) if file.has_open_friction() => {
            unknown("[tolerance]", format!("impulse ratio up to {}", plain(most, 4)))
        }
        _ if is_default(file, key) => {
            // The uncertainty of a length is in millimetres, whatever its share of the cask is.
            let (value, unit) = if key.ends_with("_m") {
                (1e3 * row.value_in_file(*known, cask), " mm")
            } else {
                row.displayed_value(*known)
            };
            let words = format!("{} ± {}{unit}", row.name, plain(value, 3));
            Some(Assumption { name, words, table: "[tolerance]", is_unknown: false })
        }
        _ => None,
    }
}

/// The tolerances, and the corrections that are switched off; without those that `said` already lists.
pub(super) fn cask_file_settings(file: &CaskFile, said: &[Setting]) -> Vec<Setting> {
    let tolerances = TOLERANCES.iter().map(|tolerance| {
        let (value, unit) = tolerance.displayed_value(file.tolerances);
        Setting {
            name: format!("tolerance of {}", tolerance.name),
            value: format!("± {}{unit} (95 %)", plain(value, 3)),
            origin: if is_default(file, tolerance.key) { "default" } else { "cask file" }.into(),
        }
    });
    let mut made = file.corrections;
    let off = made.switches().into_iter().filter(|(_, made)| !**made).map(|(name, _)| Setting {
        name: format!("correction {name}"),
        value: "switched off".into(),
        origin: "cask file".into(),
    });
    let mut settings: Vec<Setting> = tolerances.chain(off).collect();
    settings.retain(|own| said.iter().all(|other| other.name != own.name));
    settings
}

const CAPTION: &str = "As recorded, each in its unit: but for angular-rate sensors they take no part in the \
                       motion, and findings on them change no number of it. Rest: the median before the \
                       release, or before the first contact where the release is not seen; noise: RMS about \
                       it; smallest and largest of the whole recording. The strongest line is that of the \
                       curve's spectrum.";

/// Chapter on the readings of the other channels, with their curves; empty if there are none.
pub(super) fn others(result: &DropResult) -> Chapter {
    let chapter = Chapter::new("Other channels");
    if result.other_channels.is_empty() {
        return chapter;
    }
    let value = |extreme: Option<Extreme>| optional(extreme.map(|e| e.value), 4);
    let at_ms = |extreme: Option<Extreme>| optional_fixed(extreme.map(|e| 1e3 * e.time_s), 2);
    let line = |line: SpectralLine| format!("{} Hz", significant(line.frequency_hz, 3));
    let codes = |other: &OtherSummary| -> Vec<String> { other.findings.iter().map(json_word).collect() };
    let table = ReportTable::from_rows(&result.other_channels)
        .class("")
        .caption(CAPTION)
        .head("Channel", |c| &c.name[..])
        .text("Unit", |c| &c.unit[..])
        .code("Source", |c| &c.source[..])
        .number("Rate", |c| format!("{} Hz", plain(c.sample_rate_hz, 6)))
        .number("Rest", |c| optional(c.rest, 4))
        .number("Noise", |c| optional(c.noise, 2))
        .number("Smallest", |c| value(c.smallest))
        .number("at ms", |c| at_ms(c.smallest))
        .number("Largest", |c| value(c.largest))
        .number("at ms", |c| at_ms(c.largest))
        .number("Strongest line", |c| c.strongest_line.map_or_else(|| MISSING.to_owned(), line))
        .text("Serial", |c| c.sensor.serial.clone().unwrap_or_else(|| MISSING.to_owned()))
        .code("Findings", |c| if c.findings.is_empty() { MISSING.to_owned() } else { codes(c).join(" ") });
    chapter.then(table).then(ChapterPart::picture("other_channels", ""))
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn tolerances_have_their_unit_and_their_origin() {
        let settings = cask_file_settings(&sample::cask_file(), &[]);
        let sentences = |name: &str| settings.iter().find(|s| s.name == name).expect(name);
        assert_eq!(sentences("tolerance of drop angle").value, "± 0.4° (95 %)");
        assert_eq!(sentences("tolerance of drop angle").origin, "cask file");
        assert_eq!(sentences("tolerance of position of a sensor").value, "± 10 mm (95 %)");
        assert_eq!(sentences("tolerance of inertia").origin, "default");
        assert_eq!(settings.len(), TOLERANCES.len());
    }

    #[test]
    fn only_a_correction_that_is_off_is_said_and_only_once() {
        let mut file = sample::cask_file();
        file.corrections.hum = false;
        let settings = cask_file_settings(&file, &[]);
        let off: Vec<&str> =
            settings.iter().map(|s| s.name.as_str()).filter(|n| n.starts_with("correction")).collect();
        assert_eq!(off, ["correction hum"]);
        assert_eq!(cask_file_settings(&file, &settings), []);
    }
}
