//! What a format's reader hands over, and the cask file, to channels: one clock, one unit, polarity.

use super::error::{self, IngestError};
use super::{RawChannel, RawRecording, factors, refusal::Refusal, repeats, shown};
use crate::data::{
    CaskFile, Channel, ChannelFinding, ChannelSpec, Finding, OtherChannels, OtherSpec, Recording,
    RecordingFormat, SAMPLE_RATES_HZ, STANDARD_GRAVITY_M_S2, Unit, acceleration_unit_m_s2, rate_unit_rad_s,
};
use crate::numerics::{as_f64, nanoseconds};
use std::path::Path;

/// The recording: times from the earliest first sample, every channel with its unit and scale.
///
/// # Errors
/// A channel without a unit, or with one that is no acceleration.
pub(crate) fn recording(
    path: &Path,
    format: RecordingFormat,
    sha256: String,
    raw: RawRecording,
    cask_file: &CaskFile,
) -> Result<Recording, IngestError> {
    // Times of the motion do not hang on when another channel begins.
    let of_motion = raw.channels.iter().take(cask_file.channels.len());
    let first_s = of_motion.map(|channel| channel.uniform.start_s).fold(f64::INFINITY, f64::min);
    let first_s = if first_s.is_finite() { first_s } else { 0.0 };
    let mut issues: Vec<Finding> = raw.issues.into_iter().map(|issue| shifted(issue, first_s)).collect();
    let mut channels = Vec::with_capacity(raw.channels.len());
    let mut others = OtherChannels::default();
    let mut read = raw.channels.into_iter();
    let said = |spec: &ChannelSpec, refusal| error::of_channel(path, &spec.name, refusal);
    for (spec, raw) in cask_file.channels.iter().zip(read.by_ref()) {
        let scale = has_numbers(spec, &raw).and_then(|()| factors::settled(spec, &raw));
        let scale = scale.and_then(|()| scale_of(spec, raw.recorded_unit()));
        let channel = scale.and_then(|scale| channel(spec, raw, scale, first_s, &mut issues));
        channels.push(channel.map_err(|refusal| said(spec, refusal))?);
    }
    issues.extend(channels.iter().filter_map(repeats::by_turns));
    repeats::drop_repeated(&mut channels, &mut issues);
    for (other, raw) in cask_file.others.iter().zip(read) {
        let scale = own_unit(other, raw.recorded_unit());
        let channel = scale.and_then(|scale| channel(&other.read, raw, scale, first_s, &mut others.issues));
        others.channels.push(channel.map_err(|refusal| said(&other.read, refusal))?);
    }
    overlap(path, channels.iter().chain(&others.channels))?;
    let is_other = |found: &Finding| others.channels.iter().any(|o| found.channel.as_ref() == Some(&o.name));
    others.issues.extend(issues.extract_if(.., |found| is_other(found)));
    Ok(Recording {
        path: path.to_owned(),
        sha256,
        format,
        reader: None,
        channels,
        others: others.into(),
        start_unix_ns: raw.zero_unix_ns.map(|zero_ns| zero_ns.saturating_add(nanoseconds(first_s))),
        first_s,
        before_trigger_s: (raw.zero_unix_ns.is_none() && first_s < 0.0).then_some(-first_s),
        rest: None,
        calculation: None,
        joined: Vec::new(),
        issues,
    })
}

