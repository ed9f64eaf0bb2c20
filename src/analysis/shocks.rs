//! Determines the shock that every channel reads at the impacts, even without a motion; and the vectors of
//! mounting blocks with three sensors.

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

/// Longest search for a shock whose end nothing shows, s.
const LONGEST_S: f64 = 0.1;
/// A low-pass spreads the second shock before it, over this many periods of its cut-off: 1e-3 of it lies
/// beyond.
const SMEARED_PERIODS: f64 = 1.6;
/// An impact found in a channel alone is dated at a tenth of its peak; it begins at most this much earlier,
/// s.
const FOOT_S: f64 = 5e-3;
/// Share of an acceleration in the plane of the drop that a sensor on the skin reads within 3° of that plane.
const LEAST_SHARE: f64 = 0.9986;

/// Adds the shock of every channel to the result.
pub(super) fn add(recording: &Recording, file: &CaskFile, analysis: &mut Analysis) {
    let Some(search) = ShockSearch::new(recording, file, &analysis.result) else { return };
    let in_motion = recording.channels.par_iter().map(|channel| search.motion_shocks(channel));
    let others = recording.others.channels.par_iter().zip(&analysis.result.other_channels);
    let in_others = others.map(|(channel, summary)| search.other_shocks(channel, summary));
    let blocks = skin::blocks(file);
    let in_blocks = blocks.par_iter().map(|block| search.block_shocks(*block, recording));
    let all: Vec<Vec<Shock>> = in_motion.chain(in_others).chain(in_blocks).collect();
    analysis.result.shocks = all.into_iter().flatten().collect();
}

/// Search for shocks that the tables of the impacts do not contain.
struct ShockSearch<'a> {
    file: &'a CaskFile,
    result: &'a DropResult,
    cutoff_hz: f64,
    /// Start of the first impact, s, from the motion or from the channels themselves.
    contact_s: f64,
}

impl<'a> ShockSearch<'a> {
    /// Prepares the search; `None` if no channel shows an impact.
    fn new(recording: &Recording, file: &'a CaskFile, result: &'a DropResult) -> Option<Self> {
        let contact_s = result.events.first_contact_s().or_else(|| find_impact_s(recording))?;
        let cutoff_hz = motion::cutoff_hz(file.filter, file.cask.mass_kg).0;
        Some(Self { file, result, cutoff_hz, contact_s })
    }

    /// Interval of each impact, s.
    fn stretches_s(&self) -> Vec<(End, [f64; 2])> {
        let second_s = self.result.events.slap_down_s();
        let latest_s = second_s.map_or(f64::INFINITY, |at_s| at_s - SMEARED_PERIODS / self.cutoff_hz);
        let stretch = |end, from_s: f64, to_s: f64| (end, [from_s, to_s.min(from_s + LONGEST_S)]);
        let first = stretch(End::First, self.contact_s, latest_s);
        let second = second_s.map(|at_s| stretch(End::Second, at_s, f64::INFINITY));
        [Some(first), second].into_iter().flatten().collect()
    }

    /// End of the last interval, s.
    fn end_s(&self) -> f64 {
        self.stretches_s().iter().map(|(_, [_, to_s])| *to_s).fold(self.contact_s, f64::max)
    }

    /// Returns the shocks of a channel of the motion: those of the impacts' tables, else those of the channel
    /// alone.
    fn motion_shocks(&self, channel: &Channel) -> Vec<Shock> {
        let tables = self.result.impacts.iter();
        let pulse = |(end, peaks): (End, &[ChannelPeak])| {
            let own = peaks.iter().find(|peak| peak.name == channel.name)?;
            let known = [own.peak_filtered, own.peak_raw];
            Some(Shock { known, ..shock(channel, end, own.pulse, true) })
        };
        let shocks: Vec<Shock> = tables.filter_map(|table| pulse((table.end, &table.channels))).collect();
        // The tables contain the reading in the plane of the drop, which a sensor at an angle on the skin
        // does not show itself.
        let is_alone = shocks.is_empty() || self.share(channel) < LEAST_SHARE;
        if is_alone { self.shocks_of(channel, &[self.as_read(channel)], true) } else { shocks }
    }

