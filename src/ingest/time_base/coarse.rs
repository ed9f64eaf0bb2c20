//! Times coarser than the sample interval, such as stamps of whole milliseconds at 10 kHz, to a rate and how
//! well they tell it.
//!
//! A sample whose stamp is later than the one before it was taken within one interval of that stamp. All
//! lines through these changes that keep to this are as good as one another: the middle one's slope is the
//! period, half of their spread its uncertainty. A line through all samples would be off by about (step /
//! record)², 1 % for ten steps (docs/formats.md).

use super::missing;
use super::pieces::Uniform;
use crate::data::{Finding, Samples, TimesFinding};
use crate::ingest::clock::{Claims, RATE_TOLERANCE, of_times, usual_step};
use crate::ingest::{refusal::Refusal, shown::digits};
use crate::numerics::{as_count, as_f64, extent};

/// Fewer changes make two whole steps at most, which agree with any jitter: nothing would show that they are
/// even.
const LEAST_CHANGES: usize = 4;

/// A rate more uncertain than this, as a part of itself, makes a warning. Every velocity is off by as much;
/// it is the part by which a declared rate may contradict the times, and a tenth of what the intervals hold
/// for each channel's calibration.
const UNSURE: f64 = RATE_TOLERANCE;

/// A rate more uncertain than this is none: what the intervals hold for the calibration no longer covers it.
const UNKNOWN: f64 = 0.01;

/// Changes this many steps off a line: samples are missing, or the stamps are not those of the samples.
const UNEVEN_STEPS: f64 = 1.5;

/// Even changes keep to one period about their line; this part of it more is for round-off.
const ROUND_OFF: f64 = 0.01;

/// Halvings of a bracket: to a part in 2⁴⁸ of it, the round-off of its ends.
const HALVINGS: usize = 48;

/// What the changes of coarse times say.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Steps {
    /// Time of sample 0, s.
    start_s: f64,
    period_s: f64,
    /// Half-width of the period, as a part of it.
    uncertainty: f64,
    /// How far the changes are from the line at most, s.
    off_s: f64,
    /// Whether the samples may have been taken evenly.
    is_even: bool,
}

/// Samples with times that rise but for many that repeat, evenly spaced.
pub(super) fn place(
    times_s: &[f64],
    mut samples: Samples,
    claims: &Claims,
    mut issues: Vec<Finding>,
) -> Result<Uniform, Refusal> {
    let changes_of =
        |times: &[f64]| -> Vec<usize> { (1..times.len()).filter(|&i| times[i] > times[i - 1]).collect() };
    let (mut changes, step_s) = (changes_of(times_s), usual_step(times_s));
    let filled = filled(times_s, &samples, &changes, step_s);
    let mut times_s = times_s;
    if let Some(filled) = &filled {
        (times_s, samples, changes) = (&filled.times, filled.samples.clone(), changes_of(&filled.times));
        issues.push(filled.finding.clone());
    }
    no_rows_of_sensors(&changes, step_s, times_s.len(), claims)?;
    let told = (changes.len() >= LEAST_CHANGES).then(|| Steps::of(times_s, &changes));
    let steps = told.filter(|steps| steps.uncertainty <= UNKNOWN && steps.off_s <= UNEVEN_STEPS * step_s);
    if steps.is_none() && claims.is_empty() {
        let problem = match changes.len() {
            0 => format!("all times are {} s: these are no times", times_s[0]),
            changes => format!(
                "the times are cut to {} s: {} samples share {} times that are too few or too uneven to tell \
                 their rate",
                digits(step_s, 3),
                times_s.len(),
                changes + 1
            ),
        };
        let mend = "give sample_rate_hz for this channel, or name its times (`time`)";
        return Err(Refusal::new(problem, mend));
    }
    // Uneven changes tell no rate that could contradict a stated one.
    let even = steps.filter(|steps| steps.is_even || claims.is_empty());
    let own = even.map(|steps| of_times(1.0 / steps.period_s, steps.uncertainty));
    let taken = claims.weigh(own.as_ref())?;
    let sample_rate_hz = taken.rate_hz;
    let start_s = if let Some(steps) = steps.filter(|_| taken.is_of_times) {
        issues.push(steps.finding(step_s));
        steps.start_s
    } else {
        let (start_s, found) = at_rate(times_s, &changes, sample_rate_hz, step_s, told);
        issues.extend(Some(found).filter(|_| taken.issues.is_empty()));
        start_s
    };
    issues.extend(taken.issues);
    let gaps = missing::mark(&mut samples, 0, |i| start_s + as_f64(i) / sample_rate_hz, &mut issues);
    Ok(Uniform { start_s, span_s: None, sample_rate_hz, samples, gaps, time_jitter_s: 0.0, issues })
}