/// Refuses channels of which two share no time at all: their clocks are apart, and nothing tells by how much.
fn overlap<'a>(path: &Path, channels: impl Iterator<Item = &'a Channel> + Clone) -> Result<(), IngestError> {
    let end_s = |channel: &Channel| channel.start_s + as_f64(channel.samples.len()) / channel.sample_rate_hz;
    let mut all = channels.clone();
    let Some(first) = channels.min_by(|a, b| end_s(a).total_cmp(&end_s(b))) else { return Ok(()) };
    let Some(late) = all.find(|channel| channel.start_s > end_s(first)) else { return Ok(()) };
    let s = |time_s: f64| shown::digits(time_s, 6);
    let refusal = Refusal::new(
        format!(
            "it begins at {} s and {} ends at {} s: by their times the two share no moment, so that their \
             clocks are {} s apart or they are of different recordings",
            s(late.start_s),
            first.name,
            s(end_s(first)),
            s(late.start_s - first.start_s)
        ),
        "check the clocks of both; name times that they share (`time`; of MCAP messages also `time = \
         \"log_time\"`), or take one of the two out",
    );
    Err(error::of_channel(path, &late.name, refusal))
}

/// Refuses an accelerometer without a single number.
fn has_numbers(spec: &ChannelSpec, raw: &RawChannel) -> Result<(), Refusal> {
    let samples = &raw.uniform.samples;
    if (0..samples.len()).any(|i| samples.get(i).is_finite()) {
        return Ok(());
    }
    Err(Refusal::new(
        format!("{} holds no number: all its samples are NaN, infinite or empty", spec.source),
        "name the source that holds this sensor's samples, or take this [[channel]] out of the cask file",
    ))
}

fn channel(
    spec: &ChannelSpec,
    mut raw: RawChannel,
    scale: UnitScale,
    first_s: f64,
    issues: &mut Vec<Finding>,
) -> Result<Channel, Refusal> {
    let rate_hz = raw.uniform.sample_rate_hz;
    if !SAMPLE_RATES_HZ.contains(&rate_hz) {
        return Err(Refusal::new(
            format!(
                "the sample rate of {} is {}, outside {} to {} Hz",
                spec.source,
                shown::hz(rate_hz),
                SAMPLE_RATES_HZ.start(),
                SAMPLE_RATES_HZ.end()
            ),
            "check the rate that the recording states, or the unit of its times, or write the true \
             `sample_rate_hz` in this channel of the cask file",
        ));
    }
    raw.uniform.samples.shrink();
    issues.extend(scale.contradiction.clone().map(|found| found.tag(&spec.name)));
    issues.extend(raw.uniform.issues.into_iter().map(|issue| shifted(issue, first_s).tag(&spec.name)));
    Ok(Channel {
        name: spec.name.clone(),
        end: spec.end,
        axis: spec.axis,
        source: spec.source.to_string(),
        position_m: spec.position_m,
        offset_m: spec.offset_m,
        start_s: raw.uniform.start_s - first_s,
        sample_rate_hz: raw.uniform.sample_rate_hz,
        samples: raw.uniform.samples,
        scale_m_s2: scale.m_s2 * spec.polarity * spec.scale.unwrap_or(1.0) / spec.axis_share(),
        unit: scale.unit,
        unit_origin: scale.origin,
        is_unit_recorded: raw.unit.is_some() && scale.contradiction.is_none(),
        full_scale: spec.full_scale,
        gaps: raw.uniform.gaps,
        time_jitter_s: raw.uniform.time_jitter_s,
        coupling: spec.coupling,
        rest: None,
    })
}

/// The same issue, its times counted from `first_s`.
pub(super) fn shifted(mut issue: Finding, first_s: f64) -> Finding {
    issue.from_s = issue.from_s.map(|time_s| time_s - first_s);
    issue.to_s = issue.to_s.map(|time_s| time_s - first_s);
    issue
}

/// What one unit of the samples is worth.
#[derive(Debug, PartialEq)]
struct UnitScale {
    m_s2: f64,
    unit: String,
    origin: &'static str,
    /// Where the cask file's unit and the recording's differ.
    contradiction: Option<ChannelFinding>,
}

