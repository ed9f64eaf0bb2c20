//! Groups the rows of a campaign into series, the drops of one cask from one height, and these into pools,
//! its repeats at one angle: k holds for one angle, and a drop at another is no outlier.

use super::{BatchRow, MOST_SERIES};
use crate::data::{BodyModel, Contact, Estimate, Verdict};
use crate::numerics::as_f64;
use crate::numerics::pooled::{Pooled, ScatterWord, combine, compare_with_others};
use crate::report::rounding::plain;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashMap};

/// Extension of the predicted curves beyond the angles of the tests, degrees.
const BEYOND_DEG: f64 = 5.0;

/// The predicted slap-down speed over the angle.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictedCurve {
    /// Rod or body.
    pub model: BodyModel,
    /// The contact law.
    pub contact: Contact,
    /// Points of one k: angle, degrees, and speed, m/s.
    pub points: Vec<(f64, f64)>,
}

/// A quantity that repeats have in common.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum PooledQuantity {
    K,
    Speed,
}

impl PooledQuantity {
    const ALL: [Self; 2] = [Self::K, Self::Speed];

    pub(super) fn value(self, row: &BatchRow) -> Option<Estimate> {
        match self {
            Self::K => row.k,
            Self::Speed => row.slap_down_speed,
        }
    }

    /// Name in JSON, unit, and name for a reader.
    pub(super) fn words(self) -> [&'static str; 3] {
        match self {
            Self::K => ["k", "1", "k"],
            Self::Speed => ["slap_down_speed", "m/s", "slap-down speed"],
        }
    }
}

/// A row among its repeats: E_n against the others, and true for an outlier.
pub(super) struct PoolMember<'a> {
    pub(super) row: &'a BatchRow,
    pub(super) e_n: Option<f64>,
    pub(super) is_out: bool,
}

/// One quantity of the sound drops at one angle.
pub(super) struct Pool<'a> {
    /// The least and the largest of the stated angles, which count as equal within their tolerances.
    pub(super) angles_deg: [f64; 2],
    pub(super) quantity: PooledQuantity,
    pub(super) members: Vec<PoolMember<'a>>,
    /// Combined value of the repeats that are no outliers.
    pub(super) pooled: Pooled,
}

impl Pool<'_> {
    /// True if each of the repeats contradicts the others.
    pub(super) fn is_contradictory(&self) -> bool {
        self.members.iter().all(|member| member.is_out)
    }
}

/// Position of a row among its repeats at its angle.
#[derive(Clone, Copy, Default)]
pub(super) struct RowPlace {
    /// E_n of k and of the speed against the others.
    pub(super) e_n: [Option<f64>; 2],
    pub(super) is_out: bool,
    /// Shift of its point beside its angle, degrees.
    pub(super) beside_deg: f64,
}

/// Distance at which repeats at one angle are drawn, degrees.
const BESIDE_DEG: f64 = 0.16;

/// The drops of one cask from one height.
#[derive(Default)]
pub(super) struct DropSeries<'a> {
    pub(super) name: String,
    pub(super) rows: Vec<&'a BatchRow>,
    pub(super) pools: Vec<Pool<'a>>,
    pub(super) curves: Vec<PredictedCurve>,
    places: HashMap<u32, RowPlace>,
    /// Lowest and highest measured k, without outliers.
    pub(super) k: Option<[f64; 2]>,
}

impl<'a> DropSeries<'a> {
    /// Groups the rows into series, in the order in which their casks come; `predicted` gives the curves of a
    /// row's cask over these k and angles.
    pub(super) fn from_rows(
        rows: &'a [BatchRow],
        predicted: impl Fn(&BatchRow, [f64; 2], [f64; 2]) -> Vec<PredictedCurve>,
    ) -> Vec<Self> {
        let mut series: Vec<Self> = Vec::new();
        let mut places: BTreeMap<&str, usize> = BTreeMap::new();
        let mut named: HashMap<&str, usize> = HashMap::new();
        for row in rows.iter().filter(|row| row.verdict.is_some()) {
            let place = *places.entry(&row.at.series).or_insert(series.len());
            if place == series.len() {
                let same = named.entry(&row.at.cask).or_default();
                *same += 1;
                let name = if *same == 1 { row.at.cask.clone() } else { format!("{} ({same})", row.at.cask) };
                series.push(Self { name, ..Self::default() });
            }
            series[place].rows.push(row);
        }
        for (number, series) in series.iter_mut().enumerate() {
            series.pools = pools(&series.rows);
            series.set_places();
            let sound = series.rows.iter().filter(|row| is_usable(row) && !series.place(row).is_out);
            series.k = lowest_and_highest(sound.filter_map(|row| Some(row.k?.value)));
            if let (Some(k), Some([from, to]), 0..MOST_SERIES) =
                (series.k, lowest_and_highest(series.rows.iter().filter_map(|row| row.at.angle_deg)), number)
            {
                let angles = [(from - BEYOND_DEG).max(0.5), (to + BEYOND_DEG).min(90.0)];
                series.curves = predicted(series.rows[0], k.map(|k| k.clamp(0.0, 1.0)), angles);
            }
        }
        series
    }

