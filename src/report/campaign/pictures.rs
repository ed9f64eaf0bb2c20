//! Pictures of a series: slap-down speed on the predicted curves, measured over predicted, and k over angle
//! and number.

use super::BatchRow;
use super::series::{DropSeries, Pool, PooledQuantity, PredictedCurve, is_usable};
use crate::data::{BodyModel, Estimate};
use crate::report::pictures::draw::{Figure, Picture};
use crate::report::pictures::panel::{
    ALARM, COLOURS, Colour, Curve, Dash, Fill, GREY, INK, Mark, Panel, PanelAxis, PointShape, Points,
};
use crate::report::rounding::plain;
use crate::report::words::contact_words;

/// Half the width in which the mean of an angle is drawn, degrees.
const MEAN_DEG: f64 = 0.5;

/// Fewer drops show no trend.
const LEAST_TREND: usize = 3;

impl DropSeries<'_> {
    /// Pictures of the series; `number` distinguishes their files from those of other series.
    pub(super) fn pictures(&self, number: usize) -> Vec<Picture> {
        let picture = |quantity: PooledQuantity| match quantity {
            PooledQuantity::Speed => self.speeds(&Self::picture_name(number, quantity)),
            PooledQuantity::K => self.ks(&Self::picture_name(number, quantity)),
        };
        self.drawn_quantities().map(picture).collect()
    }

    /// Quantities with pictures: the speed always, since the prediction is drawn with it; k only for enough
    /// drops to show a trend.
    pub(super) fn drawn_quantities(&self) -> impl Iterator<Item = PooledQuantity> {
        let least = [(PooledQuantity::Speed, 1), (PooledQuantity::K, LEAST_TREND)];
        least.into_iter().filter(|(quantity, least)| self.count(*quantity) >= *least).map(|(it, _)| it)
    }

    /// The name of a picture of the series with this number.
    pub(super) fn picture_name(number: usize, quantity: PooledQuantity) -> String {
        format!("campaign-{}-{number}", quantity.words()[0].trim_start_matches("slap_down_"))
    }

    /// Counts the drops that have a value of the quantity.
    fn count(&self, quantity: PooledQuantity) -> usize {
        self.rows.iter().filter(|row| quantity.value(row).is_some_and(|e| e.value.is_finite())).count()
    }

    fn speeds(&self, name: &str) -> Picture {
        let mut speed = self.panel("Slap-down speed", "slap-down speed, m/s");
        (speed.fills, speed.lines) = predicted_lines(&self.curves);
        speed.marks = self.marks();
        let mut ratio = self.panel("Measured over predicted", "ratio");
        // Up to three drops leave room for both pictures beside each other.
        let is_short = self.count(PooledQuantity::Speed) < LEAST_TREND;
        if !is_short {
            (speed.height, ratio.height) = (520, 240);
        }
        if let Some((from, to)) = ratio.x.range {
            ratio.lines.push(Curve::new(GREY, vec![(from, 1.0), (to, 1.0)]));
        }
        let panels = [
            self.with_rows(speed, |row| PooledQuantity::Speed.value(row), |row| self.angle(row)),
            self.with_rows(ratio, relative, |row| self.angle(row)),
        ];
        let k = self.k.filter(|[low, high]| low < high).map_or_else(String::new, |[low, high]| {
            format!(", from {} to {}", plain(low, 3), plain(high, 3))
        });
        let caption = format!(
            "Slap-down speed: measured with 95 % intervals over the stated drop angle; repeats stand beside \
             one another. Bands: the analytical model over the measured range of k{k}. Ratio: measured over \
             predicted with each drop's own k. Hollow: with errors, in no mean. Ringed: outlier."
        );
        let title = format!("{}: slap-down speed over the drop angle", self.name);
        let columns = if is_short { 2 } else { 1 };
        Figure { columns, ..Figure::new(name, title, caption) }.picture(&panels)
    }

    fn ks(&self, name: &str) -> Picture {
        let k = |row: &BatchRow| PooledQuantity::K.value(row);
        let trend = Panel::new("k over the test number", "test number in the campaign", "k", 330);
        let mut panels = [
            self.with_rows(self.panel("k over the drop angle", "k"), k, |row| self.angle(row)),
            self.with_rows(trend, k, |row| Some(row.at.number.into())).with_air(0.03),
        ];
        // Over the number, drops at several angles alternate.
        let has_mean = |pool: &&Pool| pool.quantity == PooledQuantity::K && !pool.is_contradictory();
        for pool in self.pools.iter().filter(has_mean) {
            let [from, to] = pool.angles_deg;
            let ends = [from - MEAN_DEG, to + MEAN_DEG].map(|angle_deg| (angle_deg, pool.pooled.mean));
            panels[0].lines.push(Curve::new(GREY, ends.to_vec()).broken(Dash::Dashed));
        }
        let caption = "The coefficient of restitution with its 95 % interval. Dashed: mean of the repeats at \
                       an angle, without outliers. Hollow: with errors, in no mean. Ringed: outlier.";
        let spec = Figure { columns: 2, ..Figure::new(name, format!("{}: restitution", self.name), caption) };
        spec.picture(&panels)
    }

    fn panel(&self, title: &str, y: &str) -> Panel {
        let ends =
            self.curves.first().and_then(|curve| Some((curve.points.first()?.0, curve.points.last()?.0)));
        Panel::new(title, PanelAxis::new("drop angle, °").range(ends), y, 330)
    }

    /// The angle at which a row is drawn: slightly shifted beside its repeats.
    fn angle(&self, row: &BatchRow) -> Option<f64> {
        Some(row.at.angle_deg? + self.place(row).beside_deg)
    }

    /// The panel with the rows and their intervals.
    fn with_rows(
        &self,
        mut panel: Panel,
        y: impl Fn(&BatchRow) -> Option<Estimate>,
        x: impl Fn(&BatchRow) -> Option<f64>,
    ) -> Panel {
        let mut looks = [
            Points { radius: 7, ..Points::new(INK, PointShape::Dot, Vec::new()) }.label("measured"),
            Points { radius: 7, is_hollow: true, ..Points::new(GREY, PointShape::Dot, Vec::new()) },
            Points { radius: 15, ..Points::new(ALARM, PointShape::Ring, Vec::new()) },
        ];
        for row in &self.rows {
            let (Some(estimate), Some(x)) = (y(row).filter(|e| e.value.is_finite()), x(row)) else {
                continue;
            };
            let at = (x, estimate.value);
            let colour = if is_usable(row) { INK } else { GREY };
            if estimate.u95.is_finite() {
                let ends = vec![(x, estimate.value - estimate.u95), (x, estimate.value + estimate.u95)];
                panel.lines.push(Curve { stroke: 3, ..Curve::new(colour, ends) });
            }
            looks[usize::from(!is_usable(row))].at.push(at);
            if self.place(row).is_out {
                looks[2].at.push(at);
            }
        }
        panel.points.extend(looks.into_iter().filter(|points| !points.at.is_empty()));
        panel
    }

    /// The names of the outliers.
    fn marks(&self) -> Vec<Mark> {
        let out = self.rows.iter().filter(|row| self.place(row).is_out);
        out.filter_map(|row| Some(Mark { at: self.angle(row)?, label: row.id.clone() })).collect()
    }
}

