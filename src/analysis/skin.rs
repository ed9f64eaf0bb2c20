//! Combines sensors on the skin into the reading of each place in the plane of the drop, and across it   (53)

use crate::data::{
    Axis, CaskFile, Channel, ChannelSpec, Events, Finding, RestLevel, Signal, SkinDirection, SkinPlace, Span,
    acceleration_unit_m_s2,
};
use crate::judge;
use crate::numerics::{reduce, robust};

/// A radial and a tangential sensor at most this far apart along the axis, m, and around the skin, rad, are
/// one place: a mounting block.
const SAME_PLACE_M: f64 = 0.02;
const SAME_PLACE_RAD: f64 = 0.05;

/// Two directions are perpendicular to one another within 3°: the cosine between them.
const SQUARE: f64 = 0.05;

/// Standard uncertainty of the angle at which a sensor is mounted, rad: 1° at 95 %, as a block is set by a
/// spirit level.
const U_AROUND_RAD: f64 = 0.0087;

/// Length of free fall that determines the offset of a sensor across the plane, and its distance from the
/// contact, s.
const FREE_FALL_S: f64 = 0.1;
const CLEAR_S: f64 = 1e-3;

/// Lists the radial and the tangential sensor of each place that has both.
fn pairs(specs: &[ChannelSpec]) -> impl Iterator<Item = [&ChannelSpec; 2]> {
    let reads = |spec: &ChannelSpec, way| spec.skin.filter(|skin| skin.direction == way);
    specs.iter().filter_map(move |radial| {
        let at = reads(radial, SkinDirection::Radial)?;
        let is_beside = |other: &&ChannelSpec| {
            reads(other, SkinDirection::Tangential).is_some_and(|beside| {
                other.end == radial.end
                    && (other.position_m - radial.position_m).abs() < SAME_PLACE_M
                    && (beside.around_rad - at.around_rad).cos() > SAME_PLACE_RAD.cos()
            })
        };
        Some([radial, specs.iter().find(is_beside)?])
    })
}

/// Lists the sensors of each mounting block with three: two perpendicular ones across the axis, and the axial
/// one.
pub(super) fn blocks(file: &CaskFile) -> Vec<[&ChannelSpec; 3]> {
    let others = file.others.iter().map(|other| &other.read).filter(|spec| spec.skin.is_some());
    let all: Vec<&ChannelSpec> = file.channels.iter().chain(others).collect();
    let along = all.iter().filter(|spec| spec.axis == Axis::Axial);
    let block = along.filter_map(|axial| {
        let is_beside = |spec: &&&ChannelSpec| {
            let far_m = [spec.offset_m - axial.offset_m, spec.lateral_m - axial.lateral_m];
            (spec.axis, &spec.file) == (Axis::Transverse, &axial.file)
                && (spec.position_m - axial.position_m).abs() < SAME_PLACE_M
                && far_m[0].hypot(far_m[1]) < SAME_PLACE_M
        };
        let mut beside = all.iter().filter(is_beside);
        let one = beside.next()?;
        let cosine = |other: &ChannelSpec| reduce::dot(&one.direction(), &other.direction());
        Some([*one, *beside.find(|other| cosine(other).abs() < SQUARE)?, *axial])
    });
    block.collect()
}

/// Weights of a pair in the plane: the squares of their shares, since a signal is the sensor's reading over
/// its share. For one angle their sum is 1.
fn weights(pair: [&ChannelSpec; 2]) -> [f64; 2] {
    let squares = pair.map(|spec| spec.axis_share().powi(2));
    squares.map(|square| square / (squares[0] + squares[1]))
}

