//! Curve and spectrum of a source of a recording, read before there is a cask file.

use super::super::text::moment;
use super::curves::TIME_LABEL;
use super::draw::{Figure, Picture};
use super::live::EVERY_SAMPLE;
use super::live::thin;
use super::panel::{COLOURS, Curve, Mark, Panel, PanelAxis};
use crate::data::{Channel, ChannelLook, is_number};
use crate::numerics::spectrum::magnitude;
use std::ops::Range;

/// Bytes of a sample in the chart of a page, if some are omitted, and if none is.
const THINNED_BYTES: usize = 11;
const EVEN_BYTES: usize = 6;

/// Longest record that is transformed as a whole: of a longer one a part, since the transform would take
/// longer than reading it.
const MOST_TRANSFORMED: usize = 1 << 18;
/// The largest value of each such step is drawn.
const STEPS_A_DECADE: f64 = 80.0;

/// Picture of the curve with the supposed fall and impact, its chart in a limited number of bytes, and the
/// spectrum; with this name and title.
pub(crate) fn recorded(
    channel: &Channel,
    look: &ChannelLook,
    name: &str,
    title: &str,
    chart_bytes: usize,
) -> [Picture; 2] {
    [curve(channel, look, name, title, chart_bytes), spectrum(channel, look, name, title)]
}

/// The unit, or other words if none is stated.
fn unit<'a>(channel: &'a Channel, or: &'a str) -> &'a str {
    if channel.unit.is_empty() { or } else { &channel.unit }
}

/// Range of this many samples, a quarter of them before the impact, or before the sample farthest from the
/// level.
fn samples_around(channel: &Channel, look: &ChannelLook, count: usize) -> Range<usize> {
    let [low, high] = [&look.smallest, &look.largest].map(|extreme| (extreme.value - look.level).abs());
    let farthest = if low > high { &look.smallest } else { &look.largest };
    let centre = channel.index_at(look.impact_s.unwrap_or(farthest.time_s));
    let from = centre.saturating_sub(count / 4).min(channel.samples.len().saturating_sub(count));
    from..(from + count).min(channel.samples.len())
}

/// The times of a stretch, in words.
fn stretch_words(channel: &Channel, stretch: &Range<usize>) -> String {
    let [from, to] = [stretch.start, stretch.end].map(|i| moment(channel.time_s(i)));
    format!("from {from} to {to}")
}

fn curve(channel: &Channel, look: &ChannelLook, name: &str, title: &str, chart_bytes: usize) -> Picture {
    let count = channel.samples.len();
    // Half of a thinned chart is for the whole record, half for every sample around the largest event.
    let (each, near, note) = if count * EVEN_BYTES <= chart_bytes {
        (1, 0..count, EVERY_SAMPLE.to_owned())
    } else {
        let kept = (chart_bytes / THINNED_BYTES).max(4);
        let (each, near) = ((4 * count).div_ceil(kept), samples_around(channel, look, kept / 2));
        let all = stretch_words(channel, &near);
        let note = format!("Thinned: the lowest and the highest of each {each} samples, and all {all}.");
        (each, near, note)
    };
    let value = |i: usize| Some(channel.samples.get(i)).filter(|v| is_number(*v)).unwrap_or(f64::NAN);
    let mut points = Vec::new();
    for (stretch, each) in [(0..near.start, each), (near.clone(), 1), (near.end..count, each)] {
        // A gap may extend beyond the ends of a stretch.
        points.extend(stretch.clone().next().filter(|first| value(*first).is_nan()).map(|i| (i, f64::NAN)));
        points.extend(thin(stretch.map(|i| (i, value(i))), each));
    }
    let points = points.into_iter().map(|(i, value)| (channel.time_s(i) * 1e3, value)).collect();
    let step = Some(1e3 / channel.sample_rate_hz);
    let line = Curve { stroke: 2, step, ..Curve::new(COLOURS[0], points) };
    let fall_s = look.fall_s.as_ref().map(|fall_s| fall_s.start);
    let guesses = [("looks like a fall", fall_s), ("looks like an impact", look.impact_s)];
    let mark = |(label, time_s): (&str, Option<f64>)| Some(Mark { at: time_s? * 1e3, label: label.into() });
    let panel = Panel {
        lines: vec![line],
        marks: guesses.into_iter().filter_map(mark).collect(),
        ..Panel::new(title, TIME_LABEL, format!("value, {}", unit(channel, "unit not stated")), 300)
    };
    let caption = if each == 1 { "Every sample." } else { &note };
    let plate = Figure::new(name, "Curve", caption.to_owned()).zoomable();
    Figure { thinned: Some(note), ..plate }.picture(&[panel])
}