    /// Positions of all rows by their numbers.
    pub(super) fn places(series: &[Self]) -> HashMap<u32, RowPlace> {
        series
            .iter()
            .flat_map(|series| series.places.iter().map(|(number, place)| (*number, *place)))
            .collect()
    }

    /// Position of a row among its repeats.
    pub(super) fn place(&self, row: &BatchRow) -> RowPlace {
        self.places.get(&row.at.number).copied().unwrap_or_default()
    }

    /// Gives each row its place.
    fn set_places(&mut self) {
        let mut repeats: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
        for row in &self.rows {
            let angle = row.at.angle_deg.unwrap_or_default();
            repeats.entry(angle.to_bits()).or_default().push(row.at.number);
        }
        for numbers in repeats.into_values() {
            let count = as_f64(numbers.len());
            for (i, number) in numbers.into_iter().enumerate() {
                let beside_deg = BESIDE_DEG.min(2.0 / count) * (as_f64(i) - (count - 1.0) / 2.0);
                self.places.insert(number, RowPlace { beside_deg, ..RowPlace::default() });
            }
        }
        for (pool, member) in self.pools.iter().flat_map(|pool| pool.members.iter().map(move |m| (pool, m))) {
            let place = self.places.entry(member.row.at.number).or_default();
            place.e_n[pool.quantity as usize] = member.e_n;
            place.is_out |= member.is_out;
        }
    }

    /// The pools as `campaign.json` has them.
    pub(super) fn records(&self) -> Vec<Value> {
        let repeat = |m: &PoolMember| json!({"id": m.row.id, "e_n": m.e_n, "falls_out": m.is_out});
        let record = |pool: &Pool| {
            let Pooled { count, mean, u95, scatter, chi_square } = pool.pooled;
            let [quantity, unit, _] = pool.quantity.words();
            json!({
                "cask": self.name, "angle_deg": pool.angles_deg[0], "quantity": quantity,
                "unit": unit, "count": count, "mean": mean, "u95": u95, "scatter": scatter,
                "chi_square": chi_square, "degrees": count - 1,
                "scatter_is": pool.pooled.word().map(scatter_words),
                "repeats": pool.members.iter().map(repeat).collect::<Vec<_>>(),
            })
        };
        self.pools.iter().map(record).collect()
    }
}

/// Says how the scatter compares with the stated intervals.
pub(super) fn scatter_words(word: ScatterWord) -> &'static str {
    match word {
        ScatterWord::Smaller => "smaller than stated",
        ScatterWord::AsStated => "as stated",
        ScatterWord::Larger => "larger than stated",
    }
}

/// True if the numbers enter a mean: after an error they depend on the replacement of a lost velocity step.
pub(super) fn is_usable(row: &BatchRow) -> bool {
    row.verdict.is_some_and(|verdict| verdict != Verdict::Fail)
}

impl Pool<'_> {
    /// Formats "15°", or "14.8 to 15°" if the stated angles differ.
    pub(super) fn angle_words(&self) -> String {
        let [least, largest] = self.angles_deg.map(|angle| plain(angle, 4));
        if least == largest { format!("{least}°") } else { format!("{least} to {largest}°") }
    }
}