    /// Returns the shocks of the vector that the three sensors of a mounting block read; none if their
    /// samples have different times.
    fn block_shocks(&self, specs: [&ChannelSpec; 3], recording: &Recording) -> Vec<Shock> {
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
        let rename = |s| Shock { channel: channel.clone(), components: components.clone(), ..s };
        shocks.map(rename).collect()
    }

    /// Returns the shocks of a channel that takes no part in the motion.
    fn other_shocks(&self, channel: &Channel, summary: &OtherSummary) -> Vec<Shock> {
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

    /// Share of its channel's acceleration that a sensor itself reads.
    fn share(&self, channel: &Channel) -> f64 {
        let spec = self.file.channels.iter().find(|spec| spec.name == channel.name);
        spec.map_or(1.0, |spec| spec.axis_share().abs())
    }

    /// Returns a channel over the impacts as its sensor reads.
    fn as_read(&self, channel: &Channel) -> Signal {
        let (share, mut signal) = (self.share(channel), self.accelerations(channel));
        signal.force_m_s2.iter_mut().for_each(|force| *force *= share);
        signal
    }

    /// Returns a channel over the impacts, less its level in the free fall.
    fn accelerations(&self, channel: &Channel) -> Signal {
        let usual = Reach::for_drop(&self.file.cask, &self.file.drop);
        let reach = Reach { after_s: self.end_s() + LONGEST_S - self.contact_s, ..usual };
        let event = CoarseEvent { near_s: self.contact_s, spread_s: 0.0, velocity_step_m_s: 0.0 };
        condition::condition_channel(channel, &event, &reach, self.file.corrections).0
    }

    /// Returns the shocks of a signal, or of the vector of several.
    fn shocks_of(&self, channel: &Channel, signals: &[Signal], is_acceleration: bool) -> Vec<Shock> {
        let found = |(end, stretch_s): (End, [f64; 2])| {
            let pulse = motion::vector_pulses(signals, signals.len(), stretch_s, self.cutoff_hz).pop();
            shock(channel, end, pulse.flatten(), is_acceleration)
        };
        self.stretches_s().into_iter().map(found).collect()
    }
}

/// States a pulse in the channel's unit; an acceleration that is recorded as a voltage in m/s².
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

/// Finds the channel of an accelerometer, in m/s².
fn channel_of<'a>(spec: &ChannelSpec, recording: &'a Recording) -> Option<Cow<'a, Channel>> {
    let is_own = |channel: &&Channel| channel.name == spec.name;
    let of_motion = recording.channels.iter().find(is_own).map(Cow::Borrowed);
    let other = || recording.others.channels.iter().find(is_own).and_then(accelerometer);
    of_motion.or_else(|| other().map(Cow::Owned))
}

/// Converts an accelerometer that takes no part in the motion into a channel of the motion, in m/s².
fn accelerometer(other: &Channel) -> Option<Channel> {
    let unit_m_s2 = acceleration_unit_m_s2(&other.unit)?;
    let scale_m_s2 = other.scale_m_s2 * unit_m_s2;
    Some(Channel { scale_m_s2, axis: Axis::Transverse, ..other.clone() })
}

/// Start of the first impact in the channels themselves, s: the median of those that show one.
fn find_impact_s(recording: &Recording) -> Option<f64> {
    let of_motion = recording.channels.iter().filter_map(first_look::find_impact_s);
    let others = recording.others.channels.iter().filter_map(accelerometer);
    let others = others.filter_map(|channel| first_look::find_impact_s(&channel));
    let mut begins_s: Vec<f64> = of_motion.chain(others).collect();
    Some(robust::median(&mut begins_s) - FOOT_S).filter(|at_s| at_s.is_finite())
}
