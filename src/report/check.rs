//! Document of `check` for a set-up at rest.

use super::analysis::quality;
use super::document::{
    Chapter, ChapterPart, Frame, Medium, PartContent, ReportDocument, ReportTable, TableCell, Tone, Words,
};
use super::rounding::{fixed, optional_fixed};
use super::text::{Style, capital, drop_words, plural};
use super::{ReportError, as_html, json, pictures, record};
use crate::data::{
    CaskFile, Channel, Check, CheckedChannel, Finding, Recording, RestCause, STANDARD_GRAVITY_M_S2 as G,
};

/// Drawing and photographs leave room on the sheet for eight channels and the signatures.
const STYLE: &str = ".drawing > svg { max-height: 62mm; } .tag.ready { color: var(--good); } \
                     .tag.not { color: var(--bad); } .signatures tbody tr { height: 9mm; } \
                     @media print { img { max-height: 42mm; } p { margin: 3px 0; } \
                     h2 { margin-top: 12px; } }";

/// Properties that a recording at rest cannot verify, with the way to verify each.
const NOT_VERIFIABLE: [&str; 3] = [
    "Calibration: a reading within 0.4 g is taken for right, since an offset looks like a scale. See the \
     certificate, or turn the sensor upside down: 2 g lie between both readings.",
    "Positions and length: a tape along the axis, from the edge that strikes first.",
    "Angle: an inclinometer on the rigged cask, since 1° changes g cos φ by less than an offset.",
];
/// Advice on verifying by taps.
const BY_TAPS: &str = "Ends, clocks, and the sign of channels that are AC-coupled: strike each end once from \
                       below, the first end first, and add --taps.";

/// The page to sign; and the findings, which identify the folder as one of this program.
pub const CHECK_NAMES: [&str; 2] = ["check.html", "check.json"];

/// A checked set-up, with its cask file and recording.
#[derive(Clone, Copy)]
pub struct CheckedSetup<'a> {
    /// Result of the check.
    pub check: &'a Check,
    /// The recording at rest.
    pub rest: &'a Recording,
    /// The cask file.
    pub file: &'a CaskFile,
    /// True if the recording holds a tap on each end.
    pub has_blows: bool,
}

/// The table, with SGR colours that the caller strips if no terminal shows it.
#[must_use]
pub fn table(setup: &CheckedSetup, width: usize) -> String {
    let document = ReportDocument { chapters: chapters(setup), ..ReportDocument::default() };
    super::as_text::text(&document, width)
}

/// The files of `--out`.
///
/// # Errors
///
/// [`ReportError::Json`] if the writer fails.
pub fn check_files(setup: &CheckedSetup) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let page = as_html::page(&document(setup), &[pictures::of_setup(setup.file)]).into_bytes();
    let bytes = [page, json::pretty(setup.check)?];
    Ok(CHECK_NAMES.map(str::to_owned).into_iter().zip(bytes).collect())
}

fn document(setup: &CheckedSetup) -> ReportDocument {
    let CheckedSetup { check, rest, file, .. } = *setup;
    let (name, test) = (&file.cask.name, &file.test);
    let hash = rest.sha256.get(..16).unwrap_or_default();
    let who =
        if test.signatures.is_empty() { vec!["Checked by".to_owned()] } else { test.signatures.clone() };
    let drawing = ChapterPart::picture("setup", "drawing");
    let photos: Vec<_> = record::photographs(test).collect();
    let seen = if photos.is_empty() {
        drawing
    } else {
        PartContent::Beside([vec![drawing], vec![PartContent::Photographs(photos).into()]]).into()
    };
    let mut chapters = chapters(setup);
    chapters.push(Chapter::new("Set-up").then(seen));
    chapters.push(Chapter::new("Signatures").then(record::signatures(&who)));
    ReportDocument {
        page: Frame {
            title: format!("{name} – {}", if check.ready { "ready" } else { "not ready" }),
            product: "Check before the drop",
            heading: test.id.as_ref().map_or_else(|| name.clone(), |id| format!("{id}: {name}")),
            about: format!("{} · {} · {}", drop_words(&file.drop), rest.path.display(), file.path.display()),
            foot: format!("{} · rest {hash}", test.id.as_deref().unwrap_or(name)),
            letterhead: file.letterhead.clone(),
            style: STYLE,
            ..Frame::default()
        },
        chapters,
    }
}