/// Times and samples with those that are missing.
struct FilledTimes {
    times: Vec<f64>,
    samples: Samples,
    finding: Finding,
}

/// Rows that are missing in steps of the times that hold fewer than nine in ten others do, or that are not
/// there: such a step is lost as a whole, since nothing says which of its rows are.
fn filled(times_s: &[f64], samples: &Samples, changes: &[usize], step_s: f64) -> Option<FilledTimes> {
    /// Rates that differ from a whole number of samples a step lack one row now and then.
    const MOST_OF_DRIFT: usize = 2;
    let steps: Vec<(usize, usize)> = changes.windows(2).map(|pair| (pair[0], pair[1])).collect();
    let mut counts: Vec<usize> = steps.iter().map(|(from, to)| to - from).collect();
    counts.sort_unstable();
    let usual = counts.get(counts.len() / 2).copied().filter(|usual| *usual > 1)?;
    let others = counts.iter().filter(|count| **count != usual).count();
    if counts.len() < LEAST_CHANGES || 10 * others > counts.len() || counts.last() != Some(&usual) {
        return None;
    }
    let skipped = |at: usize| ((times_s[at] - times_s[at - 1]) / step_s).round() - 1.0;
    let short: Vec<(usize, usize)> = steps.iter().copied().filter(|(from, to)| to - from < usual).collect();
    let by_one = short.iter().filter(|(from, to)| to - from + 1 == usual).count();
    let jumps = changes.iter().filter(|at| skipped(**at) >= 1.0);
    let lost = jumps.clone().map(|at| as_count(skipped(*at))).sum::<usize>() * usual;
    if (short.is_empty() && lost == 0) || by_one > MOST_OF_DRIFT || lost > times_s.len() {
        return None;
    }
    let (mut times, mut values) = (Vec::new(), Vec::new());
    let mut row = 0;
    while row < times_s.len() {
        if changes.binary_search(&row).is_ok() {
            for step in 1..=as_count(skipped(row).max(0.0)) {
                times.extend(vec![times_s[row - 1] + as_f64(step) * step_s; usual]);
            }
        }
        let step = short.binary_search_by_key(&row, |(from, _)| *from).ok().map(|at| short[at]);
        let to = step.map_or(row + 1, |(_, to)| to);
        times.extend(vec![times_s[row]; if step.is_some() { usual } else { 1 }]);
        values.resize(times.len() - usize::from(step.is_none()), f64::NAN);
        values.extend(step.is_none().then(|| samples.get(row)));
        row = to;
    }
    let missing = times.len() - times_s.len();
    let finding = Finding::from(TimesFinding::ShortSteps { missing, step_s, usual });
    let from_s = short.iter().map(|(from, _)| times_s[*from]).chain(jumps.map(|at| times_s[at - 1]));
    let (first_s, last_s) = extent(from_s);
    let finding = finding.span(first_s, last_s + step_s);
    Some(FilledTimes { times, samples: samples.match_precision(values), finding })
}

/// Refuses times of which each stands exactly two, three or four times, as on rows of so many sensors, unless
/// a rate that is stated shows that their clock is coarse.
fn no_rows_of_sensors(changes: &[usize], step_s: f64, count: usize, claims: &Claims) -> Result<(), Refusal> {
    const SENSORS: std::ops::RangeInclusive<usize> = 2..=4;
    /// Of so many times all but one: a row may be lost here and there.
    const ALL_BUT_ONE_OF: usize = 20;
    let rows = count.div_ceil(changes.len() + 1);
    let others = changes.windows(2).filter(|pair| pair[1] - pair[0] != rows).count();
    if !SENSORS.contains(&rows) || changes.len() < LEAST_CHANGES || ALL_BUT_ONE_OF * others > changes.len() {
        return Ok(());
    }
    let rate_hz = as_f64(rows) / step_s;
    let stated_hz = claims.cask_hz.or(claims.stated.first().map(|stated| stated.rate_hz));
    if stated_hz.is_some_and(|stated_hz| (stated_hz / rate_hz - 1.0).abs() <= UNKNOWN) {
        return Ok(());
    }
    Err(Refusal::new(
        format!(
            "each of its times stands exactly {rows} times: on rows of {rows} sensors, or by a clock that is \
             cut to {} s",
            digits(step_s, 3)
        ),
        format!(
            "where the rows are of several sensors name the one that is meant (`where`); where they are \
             samples one after another write sample_rate_hz = {}",
            digits(rate_hz, 6)
        ),
    ))
}