fn scale_of(spec: &ChannelSpec, recorded: Option<&str>) -> Result<UnitScale, Refusal> {
    if let Some(unit) = spec.unit {
        let (m_s2, name) = declared(unit);
        let contradiction = recorded
            .filter(|text| !same_unit(text, name, m_s2))
            .map(|text| ChannelFinding::OtherUnit { stated: name.to_owned(), recorded: text.to_owned() });
        return Ok(UnitScale { m_s2, unit: name.to_owned(), origin: "cask file", contradiction });
    }
    let source = &spec.source;
    let Some(text) = recorded else {
        return Err(Refusal::new(
            format!("neither the recording nor the cask file says the unit of {source}"),
            "write `unit = \"g\"` (or \"m/s^2\", or \"V\" or \"mV\" with `sensitivity`) in this channel of \
             the cask file",
        ));
    };
    if let Some(m_s2) = acceleration_unit_m_s2(text) {
        return Ok(UnitScale { m_s2, unit: text.to_owned(), origin: "recording", contradiction: None });
    }
    let (what, mend) = if matches!(&text.trim().to_lowercase()[..], "v" | "mv" | "volt" | "volts") {
        let unit =
            format!("write `unit = \"{text}\"` and `sensitivity` (mV per g, from the calibration sheet)");
        ("a voltage", unit)
    } else {
        let check = "check that this is the accelerometer; if so, write `unit = \"g\"` or \"m/s^2\"";
        ("which is no unit of acceleration known here", check.to_owned())
    };
    let problem = format!("the recording gives {source} in {text:?}, {what}");
    Err(Refusal::new(problem, format!("{mend} in this channel of the cask file")))
}

/// The unit of a channel that takes no part in the motion, any text; its samples stay as they are.
fn own_unit(spec: &OtherSpec, recorded: Option<&str>) -> Result<UnitScale, Refusal> {
    let stated = spec.unit.as_deref().map(|unit| (unit.trim(), "cask file"));
    let source = &spec.read.source;
    let of_rate = "write `unit = \"rad/s\"` or \"deg/s\" in this channel of the cask file";
    let Some((unit, origin)) = stated.or(recorded.map(|unit| (unit, "recording"))) else {
        let any = "write it in this channel of the cask file, such as `unit = \"µm/m\"` or \"°C\"; any text \
                   will do, and \"1\" stands for none";
        return Err(Refusal::new(
            format!("neither the recording nor the cask file says the unit of {source}"),
            if spec.rate.is_some() { of_rate } else { any },
        ));
    };
    if spec.rate.is_some() && rate_unit_rad_s(unit).is_none() {
        return Err(Refusal::new(
            format!("the recording gives {source} in {unit:?}, which is no unit of a rate of turn"),
            format!("check that this is the angular-rate sensor; if so, {of_rate}"),
        ));
    }
    let is_same = |recorded: &&str| {
        let rates = [*recorded, unit].map(rate_unit_rad_s);
        *recorded == unit || (spec.rate.is_some() && rates[0] == rates[1])
    };
    let other = recorded.filter(|recorded| !is_same(recorded)).map(str::to_owned);
    let contradiction = other.map(|recorded| ChannelFinding::OtherUnit { stated: unit.to_owned(), recorded });
    Ok(UnitScale { m_s2: 1.0, unit: unit.to_owned(), origin, contradiction })
}

/// m/s² per unit, and the unit's name, as a cask file declares it: one volt is 1000 mV / (mV per g) · g.
fn declared(unit: Unit) -> (f64, &'static str) {
    match unit {
        Unit::G => (STANDARD_GRAVITY_M_S2, "g"),
        Unit::MetrePerSecondSquared => (1.0, "m/s^2"),
        Unit::Volt { sensitivity_mv_per_g } => (1000.0 / sensitivity_mv_per_g * STANDARD_GRAVITY_M_S2, "V"),
        Unit::Millivolt { sensitivity_mv_per_g } => (STANDARD_GRAVITY_M_S2 / sensitivity_mv_per_g, "mV"),
    }
}

