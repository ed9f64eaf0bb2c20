//! Compares a calculation with the test: lays its curves over the measured ones, rates them, and lists
//! numbers of both.

use super::impacts;
use crate::data::{
    Analysis, CalculatedNumber, CaskFile, Channel, ChannelCurve, DropFinding, DropResult, Finding,
    RatedQuantity, Recording, STANDARD_GRAVITY_M_S2, Signal, SimulationRow,
};
use crate::ingest::{self, IngestError, Limits};
use crate::motion;
use crate::numerics::filter::LowPass;
use crate::numerics::quadrature::running_integral;
use crate::numerics::rating::{self, RATING_STEP_S};
use crate::numerics::{as_count, as_f64, reduce};

/// Both first contacts are the times at which a filtered curve first reaches this share of its first peak.
const ONSET_SHARE: f64 = 0.1;
/// The level of a calculation is determined until this long before that time, s.
const CLEAR_S: f64 = 1e-3;
/// Length of zeros before a calculation, in periods 1/f of its low-pass with −3 dB at f.
const LEAD_PERIODS: f64 = 6.2;
/// Shortest common interval after first contact that is rated, s: the shortest first impact of a limiter.
const LEAST_SHARED_S: f64 = 5e-3;

/// Reads the curves of the file that `[simulation]` names, if it names one.
///
/// # Errors
/// [`IngestError`] if the file cannot be read or lacks a column.
pub(super) fn read_curves(file: &CaskFile, limits: Limits) -> Result<Option<Box<Recording>>, IngestError> {
    let Some(spec) = &file.simulation else { return Ok(None) };
    let (time, channels) = (spec.time.clone(), spec.channels.clone());
    let columns = CaskFile { path: file.path.clone(), time, channels, ..CaskFile::default() };
    ingest::read_within(&spec.path, &columns, limits, &|_| ()).map(|read| Some(Box::new(read)))
}

/// Adds the agreement of the calculation with the recording to the result, and its curves to the curves.
pub(super) fn add(recording: &Recording, file: &CaskFile, analysis: &mut Analysis) {
    let Some(calculation) = &recording.calculation else { return };
    let path = calculation.path.display().to_string();
    let as_finding = |issue: &Finding| {
        let in_file = DropFinding::InCalculation { file: path.clone(), found: issue.message.clone() };
        Finding { channel: issue.channel.clone(), ..in_file.into() }
    };
    let mut findings: Vec<Finding> = calculation.issues.iter().map(as_finding).collect();
    let (mut rows, mut numbers, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    match Overlay::new(calculation, file, analysis) {
        Err(why) => findings.push(DropFinding::NotRated { why }.into()),
        Ok(overlay) => {
            for pair in &overlay.pairs {
                rows.extend(overlay.rows(pair));
                numbers.extend(overlay.numbers(pair, &analysis.result));
                curves.push(overlay.curve(pair));
            }
        }
    }
    analysis.curves.calculated = curves;
    let result = &mut analysis.result;
    (result.simulation, result.calculated) = (rows, numbers);
    result.input.simulation = Some(path);
    result.input.simulation_sha256 = Some(calculation.sha256.clone());
    result.quality.extend(findings);
}

/// A measured curve and the calculated one of the same channel.
struct CurvePair<'a> {
    measured: &'a ChannelCurve,
    /// The measured curve, low-passed.
    smooth: Signal,
    /// The calculated curve after this many samples without force, on its own times.
    calculated: Signal,
    before: usize,
    /// The calculated curve, low-passed likewise.
    calculated_smooth: Signal,
    /// Level before its first contact, which was subtracted.
    level_m_s2: f64,
}

