//! Every channel around the impacts to the shock that it reads there, whether the motion is determined or
//! not; and the vectors that mounting blocks of three read.

use super::{first_look, skin};
use crate::condition::{self, Reach};
use crate::data::{
    Analysis, Axis, CaskFile, Channel, ChannelPeak, ChannelPulse, ChannelSpec, CoarseEvent, DropResult, End,
    OtherSummary, Recording, Shock, Signal, acceleration_unit_m_s2,
};
use crate::motion;
use crate::numerics::robust;
use rayon::prelude::*;
use std::borrow::Cow;

/// Where nothing shows when a shock ends, it is sought for so long, s.
const LONGEST_S: f64 = 0.1;
/// A low-pass smears the second shock over so many periods of its cut-off before it: 1e-3 of it is beyond.
const SMEARED_PERIODS: f64 = 1.6;
/// An impact that a channel's own course shows is found where a tenth of its peak is reached; it begins less
/// than this before, s.
const FOOT_S: f64 = 5e-3;
/// A sensor on the skin within 3° of the plane of the drop reads this share of an acceleration in it.
const UPRIGHT: f64 = 0.9986;

/// Adds the shock of every channel to the result.
pub(super) fn add(recording: &Recording, file: &CaskFile, found: &mut Analysis) {
    let Some(sought) = ShockSearch::new(recording, file, &found.result) else { return };
    let in_motion = recording.channels.par_iter().map(|channel| sought.of_motion(channel));
    let others = recording.others.channels.par_iter().zip(&found.result.other_channels);
    let others = others.map(|(channel, summary)| sought.of_other(channel, summary));
    let blocks = skin::blocks(file);
    let of_blocks = blocks.par_iter().map(|block| sought.of_block(*block, recording));
    let all: Vec<Vec<Shock>> = in_motion.chain(others).chain(of_blocks).collect();
    found.result.shocks = all.into_iter().flatten().collect();
}

/// Where shocks are sought that the tables of the impacts do not have.
struct ShockSearch<'a> {
    file: &'a CaskFile,
    result: &'a DropResult,
    cutoff_hz: f64,
    /// When the first impact begins, s, by the motion or by the channels themselves.
    contact_s: f64,
}

impl<'a> ShockSearch<'a> {
    /// `None` where no channel shows an impact.
    fn new(recording: &Recording, file: &'a CaskFile, result: &'a DropResult) -> Option<Self> {
        let contact_s = result.events.first_contact_s().or_else(|| own_impact_s(recording))?;
        let cutoff_hz = motion::cutoff_hz(file.filter, file.cask.mass_kg).0;
        Some(Self { file, result, cutoff_hz, contact_s })
    }

    /// The stretch of each impact, s.
    fn stretches_s(&self) -> Vec<(End, [f64; 2])> {
        let second_s = self.result.events.slap_down_s();
        let latest_s = second_s.map_or(f64::INFINITY, |at_s| at_s - SMEARED_PERIODS / self.cutoff_hz);
        let stretch = |end, from_s: f64, to_s: f64| (end, [from_s, to_s.min(from_s + LONGEST_S)]);
        let first = stretch(End::First, self.contact_s, latest_s);
        let second = second_s.map(|at_s| stretch(End::Second, at_s, f64::INFINITY));
        [Some(first), second].into_iter().flatten().collect()
    }

    /// When the last of them ends, s.
    fn end_s(&self) -> f64 {
        self.stretches_s().iter().map(|(_, [_, to_s])| *to_s).fold(self.contact_s, f64::max)
    }

    /// The shocks of a channel of the motion: those of the impacts' tables, else those of the channel alone.
    fn of_motion(&self, channel: &Channel) -> Vec<Shock> {
        let tables = self.result.impacts.iter();
        let pulse = |(end, peaks): (End, &[ChannelPeak])| {
            let own = peaks.iter().find(|peak| peak.name == channel.name)?;
            let known = [own.peak_filtered, own.peak_raw];
            Some(Shock { known, ..shock(channel, end, own.pulse, true) })
        };
        let shocks: Vec<Shock> = tables.filter_map(|table| pulse((table.end, &table.channels))).collect();
        // The tables have what a sensor aslant on the skin would read in the plane of the drop.
        let is_alone = shocks.is_empty() || self.share(channel) < UPRIGHT;
        if is_alone { self.shocks_of(channel, &[self.as_read(channel)], true) } else { shocks }
    }

    /// The shocks of the vector that the three sensors of a mounting block read; none where they are of
    /// different times.
    fn of_block(&self, specs: [&ChannelSpec; 3], recording: &Recording) -> Vec<Shock> {
        let [Some(one), Some(other), Some(axial)] = specs.map(|spec| channel_of(spec, recording)) else {
            return Vec::new();
        };
        let signals = [&one, &other, &axial].map(|channel| self.as_read(channel));
        if !signals.iter().all(|signal| skin::are_of_same_times([&signals[2], signal])) {
            return Vec::new();
        }
        let components = specs.map(|spec| spec.name.clone()).to_vec();
        let channel = format!("resultant of {}", components.join(", "));
        let shocks = self.shocks_of(&axial, &signals, true).into_iter();
        let named = |s| Shock { channel: channel.clone(), components: components.clone(), ..s };
        shocks.map(named).collect()
    }

