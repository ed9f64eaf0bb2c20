//! Page that `inspect` writes before there is a cask file: the content of a recording and its sources.

use super::acceleration_sources::{accelerations, is_time};
use super::document::{Chapter, ChapterPart, Frame, ReportDocument, ReportTable, TableCell};
use super::pictures::draw::Picture;
use super::pictures::recorded;
use super::rounding::{MISSING, plain};
use super::text::{moment, sanitize, tail};
use super::{ReportError, as_html, json, listing};
use crate::data::{Channel, ChannelLook, Extreme, ListedChannel, Listing};
use serde::Serialize;

/// Files of the folder; the listing records to which recording they belong.
pub const FIRST_LOOK_NAMES: [&str; 2] = ["recording.html", "recording.json"];

/// Most sources that are drawn.
const MOST_DRAWN: usize = 64;

/// Bytes of a page for a source's drawings, besides scripts and tables: below 3 MB in all.
const PAGE_BYTES: usize = 2_600_000;
const DRAWING_BYTES: usize = 25_000;

const LEAD: &str = "Curves to look at before there is a cask file: nothing here is a result. What looks \
                    like a fall or an impact is a guess from one source alone, made where its unit is one \
                    of acceleration.";

const LEVELS: &str = "Level and noise: median and spread of the first samples, a twentieth of the record \
                      but at most 0.25 s, before what looks like an impact. A fall is sought by its step of \
                      0.5 to 1.5 g from rest, an impact by a change of velocity of at least 1 m/s within \
                      25 ms.";

/// Sources that a page draws: readable ones that change and have times, except clocks; accelerations first,
/// if the page has no room for all.
#[must_use]
pub fn drawn_sources(listing: &Listing) -> Vec<&ListedChannel> {
    let changes = |c: &ListedChannel| c.range.is_none_or(|(low, high)| low < high) && c.samples != Some(1);
    let is_curve = |c: &ListedChannel| c.unreadable.is_none() && c.start_s.is_some() && !is_time(&c.source);
    let mut drawn: Vec<_> = listing.channels.iter().filter(|c| is_curve(c) && changes(c)).collect();
    if drawn.len() > MOST_DRAWN {
        let first = accelerations(listing);
        drawn.sort_by_key(|c| !first.iter().any(|acceleration| std::ptr::eq(*acceleration, *c)));
        drawn.truncate(MOST_DRAWN);
    }
    drawn
}

/// A page under construction, source by source.
pub struct FirstLook<'a> {
    listing: &'a Listing,
    drawn: &'a [&'a ListedChannel],
    shown: Vec<ShownSource>,
    pictures: Vec<Picture>,
}

/// A row of the table of the sources' looks.
struct ShownSource {
    name: String,
    /// Position of its curve on the page.
    place: String,
    unit: String,
    look: Result<ChannelLook, String>,
}

impl ShownSource {
    /// A value of the look with its unit, or a dash.
    fn value(&self, value: impl Fn(&ChannelLook) -> f64) -> String {
        let words = |look| format!("{} {}", plain(value(look), 3), self.unit).trim_end().to_owned();
        self.look.as_ref().map_or_else(|_| MISSING.to_owned(), words)
    }

    /// An extreme with its time, or a dash.
    fn extreme(&self, extreme: impl Fn(&ChannelLook) -> Extreme) -> String {
        let time = self.look.as_ref().map(|look| format!(" at {}", moment(extreme(look).time_s)));
        self.value(|look| extreme(look).value) + &time.unwrap_or_default()
    }

    fn guess(&self) -> String {
        let look = match &self.look {
            Ok(look) => look,
            Err(refused) => return format!("not drawn: {refused}"),
        };
        let fall = look.fall_s.as_ref().map(|fall_s| format!("a fall from {}", moment(fall_s.start)));
        let impact = look.impact_s.map(|impact_s| format!("an impact at {}", moment(impact_s)));
        let guesses: Vec<String> = fall.into_iter().chain(impact).collect();
        if guesses.is_empty() { MISSING.to_owned() } else { guesses.join(", ") }
    }
}

