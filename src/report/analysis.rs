//! Document of an analysis, for the terminal and `report.html`.

use super::document::{
    Chapter, ChapterPart, Fact, Frame, Medium, PartContent, ReportDocument, ReportTable, TableCell,
    TableShape, Tone,
};
use super::first_screen::{RIGID, agreement, built_in, corner_words, measured_inputs, not_checkable};
use super::impacts::{impacts, missing_notes, prototype};
use super::kind;
use super::prediction::prediction_columns;
use super::reconstruction::{assumed, budget, flight, reconstruction};
use super::record::{self, LIMIT_EXCEEDED, TOLD, limits_sentence, others, test_chapter};
use super::rounding::{MISSING, interval, optional, optional_fixed, pair, percent, plain};
use super::shocks::shocks;
use super::simulation::simulation;
use super::text::{
    Style, causes, chosen_mark, drop_words, json_word, or_unknown, reasons, sentence, span_text, true_minus,
    verdict_sentence, verdict_style, verdict_word, yes_no,
};
use super::words::{OVER_SENTENCE, REGIME_SENTENCE};
use crate::data::{
    Analysis, CaskFile, DropResult, Finding, FlightRegime, Prediction, QuantityRow, STANDARD_GRAVITY_M_S2,
    Setting, Severity,
};

/// The whole document, with the basis of a decision on its first page.
pub(super) fn document(analysis: &Analysis) -> ReportDocument {
    let (result, file) = (&analysis.result, &analysis.cask_file);
    let (name, input) = (&file.cask.name, &result.input);
    let heading = record::heading(&result.test, name, kind::words(result, file).is_none());
    let pictures =
        |names: &[&str]| names.iter().map(|name| ChapterPart::picture(name, "")).collect::<Vec<_>>();
    let photographs = PartContent::Photographs(record::photographs(&result.test).collect());
    let signatures = record::signatures(&result.test.signatures);
    let hash = input.recording_sha256.get(..16).unwrap_or_default();
    ReportDocument {
        page: Frame {
            title: format!(
                "{heading} – {}",
                verdict_word(result.verdict, result.k.or(result.slap_down.speed))
            ),
            product: "Drop test report",
            foot: format!("{} · recording {hash}", result.test.id.as_deref().unwrap_or(name)),
            heading,
            about: format!("{} · {}", drop_words(&file.drop), input.recording),
            footer: "An interval holds the value with 95 % probability. Times count from the recording's \
                     first sample. Body axes: axial from the first end to the second, transverse away from \
                     the target. [P]: Analytical, Numerical and Experimental Investigations on the Impact \
                     Behaviour of Packagings for the Transport of Radioactive Material under Slap Down \
                     Conditions (BAM, PATRAM). SSG-26: IAEA Specific Safety Guide No. SSG-26.",
            letterhead: file.letterhead.clone(),
            files: &super::file_names(analysis)[1..],
            ..Frame::default()
        },
        chapters: vec![
            summary(result, file),
            record::head(result),
            record::limits(&result.limits),
            quality(&result.quality),
            Chapter::new("Accelerations and velocities")
                .only_on(Medium::Page)
                .with_all(pictures(&["accelerations", "velocities"])),
            test_chapter(file, "What was tested")
                .then(ChapterPart::picture("setup", ""))
                .then(record::sensors(file)),
            quantities(result),
            impacts(result).with_all(pictures(&["impacts", "crush"])),
            shocks(result),
            prototype(result, file),
            comparison(result, file),
            simulation(result),
            record::observed(&result.observed),
            reconstruction(result).with_all(pictures(&["motion"])),
            flight(result).with_all(pictures(&["fit"])),
            budget(result, file),
            predictions(result),
            channels(result).with_all(pictures(&["spectra"])),
            others(result),
            provenance(result, file),
            Chapter::new("Photographs").only_on(Medium::Page).then(photographs),
            Chapter::new("Signatures").only_on(Medium::Page).then(signatures),
        ],
    }
}