/// Replaces the radial and the tangential signal of a place by the one in the plane of the drop, under the
/// name of the radial one; returns the signals across it, with the same names. A single sensor cannot
/// separate a motion across the plane from its own reading, and its scale is as uncertain as its angle.
pub(super) fn turn_into_plane(signals: &mut Vec<Signal>, specs: &[ChannelSpec]) -> Vec<Signal> {
    let mut across = Vec::new();
    for pair in pairs(specs) {
        let places = pair.map(|spec| signals.iter().position(|signal| signal.name == spec.name));
        let [Some(radial), Some(tangential)] = places else { continue };
        let pair_signals = [&signals[radial], &signals[tangential]];
        if !are_of_same_times(pair_signals) {
            continue;
        }
        let [share, other] = pair.map(ChannelSpec::axis_share);
        across.push(combine(pair_signals, [share * other, -share * other]));
        signals[radial] = combine(pair_signals, weights(pair));
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

/// Combines the levels at rest of a place likewise; without both there is none.
pub(super) fn turn_rests(rests: &mut Vec<RestLevel>, across: &[Signal], specs: &[ChannelSpec]) {
    for pair in pairs(specs).filter(|[radial, _]| across.iter().any(|of_pair| of_pair.name == radial.name)) {
        let is_of_pair = |rest: &mut RestLevel| pair.iter().any(|spec| rest.channel == spec.name);
        let both: Vec<RestLevel> = rests.extract_if(.., is_of_pair).collect();
        let find = |spec: &ChannelSpec| both.iter().find(|rest| rest.channel == spec.name);
        let ([Some(radial), Some(tangential)], [one, other]) = (pair.map(find), weights(pair)) else {
            continue;
        };
        rests.push(RestLevel {
            rest_m_s2: one * radial.rest_m_s2 + other * tangential.rest_m_s2,
            u_m_s2: (one * radial.u_m_s2).hypot(other * tangential.u_m_s2),
            ..radial.clone()
        });
    }
}

/// True if the samples of both signals have the same times, within a fraction of a step.
pub(super) fn are_of_same_times([one, other]: [&Signal; 2]) -> bool {
    let is_shifted = (one.start_s - other.start_s).abs() * one.sample_rate_hz >= 1.0;
    !is_shifted && (one.sample_rate_hz / other.sample_rate_hz - 1.0).abs() < 1e-9
}

/// Merges the spans of both, without overlaps.
fn merge_spans(one: &[Span], other: &[Span]) -> Vec<Span> {
    let mut all = [one, other].concat();
    all.sort_by_key(|span| span.from);
    all.dedup_by(|next, span| {
        let is_joined = next.from <= span.to;
        span.to = if is_joined { span.to.max(next.to) } else { span.to };
        is_joined
    });
    all
}

/// Weighted sum of two signals with the same times.
fn combine([one, other]: [&Signal; 2], [first, second]: [f64; 2]) -> Signal {
    let sum = |a: f64, b: f64| first * a + second * b;
    let u = |a: f64, b: f64| (first * a).hypot(second * b);
    let bins = one.noise_spectrum.iter().zip(&other.noise_spectrum);
    Signal {
        force_m_s2: one.force_m_s2.iter().zip(&other.force_m_s2).map(|(a, b)| sum(*a, *b)).collect(),
        removed_offset_m_s2: sum(one.removed_offset_m_s2, other.removed_offset_m_s2),
        u_offset_m_s2: u(one.u_offset_m_s2, other.u_offset_m_s2),
        noise_m_s2: u(one.noise_m_s2, other.noise_m_s2),
        noise_spectrum: bins.map(|(a, b)| (a.0, sum(first * a.1, second * b.1))).collect(),
        free_fall_s: one.free_fall_s.min(other.free_fall_s),
        clipped: merge_spans(&one.clipped, &other.clipped),
        gaps: merge_spans(&one.gaps, &other.gaps),
        ..one.clone()
    }
}

/// Judges the motion across the plane of the drop, from pairs on the skin and channels beside the motion;
/// names recorded signals that cannot show it.
pub(super) fn judge_across(
    [pairs, recorded]: [&[Signal]; 2],
    channels: &[Channel],
    events: &Events,
    file: &CaskFile,
) -> Vec<Finding> {
    let signal = |channel: &Channel| {
        let spec = file.others.iter().find(|spec| spec.read.name == channel.name)?;
        spec.read.skin.and_then(|_| lateral_signal(channel, events))
    };
    let others: Vec<Signal> = channels.iter().filter_map(signal).collect();
    let moving = pairs.iter().chain(&others);
    let moving = moving.filter_map(|signal| judge::judge_across(signal, events));
    let alone = recorded.iter().filter_map(judge::judge_alone);
    moving.chain(alone).collect()
}

/// Signal of a sensor that reads across the plane, from the free fall on.
fn lateral_signal(channel: &Channel, events: &Events) -> Option<Signal> {
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