impl Steps {
    /// Of times with two changes at least.
    fn of(times_s: &[f64], changes: &[usize]) -> Self {
        let first = changes[0];
        let first_s = times_s[first];
        let points: Vec<(f64, f64)> =
            changes.iter().map(|&i| (as_f64(i - first), times_s[i] - first_s)).collect();
        let held_s = 4.0 * f64::EPSILON * times_s[0].abs().max(times_s[times_s.len() - 1].abs());
        let (length, last_s) = points[points.len() - 1];
        let points = hull(&points);
        let width = |period_s: f64| range(points.iter().copied(), period_s).1;
        let through_s = last_s / length;
        // The end points alone keep the best slope within this.
        let reach_s = width(through_s) / length;
        let best_s = least(&width, through_s - reach_s, through_s + reach_s);
        let best_width_s = width(best_s);
        let is_even = best_width_s <= (1.0 + ROUND_OFF) * best_s + held_s;
        // Uneven ones have no width of their own: twice the least one is as likely.
        let most_s = if is_even { best_s.max(best_width_s) } else { 2.0 * best_width_s };
        let far_s = (most_s + best_width_s) / length;
        let (low_s, high_s) =
            (edge(&width, most_s, (best_s, best_s - far_s)), edge(&width, most_s, (best_s, best_s + far_s)));
        let period_s = f64::midpoint(low_s, high_s);
        let (lowest_s, width_s) = range(points.iter().copied(), period_s);
        let middle_s = first_s + lowest_s + width_s / 2.0;
        Self {
            // A change lies up to one period before its sample, half of one in the mean.
            start_s: middle_s + period_s / 2.0 - period_s * as_f64(first),
            period_s,
            uncertainty: (high_s - low_s) / (2.0 * period_s),
            off_s: width_s / 2.0,
            is_even,
        }
    }

    fn finding(&self, step_s: f64) -> Finding {
        let &Self { uncertainty, is_even, .. } = self;
        let off_s = (!is_even).then_some(self.off_s);
        let is_sure = is_even && uncertainty <= UNSURE;
        TimesFinding::Coarse { step_s, rate_hz: 1.0 / self.period_s, uncertainty, off_s, is_sure }.into()
    }
}

/// Time of sample 0 at a rate that is declared beside coarse times, which change by `step_s` and tell the
/// `steps`, and what is said of it.
fn at_rate(
    times_s: &[f64],
    changes: &[usize],
    rate_hz: f64,
    step_s: f64,
    steps: Option<Steps>,
) -> (f64, Finding) {
    if changes.is_empty() {
        return (times_s[0], TimesFinding::AllEqual { rate_hz }.into());
    }
    let period_s = 1.0 / rate_hz;
    let points = changes.iter().map(|&i| (as_f64(i), times_s[i] - times_s[0]));
    let (lowest_s, width_s) = range(points, period_s);
    // Each change lies within one interval of its sample, and the rate may be off by its tolerance; more is
    // samples lost or another rate.
    let length_s = times_s[times_s.len() - 1] - times_s[0];
    let is_uneven = steps.is_some_and(|steps| !steps.is_even);
    let is_off = is_uneven || width_s > (1.0 + ROUND_OFF) / rate_hz + RATE_TOLERANCE * length_s;
    let found = TimesFinding::CoarseBesideRate { step_s, rate_hz, off_s: is_off.then_some(width_s) };
    (times_s[0] + lowest_s + width_s / 2.0 + period_s / 2.0, found.into())
}

/// Of what the points are above a line through the origin, the least and the width.
fn range(points: impl Iterator<Item = (f64, f64)>, slope: f64) -> (f64, f64) {
    let (low, high) = extent(points.map(|(x, y)| y - slope * x));
    (low, high - low)
}

/// The corners of points that rise in x, lower and upper: no line touches any other (Andrew 1979).
fn hull(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut corners = Vec::new();
    for side in [1.0, -1.0] {
        let mut chain: Vec<(f64, f64)> = Vec::new();
        for &(x, y) in points {
            while let [.., a, b] = chain[..]
                && side * ((b.0 - a.0) * (y - a.1) - (b.1 - a.1) * (x - a.0)) <= 0.0
            {
                chain.pop();
            }
            chain.push((x, y));
        }
        corners.append(&mut chain);
    }
    corners
}

/// Where a convex function is least between two places.
fn least(function: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..2 * HALVINGS {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if function(a) <= function(b) {
            high = b;
        } else {
            low = a;
        }
    }
    f64::midpoint(low, high)
}