/// Statement that no reader of the first page should miss.
const NO_REFERENCE: &str = "The results relate to this one drop of this item only, and the verdict to the \
                            data of its recording, not to the cask. The intervals were tested on simulated \
                            drops of known truth; no recording with a certified slap-down velocity was \
                            available.";

/// Chapter on the verdict and its cause, the four headline numbers, and their basis: on a page; a terminal
/// has its first screen.
fn summary(result: &DropResult, file: &CaskFile) -> Chapter {
    let causes = Some(causes(result).join(" ")).filter(|said| !said.is_empty());
    let assumed = assumed(result, file, false).map(|words| format!("The interval {words}."));
    let unchecked = not_checkable(result).map(|[named, remedies]| {
        format!("Not checkable from this recording: {named}. To check them: {remedies}.")
    });
    let banner = |style, word: &str, sentence| PartContent::Banner(Tone(style, word.to_owned()), sentence);
    let word = verdict_word(result.verdict, result.k.or(result.slap_down.speed));
    let verdict = banner(verdict_style(result.verdict), word, verdict_sentence(result));
    let limits = limits_sentence(&result.limits, usize::MAX);
    let (alarm, limits) = if result.exceeds_a_limit() { (limits, None) } else { (None, limits) };
    let alarm = alarm.map(|said| banner(Style::Red, LIMIT_EXCEEDED, said));
    let banners = alarm.into_iter().chain([verdict]).map(ChapterPart::from);
    let sentences = [limits.map(|sentences| format!("Limits: {sentences}")), causes, assumed, unchecked];
    let sentences = sentences.into_iter().flatten().map(ChapterPart::text);
    Chapter::new("")
        .only_on(Medium::Page)
        .with_all(kind::words(result, file).map(ChapterPart::text))
        .with_all(banners)
        .then(PartContent::Figures(figures(result, file)))
        .with_all(sentences)
        .then(ChapterPart::note(NO_REFERENCE))
}

fn figures(result: &DropResult, file: &CaskFile) -> Vec<[String; 3]> {
    let corner = corner_words(result)
        .map_or_else(String::new, |corner| format!("; of the corner {}", corner.replace(' ', "\u{a0}")));
    let model = result.model.as_ref().map_or("no model taken", |model| model.rung.words());
    let compared = result.comparison.as_ref();
    let predicted = compared.map(|c| pair(c.predicted, c.predicted_u95, "m/s"));
    let by = compared.map(|_| format!("{model}, {}", measured_inputs(result, file)));
    let figures = [
        (
            "Slap-down speed, measured, ±\u{a0}95\u{a0}%",
            interval(result.slap_down.speed.as_ref()),
            format!("{RIGID}{corner}"),
        ),
        (
            "Slap-down speed, predicted, ±\u{a0}95\u{a0}%",
            predicted.unwrap_or_else(|| MISSING.to_owned()),
            by.unwrap_or_default(),
        ),
        (
            "Measured against predicted",
            percent(compared.map(|c| c.difference_percent)),
            compared.map_or("", |c| agreement(c.agrees)).to_owned(),
        ),
        ("Coefficient of restitution k, ±\u{a0}95\u{a0}%", interval(result.k.as_ref()), String::new()),
    ];
    figures.map(|(name, value, detail)| [name.to_owned(), or_unknown(value), detail]).into()
}

/// First impact, slap-down and k, each with its interval or with the reason why it is missing.
fn quantities(result: &DropResult) -> Chapter {
    let (first, second) = (&result.first_impact, &result.slap_down);
    let row = |name, remark, value| QuantityRow { name, remark, value };
    let time = |name, value| [row(name, "after the first sample", value)].into_iter();
    let k = row("restitution k", "rebound over impact velocity", result.k);
    let first_impact = time("first contact", first.time).chain(first.rows()).chain([k]);
    let slap_down = second.rows().into_iter().chain(time("time", second.time));
    let fact = |row: QuantityRow| Fact::number(row.name, interval(row.value.as_ref())).note(row.remark);
    let estimates = |caption, rows: Vec<QuantityRow>, places: &[&str]| {
        let facts = ChapterPart::facts(caption, rows.into_iter().map(fact).collect());
        [facts].into_iter().chain(missing_notes(result, places)).collect()
    };
    Chapter::new("Results, ± 95 %").then(PartContent::Beside([
        estimates("First impact", first_impact.collect(), &["first_impact.", "k"]),
        estimates("Slap-down", slap_down.collect(), &["slap_down."]),
    ]))
}