    /// The shocks of a channel that takes no part in the motion.
    fn of_other(&self, channel: &Channel, summary: &OtherSummary) -> Vec<Shock> {
        if let Some(accelerometer) = accelerometer(channel) {
            return self.shocks_of(channel, &[self.accelerations(&accelerometer)], true);
        }
        let Some(rest) = summary.rest else { return Vec::new() };
        let (from_s, to_s) = (self.contact_s - LONGEST_S, self.end_s() + LONGEST_S);
        let from = channel.index_at(from_s);
        let change = |value: f64| if value.is_finite() { value - rest } else { 0.0 };
        let changes = channel.force_m_s2(from, channel.index_at(to_s)).into_iter().map(change).collect();
        let whole = Signal {
            start_s: channel.start_s,
            sample_rate_hz: channel.sample_rate_hz,
            clipped: summary.clipped.clone(),
            gaps: channel.gaps.clone(),
            ..Signal::default()
        };
        self.shocks_of(channel, &[whole.cut_with(from, changes)], false)
    }

    /// What a sensor reads of the acceleration that its channel holds, as a share.
    fn share(&self, channel: &Channel) -> f64 {
        let spec = self.file.channels.iter().find(|spec| spec.name == channel.name);
        spec.map_or(1.0, |spec| spec.axis_share().abs())
    }

    /// A channel over the impacts as its sensor reads.
    fn as_read(&self, channel: &Channel) -> Signal {
        let (share, mut signal) = (self.share(channel), self.accelerations(channel));
        signal.force_m_s2.iter_mut().for_each(|force| *force *= share);
        signal
    }

    /// A channel over the impacts, counted from its level in the free fall.
    fn accelerations(&self, channel: &Channel) -> Signal {
        let usual = Reach::for_drop(&self.file.cask, &self.file.drop);
        let reach = Reach { after_s: self.end_s() + LONGEST_S - self.contact_s, ..usual };
        let event = CoarseEvent { near_s: self.contact_s, spread_s: 0.0, velocity_step_m_s: 0.0 };
        condition::condition_channel(channel, &event, &reach, self.file.corrections).0
    }

    /// The shocks of a signal, or of the vector of several.
    fn shocks_of(&self, channel: &Channel, signals: &[Signal], is_acceleration: bool) -> Vec<Shock> {
        let found = |(end, stretch_s): (End, [f64; 2])| {
            let pulse = motion::vector_pulses(signals, signals.len(), stretch_s, self.cutoff_hz).pop();
            shock(channel, end, pulse.flatten(), is_acceleration)
        };
        self.stretches_s().into_iter().map(found).collect()
    }
}

/// A pulse in the channel's unit; an acceleration that is recorded as a voltage in m/s².
fn shock(channel: &Channel, event: End, pulse: Option<ChannelPulse>, is_acceleration: bool) -> Shock {
    let own_m_s2 = acceleration_unit_m_s2(&channel.unit);
    let unit_m_s2 = is_acceleration.then_some(own_m_s2.unwrap_or(1.0));
    let is_in_own_unit = own_m_s2.is_some() || !is_acceleration;
    let in_unit = |reading: f64| reading / unit_m_s2.unwrap_or(1.0);
    let integral = |i: usize| pulse.filter(|_| is_acceleration).and_then(|p| Some(p.integrals?[i]));
    Shock {
        channel: channel.name.clone(),
        event,
        peak: pulse.map(|p| in_unit(p.filtered)),
        peak_unfiltered: pulse.map(|p| in_unit(p.raw)),
        time_s: pulse.map(|p| p.time_s),
        duration_s: pulse.and_then(|p| Some(p.length?.length_s)),
        velocity_change_m_s: integral(0),
        displacement_m: integral(1),
        unit: if is_in_own_unit { channel.unit.clone() } else { "m/s^2".to_owned() },
        unit_m_s2,
        ..Shock::default()
    }
}

/// The channel of an accelerometer, in m/s².
fn channel_of<'a>(spec: &ChannelSpec, recording: &'a Recording) -> Option<Cow<'a, Channel>> {
    let is_own = |channel: &&Channel| channel.name == spec.name;
    let of_motion = recording.channels.iter().find(is_own).map(Cow::Borrowed);
    let other = || recording.others.channels.iter().find(is_own).and_then(accelerometer);
    of_motion.or_else(|| other().map(Cow::Owned))
}

/// An accelerometer that takes no part in the motion as one of the motion, in m/s².
fn accelerometer(other: &Channel) -> Option<Channel> {
    let unit_m_s2 = acceleration_unit_m_s2(&other.unit)?;
    let scale_m_s2 = other.scale_m_s2 * unit_m_s2;
    Some(Channel { scale_m_s2, axis: Axis::Transverse, ..other.clone() })
}

/// When the first impact begins by what the channels read themselves, s: the median of those that show one.
fn own_impact_s(recording: &Recording) -> Option<f64> {
    let of_motion = recording.channels.iter().filter_map(first_look::impact_s);
    let others = recording.others.channels.iter().filter_map(accelerometer);
    let others = others.filter_map(|channel| first_look::impact_s(&channel));
    let mut begins_s: Vec<f64> = of_motion.chain(others).collect();
    Some(robust::median(&mut begins_s) - FOOT_S).filter(|at_s| at_s.is_finite())
}