fn chapters(setup: &CheckedSetup) -> Vec<Chapter> {
    let check = setup.check;
    let range = |c: &CheckedChannel| setup.channel(c).and_then(Channel::range_m_s2).map(|range| range / G);
    let head = |words: &str| Words::with_short(capital(words), words);
    let channels = ReportTable::from_rows(&check.channels)
        .head(head("channel"), |c| c.name.clone())
        .tag("", |c| ready_cell(c.ready))
        .number(head("reads, g"), |c| fixed(c.reads_g, 2))
        .number(head("expected, g"), |c| optional_fixed(c.expected_g, 2))
        .number(head("noise, g"), |c| fixed(c.noise_g, 3))
        .number(head("range, g"), |c| optional_fixed(range(c), 0))
        .number(head("rate, Hz"), |c| optional_fixed(setup.channel(c).map(|c| c.sample_rate_hz), 0));
    let not_ready = check.channels.iter().filter(|channel| !channel.ready).count();
    let (word, sentence) = match (check.ready, not_ready) {
        (true, _) => ("Ready", "at rest nothing speaks against the drop".to_owned()),
        (false, 0) => ("Not ready", "see what was found".to_owned()),
        (false, count) => ("Not ready", format!("{} of {}", count, plural(check.channels.len(), "channel"))),
    };
    let tone = Tone(if check.ready { Style::Green } else { Style::Red }, word.to_owned());
    let banner = ChapterPart::from(PartContent::Banner(tone, sentence.clone())).only_on(Medium::Page);
    let title = ChapterPart::title(format!("{word}: {sentence}")).only_on(Medium::Terminal);
    let mut found: Vec<Finding> = check.channels.iter().flat_map(|c| c.findings.clone()).collect();
    found.extend(check.findings.iter().cloned());
    found.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    let found = (!found.is_empty()).then(|| quality(&found));
    let not_verifiable = NOT_VERIFIABLE.map(str::to_owned).into_iter();
    let not_verifiable = not_verifiable
        .chain(open_levels(setup))
        .chain(open_ranges(setup))
        .chain((!setup.has_blows).then(|| BY_TAPS.to_owned()));
    let head = Chapter::new("").then(banner).then(title).then(channels);
    let foot = Chapter::new("Not told by rest").with_all(not_verifiable.map(ChapterPart::text));
    [head].into_iter().chain(found).chain([foot]).collect()
}

impl CheckedSetup<'_> {
    fn channel(&self, checked: &CheckedChannel) -> Option<&Channel> {
        self.rest.channels.iter().find(|channel| channel.name == checked.name)
    }
}

/// Names the mistakes that an offset could hide, by channel, and the check that would show them.
fn open_levels(setup: &CheckedSetup) -> Option<String> {
    let remedies = [
        (RestCause::Sign, "the sign"),
        (RestCause::Axis, "the axis"),
        (RestCause::Nothing, "whether gravity is felt: coupling, scale, cable"),
    ];
    let line = |(cause, what): (RestCause, &str)| {
        let is_open = |c: &&CheckedChannel| c.ready && c.open.contains(&cause);
        let names: Vec<&str> = setup.check.channels.iter().filter(is_open).map(|c| &c.name[..]).collect();
        (!names.is_empty()).then(|| format!("{what} (of {})", names.join(", ")))
    };
    let open: Vec<String> = remedies.into_iter().filter_map(line).collect();
    (!open.is_empty()).then(|| {
        format!(
            "What an offset of 0.4 g hides at this angle: {}. Check once more at another `angle_deg`, of \
             the cask or its sensors by hand: near level for transverse channels, near upright for axial \
             ones.",
            open.join("; ")
        )
    })
}

/// Channels without a stated range, and the range that each needs.
fn open_ranges(setup: &CheckedSetup) -> Option<String> {
    let open = setup.rest.channels.iter().filter(|channel| channel.full_scale.is_none());
    let names: Vec<&str> = open.map(|channel| &channel.name[..]).collect();
    (!names.is_empty()).then(|| {
        format!(
            "Range of {}: not stated. Read it off the amplifier and state `full_scale`; `dropcheck predict` \
             says which range the drop needs.",
            names.join(", ")
        )
    })
}

fn ready_cell(is_ready: bool) -> TableCell {
    let (style, words) = if is_ready { (Style::Green, "ready") } else { (Style::Red, "not ready") };
    TableCell::tone(style, words)
}