/// Where a function that is at most `most` at `inside` and above it at `outside` passes `most`.
fn edge(function: &impl Fn(f64) -> f64, most: f64, (mut inside, mut outside): (f64, f64)) -> f64 {
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(inside, outside);
        if function(middle) <= most {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Samples;
    use crate::data::{IssueCode, ResultPart, Severity};
    use crate::ingest::time_base::{Uniform, from_times};

    #[test]
    fn a_row_that_a_step_of_the_times_lacks_is_missing() {
        for (lost, missing) in [(300..301, 5), (300..302, 5), (303..315, 15), (0..0, 0)] {
            let rows: Vec<usize> = (0..600).filter(|row| !lost.contains(row)).collect();
            let times_s: Vec<f64> = rows.iter().map(|row| as_f64(row / 5) * 1e-3).collect();
            let samples = Samples::F64(rows.iter().map(|row| as_f64(*row)).collect());
            let placed = from_times(&times_s, samples, None).unwrap();
            assert_eq!((placed.samples.len(), placed.samples.missing()), (600, missing), "{lost:?}");
            let is_placed =
                |row: usize| placed.samples.get(row).is_nan() || placed.samples.get(row) - as_f64(row) == 0.0;
            assert!((0..600).all(is_placed), "{lost:?}");
        }
    }

    fn is_too_coarse(error: &Refusal) -> bool {
        error.to_string().contains("too few or too uneven to tell their rate")
    }

    /// Times of `count` samples at a rate from `from_s` on, cut to steps.
    fn cut(rate_hz: f64, step_s: f64, from_s: f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| ((from_s + as_f64(i) / rate_hz) / step_s + 1e-9).floor() * step_s).collect()
    }

    fn placed(times_s: &[f64], declared_hz: Option<f64>) -> Result<Uniform, Refusal> {
        from_times(times_s, Samples::F64((0..times_s.len()).map(as_f64).collect()), declared_hz)
    }

    fn only(uniform: &Uniform) -> (Severity, &str) {
        let [issue] = &uniform.issues[..] else { panic!("{:?}", uniform.issues) };
        assert_eq!(issue.code, IssueCode::Clock);
        (issue.severity, &issue.message)
    }

    #[test]
    fn the_rate_of_cut_times_lies_within_its_uncertainty() {
        let mut surest = f64::INFINITY;
        for (rate_hz, step_s, length_s) in [
            (20_000.0, 0.1, 0.45),
            (20_011.3, 0.1, 1.0),
            (20_000.0, 1e-3, 0.3),
            (9_973.0, 0.015_625, 0.5),
            (1_613.0, 1e-3, 0.9),
            (50_000.0, 1.0, 5.3),
        ] {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count")]
            let count = (length_s * rate_hz) as usize;
            for part in 0..20 {
                let from_s = 7.0 + as_f64(part) / 20.0 * step_s;
                let times_s = cut(rate_hz, step_s, from_s, count);
                let uniform = placed(&times_s, None).unwrap();
                let changes: Vec<usize> = (1..count).filter(|&i| times_s[i] > times_s[i - 1]).collect();
                let steps = Steps::of(&times_s, &changes);
                let error = (uniform.sample_rate_hz / rate_hz - 1.0).abs();
                assert!(error <= steps.uncertainty + 1e-9, "{rate_hz} {step_s} {part}: {error:e}, {steps:?}");
                assert!(steps.is_even && steps.uncertainty < 1e-3, "{rate_hz} {step_s} {part}: {steps:?}");
                assert!((uniform.start_s - from_s).abs() < 1.1 / rate_hz, "{} for {from_s}", uniform.start_s);
                assert_eq!(only(&uniform).0, Severity::Note, "{}", only(&uniform).1);
                assert_eq!(uniform.samples.len(), count);
                surest = surest.min(steps.uncertainty);
            }
        }
        assert!(surest < 1e-5, "{surest}");
    }

    #[test]
    fn the_note_says_step_rate_and_uncertainty() {
        let uniform = placed(&cut(20_000.0, 0.1, 0.03, 9000), None).unwrap();
        assert_eq!(
            only(&uniform).1,
            "the times are cut to 0.1 s, about 2000 samples each; the samples were taken as evenly spaced at \
             20000 Hz, a rate that is uncertain by 0.017 %, and the channel's start is known to 0.1 s only"
        );
    }

    #[test]
    fn too_few_steps_tell_no_rate() {
        // Whole seconds, two and a half of them.
        let times_s = cut(2000.0, 1.0, 0.3, 5000);
        let error = placed(&times_s, None).unwrap_err();
        assert!(error.to_string().contains("cut to 1 s: 5000 samples share 3 times"), "{error}");
        assert!(error.remedy.contains("give sample_rate_hz"), "{error}");
        let uniform = placed(&times_s, Some(2000.0)).unwrap();
        assert_eq!((uniform.sample_rate_hz, uniform.samples.len()), (2000.0, 5000));
        assert_eq!(only(&uniform).0, Severity::Note);
        assert!((uniform.start_s - 0.3).abs() < 1e-3, "{}", uniform.start_s);
        // Within one second.
        let equal = vec![5.0; 3000];
        assert!(placed(&equal, None).unwrap_err().to_string().contains("all times are 5 s"));
        let uniform = placed(&equal, Some(2000.0)).unwrap();
        assert_eq!((uniform.start_s, uniform.sample_rate_hz), (5.0, 2000.0));
        assert!(only(&uniform).1.contains("all times are equal"), "{}", only(&uniform).1);
    }

    #[test]
    fn a_wrong_declared_rate_is_a_warning() {
        let times_s = cut(20_000.0, 0.01, 0.0, 9000);
        assert_eq!(only(&placed(&times_s, Some(20_000.0)).unwrap()).0, Severity::Note);
        for wrong_hz in [20_100.0, 19_000.0, 20_000e3] {
            let uniform = placed(&times_s, Some(wrong_hz)).unwrap();
            assert_eq!(only(&uniform).0, Severity::Warning, "{}", only(&uniform).1);
        }
        // Too few changes to tell a rate of their own still contradict one that is far off.
        let times_s = cut(2000.0, 1.0, 0.3, 5000);
        assert_eq!(only(&placed(&times_s, Some(1000.0)).unwrap()).0, Severity::Warning);
    }

    #[test]
    fn uneven_steps_never_make_a_mere_note() {
        // A block of 12 samples of 20 a step is lost in the middle.
        let mut lost = cut(20_000.0, 1e-3, 0.0, 9000);
        lost.drain(4000..4012);
        let lack = |uniform: &Uniform| {
            let warns = uniform.issues.iter().any(|issue| issue.severity == Severity::Warning);
            (warns, uniform.samples.len(), uniform.samples.missing())
        };
        assert_eq!(lack(&placed(&lost, None).unwrap()), (true, 9000, 20));
        // More than a step of them.
        lost.drain(6000..6200);
        for stated_hz in [None, Some(20_000.0)] {
            assert_eq!(lack(&placed(&lost, stated_hz).unwrap()), (true, 9000, 240), "{stated_hz:?}");
        }
        // Few samples of a step of 1000, and too few steps to tell a rate: what is declared cannot explain
        // them either.
        for (step_s, count, lost_from) in [(0.05, 9000, 3000), (0.1, 7000, 4500)] {
            let mut lost = cut(20_000.0, step_s, 0.013, count);
            lost.drain(lost_from..lost_from + 40);
            let stated = placed(&lost, Some(20_000.0)).unwrap();
            assert_eq!(only(&stated).0, Severity::Warning, "{step_s}: {}", only(&stated).1);
            assert!(stated.issues[0].removes(ResultPart::Motion), "rows of the impact may be missing");
        }
        // Blocks of 1000 samples that a computer stamps as they come, 3 ms early or late.
        let blocks: Vec<f64> =
            (0..20_000).map(|i| as_f64(i / 1000) * 0.05 + 0.003 * (as_f64(i / 1000) * 2.3).sin()).collect();
        match placed(&blocks, None) {
            Ok(uniform) => assert_eq!(only(&uniform).0, Severity::Warning, "{}", only(&uniform).1),
            Err(error) => assert!(is_too_coarse(&error), "{error}"),
        }
    }

    #[test]
    fn a_short_record_is_less_sure() {
        // 400 samples in four steps and more: within a sample of 300.
        let uniform = placed(&cut(1000.0, 0.1, 0.05, 500), None).unwrap();
        assert_eq!(only(&uniform).0, Severity::Warning);
        assert!(only(&uniform).1.contains("give sample_rate_hz"), "{}", only(&uniform).1);
        assert!(is_too_coarse(&placed(&cut(1000.0, 0.01, 0.0, 60), None).unwrap_err()));
    }

    #[test]
    fn a_channel_that_does_not_move_has_the_rate_of_the_others() {
        let times_s = cut(20_000.0, 0.01, 0.0, 9000);
        let still = from_times(&times_s, Samples::F64(vec![0.0; 9000]), None).unwrap();
        assert_eq!(still.sample_rate_hz.to_bits(), placed(&times_s, None).unwrap().sample_rate_hz.to_bits());
        assert_eq!(still.samples.len(), 9000);
    }
}