/// Pools of both quantities at every angle.
fn pools<'a>(rows: &[&'a BatchRow]) -> Vec<Pool<'a>> {
    // A recording that is listed several times is one drop.
    let drops = rows.iter().filter(|row| row.same_recording_as.is_none());
    let mut drops: Vec<(f64, &BatchRow)> =
        drops.filter_map(|row| Some((row.at.angle_deg.filter(|a| a.is_finite())?, *row))).collect();
    drops.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut repeats: Vec<([f64; 2], Vec<&BatchRow>)> = Vec::new();
    for (angle_deg, row) in drops {
        let within_deg = |other: &BatchRow| row.at.angle_u95_deg.min(other.at.angle_u95_deg);
        match repeats.last_mut().filter(|(angles, rows)| angle_deg - angles[0] <= within_deg(rows[0])) {
            Some((angles, rows)) => {
                angles[1] = angle_deg;
                rows.push(row);
            }
            None => repeats.push(([angle_deg; 2], vec![row])),
        }
    }
    let pools = |(angles, rows): &([f64; 2], Vec<&'a BatchRow>)| {
        PooledQuantity::ALL.map(|quantity| pool(*angles, quantity, rows))
    };
    repeats.iter().flat_map(pools).flatten().collect()
}

fn pool<'a>(angles_deg: [f64; 2], quantity: PooledQuantity, rows: &[&'a BatchRow]) -> Option<Pool<'a>> {
    let measured = |row: &&'a BatchRow| {
        let estimate =
            quantity.value(row).filter(|e| e.value.is_finite() && e.u95.is_finite() && e.u95 > 0.0);
        estimate.filter(|_| is_usable(row)).map(|e| (*row, (e.value, e.u95)))
    };
    let (rows, values): (Vec<&BatchRow>, Vec<(f64, f64)>) = rows.iter().filter_map(measured).unzip();
    let found = compare_with_others(&values);
    let kept: Vec<(f64, f64)> =
        values.iter().zip(&found).filter(|(_, (_, is_out))| !is_out).map(|(value, _)| *value).collect();
    // If all contradict one another none is more credible, and their mean is not shown.
    let pooled = combine(if kept.is_empty() { &values } else { &kept })?;
    let members = rows.into_iter().zip(found).map(|(row, (e_n, is_out))| PoolMember { row, e_n, is_out });
    Some(Pool { angles_deg, quantity, members: members.collect(), pooled })
}

/// The lowest and the highest.
fn lowest_and_highest(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.filter(|value| value.is_finite()).fold(None, |ends, value| {
        Some(ends.map_or([value, value], |[low, high]: [f64; 2]| [low.min(value), high.max(value)]))
    })
}

#[cfg(test)]
mod tests {
    use super::super::DropPoint;
    use super::*;

    fn row(number: u32, angle_deg: f64, k: f64) -> BatchRow {
        BatchRow {
            id: number.to_string(),
            verdict: Some(Verdict::Pass),
            k: Some(Estimate::new(k, 0.02, "1")),
            at: DropPoint { number, angle_deg: Some(angle_deg), angle_u95_deg: 0.4, ..DropPoint::default() },
            ..BatchRow::default()
        }
    }

    #[test]
    fn a_drop_at_another_angle_is_no_outlier_and_in_no_mean_but_its_own() {
        let angles = [15.0, 30.0, 15.0, 15.3, 30.0, 30.0, 22.0];
        let ks = [0.43, 0.51, 0.44, 0.42, 0.52, 0.50, 0.9];
        let rows: Vec<BatchRow> = (1..).zip(angles).zip(ks).map(|((i, angle), k)| row(i, angle, k)).collect();
        let series = DropSeries::from_rows(&rows, |_, _, _| Vec::new());
        let pools: Vec<(String, usize, f64)> = series[0]
            .pools
            .iter()
            .map(|pool| (pool.angle_words(), pool.members.len(), (1e3 * pool.pooled.mean).round() / 1e3))
            .collect();
        let expected = [("15 to 15.3°", 3, 0.43), ("22°", 1, 0.9), ("30°", 3, 0.51)];
        assert_eq!(pools, expected.map(|(words, count, mean)| (words.to_owned(), count, mean)));
        assert!(series[0].pools.iter().flat_map(|pool| &pool.members).all(|member| !member.is_out));
    }

    #[test]
    fn angles_farther_apart_than_their_tolerance_are_two() {
        let rows = [(1, 15.0), (2, 15.3), (3, 15.6)].map(|(number, angle)| row(number, angle, 0.5));
        let series = DropSeries::from_rows(&rows, |_, _, _| Vec::new());
        // The third lies within the tolerance of the second, but not of the first.
        assert_eq!(series[0].pools.iter().map(|pool| pool.members.len()).collect::<Vec<_>>(), [2, 1]);
    }
}