impl<'a> CurvePair<'a> {
    /// Pairs the curves, or returns the reason why it cannot; the measured first impact lies within
    /// `first_s`.
    fn new(
        measured: &'a ChannelCurve,
        channel: &Channel,
        first_s: [f64; 2],
        cutoff_hz: f64,
    ) -> Result<Self, String> {
        let (force_m_s2, rate_hz) = (channel.force_m_s2(0, channel.samples.len()), channel.sample_rate_hz);
        if force_m_s2.iter().any(|f| !f.is_finite()) {
            return Err(format!("{} has empty samples; write it without them", channel.source));
        }
        let filter = LowPass::with_cutoff_hz(cutoff_hz, rate_hz).ok_or_else(|| {
            format!("{rate_hz:.0} values a second do not carry the low-pass of {cutoff_hz:.0} Hz; write more")
        })?;
        let smooth = measured_signal(measured).ok_or("the recording has no curve of it")?;
        let foot_m_s2 = ONSET_SHARE * peak(&smooth, first_s);
        let rises = force_m_s2.iter().position(|f| (f - force_m_s2[0]).abs() >= foot_m_s2);
        let quiet = rises.unwrap_or_default().saturating_sub(as_count(CLEAR_S * rate_hz)).max(1);
        let level_m_s2 = force_m_s2.iter().take(quiet).sum::<f64>() / as_f64(quiet);
        let before = as_count(LEAD_PERIODS / cutoff_hz * rate_hz);
        let force_m_s2 = force_m_s2.iter().map(|f| f - level_m_s2);
        let calculated = Signal {
            start_s: channel.start_s - as_f64(before) / rate_hz,
            sample_rate_hz: rate_hz,
            force_m_s2: std::iter::repeat_n(0.0, before).chain(force_m_s2).collect(),
            ..Signal::default()
        };
        let calculated_smooth = calculated.cut_with(0, filter.apply(&calculated.force_m_s2));
        Ok(Self { measured, smooth, calculated, before, calculated_smooth, level_m_s2 })
    }

    fn name(&self) -> &str {
        &self.measured.channel
    }
}

/// Converts the measured curve into a signal; `None` if it has fewer than two points.
fn measured_signal(curve: &ChannelCurve) -> Option<Signal> {
    let (start_s, last_s) = (*curve.time_s.first()?, *curve.time_s.last()?);
    let sample_rate_hz = as_f64(curve.time_s.len() - 1) / (last_s - start_s);
    let signal = Signal { start_s, sample_rate_hz, ..Signal::default() };
    sample_rate_hz.is_finite().then(|| signal.cut_with(0, curve.filtered_m_s2.clone()))
}

/// Largest magnitude between two times, s.
fn peak(signal: &Signal, between_s: [f64; 2]) -> f64 {
    let [from, to] = between_s.map(|time_s| signal.index_from(time_s));
    reduce::peak(&signal.force_m_s2[from.min(to)..to])
}

/// Time at which the magnitude first reaches a level, s, interpolated linearly.
fn rises_s(signal: &Signal, from_s: f64, level_m_s2: f64) -> Option<f64> {
    let size = |i: usize| signal.force_m_s2[i].abs();
    let first = (signal.index_from(from_s)..signal.force_m_s2.len()).find(|&i| size(i) >= level_m_s2)?;
    let share = (size(first) - level_m_s2) / (size(first) - size(first.saturating_sub(1)));
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    Some(signal.time_s(first) - share / signal.sample_rate_hz)
}

/// Value at a time, s, interpolated linearly; 0 outside.
fn value_at(signal: &Signal, time_s: f64) -> f64 {
    let place = signal.position_at(time_s);
    let (below, value) = (as_count(place), |i: usize| signal.force_m_s2.get(i).copied().unwrap_or_default());
    let share = place - as_f64(below);
    if place < 0.0 { 0.0 } else { value(below) * (1.0 - share) + value(below + 1) * share }
}

/// Curves of a calculation laid over those of a recording, with one shift of time.
struct Overlay<'a> {
    pairs: Vec<CurvePair<'a>>,
    cutoff_hz: f64,
    /// Intervals of the measured pulses of both impacts, s; the first begins with first contact.
    first_s: [f64; 2],
    second_s: Option<[f64; 2]>,
    /// Shift that is added to the calculation's times.
    shift_s: f64,
}

