//! Findings on a single channel: code, severity, effect and sentence of each.

use super::drop::numbers;
use super::{IssueCode as Code, Severity};
use crate::data::shown::digits;
use crate::data::{End, Estimate, STANDARD_GRAVITY_M_S2 as G};

/// Advice on how to determine a velocity step that a channel lost.
const REPLACES_STEP: &str =
    "only the other channels and the path of the second end to the target can replace it";
/// Advice for channels whose clocks disagree.
const ONE_TRIGGER: &str =
    "the channels' clocks are apart; record them with one trigger, or shift the channel";

/// Times that a sentence lists.
const MOST_TIMES: usize = 8;

/// The part of a drop in which a channel clips.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DropPart {
    /// Between the first contact and the separation.
    FirstImpact,
    /// Between the separation and the slap-down.
    Flight,
    /// After the slap-down.
    SlapDown,
}

/// Slap-down speed and k, if they are determined.
type SpeedAndK = (Option<Estimate>, Option<Estimate>);

/// Likely reason why an angular-rate sensor disagrees with the accelerometers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RotationCause {
    /// The sign is wrong.
    #[error("turn its `polarity` round")]
    Sign,
    /// The unit is wrong.
    #[error("the factor between rad/s and deg/s: correct its `unit`")]
    Unit,
    /// The sensor reads nothing.
    #[error("unplugged, broken, or the wrong `source`")]
    Nothing,
}