/// Chapter on the measured and the predicted speed, the selected model with its reason, and all models that
/// were compared.
fn comparison(result: &DropResult, file: &CaskFile) -> Chapter {
    let taken = result.model.as_ref();
    let compared = result.comparison.as_ref().map_or_else(
        || {
            let reasons = reasons(result, &["comparison"]).join("; ");
            ChapterPart::text(format!("{MISSING} not compared: {reasons}"))
        },
        |c| {
            let (style, by) =
                (if c.agrees { Style::Green } else { Style::Yellow }, measured_inputs(result, file));
            let facts = vec![
                Fact::number("measured", pair(c.measured, c.measured_u95, "m/s")),
                Fact::number("predicted", pair(c.predicted, c.predicted_u95, "m/s")).note(by),
                Fact::number("difference", percent(c.difference_percent)).tone(style, agreement(c.agrees)),
            ];
            // A page has them in its first boxes.
            ChapterPart::facts("", facts).only_on(Medium::Terminal)
        },
    );
    let model = taken.map(|model| {
        let candidates = ReportTable::from_rows(&model.candidates)
            .caption(
                "The analytical models with the measured k, the simplest first, without those that change \
                 nothing. Taken: the first that agrees, all richer ones agreeing too and none farther from \
                 it than the measured speed is known; else the richest.",
            )
            .mark_chosen(|c| c.rung == model.rung)
            .head("Model", |c| format!("{}{}", c.rung.words(), chosen_mark(c.rung == model.rung)))
            .number("Predicted, m/s", |c| optional_fixed(c.predicted, 2))
            .number("± 95 %, m/s", |c| optional(c.u95, 2))
            .number("Measured against predicted", |c| percent(c.difference_percent))
            .text("Within both intervals", |c| yes_no(c.consistent));
        let built_in = built_in(result).map(|words| format!(" The agreement is partly {words}."));
        let built_in = built_in.unwrap_or_default();
        let words = format!("Model: {}. {}{built_in}", model.rung.words(), sentence(&model.reason));
        [ChapterPart::text(words), candidates.into()]
    });
    Chapter::new("Measured beside predicted")
        .then(compared)
        .then(ChapterPart::picture("comparison", ""))
        .with_all(model.into_iter().flatten())
}

/// Chapter on every finding: severity, code, channel and span, and its sentence.
pub(super) fn quality(issues: &[Finding]) -> Chapter {
    let chapter = Chapter::new("Quality");
    if issues.is_empty() {
        return chapter.then(ChapterPart::text("No check found anything to say."));
    }
    let style = |severity| match severity {
        Severity::Note => Style::Dim,
        Severity::Warning => Style::Yellow,
        Severity::Error => Style::Red,
    };
    let findings = ReportTable::from_rows(issues)
        .class("findings")
        .shape(TableShape::Items)
        .tag("Severity", |i| TableCell::tone(style(i.severity), json_word(i.severity)))
        .code("Check", |i| json_word(i.code))
        .text("Channel", |i| i.channel.as_deref().unwrap_or(MISSING))
        .line("When", |i| span_text(i).unwrap_or_else(|| MISSING.into()))
        .text("Finding", |i| true_minus(&i.message));
    chapter.then(findings)
}