impl<'a> Overlay<'a> {
    /// Lays the curves over each other, or returns the reason why it cannot.
    fn new(calculation: &Recording, file: &CaskFile, analysis: &'a Analysis) -> Result<Self, String> {
        let (cutoff_hz, _) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
        let [first_s, second_s] = impacts::stretches_s(&analysis.result.events, None, file.cask.length_m);
        let first_s = first_s.ok_or("the recording shows no first contact")?;
        let pair = |channel: &Channel| {
            let measured = analysis.curves.channels.iter().find(|curve| curve.channel == channel.name);
            let measured = measured.ok_or_else(|| "the recording has no curve of it".to_owned());
            let pair = measured.and_then(|measured| CurvePair::new(measured, channel, first_s, cutoff_hz));
            pair.map_err(|why| format!("{}: {why}", channel.name))
        };
        let pairs: Vec<CurvePair> = calculation.channels.iter().map(pair).collect::<Result<_, _>>()?;
        let mut overlay = Self { pairs, cutoff_hz, first_s, second_s, shift_s: 0.0 };
        overlay.shift_s = overlay.aligning_shift_s()?;
        for pair in &overlay.pairs {
            let shared_s = overlay.end_s(pair) - first_s[0];
            if shared_s < LEAST_SHARED_S {
                let shared_ms = 1e3 * shared_s.max(0.0);
                return Err(format!("{} has {shared_ms:.1} ms after its first contact", pair.name()));
            }
        }
        Ok(overlay)
    }

    /// Determines the shift from the channel that shows the first impact best   (55)
    fn aligning_shift_s(&self) -> Result<f64, String> {
        let first_peak = |pair: &CurvePair| peak(&pair.smooth, self.first_s);
        let best = self.pairs.iter().max_by(|a, b| first_peak(a).total_cmp(&first_peak(b)));
        let pair = best.ok_or("it has no channel")?;
        let (foot_m_s2, [contact_s, left_s]) = (ONSET_SHARE * first_peak(pair), self.first_s);
        let calculated = &pair.calculated_smooth;
        let measured_s = rises_s(&pair.smooth, contact_s - 2.0 / self.cutoff_hz, foot_m_s2);
        let rough_s = rises_s(calculated, calculated.start_s, foot_m_s2);
        let (Some(measured_s), Some(rough_s)) = (measured_s, rough_s) else {
            return Err(format!(
                "{} never reaches a tenth of the first peak measured; check its column and `unit`",
                pair.name()
            ));
        };
        let own_foot_m_s2 = ONSET_SHARE * peak(calculated, [rough_s, rough_s + left_s - contact_s]);
        if pair.level_m_s2.abs() >= own_foot_m_s2 {
            let name = pair.name();
            return Err(format!("{name} begins within its first impact; let the file begin before contact"));
        }
        let calculated_s = rises_s(calculated, calculated.start_s, own_foot_m_s2);
        Ok(measured_s - calculated_s.unwrap_or(rough_s))
    }

    /// Last time that both curves include, s.
    fn end_s(&self, pair: &CurvePair) -> f64 {
        pair.smooth.end_s().min(pair.calculated.end_s() + self.shift_s)
    }

    /// Both filtered curves from first contact on, in steps of the rating, and their velocities, which begin
    /// with the measured one.
    fn stretches(&self, pair: &CurvePair) -> [[Vec<f64>; 2]; 2] {
        let count = as_count((self.end_s(pair) - self.first_s[0]) / RATING_STEP_S);
        let sides = [(&pair.smooth, 0.0), (&pair.calculated_smooth, self.shift_s)];
        let forces = sides.map(|(signal, shift_s)| {
            let time_s = |i: usize| self.first_s[0] + as_f64(i) * RATING_STEP_S - shift_s;
            (0..count).map(|i| value_at(signal, time_s(i))).collect::<Vec<_>>()
        });
        let before_m_s = self.velocity_at_contact_m_s(pair);
        let velocities = forces.each_ref().map(|force| {
            running_integral(force, RATING_STEP_S).into_iter().map(|v| before_m_s + v).collect()
        });
        [forces, velocities]
    }

    fn velocity_at_contact_m_s(&self, pair: &CurvePair) -> f64 {
        let at = pair.measured.time_s.partition_point(|t| *t < self.first_s[0]);
        pair.measured.velocity_m_s.get(at).copied().unwrap_or_default()
    }