impl<'a> FirstLook<'a> {
    /// Prepares the page; no source is drawn yet.
    #[must_use]
    pub fn new(listing: &'a Listing, drawn: &'a [&'a ListedChannel]) -> Self {
        Self { listing, drawn, shown: Vec::new(), pictures: Vec::new() }
    }

    /// Draws the source at this index among those drawn, or states why it cannot be read.
    pub fn add(&mut self, number: usize, read: Result<(Channel, ChannelLook), String>) {
        let (name, place) = (listing::source_words(self.drawn[number]), format!("source-{}", number + 1));
        let chart_bytes = PAGE_BYTES / self.drawn.len() - DRAWING_BYTES;
        let unit = self.drawn[number].unit.clone().unwrap_or_default();
        let look = read.map(|(channel, look)| {
            self.pictures.extend(recorded(&channel, &look, &place, &tail(&name, 60), chart_bytes));
            look
        });
        self.shown.push(ShownSource { name, place: format!("#{place}"), unit, look });
    }

    /// The files, for the recording with this SHA-256.
    ///
    /// # Errors
    ///
    /// [`ReportError::Json`] if the writer fails.
    pub fn files(self, sha256: &str) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
        /// Content of `inspect --json`, with the name of the recording.
        #[derive(Serialize)]
        struct ListingFile<'a> {
            #[serde(flatten)]
            listing: &'a Listing,
            recording_sha256: &'a str,
        }
        let listing = json::pretty(&ListingFile { listing: self.listing, recording_sha256: sha256 })?;
        let page = as_html::page(&self.document(sha256), &self.pictures).into_bytes();
        Ok(FIRST_LOOK_NAMES.map(str::to_owned).into_iter().zip([page, listing]).collect())
    }

    fn document(&self, sha256: &str) -> ReportDocument {
        let pictures = self.pictures.iter().map(|picture| ChapterPart::picture(&picture.name, "short"));
        let curves = Chapter::new("Curves and spectra").with_all(pictures);
        let mut chapters = listing::document(self.listing).chapters;
        chapters.insert(0, Chapter::new("").then(ChapterPart::text(LEAD)));
        // These chapters follow the facts of the container and the sources; the storage and the findings come
        // after them.
        chapters.splice(3..3, [self.sources_chapter(), curves]);
        let name = self.listing.recording.rsplit(['/', '\\']).next().unwrap_or_default();
        ReportDocument {
            page: Frame {
                title: format!("{name} – first look"),
                product: "First look at a recording",
                heading: sanitize(name),
                about: listing::recording_words(self.listing),
                foot: format!("{name} · recording {}", sha256.get(..16).unwrap_or_default()),
                files: &FIRST_LOOK_NAMES[1..],
                // Guesses are words, which a narrow screen would break into single lines.
                style: ".whole td:last-child { min-width: 15em; }",
                ..Frame::default()
            },
            chapters,
        }
    }

    fn sources_chapter(&self) -> Chapter {
        let table = ReportTable::from_rows(&self.shown)
            .head("source", |row| TableCell { link: row.place.clone(), ..row.name.clone().into() })
            .number("smallest", |row| row.extreme(|look| look.smallest))
            .number("largest", |row| row.extreme(|look| look.largest))
            .number("level", |row| row.value(|look| look.level))
            .number("noise", |row| row.value(|look| look.noise))
            .text("looks like", ShownSource::guess);
        let [drawn, listed] = [self.drawn.len(), self.listing.channels.len()];
        let all = format!(
            "{drawn} of {listed} sources are drawn: those that change, have times and are no clock, at most \
             {MOST_DRAWN}."
        );
        let chapter = Chapter::new("What they show").then(ChapterPart::text(all));
        if self.shown.is_empty() { chapter } else { chapter.then(table).then(ChapterPart::note(LEVELS)) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::listing::tests::{listed, listing};
    use super::*;
    use crate::data::{Extreme, example};

    fn added(page: &mut FirstLook, number: usize, samples: &[f64]) {
        let extreme = Extreme { time_s: 1.0, value: 3.0 };
        let look = ChannelLook {
            smallest: extreme,
            largest: extreme,
            level: 0.0,
            noise: 1.0,
            fall_s: None,
            impact_s: Some(1.0),
        };
        page.add(number, Ok((example::channel(samples.to_vec()), look)));
    }

    #[test]
    fn a_page_of_as_many_long_sources_as_it_draws_stays_below_three_megabytes() {
        let sources = (0..70).map(|i| listed(&format!("/daq/a{i}.<b>"), "array", Some("g")));
        let listing = listing(sources.collect());
        let drawn = drawn_sources(&listing);
        assert_eq!(drawn.len(), MOST_DRAWN);
        let samples: Vec<f64> = (0..100_000).map(|i| example::noise(i, 1)).collect();
        let mut page = FirstLook::new(&listing, &drawn);
        (0..drawn.len() - 1).for_each(|number| added(&mut page, number, &samples));
        page.add(drawn.len() - 1, Err("its times go backwards".into()));
        let files = page.files("0123456789abcdef0").unwrap();
        let text = String::from_utf8(files[0].1.clone()).unwrap();
        assert!(text.len() < 3_000_000 && text.len() > 1_500_000, "{}", text.len());
        for part in [
            "Thinned: ",
            "64 of 70 sources are drawn",
            "/daq/a63.&lt;b&gt;",
            "not drawn: its times go backwards",
            "recording 0123456789abcdef",
        ] {
            assert!(text.contains(part), "{part}");
        }
        assert!(!text.contains("<b>"));
    }

    #[test]
    fn what_stands_still_or_is_a_clock_is_not_drawn() {
        let still = ListedChannel { range: Some((2.0, 2.0)), ..listed("/daq/still", "dataset", None) };
        let unreadable =
            ListedChannel { unreadable: Some("text".into()), ..listed("/daq/name", "dataset", None) };
        let listing = listing(vec![
            still,
            listed("/daq/time_s", "dataset", None),
            unreadable,
            listed("/daq/s1", "dataset", None),
        ]);
        assert_eq!(drawn_sources(&listing).iter().map(|c| &c.source[..]).collect::<Vec<_>>(), ["/daq/s1"]);
    }
}
