//! Curves to `srs.csv`: shock response and pseudo-velocity of each channel that returns to rest.

use super::ReportError;
use super::records::{finish, text_cell};
use crate::data::{
    Analysis, ChannelFinding, DropResult, Finding, FindingKind, STANDARD_GRAVITY_M_S2, acceleration_unit_m_s2,
};
use crate::numerics::shock_response::shock_response;
use crate::numerics::{as_count, as_f64, robust, to_f32};
use rayon::prelude::*;

/// Q of the oscillators: 5 % of critical damping.
const QUALITY: f64 = 10.0;
/// Natural frequencies: twelve per octave from this one, Hz, to this share of the sample rate, at which the
/// samples still show a cycle's largest value to 5 %.
const LOWEST_HZ: f64 = 5.0;
const PER_OCTAVE: f64 = 12.0;
const HIGHEST_SHARE: f64 = 0.1;
/// A channel is at rest again, or rings about its rest level, if its mean over this time at its end, s, does
/// not exceed one and a half times gravity, g, plus the mean that ringing over a period or more may leave,
/// √2/π of its RMS: a higher level would dominate the spectrum at low frequencies.
const END_S: f64 = 0.025;
const MOST_LEVEL_G: f64 = 1.5;
const MOST_OF_RINGING: f64 = 0.45;

/// One acceleration over the event, m/s².
struct AccelerationCourse<'a> {
    channel: &'a str,
    sample_rate_hz: f64,
    force_m_s2: Vec<f64>,
}

/// The table, channel by channel.
///
/// # Errors
///
/// [`ReportError::Csv`] if the writer fails.
pub(super) fn table_bytes(analysis: &Analysis) -> Result<Vec<u8>, ReportError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["channel", "frequency_hz", "acceleration", "pseudo_velocity_m_s"])?;
    let mut table = finish(writer)?;
    let rows = |course: &AccelerationCourse| {
        unit_m_s2(&analysis.result, course).map(|unit_m_s2| spectrum(course, unit_m_s2))
    };
    let spectra: Result<Vec<Vec<u8>>, ReportError> = courses(analysis).par_iter().filter_map(rows).collect();
    table.extend(spectra?.concat());
    Ok(table)
}

/// Every acceleration channel, relative to the free fall.
fn courses(analysis: &Analysis) -> Vec<AccelerationCourse<'_>> {
    let rate_hz = |time_s: &[f64]| Some(as_f64(time_s.len().checked_sub(1)?) / (time_s.last()? - time_s[0]));
    let in_motion = analysis.curves.channels.iter().filter_map(|curve| {
        let (force_m_s2, sample_rate_hz) = (curve.raw_m_s2.clone(), rate_hz(&curve.time_s)?);
        Some(AccelerationCourse { channel: &curve.channel, sample_rate_hz, force_m_s2 })
    });
    let contact_s = analysis.result.events.first_contact_s().unwrap_or(f64::INFINITY);
    let others = analysis.curves.others.iter().filter_map(move |curve| {
        let unit_m_s2 = acceleration_unit_m_s2(&curve.unit)?;
        let falls = curve.time_s.partition_point(|t| *t < contact_s);
        let (level, _) = robust::mean_and_rms(&curve.values[..falls]);
        let force_m_s2 = curve.values.iter().map(|value| unit_m_s2 * (value - level)).collect();
        let sample_rate_hz = rate_hz(&curve.time_s)?;
        Some(AccelerationCourse { channel: &curve.channel, sample_rate_hz, force_m_s2 })
    });
    in_motion.chain(others).collect()
}

/// m/s² per unit of the channel's shocks, if it shows all of them completely and returns to rest.
fn unit_m_s2(result: &DropResult, course: &AccelerationCourse) -> Option<f64> {
    let mut own = result.shocks.iter().filter(|shock| shock.channel == course.channel).peekable();
    let unit_m_s2 = own.peek()?.unit_m_s2?;
    let force = &course.force_m_s2;
    let is_whole = own.all(|shock| shock.peak.is_some()) && force.iter().all(|f| f.is_finite());
    let is_zero_shift = |f: &Finding| {
        f.channel.as_deref() == Some(course.channel)
            && matches!(f.what, FindingKind::Channel(ChannelFinding::ZeroShift { .. }))
    };
    let from = force.len().checked_sub(as_count(END_S * course.sample_rate_hz).max(1))?;
    let (level_m_s2, ringing_m_s2) = robust::mean_and_rms(&force[from..]);
    let most_m_s2 = MOST_LEVEL_G * STANDARD_GRAVITY_M_S2 + MOST_OF_RINGING * ringing_m_s2;
    let is_at_rest = level_m_s2.abs() <= most_m_s2 && !result.quality.iter().any(is_zero_shift);
    (is_whole && is_at_rest).then_some(unit_m_s2)
}

fn spectrum(course: &AccelerationCourse, unit_m_s2: f64) -> Result<Vec<u8>, ReportError> {
    let highest_hz = HIGHEST_SHARE * course.sample_rate_hz;
    let frequency_hz = |i: usize| LOWEST_HZ * (as_f64(i) / PER_OCTAVE).exp2();
    let last = as_count(PER_OCTAVE * (highest_hz / LOWEST_HZ).log2());
    let all_hz = (0..=last).map(frequency_hz).filter(|f| *f <= highest_hz);
    let frequencies_hz: Vec<f64> = all_hz.collect();
    let (name, mut rows) = (text_cell(course.channel), csv::Writer::from_writer(Vec::new()));
    for found in shock_response(&course.force_m_s2, course.sample_rate_hz, &frequencies_hz, QUALITY) {
        let numbers = [found.frequency_hz, found.acceleration / unit_m_s2, found.pseudo_velocity];
        let cells = numbers.map(|number| zmij::Buffer::new().format(to_f32(number)).to_owned());
        rows.write_record([&name].into_iter().chain(&cells))?;
    }
    finish(rows)
}
