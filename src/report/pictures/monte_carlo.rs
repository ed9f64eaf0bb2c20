//! Picture of the Monte Carlo results: quantiles of the speed, share of the draws in their band, histogram of
//! the critical angle.

use super::super::rounding::plain;
use super::super::words::{bands_words, criterion_words, degrees};
use super::draw::{Figure, Picture};
use super::look::{angle_panel, edges};
use super::panel::{COLOURS, Curve, Dash, Fill, Panel, points};
use crate::data::{Criterion, QuantileCurves, Study};

const NOTHING: (&str, &str) = (
    "There is nothing to show: fewer than half of the draws have a slap-down.",
    "No quantiles could be had.",
);

/// The picture.
pub(super) fn picture(study: &Study, name: &str) -> Picture {
    let found = &study.monte_carlo;
    let title = format!("Slap-down speed under uncertain inputs, {}", found.model.as_str());
    let has_draws =
        |q: &&QuantileCurves| q.criterion == Criterion::Speed && q.critical_angle_deg[2].is_finite();
    let speed = found.quantiles.iter().find(has_draws);
    let panels = speed.map(|speed| [quantiles(study, speed), shares(study), histogram(study, speed)]);
    let caption = format!(
        "{} draws, seed {}. Above: median and quantiles of the slap-down speed over the nominal drop angle. \
         Middle: share of the draws whose value at that angle is within {} % of their own largest, with the \
         length of the contact that makes it least; shaded: the robust band of the speed. Below: at which \
         angle each draw's speed is largest; shaded 95 % of the draws.",
        found.uncertain.draws,
        found.uncertain.seed,
        plain(found.band_percent, 3)
    );
    Figure::new(name, title, caption).empty(NOTHING).picture(panels.as_ref().map_or(&[], |panels| panels))
}

fn quantiles(study: &Study, speed: &QuantileCurves) -> Panel {
    let x = &study.monte_carlo.angle_deg;
    let mut panel = angle_panel(&study.request, "Slap-down speed", "slap-down speed, m/s");
    let fill = |label: &str, opacity, low, high| {
        Fill::new(COLOURS[0], opacity, Fill::band(x, low, high)).label(label)
    };
    panel.fills = vec![
        fill("95 % of the draws", 0.22, &speed.q025, &speed.q975),
        fill("50 %", 0.40, &speed.q25, &speed.q75),
    ];
    panel.lines = vec![Curve::new(COLOURS[0], points(x, &speed.q50, [1.0, 1.0])).label("median")];
    panel
}

fn shares(study: &Study) -> Panel {
    let found = &study.monte_carlo;
    let title = format!("Share of the draws within {} % of their largest", plain(found.band_percent, 3));
    let mut panel = angle_panel(&study.request, title, "share of the draws, %");
    panel.y.range = Some((0.0, 104.0));
    panel.height = 300;
    let line = |label: &str, colour: usize, dash, shares: &[f64]| {
        let points = points(&found.angle_deg, shares, [1.0, 100.0]);
        Curve::new(COLOURS[colour], points).label(label).broken(dash)
    };
    for q in &found.quantiles {
        let (colour, dash) = match q.criterion {
            Criterion::Speed => (0, Dash::Solid),
            Criterion::VerticalSpeed => (1, Dash::Dashed),
            Criterion::EnergyRatio => (2, Dash::Dotted),
        };
        panel.lines.push(line(criterion_words(q.criterion), colour, dash, &q.in_band));
        if q.criterion == Criterion::Speed {
            let areas = q.robust_bands_deg.iter().map(|band| Fill::rectangle(*band, (0.0, 104.0)));
            panel.fills.push(Fill::new(COLOURS[0], 0.14, areas.collect()));
        }
    }
    if found.no_slap_down.iter().any(|share| *share > 0.0) {
        let without = line("no slap-down", 6, Dash::Dashed, &found.no_slap_down);
        panel.lines.push(Curve { opacity: 0.9, ..without });
    }
    panel
}

fn histogram(study: &Study, speed: &QuantileCurves) -> Panel {
    let found = &study.monte_carlo;
    let bars = bars(&found.angle_deg, &speed.critical_counts);
    let [low, _, median, _, high] = speed.critical_angle_deg;
    let title =
        format!("Critical angle: median {}°, 95 % within {}°", degrees(median), bands_words(&[(low, high)]));
    let mut panel = angle_panel(&study.request, title, "share of the draws, %");
    panel.height = 260;
    let top = bars.iter().map(|(_, share)| *share).fold(f64::MIN_POSITIVE, f64::max) * 1.1;
    panel.y.range = Some((0.0, top));
    let shown = bars.into_iter().filter(|(_, share)| *share > 0.0);
    let areas = shown.map(|(ends, share)| Fill::rectangle(ends, (0.0, share))).collect();
    panel.fills = vec![
        Fill::new(COLOURS[0], 0.14, vec![Fill::rectangle((low, high), (0.0, top))]),
        Fill::new(COLOURS[0], 0.75, areas),
    ];
    panel
}

/// Angles of each bar, and its height, percent of the draws.
fn bars(angle_deg: &[f64], counts: &[u32]) -> Vec<((f64, f64), f64)> {
    let all = counts.iter().map(|count| f64::from(*count)).sum::<f64>().max(1.0);
    let bar = |(ends, count): (&[f64], &u32)| ((ends[0], ends[1]), 100.0 * f64::from(*count) / all);
    edges(angle_deg).windows(2).zip(counts).map(bar).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_hold_every_draw() {
        let angle_deg: Vec<f64> = (0..91).map(f64::from).collect();
        let mut counts = vec![0; 91];
        counts[0] = 100;
        counts[30] = 600;
        counts[31] = 200;
        counts[90] = 100;
        let bars = bars(&angle_deg, &counts);
        // Shares of 1000 draws are whole tenths of a percent: their sum is exact but for round-off.
        assert!((bars.iter().map(|(_, share)| share).sum::<f64>() - 100.0).abs() < 1e-9);
        assert!(bars.len() == 91 && bars.windows(2).all(|w| w[0].0.1.to_bits() == w[1].0.0.to_bits()));
        assert_eq!(bars.iter().filter(|(_, share)| *share > 0.0).count(), 4);
    }
}