/// Whether the recording's word means the unit `name`, worth `m_s2`.
#[allow(clippy::float_cmp, reason = "both come from the same constants")]
fn same_unit(text: &str, name: &str, m_s2: f64) -> bool {
    text == name || (!matches!(name, "V" | "mV") && acceleration_unit_m_s2(text) == Some(m_s2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{End, Samples};
    use crate::ingest::mcap::written::cask_file;
    use crate::ingest::time_base::Uniform;

    pub(super) fn spec(unit: Option<Unit>) -> ChannelSpec {
        ChannelSpec { unit, ..ChannelSpec::new("A1", End::First, "/daq/a1", 0.0) }
    }

    fn of(unit: Option<Unit>, recorded: Option<&str>) -> Result<UnitScale, Refusal> {
        scale_of(&spec(unit), recorded)
    }

    #[test]
    fn units_are_recognised_however_they_are_written() {
        for (text, m_s2) in [
            ("g", 9.80665),
            ("G", 9.80665),
            ("gn", 9.80665),
            ("[g]", 9.80665),
            ("mg", 0.009_806_65),
            ("m/s^2", 1.0),
            ("m/s²", 1.0),
            ("M/S2", 1.0),
            ("m s-2", 1.0),
            ("m·s⁻²", 1.0),
            ("m/s**2", 1.0),
            ("(m/(s*s))", 1.0),
            ("mm/s^2", 1e-3),
        ] {
            let read_m_s2 = of(None, Some(text)).unwrap().m_s2;
            // One rounding of a product apart at most.
            assert!((read_m_s2 - m_s2).abs() <= f64::EPSILON * m_s2, "{text}");
        }
        for text in ["Mg", "m/s", "rad/s", "N", "furlong"] {
            assert!(of(None, Some(text)).is_err(), "{text}");
        }
    }

    #[test]
    fn a_rate_that_no_recorder_has_is_refused_by_its_channel() {
        let at = |sample_rate_hz: f64| {
            let samples = Samples::F64(vec![1.0, 2.0]);
            let uniform = Uniform {
                start_s: 0.0,
                span_s: None,
                sample_rate_hz,
                samples,
                gaps: Vec::new(),
                time_jitter_s: 0.0,
                issues: Vec::new(),
            };
            let raw = RawChannel { uniform, unit: Some("g".into()), factors: Vec::new() };
            let scale = of(None, Some("g"))?;
            channel(&spec(None), raw, scale, 0.0, &mut Vec::new())
        };
        for rate_hz in [1e-3, 50.0, 1e8] {
            assert!(at(rate_hz).is_ok(), "{rate_hz}");
        }
        for rate_hz in [5e-324, 9e-4, 1.1e8, 1e14, 1e308, f64::INFINITY, f64::NAN] {
            let refused = at(rate_hz).unwrap_err().to_string();
            assert!(
                refused.contains("/daq/a1 is ") && refused.contains("outside 0.001 to 100000000 Hz"),
                "{refused}"
            );
        }
    }

    #[test]
    fn a_volt_at_ten_millivolt_a_g_is_a_hundred_g() {
        let scale = of(Some(Unit::Volt { sensitivity_mv_per_g: 10.0 }), Some("V")).unwrap();
        assert!((scale.m_s2 - 980.665).abs() < 1e-9);
        assert_eq!(scale.contradiction, None);
        let scale = of(Some(Unit::Millivolt { sensitivity_mv_per_g: 10.0 }), None).unwrap();
        assert!((scale.m_s2 - 0.980_665).abs() < 1e-12);
    }

    #[test]
    fn the_cask_file_overrides_and_the_contradiction_is_said() {
        let scale = of(Some(Unit::G), Some("m/s^2")).unwrap();
        assert_eq!((scale.m_s2, scale.origin), (9.80665, "cask file"));
        assert!(scale.contradiction.is_some());
        assert_eq!(of(Some(Unit::G), Some("G")).unwrap().contradiction, None);
    }

    #[test]
    fn no_unit_anywhere_says_what_to_write() {
        let error = of(None, None).unwrap_err();
        let help = error.remedy;
        assert!(help.contains("unit = \"g\""), "{help}");
        let error = of(None, Some("mV")).unwrap_err();
        assert!(error.remedy.contains("sensitivity"));
    }

    #[test]
    fn any_text_is_the_unit_of_a_channel_outside_the_motion() {
        let own = |unit: Option<&str>, recorded| {
            let spec = OtherSpec { read: spec(None), unit: unit.map(str::to_owned), rate: None };
            own_unit(&spec, recorded)
        };
        let recorded = own(None, Some("µm/m")).unwrap();
        assert_eq!(
            (&recorded.unit[..], recorded.origin, recorded.contradiction),
            ("µm/m", "recording", None)
        );
        let stated = own(Some("mV/V"), Some("V")).unwrap();
        assert_eq!((&stated.unit[..], stated.origin), ("mV/V", "cask file"));
        assert!(stated.contradiction.is_some() && own(Some("V"), Some("V")).unwrap().contradiction.is_none());
        let help = own(None, None).unwrap_err().remedy;
        assert!(help.contains("any text"), "{help}");
    }

    #[test]
    fn a_channel_without_any_number_is_named() {
        let uniform = Uniform {
            start_s: 0.0,
            span_s: None,
            sample_rate_hz: 1000.0,
            samples: Samples::F32(vec![f32::NAN; 3]),
            gaps: Vec::new(),
            time_jitter_s: 0.0,
            issues: Vec::new(),
        };
        let raw = RawChannel { uniform, unit: None, factors: Vec::new() };
        let error = has_numbers(&spec(Some(Unit::G)), &raw).unwrap_err();
        assert!(error.to_string().contains("/daq/a1 holds no number"), "{error}");
    }

    #[test]
    fn times_count_from_the_earliest_first_sample_and_polarity_turns_the_scale() {
        let raw = |start_s| RawChannel {
            uniform: Uniform {
                start_s,
                span_s: None,
                sample_rate_hz: 1.0,
                samples: Samples::F64(vec![1.0, 2.0]),
                gaps: Vec::new(),
                time_jitter_s: 0.0,
                issues: vec![
                    Finding::from(crate::data::TimesFinding::NonFinite { samples: 1 })
                        .span(start_s, start_s + 0.25),
                ],
            },
            unit: Some("g".into()),
            factors: Vec::new(),
        };
        let mut cask_file = cask_file(&["/a.x", "/b.x"]);
        cask_file.channels[1].polarity = -1.0;
        let channels = vec![raw(2.5), raw(2.0)];
        let apart =
            RawRecording { channels: vec![raw(39.0), raw(2.0)], zero_unix_ns: None, issues: Vec::new() };
        let refused = recording(Path::new("r"), RecordingFormat::Mcap, "ab".into(), apart, &cask_file);
        assert!(refused.unwrap_err().to_string().contains("37 s apart"));
        let raw =
            RawRecording { channels, zero_unix_ns: Some(1_700_000_000_000_000_000), issues: Vec::new() };
        let path = Path::new("r");
        let recording = recording(path, RecordingFormat::Mcap, "ab".into(), raw, &cask_file).unwrap();
        let [first, second] = &recording.channels[..] else { panic!() };
        assert_eq!((first.start_s, second.start_s), (0.5, 0.0));
        assert_eq!(recording.start_unix_ns, Some(1_700_000_002_000_000_000));
        assert_eq!((first.scale_m_s2, second.scale_m_s2), (9.80665, -9.80665));
        let spans: Vec<_> =
            recording.issues.iter().map(|issue| (issue.channel.as_deref(), issue.from_s)).collect();
        assert_eq!(spans, [(Some("/a.x"), Some(0.5)), (Some("/b.x"), Some(0.0))]);
    }
}