    /// Ratings of acceleration and velocity   (54)
    fn rows(&self, pair: &CurvePair) -> impl Iterator<Item = SimulationRow> {
        let rated = [RatedQuantity::Acceleration, RatedQuantity::Velocity].into_iter();
        rated.zip(self.stretches(pair)).filter_map(|(quantity, [measured, calculated])| {
            let rating = rating::rate(&measured, &calculated)?;
            Some(SimulationRow {
                channel: pair.name().to_owned(),
                quantity,
                corridor: rating.corridor,
                phase: rating.phase,
                magnitude: rating.magnitude,
                slope: rating.slope,
                rating: rating.total(),
                shift_s: self.shift_s,
                peak_difference: reduce::peak(&calculated) / reduce::peak(&measured) - 1.0,
            })
        })
    }

    /// Calculated curve on the recording's times, as far as the measured one extends.
    fn curve(&self, pair: &CurvePair) -> ChannelCurve {
        let smooth = &pair.calculated_smooth;
        let gained_m_s = running_integral(&smooth.force_m_s2, 1.0 / smooth.sample_rate_hz);
        let gained = smooth.cut_with(0, gained_m_s);
        let begin_m_s =
            self.velocity_at_contact_m_s(pair) - value_at(&gained, self.first_s[0] - self.shift_s);
        let from = smooth.index_from(pair.smooth.start_s - self.shift_s).max(pair.before);
        let shown = from..smooth.index_from(pair.smooth.end_s() - self.shift_s).max(from);
        ChannelCurve {
            channel: pair.name().to_owned(),
            time_s: shown.clone().map(|i| smooth.time_s(i) + self.shift_s).collect(),
            raw_m_s2: pair.calculated.force_m_s2[shown.clone()].to_vec(),
            filtered_m_s2: smooth.force_m_s2[shown.clone()].to_vec(),
            velocity_m_s: gained.force_m_s2[shown].iter().map(|v| begin_m_s + v).collect(),
        }
    }

    /// Peaks, pulses and times of both impacts, and the change of velocity in the first.
    fn numbers(&self, pair: &CurvePair, result: &DropResult) -> Vec<CalculatedNumber> {
        let start_s = pair.calculated.start_s + self.shift_s;
        let calculated = [Signal { start_s, ..pair.calculated.clone() }];
        let end_s = calculated[0].end_s();
        let [contact_s, left_s] = [self.first_s[0], result.events.separation_s().unwrap_or(f64::NAN)];
        // The second pulse of the calculation may be earlier or later than the measured one.
        let second_s = self.second_s.filter(|[_, to_s]| left_s.is_finite() && *to_s <= end_s);
        let stretches_s =
            [Some(self.first_s), second_s.map(|[from_s, _]| [f64::midpoint(from_s, left_s), end_s])];
        let mut numbers = Vec::new();
        for ((impact, stretch), name) in result.impacts.iter().zip(stretches_s).zip(["first", "second"]) {
            let measured = impact.channels.iter().find(|channel| channel.name == pair.name());
            let pulse = stretch.and_then(|s| motion::pulses(&calculated, s, self.cutoff_hz).pop()?);
            let Some((measured, pulse)) = measured.zip(pulse) else { continue };
            let (g, length_s) = (STANDARD_GRAVITY_M_S2, pulse.length.map(|length| length.length_s));
            for (what, unit, size, begin, own, other) in [
                ("peak", "g", g, 0.0, measured.peak_filtered, Some(pulse.filtered)),
                ("pulse", "ms", 1e-3, 0.0, measured.pulse_length, length_s),
                ("peak after first contact", "ms", 1e-3, contact_s, measured.time, Some(pulse.time_s)),
            ] {
                numbers.extend(own.zip(other).map(|(own, other)| CalculatedNumber {
                    what: format!("{}, {name} impact: {what}", pair.name()),
                    unit,
                    measured: (own.value - begin) / size,
                    u95: Some(own.u95 / size),
                    calculated: (other - begin) / size,
                }));
            }
        }
        let at = as_count((left_s - contact_s) / RATING_STEP_S);
        let [_, velocities] = self.stretches(pair);
        if let [Some(measured), Some(calculated)] = velocities.map(|v| Some(v.get(at)? - v[0]))
            && left_s.is_finite()
        {
            let what = format!("{}, first impact: change of velocity", pair.name());
            numbers.push(CalculatedNumber { what, unit: "m/s", measured, u95: None, calculated });
        }
        numbers
    }
}