findings! {
/// A finding about one channel; its words follow the name of the channel.
pub enum ChannelFinding {
    /// Samples stay at a limit; `takes_step` if more velocity is cut off than a result may miss.
    Clipped { limit_m_s2: f64, samples: usize, during: DropPart, lost_m_s: f64, takes_step: bool }
        => if *takes_step { (Code::Clipped, Error, VelocityStep) } else { (Code::Clipped, Warning, Channel) },
        ("stands at its limit of {:.0} g for {samples} samples {}. Use a sensor or range with more head-room",
         limit_m_s2 / G, cut_off(*during, *lost_m_s, *takes_step));
    /// The signal falls in a straight line, at the chain's largest slope; `takes_step` as for `Clipped`.
    Slewed { slope_m_s3: f64, samples: usize, during: DropPart, lost_m_s: f64, takes_step: bool }
        => if *takes_step { (Code::Clipped, Error, VelocityStep) } else { (Code::Clipped, Warning, Channel) },
        ("falls in one straight line of {:.0} g/ms for {samples} samples {}. Its amplifier does not follow: \
         use one of a higher slew rate", slope_m_s3 / G / 1e3, cut_off(*during, *lost_m_s, *takes_step));
    /// Samples of the first impact are missing, and with them the velocity step, which a slap-down may
    /// determine instead.
    LostStep { shows_slap_down: bool } => (Code::Gap, Error, VelocityStep),
        ("lacks samples of the first impact (missing, or one value repeated), and with them its velocity \
         step: {}", if *shows_slap_down { REPLACES_STEP } else { "no slap-down tells what it was" });
    /// Noise makes the velocity uncertain over a stretch of `length_s`.
    Noise { noise_m_s2: f64, u_m_s: f64, length_s: f64, severity: Severity }
        => (Code::Noise, *severity, Nothing),
        ("({:.2} g before the impact) alone makes its velocity uncertain by ± {:.2} m/s over {:.0} ms, which \
         is in the intervals: record more of the free fall, use a more sensitive range, or look for a loose \
         cable", noise_m_s2 / G, 2.0 * u_m_s, 1e3 * length_s);
    /// The first sample is at this share of the first impact's peak.
    BeginsInImpact { share: f64 } => (Code::BeginsLate, Error, ChannelAndMotion),
        ("begins in the first impact, at {:.0} % of its peak: what came before is missing from the velocity \
         step; set the trigger at least 0.1 s before the impact", 100.0 * share);
    /// The free fall in the record is too short for an offset.
    ShortFreeFall { length_s: f64 } => (Code::BeginsLate, Warning, Nothing),
        ("has {:.1} ms of free fall before the first impact: no offset could be taken from it. Record from \
         before the release", 1e3 * length_s);
    /// A free fall that is long enough holds too few samples for an offset.
    FewSamples { length_s: f64, samples: usize, sample_rate_hz: f64 } => (Code::BeginsLate, Warning, Nothing),
        ("has {samples} sample(s) in the {:.0} ms of free fall before the first impact, at \
         {sample_rate_hz:.3} Hz: no offset could be taken from so few. Check the times and their unit, or \
         `sample_rate_hz`, and what is missing", 1e3 * length_s);
    /// The sensor would sit beyond the ends of the cask.
    OffCask { position_m: f64, length_m: f64 } => (Code::SensorPosition, Warning, DoubtfulPlace),
        ("is placed at {position_m} m, off the cask, which reaches from 0 to {length_m} m: correct \
         `position_m`, measured along the axis from the first end");
    /// A sensor of the first end is no nearer to that end than a sensor of the second.
    NotNearer { position_m: f64, second: String, second_m: f64 }
        => (Code::SensorPosition, Warning, DoubtfulPlace),
        ("of the first end is placed at {position_m} m, no nearer to it than {second} of the second end at \
         {second_m} m: correct `end` or `position_m`");
    /// The sensor is closer to the other end than to its own end.
    NearerOtherEnd { end: End, position_m: f64, length_m: f64 }
        => (Code::SensorPosition, Warning, DoubtfulPlace),
        ("belongs to the {end} end and is placed at {position_m} m, nearer to the other end of {length_m} m: \
         correct `end` or `position_m`");
    /// Noise and peak are larger than another channel's by the factor between two units.
    UnitFactor { noise: f64, peak: f64, other: String, units: &'static str }
        => (Code::Scale, Warning, Contradiction),
        ("has {noise:.1} times the noise and {peak:.1} times the peak of {other}, the factor between \
         {units}: one of the two has the wrong `unit` or `sensitivity`");
    /// The first pulse has too few samples; the velocity step may be wrong by `off_percent`.
    LowRate { samples: f64, pulse_s: f64, off_percent: f64, least_hz: f64 }
        => (Code::LowRate, Warning, Nothing),
        ("has {samples:.1} samples over the first pulse of {:.1} ms: its velocity step may be off by \
         {off_percent:.0} % and more; sample at {least_hz:.0} Hz or faster", 1e3 * pulse_s);
    /// This share of the pulse's spectrum remains just below half the sample rate.
    Aliasing { share: f64, sample_rate_hz: f64 } => (Code::Aliasing, Warning, Motion),
        ("has {:.0} % of the pulse's spectrum left just below half its sample rate of {sample_rate_hz:.0} \
         Hz: what lies above it has folded down, by about {:.0} % of the velocity step; put an anti-alias \
         filter before the sampling, or sample faster", 100.0 * share, 50.0 * share);
    /// The other transverse channels and the consistency checks contradict the channel, and it is excluded:
    /// speed and k with it and without.
    LeftOut { with: SpeedAndK, without: SpeedAndK } => (Code::NotRigid, Warning, Channel),
        ("disagrees with the other channels and is left out: without it everything is consistent, at {}; \
         with it there is {}; check its sensitivity, polarity, position and cable",
         numbers(without.0, without.1), numbers(with.0, with.1));
    /// The channel has the samples of another channel.
    Copied { of: String, is_other_end: bool }
        => if *is_other_end { (Code::CopiedChannel, Error, ChannelAndMotion) }
           else { (Code::CopiedChannel, Warning, Channel) },
        ("holds the samples of {of}, one for one, {}", if *is_other_end {
            "which sits on the other end: correct the `source` of one of the two"
        } else {
            "and is left out: one sensor counts once; correct its `source`, or delete its table"
        });
    /// The channel shows only noise while other channels show the impacts.
    Dead { farthest_m_s2: f64, is_beside_others: bool }
        => if *is_beside_others { (Code::DeadChannel, Warning, Channel) }
           else { (Code::DeadChannel, Error, ChannelAndMotion) },
        ("{} while others show the impacts{}: unplugged, broken, or the wrong `source`; name the right one \
         or take the channel out of the cask file",
         if *farthest_m_s2 > 0.0 {
             format!("stays within {:.2} g of its mean, all of it noise or hum,", farthest_m_s2 / G)
         } else { "holds one value".into() },
         if *is_beside_others { ", and is left out" } else { "" });
    /// Mains hum with some harmonics beside the fundamental; `left_m_s` of velocity is not corrected.
    Hum { amplitude_m_s2: f64, frequency_hz: f64, harmonics: usize, is_taken_off: bool, left_m_s: f64,
          severity: Severity } => (Code::Hum, *severity, Nothing),
        ("hums with {:.2} g at {frequency_hz:.1} Hz{} before the impact: {}; check shields and earth loops",
         amplitude_m_s2 / G,
         if *harmonics > 0 { format!(" and {harmonics} harmonics") } else { String::new() },
         if *is_taken_off {
             format!("it was taken off, and up to {left_m_s:.3} m/s of it may be left in the velocity")
         } else { format!("left as it is it swings the velocity by {left_m_s:.3} m/s") });
    /// Single samples far off their neighbours.
    Spikes { count: usize, held_m_s: f64, severity: Severity } => (Code::Spikes, *severity, Disturbance),
        ("has {count} spikes of one to five samples that no cask makes; left in, they move the velocity by \
         up to {held_m_s:.3} m/s: fasten or change the cable and its connectors");
    /// Stretches of samples that repeat to the bit.
    Dropout { stretches: usize, samples: usize, most_m_s: f64 } => (Code::Dropout, Warning, Disturbance),
        ("repeats itself to the bit in {stretches} stretches of {samples} samples together: a connector or \
         the recorder dropped out, or a driver writes each value several times; they are taken for lost (the \
         longest would hold about {most_m_s:.2} m/s): fasten cable and connectors, or record each value \
         once");
    /// The noise ends at a corner frequency below the report's cut-off. A half sine as long as the contact
    /// has `lost` that share of its peak.
    Filtered { corner_hz: f64, cutoff_hz: f64, rise_s: f64, contact_s: f64, lost: f64 }
        => (Code::Filtered, Warning, Nothing),
        ("is low-passed at about {corner_hz:.0} Hz in its chain, where the noise of the free fall ends, and \
         the report at {cutoff_hz:.0} Hz: its rise takes {:.1} ms, the contact may be shorter by as much, \
         peak and crush are those of a smoothed pulse (a half sine of {:.1} ms loses {:.0} %, a sharper one \
         more); the velocity stands. Set the low-pass of amplifier or recorder higher",
         1e3 * rise_s, 1e3 * contact_s, 100.0 * lost);
    /// The rows alternate between several sensors, with this period, and this factor between them.
    ByTurns { rows: usize, factor: f64 } => (Code::Scale, Error, Motion),
        ("holds the rows of several sensors by turns: throughout the shocks the same pattern returns every \
         {rows} rows, in which one reads {factor:.2} of another; where a column tells them apart take one, \
         `where = {{ column = …, is = … }}`, else write the rows of each into a file of its own");
    /// Samples beyond the full scale that the cask file states.
    BeyondFullScale { reads_m_s2: f64, full_scale_m_s2: f64 } => (Code::Clipped, Warning, Nothing),
        ("reads up to {:.0} g and has a `full_scale` of {:.0} g: what it reads beyond its full scale is no \
         limit. Correct `full_scale` by the data sheet of the whole chain, or the `sensitivity` or `unit` by \
         which it reads so much", reads_m_s2 / G, full_scale_m_s2 / G);
    /// The AC coupling that the cask file states is corrected.
    AcStated { time_constant_s: f64 } => (Code::AcCoupled, Note, Nothing),
        ("is AC-coupled; its droop was put back with the stated time constant of {time_constant_s} s");
    /// The channel droops after the step as the other channels do: AC coupling that nobody stated.
    AcUnstated { droop_m_s2: f64, step_m_s: f64, time_constant_s: f64 }
        => (Code::AcCoupled, Warning, Nothing),
        ("droops after its step in the proportion of the other channels, {:+.2} g after {step_m_s:+.1} m/s, \
         as behind a high-pass of {time_constant_s:.2} s: it is AC-coupled; set `coupling = \"ac\"` and \
         `time_constant_s` from the amplifier's data sheet, or record DC-coupled", droop_m_s2 / G);
    /// The free fall shows an offset, which is subtracted.
    OffsetTakenOff { mean_m_s2: f64, is_large: bool }
        => (Code::Offset, if *is_large { Warning } else { Note }, Nothing),
        ("reads {:+.2} g before the first impact, where free fall reads 0; that offset was taken off{}",
         mean_m_s2 / G, if *is_large { "; check the sensor and its amplifier" } else { "" });
    /// The free fall shows an offset, which stays as the cask file requests.
    OffsetLeftIn { mean_m_s2: f64, adds_m_s: f64, over_s: f64, severity: Severity }
        => (Code::Offset, *severity, Nothing),
        ("reads {:+.2} g before the first impact, where free fall reads 0; the cask file leaves that offset \
         in, which adds {adds_m_s:.2} m/s over {:.0} ms; set `offset = true` under `[corrections]` to have \
         it taken off", mean_m_s2 / G, 1e3 * over_s);
    /// An offset that drifts in the free fall.
    Drift { slope_m_s3: f64, u_m_s3: f64, adds_m_s: f64 } => (Code::Offset, Warning, Nothing),
        ("drifts by {:+.1} ± {:.1} g/s before the first impact; going on like that it adds {adds_m_s:.2} m/s \
         by the slap-down: let the amplifier warm up, check the cable and its insulation, or use another \
         channel", slope_m_s3 / G, 2.0 * u_m_s3 / G);
    /// The first impact accelerates the channel's end towards the target.
    Polarity => (Code::Polarity, Error, Motion),
        ("reads the first impact as pulling towards the target: set `polarity = -1` for it, or its end is \
         the other one");
    /// The offset in the flight differs from that before the impact; the change is subtracted.
    ///
    /// Alternatively the sensor's distance from the axis, stated and as it would have to be, explains it.
    ZeroShift {
        shift_m_s2: f64, u_m_s2: f64, effect_m_s: f64, offsets_m: Option<[f64; 2]>, severity: Severity
    }
        => (Code::ZeroShift, *severity, if offsets_m.is_some() { DoubtfulPlace } else { Nothing }),
        ("reads {:+.2} ± {:.2} g more between the impacts than before the first (zero shift or droop{}); it \
         was taken off, which moves the velocity by up to {effect_m_s:.2} m/s",
         shift_m_s2 / G, 2.0 * u_m_s2 / G,
         offsets_m.map(|[stated, explains]| format!(
             ", or `offset_m` is {explains:.2} in place of {stated:.2}")).unwrap_or_default());
    /// The velocity is off its flight by the time R strikes.
    LateMismatch { mismatch_m_s: f64 } => (Code::SecondContact, Warning, Motion),
        ("is {mismatch_m_s:+.2} m/s off its flight between the impacts by the time the second end strikes: \
         the first end touched again, or the sensor drifts; the film tells which");
    /// The flight's fit, extrapolated back to the separation, does not match the velocity.
    EarlyMismatch { mismatch_m_s: f64 } => (Code::FlightFit, Warning, Motion),
        ("is {mismatch_m_s:+.2} m/s off its flight as the first end leaves the target: its cable broke \
         contact, or a force acts on after the separation; k and the slap-down speed are not determined");
    /// Plateau and modes leave a large residual in the flight.
    Unexplained { modes: usize, residual_m_s: f64, u_m_s: f64 } => (Code::FlightFit, Warning, Motion),
        ("is not explained by a plateau and {modes} modes: {residual_m_s:.2} m/s are left, and its velocity \
         step is known to ± {:.2} m/s", 2.0 * u_m_s);
    /// A fitted mode bends the plateau of this channel alone.
    Bend { frequency_hz: f64, size_m_s: f64 } => (Code::FlightFit, Warning, Motion),
        ("swings by {size_m_s:.2} m/s at {frequency_hz:.0} Hz in the flight, which the other end does not: a \
         cask rings at both ends, so that is a cable that whips, a loose mount or a slow drift of the \
         sensor, and the velocity step is known only to about as much; fasten cable and sensor");
    /// The velocity step lies off the line through the steps of the other channels.
    OffLine { off_m_s: f64, u_m_s: f64 } => (Code::NotRigid, Warning, Contradiction),
        ("gains {off_m_s:+.2} ± {:.2} m/s more in the first impact than the other channels have a rigid body \
         gain there: check its scale, polarity, position and mount, or leave it out of the cask file",
         2.0 * u_m_s);
    /// The force vanishes between two times after first contact, and then returns.
    ForceRests { from_s: f64, to_s: f64 } => (Code::SecondContact, Warning, Motion),
        ("feels no force from {:.1} to {:.1} ms after first contact, and then again: the first end left the \
         target and was struck once more, or something strikes the cask; k and the slap-down speed are not \
         determined", 1e3 * from_s, 1e3 * to_s);
    /// Something strikes the cask in the flight at these times after first contact; `far` is the strongest in
    /// spreads of the residual.
    Struck { after_s: Vec<f64>, far: f64 } => (Code::SecondContact, Warning, Motion),
        ("shows shocks in the flight, at {} ms after first contact, the hardest {far:.0} times what ringing \
         and noise leave: contents that are loose and strike the cask, or a cable; the velocity steps mix \
         what was before with what came after, so k and the slap-down speed are not determined; fasten the \
         contents, or read the speed from the film", times_ms(after_s));
    /// The channel jumps within a few samples, while no other channel does so.
    Jumps { after_s: f64, size_m_s2: f64 } => (Code::Electrical, Warning, Motion),
        ("jumps by {:+.0} g within a few samples, {:.1} ms after first contact, and no other channel does \
         so then: no force does that, but a cable that breaks contact or the spike of a trigger; k and \
         the slap-down speed are not determined; fasten cable and connector, and keep the trigger's line \
         apart",
         size_m_s2 / G, 1e3 * after_s);
    /// The channel stands at one level from a time to its end, and nothing it reads is beyond that.
    AtStop { level_m_s2: f64, is_beside_others: bool } => (Code::Electrical, Warning, Disturbance),
        ("stands at {:+.0} g, as far as it ever reads, from there to its end, with nothing but noise on it: a \
         cable that is torn, or an amplifier at its stop; {} left out; fasten cable and connector",
         level_m_s2 / G, if *is_beside_others { "the channel is" } else { "those samples are" });
    /// The channel reads nothing but its noise as its end slaps down, and another up to a range.
    Quiet { after_s: f64, others_m_s2: f64 } => (Code::Electrical, Warning, Motion),
        ("reads nothing but its noise as its end strikes, {:.1} ms after first contact, where another channel \
         reads {:.0} g: its cable is torn; k and the slap-down speed are not determined; fasten cable and \
         connector, or leave the channel out if another is at that end", 1e3 * after_s, others_m_s2 / G);
    /// The channel alone jumps in the flight, with the numbers of `Struck`.
    JumpsAlone { after_s: Vec<f64>, far: f64 } => (Code::Electrical, Warning, Motion),
        ("jumps in the flight, at {} ms after first contact, by {far:.0} times what ringing and noise leave, \
         and no other channel shows it: no blow on a cask does so, but a cable that breaks contact or the \
         spike of a trigger; k and the slap-down speed are not determined; fasten cable and connector, and \
         keep the trigger's line apart", times_ms(after_s));
    /// The channel is struck while the first end is still falling.
    Ahead { ahead_s: f64 } => (Code::Skew, Error, Everything),
        ("is struck some {:.0} ms before the first end, which still falls by then: its recorder's clock is \
          ahead; record with one trigger, or shift the times of one recorder in a copy until both show the \
          first contact at one time", 1e3 * ahead_s);
    /// The channel answers before the first end is struck.
    AnswersEarly { delay_s: f64, u_s: f64, is_shifted: bool } => (Code::Skew, Warning, Nothing),
        ("answers the first impact {} before the first end is struck, which no body does: {ONE_TRIGGER}{}",
         size_ms(*delay_s, *u_s), shift_words(*is_shifted));
    /// The channel answers later than the slowest bending wave, which takes `wave_s`.
    AnswersLate { delay_s: f64, u_s: f64, wave_s: f64, is_shifted: bool } => (Code::Skew, Warning, Nothing),
        ("answers the first impact {} after the first end is struck, and a bending wave needs {:.1} ms at \
         most: {ONE_TRIGGER}{}", size_ms(*delay_s, *u_s), 1e3 * wave_s, shift_words(*is_shifted));
    /// The channel answers as late as the slowest bending wave would arrive.
    AnswersAsAWave { delay_s: f64, u_s: f64 } => (Code::Skew, Note, Nothing),
        ("answers the first impact {} after the first end is struck: a bending wave may take as long, or the \
         channels' clocks are apart; check that one trigger starts both", size_ms(*delay_s, *u_s));
    /// A mounting block shows a motion across the plane of the drop.
    MovesAcross { velocity_m_s: f64, u_m_s: f64 } => (Code::NotPlanar, Warning, Nothing),
        ("moves across the plane of the drop at {:+.2} ± {:.2} m/s through the flight, and the analysis is \
         that of a motion in this plane: the speed across it is not in the results; check how the cask hung",
         velocity_m_s, 2.0 * u_m_s);
    /// A sensor on the skin has no partner beside it that shows a motion across the plane.
    AloneOnSkin { u_share: f64 } => (Code::NotPlanar, Note, Nothing),
        ("stands alone at its place on the skin: its part in the plane of the drop is determined as if the \
         cask did not move across it, and 1° of `around_deg` is {:.1} % of it; mount a radial and a \
         tangential sensor together", 200.0 * u_share);
    /// A channel that takes no part in the motion stays at a limit.
    OtherClipped { limit: f64, samples: usize, unit: String } => (Code::Clipped, Warning, Nothing),
        ("stands at its limit of {} {unit} for {samples} samples: its true extreme lies beyond; use a range \
         with more head-room", digits(*limit, 4));
    /// A channel that takes no part in the motion shows nothing but noise.
    OtherStill { farthest: Option<f64>, unit: String } => (Code::DeadChannel, Note, Nothing),
        ("{} through the impacts: a slow quantity, or a sensor that is unplugged or broken, or the wrong \
         `source`", stillness_words(*farthest, unit));
    /// Noise of a channel that takes no part in the motion, compared with its largest deviation from rest.
    OtherNoise { noise: f64, farthest: f64, unit: String } => (Code::Noise, Note, Nothing),
        ("has noise of {} {unit} RMS, {:.0} % of its largest deviation from rest, and its extremes are \
         uncertain by about twice as much: use a more sensitive range, or look for a loose cable",
         digits(*noise, 3), 100.0 * noise / farthest);
    /// An angular-rate sensor reads this share of the rotation by the accelerometers, and is excluded.
    OtherRotation { share: f64, cause: RotationCause } => (cause.code(), Warning, Channel),
        ("reads {} times the rotation that the accelerometers have the first impact give: {cause}; until \
         then it is left out", digits(*share, 3));
    /// The recording states another unit than the cask file.
    OtherUnit { stated: String, recorded: String } => (Code::Scale, Note, Nothing),
        ("the cask file gives the unit {stated:?}, the recording {recorded:?}; the cask file is followed");
}
}

impl RotationCause {
    fn code(self) -> Code {
        match self {
            Self::Sign => Code::Polarity,
            Self::Unit => Code::Scale,
            Self::Nothing => Code::DeadChannel,
        }
    }
}

impl ChannelFinding {
    /// States the finding on the named channel, its size, and the action to take.
    pub(super) fn sentence(&self, name: &str) -> String {
        match self {
            Self::LeftOut { .. } | Self::Copied { .. } | Self::OtherUnit { .. } => self.to_string(),
            Self::Noise { .. } => format!("the noise of {name} {self}"),
            Self::Unexplained { .. } => format!("the flight of {name} {self}"),
            _ => format!("{name} {self}"),
        }
    }
}

fn cut_off(during: DropPart, lost_m_s: f64, takes_step: bool) -> String {
    let part = match during {
        DropPart::FirstImpact => "first impact",
        DropPart::Flight => "flight",
        DropPart::SlapDown => {
            return "from the slap-down on, which leaves the speed before it as it is but not the peak"
                .into();
        }
    };
    let had = if takes_step { format!(", and {REPLACES_STEP}") } else { String::new() };
    format!("in the {part}; about {lost_m_s:.2} m/s of velocity is cut off{had}")
}

fn stillness_words(farthest: Option<f64>, unit: &str) -> String {
    match farthest {
        None => "holds no number".into(),
        Some(0.0) => "holds one value".into(),
        Some(farthest) => {
            format!("stays within {} {unit} of its rest, all of it noise,", digits(farthest, 3))
        }
    }
}

fn times_ms(after_s: &[f64]) -> String {
    let mut times: Vec<String> = after_s.iter().map(|t| format!("{:.1}", 1e3 * t)).collect();
    if times.len() > MOST_TIMES {
        times.splice(MOST_TIMES.., [format!("… {} in all", after_s.len())]);
    }
    times.join(", ")
}

fn size_ms(delay_s: f64, u_s: f64) -> String {
    format!("{:.2} ± {:.2} ms", 1e3 * delay_s.abs(), 2e3 * u_s)
}

fn shift_words(is_shifted: bool) -> &'static str {
    if is_shifted { "; it was shifted back by as much" } else { "" }
}