fn spectrum(channel: &Channel, look: &ChannelLook, name: &str, title: &str) -> Picture {
    let part = samples_around(channel, look, channel.samples.len().min(MOST_TRANSFORMED));
    let caption = format!(
        "One-sided amplitude spectrum {}, less the level; both axes logarithmic, the largest value of each \
         {STEPS_A_DECADE}th of a decade.",
        stretch_words(channel, &part)
    );
    let off = |sample: f64| if is_number(sample - look.level) { sample - look.level } else { 0.0 };
    let values = part.map(|i| off(channel.samples.get(i)));
    let (frequency_hz, magnitude) = magnitude(values, channel.sample_rate_hz);
    let mut points: Vec<(f64, f64)> = Vec::new();
    let step = |frequency_hz: f64| (frequency_hz.log10() * STEPS_A_DECADE).floor();
    for (frequency_hz, magnitude) in frequency_hz.into_iter().zip(magnitude).skip(1) {
        match points.last_mut().filter(|top| step(top.0).total_cmp(&step(frequency_hz)).is_eq()) {
            Some(top) => *top = if top.1 < magnitude { (frequency_hz, magnitude) } else { *top },
            None => points.push((frequency_hz, magnitude)),
        }
    }
    let [x, y] = ["frequency, Hz".to_owned(), format!("magnitude, {} · s", unit(channel, "value"))]
        .map(|label| PanelAxis::new(label).logarithmic());
    let line = Curve { stroke: 2, ..Curve::new(COLOURS[0], points) };
    let panel = Panel { lines: vec![line], ..Panel::new(title, x, y, 240) };
    Figure::new(&format!("{name}-spectrum"), "Spectrum", caption).picture(&[panel])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Extreme, example};
    use base64::prelude::{BASE64_STANDARD, Engine};

    #[test]
    fn a_thinned_chart_keeps_extremes_gaps_and_every_sample_about_the_middle() {
        let mut samples: Vec<f64> = (0..100_000).map(|i| example::noise(i, 1)).collect();
        samples[20_000..20_100].fill(f64::NAN);
        (samples[30_003], samples[77_777]) = (-50.0, 99.0);
        let channel = example::channel(samples);
        let extreme = |time_s, value| Extreme { value, time_s };
        let look = ChannelLook {
            smallest: extreme(3.0003, -50.0),
            largest: extreme(7.7777, 99.0),
            level: 0.0,
            noise: 1.0,
            fall_s: None,
            impact_s: None,
        };
        let pictures = recorded(&channel, &look, "a", "A", 22_000);
        assert_eq!(pictures.iter().map(|p| &p.name[..]).collect::<Vec<_>>(), ["a", "a-spectrum"]);
        let chart: serde_json::Value = serde_json::from_str(&pictures[0].live).unwrap();
        assert!(chart["note"].as_str().is_some_and(|note| note.starts_with("Thinned: ")));
        let line = &chart["panels"][0]["lines"][0];
        let bytes = BASE64_STANDARD.decode(line["y"].as_str().unwrap()).unwrap();
        let values = bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()));
        let steps = line["steps"].as_array().unwrap().iter().map(|step| step.as_f64().unwrap());
        let [x0, dx] = ["x0", "dx"].map(|key| line[key].as_f64().unwrap());
        // The samples count ten per millisecond.
        let (mut place, mut points) = (0.0, Vec::new());
        for (step, value) in steps.zip(values) {
            place += step;
            points.push((10.0 * (x0 + dx * place), value));
        }
        let at = |i: u32| points.iter().find(|(place, _)| (place - f64::from(i)).abs() < 0.5);
        let has = |i: u32, sample: f32| at(i).is_some_and(|(_, value)| (value - sample).abs() < 1e-3);
        assert!(has(77_777, 99.0) && has(30_003, -50.0));
        let is_gap = |of: &[(f64, f32)]| of[0].0 < 20_000.0 && of[1].1.is_nan() && of[2].0 > 20_099.5;
        assert!(points.windows(3).any(is_gap));
        assert!((77_700..77_900).all(|near| at(near).is_some()));
        assert!((1_500..2_100).contains(&points.len()), "{}", points.len());
    }
}