/// Chapter on the predictions of the analytical models at the angle of the drop.
fn predictions(result: &DropResult) -> Chapter {
    let table = ReportTable::from_rows(&result.predictions).class("").caption(
        "Rigid-body models at the angle of the drop. Energy: kinetic, before the slap-down over before the \
         first impact.",
    );
    let table = prediction_columns(table, Some, false)
        .number("Angle, °", |p| optional_fixed(p.slap_down_angle_deg, 1))
        .only_on(Medium::Page)
        .number("Impacts of the first end", |p| p.first_end_impacts.to_string())
        .only_on(Medium::Page);
    let kept = result.predictions.iter().any(|p| p.regime == FlightRegime::Contact);
    let over = result.predictions.iter().any(Prediction::turns_over);
    let notes = [kept.then_some(REGIME_SENTENCE), over.then_some(OVER_SENTENCE)];
    Chapter::new("Predictions").then(table).with_all(notes.into_iter().flatten().map(ChapterPart::note))
}

/// Chapter on the quality of each channel.
fn channels(result: &DropResult) -> Chapter {
    let g = |value: Option<f64>| optional(value.map(|v| v / STANDARD_GRAVITY_M_S2), 3);
    let table = ReportTable::from_rows(&result.channels)
        .class("")
        .caption("Offset and noise (RMS) in g; where no impact is tabulated, also the peaks of the event")
        .head("Channel", |c| &c.name[..])
        .text("End, axis", |c| format!("{}, {}", json_word(c.end), json_word(c.axis)))
        .code("Source", |c| &c.source[..])
        .number("Samples", |c| c.samples.to_string())
        .number("Rate", |c| format!("{} kHz", plain(c.sample_rate_hz / 1e3, 6)))
        .text("Unit", |c| &c.unit[..])
        .number("Offset", |c| g(c.offset_m_s2))
        .number("Noise", |c| g(c.noise_m_s2));
    // Otherwise the impacts show the peaks, each with its interval.
    let has_peaks = result.impacts.iter().all(|impact| impact.channels.is_empty());
    let table = table
        .number("Filtered peak", |c| g(c.peak_filtered_m_s2))
        .show_if(has_peaks)
        .number("Unfiltered peak", |c| g(c.peak_raw_m_s2))
        .show_if(has_peaks);
    Chapter::new("Channels").then(table)
}

/// Chapter on files, version and settings.
fn provenance(result: &DropResult, file: &CaskFile) -> Chapter {
    let input = &result.input;
    let own = result.program.as_ref().and_then(|program| program.sha256.as_deref());
    let words = |name: &'static str, words: Option<&str>| words.map(|words| Fact::words(name, words));
    let hash = |name: &'static str, hash: Option<&str>| hash.map(|hash| Fact::code(name, hash));
    let recording = format!("{} ({})", input.recording, json_word(input.format));
    let facts = [
        words("Recording", Some(&recording)),
        hash("SHA-256 of the recording", Some(&input.recording_sha256)),
        words("Cask file", Some(&input.cask)),
        hash("SHA-256 of the cask file", Some(&input.cask_sha256)),
        words("Rest before the drop", input.rest.as_deref()),
        hash("SHA-256 of the rest", input.rest_sha256.as_deref()),
        words("Calculation", input.simulation.as_deref()),
        hash("SHA-256 of the calculation", input.simulation_sha256.as_deref()),
        words("Program", Some(&record::program(result))),
        hash("SHA-256 of the program", own),
        words("Schema of result.json", Some(result.schema)),
        words("Recording read by", input.reader.as_deref()),
    ];
    let facts = facts.into_iter().flatten().collect();
    let stated = record::cask_file_settings(file, &result.settings);
    let is_new = |s: &&Setting| !TOLD.contains(&s.name.as_str());
    let all: Vec<_> = result.settings.iter().chain(&stated).filter(is_new).collect();
    let settings = ReportTable::from_rows(&all)
        .class("")
        .caption("Every other setting and where it came from; cask and drop stand under \"What was tested\"")
        .head("Setting", |s| &s.name[..])
        .text("Value", |s| true_minus(&s.value))
        .text("From", |s| &s.origin[..]);
    Chapter::new("Provenance").then(ChapterPart::facts("", facts)).then(settings)
}
