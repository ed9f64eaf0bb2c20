//! Sensors of the skin to what each place reads in the plane of the drop, and across it   (51)

use super::impact::Impact;
use crate::data::{
    CaskFile, Channel, ChannelSpec, Events, Finding, RestLevel, Signal, SkinDirection, SkinPlace, Span,
    acceleration_unit_m_s2,
};
use crate::judge;
use crate::numerics::robust;

/// A radial and a tangential sensor within this of one another along the axis, m, and around the skin, rad,
/// are one place: a mounting block.
const SAME_PLACE_M: f64 = 0.02;
const SAME_PLACE_RAD: f64 = 0.05;

/// Standard uncertainty of the angle at which a sensor is mounted, rad: 1° at 95 %, as a block is set by a
/// spirit level.
const U_AROUND_RAD: f64 = 0.0087;

/// Free fall that the offset of a sensor across the plane is taken from, s.
const FREE_FALL_S: f64 = 0.1;
const CLEAR_S: f64 = 1e-3;

/// The radial and the tangential sensor of each place that has both.
fn pairs(specs: &[ChannelSpec]) -> impl Iterator<Item = [&ChannelSpec; 2]> {
    let reads = |spec: &ChannelSpec, way| spec.skin.filter(|skin| skin.direction == way);
    specs.iter().filter_map(move |radial| {
        let at = reads(radial, SkinDirection::Radial)?;
        let is_beside = |other: &&ChannelSpec| {
            reads(other, SkinDirection::Tangential).is_some_and(|beside| {
                other.end == radial.end
                    && (other.position_m - radial.position_m).abs() < SAME_PLACE_M
                    && (beside.around_rad - at.around_rad).abs() < SAME_PLACE_RAD
            })
        };
        Some([radial, specs.iter().find(is_beside)?])
    })
}

/// The weight of a sensor in the acceleration in the plane of its place: the square of its share, since its
/// signal is what it reads over that share.
fn weight(spec: &ChannelSpec) -> f64 {
    spec.axis_share().powi(2)
}

/// Puts in place of the radial and the tangential signal of a place the one in the plane of the drop, under
/// the name of the radial one; returns those across it, of the same names. What a sensor alone reads is not
/// told from a motion across the plane, and its scale is as uncertain as its angle.
pub(super) fn turn_into_plane(signals: &mut Vec<Signal>, specs: &[ChannelSpec]) -> Vec<Signal> {
    let mut across = Vec::new();
    for pair in pairs(specs) {
        let places = pair.map(|spec| signals.iter().position(|signal| signal.name == spec.name));
        let [Some(radial), Some(tangential)] = places else { continue };
        let both = [&signals[radial], &signals[tangential]];
        let [share, other] = pair.map(ChannelSpec::axis_share);
        across.push(combined(both, [share * other, -share * other]));
        signals[radial] = combined(both, pair.map(weight));
        signals.remove(tangential);
    }
    let is_paired = |signal: &Signal| across.iter().any(|of_pair| of_pair.name == signal.name);
    for signal in signals.iter_mut() {
        let spec = specs.iter().find(|spec| spec.name == signal.name);
        if let Some([share, other]) = spec.and_then(|spec| spec.skin).map(SkinPlace::shares)
            && !is_paired(signal)
        {
            signal.u_around = U_AROUND_RAD * (other / share).abs();
        }
    }
    across
}

/// Puts the levels at rest of a place into the plane of the drop, likewise.
pub(super) fn turn_rests(rests: &mut Vec<RestLevel>, signals: &[Signal], specs: &[ChannelSpec]) {
    for pair in pairs(specs) {
        let places = pair.map(|spec| rests.iter().position(|rest| rest.channel == spec.name));
        let is_combined = signals.iter().all(|signal| signal.name != pair[1].name);
        let ([Some(radial), Some(tangential)], true) = (places, is_combined) else { continue };
        let [one, other] = pair.map(weight);
        let beside = rests[tangential].clone();
        let rest = &mut rests[radial];
        rest.rest_m_s2 = one * rest.rest_m_s2 + other * beside.rest_m_s2;
        rest.u_m_s2 = (one * rest.u_m_s2).hypot(other * beside.u_m_s2);
        rests.remove(tangential);
    }
}