fn relative(row: &BatchRow) -> Option<Estimate> {
    let comparison = row.comparison?;
    let ratio = comparison.measured / comparison.predicted;
    let share = (comparison.measured_u95 / comparison.measured)
        .hypot(comparison.predicted_u95 / comparison.predicted);
    Some(Estimate::new(ratio, ratio * share, "1"))
}

/// A band for each body and contact law between the curves of its lowest and highest k.
fn predicted_lines(curves: &[PredictedCurve]) -> (Vec<Fill>, Vec<Curve>) {
    let (mut fills, mut lines) = (Vec::new(), Vec::new());
    let is_same = |a: &PredictedCurve, b: &PredictedCurve| a.model == b.model && a.contact == b.contact;
    for (i, group) in curves.chunk_by(is_same).enumerate() {
        let colour: Colour = COLOURS[i % COLOURS.len()];
        let body = if group[0].model == BodyModel::Rod { "rod" } else { "body" };
        let label = format!("{body}, {}", contact_words(group[0].contact));
        let line = |curve: &PredictedCurve| Curve { stroke: 2, ..Curve::new(colour, curve.points.clone()) };
        lines.extend(group.iter().map(line));
        let (Some(low), Some(high)) = (group.first(), group.last()) else { continue };
        let values =
            |curve: &PredictedCurve| -> Vec<f64> { curve.points.iter().map(|point| point.1).collect() };
        let angles: Vec<f64> = low.points.iter().map(|point| point.0).collect();
        fills.push(Fill::new(colour, 0.16, Fill::band(&angles, &values(low), &values(high))).label(label));
    }
    (fills, lines)
}