/// The sum of two signals by their weights, on the time base of the first.
fn combined([one, other]: [&Signal; 2], [first, second]: [f64; 2]) -> Signal {
    let sum = |a: f64, b: f64| first * a + second * b;
    let u = |a: f64, b: f64| (first * a).hypot(second * b);
    let at = |index: usize| other.position_at(one.time_s(index));
    let value = |position: f64| {
        let before = position.floor();
        let [low, high] = [before, before + 1.0].map(|at| {
            let index = other.index_from(other.start_s + at / other.sample_rate_hz);
            other.force_m_s2.get(index).copied().unwrap_or(0.0)
        });
        low + (position - before) * (high - low)
    };
    let indices = 0..one.force_m_s2.len();
    let force_m_s2 = indices.map(|index| sum(one.force_m_s2[index], value(at(index)))).collect();
    let own_base = |spans: &[Span]| -> Vec<Span> {
        let index = |at: usize| one.index_from(other.time_s(at));
        spans.iter().map(|span| Span { from: index(span.from), to: index(span.to) }).collect()
    };
    // What is recorded by one of the two alone is missing.
    let last = one.index_from(other.end_s());
    let beyond = [
        Span { from: 0, to: one.index_from(other.start_s) },
        Span { from: last + 1, to: one.force_m_s2.len() },
    ];
    let beyond = beyond.into_iter().filter(|span| span.from < span.to);
    let spectrum = one.noise_spectrum.iter().enumerate().map(|(bin, (hz, density))| {
        let beside = other.noise_spectrum.get(bin).map_or(*density, |(_, density)| *density);
        (*hz, first * first * density + second * second * beside)
    });
    Signal {
        force_m_s2,
        removed_offset_m_s2: sum(one.removed_offset_m_s2, other.removed_offset_m_s2),
        u_offset_m_s2: u(one.u_offset_m_s2, other.u_offset_m_s2),
        noise_m_s2: u(one.noise_m_s2, other.noise_m_s2),
        noise_spectrum: spectrum.collect(),
        free_fall_s: one.free_fall_s.min(other.free_fall_s),
        clipped: [&one.clipped[..], &own_base(&other.clipped)].concat(),
        gaps: one.gaps.iter().copied().chain(own_base(&other.gaps)).chain(beyond).collect(),
        ..one.clone()
    }
}

/// What the skin's sensors say of a motion across the plane of the drop, and which of them cannot tell.
pub(super) fn judge_across(impact: &Impact, events: &Events, file: &CaskFile) -> Vec<Finding> {
    let of_other = |channel: &Channel| {
        let spec = file.others.iter().find(|spec| spec.read.name == channel.name)?;
        spec.read.skin.and_then(|_| across(channel, events))
    };
    let others: Vec<Signal> = impact.others.channels.iter().filter_map(of_other).collect();
    let moving = impact.across.iter().chain(&others);
    let moving = moving.filter_map(|signal| judge::judge_across(signal, events));
    let alone = impact.recorded().iter().filter_map(judge::judge_alone);
    moving.chain(alone).collect()
}

/// The signal of a sensor that reads across the plane, from the free fall on.
fn across(channel: &Channel, events: &Events) -> Option<Signal> {
    let contact_s = events.first_contact_s()?;
    let unit_m_s2 = acceleration_unit_m_s2(&channel.unit)?;
    let from_s = events.release_s.map_or(contact_s - FREE_FALL_S, |at_s| at_s.max(contact_s - FREE_FALL_S));
    let [from, before] = [from_s, contact_s - CLEAR_S].map(|at_s| channel.index_at(at_s));
    let to = channel.index_at(events.slap_down_s()?) + 1;
    let read: Vec<f64> = channel.force_m_s2(from, to).iter().map(|f| f * unit_m_s2).collect();
    let free = read.get(..before.checked_sub(from)?).filter(|free| free.len() > 1)?;
    let (mean, u) = robust::mean_and_u(free);
    let is_whole = read.iter().all(|f| f.is_finite());
    is_whole.then(|| Signal {
        name: channel.name.clone(),
        start_s: channel.time_s(from),
        sample_rate_hz: channel.sample_rate_hz,
        force_m_s2: read.iter().map(|f| f - mean).collect(),
        u_offset_m_s2: u,
        ..Signal::default()
    })
}
