//! Result of the fit to the free-flight window: a plateau per channel, and the modes that ring on it.

use super::{Axis, Cask, End, SLOWEST_BENDING_HZ, Signal};
use serde::Serialize;

/// One damped bending mode in the flight window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mode {
    /// Damped frequency, Hz.
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Largest velocity amplitude over the channels at the window's start, m/s.
    pub amplitude_m_s: f64,
}

/// Error of a plateau that a mode causes if the flight shows one period of it, as a share of the mode's
/// amplitude; twice the periods halve it. On simulated drops a window of one period has half a percent, one
/// of half a period two percent (docs/uncertainty.md).
const RINGING_SHARE: f64 = 0.005;

/// Fewest periods of the first bending mode in a contact after which nothing rings: 25 of 28 sound flights of
/// simulated elastic bodies without a mode had 2.2 and more.
const SHORTEST_CALM: f64 = 2.0;
/// The first bending mode has more than this share of the largest amplitude.
const FIRST_SHARE: f64 = 0.3;

impl Mode {
    /// Standard uncertainty of a plateau on which the mode rings with this amplitude for this duration, in
    /// the unit of the amplitude.
    pub fn u_plateau(&self, amplitude: f64, flight_s: f64) -> f64 {
        let periods = self.frequency_hz * flight_s;
        // A mode of which the flight shows less than a period looks like a bend of the plateau.
        RINGING_SHARE * amplitude / periods.min(periods * periods)
    }
}

/// The velocity step of one channel from before the impact to the flight, free of ringing.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Plateau {
    /// The channel's name.
    pub channel: String,
    /// Integral of specific force from before first contact to the reference time, ringing and drift removed,
    /// m/s.
    pub velocity_step_m_s: f64,
    /// Standard uncertainty of that integral, m/s.
    pub u_m_s: f64,
    /// Change of the channel's offset from before the impact to the flight, m/s²; 0 if the fit needs none.
    pub zero_shift_m_s2: f64,
    /// Standard uncertainty of that change, m/s².
    pub u_zero_shift_m_s2: f64,
    /// RMS of the residual, m/s.
    pub residual_m_s: f64,
    /// RMS of the residual in means over a 24th of the window, m/s: the part that may move the plateau.
    #[serde(skip)]
    pub slow_residual_m_s: f64,
    /// Cosine and sine amplitude of each mode at the window's start, m/s.
    pub ringing_m_s: Vec<(f64, f64)>,
    /// Mean velocity just before the flight ends, less the fitted value, m/s, if the flight is long enough to
    /// show it.
    pub late_mismatch_m_s: Option<f64>,
    /// Mean velocity after the separation, less the value of the fit extrapolated back, m/s, if the fit
    /// begins later.
    #[serde(skip)]
    pub early_mismatch_m_s: Option<f64>,
}

/// Score of one candidate of the flight fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FlightScore {
    /// Number of modes.
    pub modes: usize,
    /// True if each channel has a drift (zero shift).
    pub drift: bool,
    /// True if the contact force determines the phases of the modes; else they are free.
    pub driven: bool,
    /// True if this fit is selected: the one with the lowest criterion, or the next if the motion contradicts
    /// that one.
    pub taken: bool,
    /// Bayesian information criterion; lower is better.
    pub bic: f64,
    /// RMS of the residual over all channels, m/s.
    pub residual_m_s: f64,
}

/// The fit of the free-flight window.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FlightFit {
    /// Start of the window, s from the recording's first sample.
    pub from_s: f64,
    /// End of the window, s.
    pub to_s: f64,
    /// Plateaus of the channels, transverse channels first.
    pub plateaus: Vec<Plateau>,
    /// Fitted modes, lowest frequency first.
    pub modes: Vec<Mode>,
    /// True if a drift was fitted.
    pub drift: bool,
    /// All candidates, including the selected one.
    pub candidates: Vec<FlightScore>,
    /// The shock in the flight that explains it best, however weak.
    pub strike: Option<FlightShock>,
    /// The touch of L near its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub landing: Option<Landing>,
}

/// Touches of L between its flight and the slap-down, as one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Landing {
    /// Time at which the first touch begins, s from the recording's first sample.
    pub begin_s: f64,
    /// Time of one equivalent step with the same effect on the later motion, s.
    pub time_s: f64,
    /// Change of each channel's velocity, m/s, in the order of the plateaus.
    pub steps_m_s: Vec<f64>,
    /// Standard uncertainty of each, m/s.
    pub u_m_s: Vec<f64>,
    /// Change along the axis and its standard uncertainty, m/s, if no axial channel shows it.
    pub along_m_s: Option<[f64; 2]>,
}

/// A step of all velocities within a flight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FlightShock {
    /// Time from the recording's first sample, s.
    pub time_s: f64,
    /// Largest change of a transverse channel's velocity, m/s.
    pub step_m_s: f64,
    /// Reduction of the Bayesian information criterion by the shock.
    pub gain: f64,
}

/// Below this many periods of its slowest mode, different fits of a flight may have the same residual.
const RANKING_PERIODS: f64 = 1.5;

/// Modes closer than this over the window's length cannot be separated: half the width of its spectral lines.
/// Two of them would adapt to anything else in the window, such as a part of the contact.
const SEPARATION: f64 = 0.5;

/// A mode this many times larger at one end than at the other rings at that end alone: a free beam moves
/// alike at both ends.
const ONE_END: f64 = 10.0;
/// Damping above which a mode is not a bending mode: bolted and welded steel has 0.01 to 0.03, a whipping
/// cable is damped by the air.
const STRONG_DAMPING: f64 = 0.08;
/// Above this ratio the fitted mode is not a bending mode at all, however long the window: within a hundredth
/// of its length no sensor sits on a node by chance.
const ONE_END_ONLY_RATIO: f64 = 30.0;
/// An overtone of the slowest mode has its nodes at 0.13 and 0.09 of the length, where sensors often sit: the
/// second mode of a short cask has 1.6 times the frequency of the first.
const OVERTONE: f64 = 1.5;
/// No cask bends more slowly, Hz: a mode this slow is at the edge of the searched range.
const SLOWEST_HZ: f64 = 16.5;

/// The second bending mode, in which the ends move in opposite directions, exceeds this multiple of the
/// first: 2.76 in a slender uniform beam.
const SECOND_MODE: f64 = 1.8;
/// Second mode's frequency ratio for a beam of one height, and its growth with the slenderness: 1.4 at two
/// heights, where shear leaves 1.49 of it in a thick tube, 1.55 at 2.5, where it leaves 1.65 (Timoshenko
/// beams of steel).
const SECOND_MODE_THICK: (f64, f64) = (0.8, 0.3);
/// Contents that weigh tons have no stiffer mounts, Hz.
const FASTEST_SWING_HZ: f64 = 100.0;
/// A uniform beam in its first bending mode is nearly straight from its end to a node at this share of its
/// length.
const NODE: f64 = 0.2155;
/// An impact limiter on either end weighs at most this share of the beam.
const MOST_END_MASS: f64 = 0.12;
/// Such a limiter moves the node of its own end outwards by the first factor times its share of the mass, and
/// that of the other end inwards by the second.
const NODE_BY_END_MASS: (f64, f64) = (0.55, 0.137);
/// Sensors farther in than this share of the length on either end are so near to that node, or beyond it,
/// that their signs do not show the shape.
const NEAR_NODE: f64 = 0.175;
/// If bending would make the ends differ by this factor, they show whether the cask bends or moves as a
/// whole.
const SHAPE_RATIO: f64 = 1.3;
/// A mode with less than this share of the largest does not show how the cask moves.
const LEAST_SHARE: f64 = 0.1;

impl FlightFit {
    /// True if the fitted mode is an artefact: it bends one channel's plateau instead of ringing at both
    /// ends. It appears at one end alone and for less than a period, or slower than any cask, or strongly
    /// damped; or it is wholly at one end, like a whipping cable.
    pub fn is_fit_artefact(&self, mode: usize, signals: &[Signal]) -> bool {
        let (frequency_hz, damping) =
            self.modes.get(mode).map_or((f64::INFINITY, 0.0), |m| (m.frequency_hz, m.damping));
        let largest_m_s = |end: End| {
            let of_end = signals
                .iter()
                .zip(&self.plateaus)
                .filter(|(s, _)| s.end == end && s.axis == Axis::Transverse);
            of_end.filter_map(|(_, p)| p.ringing_m_s.get(mode)).map(|(a, b)| a.hypot(*b)).fold(0.0, f64::max)
        };
        let (first, second) = (largest_m_s(End::First), largest_m_s(End::Second));
        let is_slow = frequency_hz < SLOWEST_HZ || frequency_hz * (self.to_s - self.from_s) < 1.0;
        let is_overtone =
            self.modes.first().is_some_and(|slowest| frequency_hz > OVERTONE * slowest.frequency_hz);
        let alone = match is_slow || damping > STRONG_DAMPING {
            true => ONE_END,
            false if is_overtone => f64::INFINITY,
            false => ONE_END_ONLY_RATIO,
        };
        first.max(second) > alone * first.min(second)
    }

    /// Largest amplitude of a mode over the transverse channels, m/s.
    pub fn size_m_s(&self, mode: usize, signals: &[Signal]) -> f64 {
        let across = signals.iter().zip(&self.plateaus).filter(|(s, _)| s.axis == Axis::Transverse);
        let sizes_m_s = across.filter_map(|(_, p)| p.ringing_m_s.get(mode)).map(|(a, b)| a.hypot(*b));
        sizes_m_s.fold(0.0, f64::max)
    }

    /// Motion of the outermost channel on the first end relative to that on the second in a mode; negative if
    /// the ends move in opposite directions.
    pub fn end_ratio(&self, mode: usize, signals: &[Signal]) -> f64 {
        let across = || signals.iter().zip(&self.plateaus).filter(|(s, _)| s.axis == Axis::Transverse);
        let by_place =
            |a: &(&Signal, &Plateau), b: &(&Signal, &Plateau)| a.0.position_m.total_cmp(&b.0.position_m);
        let ringing_m_s =
            |outermost: Option<(&Signal, &Plateau)>| outermost?.1.ringing_m_s.get(mode).copied();
        let ends = (ringing_m_s(across().min_by(by_place)), ringing_m_s(across().max_by(by_place)));
        let (Some(first), Some(last)) = ends else { return 0.0 };
        let square = last.0 * last.0 + last.1 * last.1;
        if square > 0.0 { (last.0 * first.0 + last.1 * first.1) / square } else { 0.0 }
    }

    /// Counts the slowest modes in which a cask of `height_m` moves as a whole on its mounts or contents,
    /// since a free body does not bend so: slower than any cask; both ends in opposite directions, or in the
    /// same direction once more near the slowest such mode; or equally far where bending would make the ends
    /// differ. 0 for a slender cask.
    pub fn rigid_modes(&self, signals: &[Signal], cask: &Cask) -> usize {
        let &Cask { length_m, height_m, .. } = cask;
        let second_mode = if height_m > 0.0 {
            SECOND_MODE.min(SECOND_MODE_THICK.0 + SECOND_MODE_THICK.1 * length_m / height_m)
        } else {
            SECOND_MODE
        };
        // Axial channels show the slope of a mode.
        let sizes_m_s: Vec<f64> = (0..self.modes.len()).map(|mode| self.size_m_s(mode, signals)).collect();
        let largest_m_s = sizes_m_s.iter().fold(0.0, |a: f64, b| a.max(*b));
        let goes = |(i, m): (usize, &Mode)| {
            let along = self.end_ratio(i, signals);
            let is_mode = sizes_m_s[i] > LEAST_SHARE * largest_m_s && m.damping < STRONG_DAMPING;
            is_mode.then_some((m.frequency_hz, along))
        };
        let shown: Vec<(f64, f64)> = self.modes.iter().enumerate().filter_map(goes).collect();
        let mut together = shown.iter().filter(|(_, along)| *along > 1.0 / ONE_END);
        let mut apart = shown.iter().filter(|(_, along)| (-ONE_END..-1.0 / ONE_END).contains(along));
        let (slowest, next, apart) = (together.next(), together.next(), apart.next());
        let length_s = self.to_s - self.from_s;
        let is_near = |hz: f64, than_hz: f64| hz < second_mode * than_hz;
        let apart_hz = apart.map(|apart| apart.0).filter(|apart_hz| {
            slowest.map_or(*apart_hz < FASTEST_SWING_HZ, |slowest| is_near(*apart_hz, slowest.0))
        });
        let swings = |(hz, along): &&(f64, f64)| {
            (*hz < FASTEST_SWING_HZ && moves_straight(*along, signals, cask))
                || next.is_some_and(|next| is_near(next.0, *hz) && (next.0 - hz) * length_s > SEPARATION)
                || apart_hz.is_some_and(|apart_hz| is_near(*hz, apart_hz))
        };
        let together_hz = slowest.filter(swings).map(|(hz, _)| *hz);
        let by_shape_hz = [apart_hz, together_hz].into_iter().flatten();
        let by_shape_hz = by_shape_hz.filter(|_| shows_shapes(signals, length_m));
        let up_to_hz = by_shape_hz.fold(SLOWEST_BENDING_HZ, f64::max);
        self.modes.iter().take_while(|m| m.frequency_hz <= up_to_hz).count()
    }

    /// Order of the bending mode of a free beam for each fitted mode, from 1 on, by the relative direction of
    /// the ends; 0 if the cask moves as a whole.
    pub fn bending_orders(&self, signals: &[Signal], cask: &Cask) -> Vec<u8> {
        let (swinging, mut together) = (self.rigid_modes(signals, cask), 0);
        let order = |mode: usize| {
            let goes = mode >= swinging && self.end_ratio(mode, signals) > 0.0;
            together += u8::from(goes);
            if mode < swinging {
                0
            } else if goes {
                2 * together - 1
            } else {
                2
            }
        };
        (0..self.modes.len()).map(order).collect()
    }

    /// Number of periods of the slowest mode in the window; infinite without modes.
    pub fn periods(&self) -> f64 {
        let lowest_hz = self.modes.iter().map(|m| m.frequency_hz).fold(f64::INFINITY, f64::min);
        lowest_hz * (self.to_s - self.from_s)
    }

    /// True if the window separates its modes, or shows a period of each, so that they ring whatever their
    /// assignment.
    ///
    /// Neighbours differ by half of 1/T, and there is a period of the fastest for each pair of modes.
    #[allow(clippy::cast_precision_loss, reason = "a handful of modes")]
    pub fn resolves_modes(&self) -> bool {
        let length_s = self.to_s - self.from_s;
        let is_apart = |pair: &[Mode]| (pair[1].frequency_hz - pair[0].frequency_hz) * length_s > SEPARATION;
        let fastest_hz = self.modes.iter().map(|m| m.frequency_hz).fold(0.0, f64::max);
        let pairs = (self.modes.len() * self.modes.len().saturating_sub(1) / 2) as f64;
        let has_room = fastest_hz * length_s >= pairs;
        self.periods() > 1.0 || (has_room && self.modes.windows(2).all(is_apart))
    }

    /// True if the window shows the slowest mode for long enough to rank fits by their residuals.
    pub fn can_rank_fits(&self) -> bool {
        self.periods() > RANKING_PERIODS
    }

    /// Frequency of the first bending mode, Hz: of the slowest one that rings like the largest; if nothing
    /// rings after a contact of `contact_s`, a lower limit.
    pub fn first_bending_hz(&self, contact_s: f64) -> f64 {
        let largest_m_s = self.modes.iter().map(|mode| mode.amplitude_m_s).fold(0.0, f64::max);
        let rings =
            |m: &&Mode| m.amplitude_m_s > FIRST_SHARE * largest_m_s && m.frequency_hz > SLOWEST_BENDING_HZ;
        self.modes.iter().find(rings).map_or(SHORTEST_CALM / contact_s, |mode| mode.frequency_hz)
    }

    /// The plateau of a channel.
    pub fn plateau(&self, channel: &str) -> Option<&Plateau> {
        self.plateaus.iter().find(|p| p.channel == channel)
    }
}

/// Positions of the outermost transverse channels, as shares of the length.
fn outermost(signals: &[Signal], length_m: f64) -> (f64, f64) {
    let across = || signals.iter().filter(|s| s.axis == Axis::Transverse).map(|s| s.position_m / length_m);
    (across().fold(f64::INFINITY, f64::min), across().fold(0.0, f64::max))
}

/// True if the outermost channels are clear of the first mode's nodes, so that their signs show its shape.
fn shows_shapes(signals: &[Signal], length_m: f64) -> bool {
    let (first, last) = outermost(signals, length_m);
    first.max(1.0 - last) < NEAR_NODE
}

/// True if both ends move nearly equally far where the first bending mode would make them differ: with
/// limiters of no mass or of the largest mass, and with the centre of gravity shifted by the beam or by the
/// limiter of its end.
fn moves_straight(along: f64, signals: &[Signal], cask: &Cask) -> bool {
    let (first, last) = outermost(signals, cask.length_m);
    let heavier = 2.0 * (cask.cog_m / cask.length_m - 0.5);
    let mut limiters = [0.0, MOST_END_MASS]
        .into_iter()
        .flat_map(|both| [[both; 2], [both + (-heavier).max(0.0), both + heavier.max(0.0)]]);
    limiters.all(|masses| {
        let (own, other) = NODE_BY_END_MASS;
        let node = |own_mass: f64, other_mass: f64| NODE - own * own_mass + other * other_mass;
        let bent = (node(masses[0], masses[1]) - first) / (node(masses[1], masses[0]) - (1.0 - last));
        bent.ln().abs() > SHAPE_RATIO.ln() && (along / bent).ln().abs() > 2.0 * along.ln().abs()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::example;

    /// A flight of so many seconds with undamped modes.
    fn flight(length_s: f64, frequencies_hz: &[f64]) -> FlightFit {
        let mode = |&frequency_hz: &f64| Mode { frequency_hz, damping: 0.0, amplitude_m_s: 1.0 };
        FlightFit {
            modes: frequencies_hz.iter().map(mode).collect(),
            ..example::flight(1.0, 1.0 + length_s, vec![])
        }
    }

    #[test]
    fn periods_are_those_of_the_slowest_mode() {
        assert!((flight(0.05, &[30.0, 80.0]).periods() - 1.5).abs() < 1e-9);
        assert!(!flight(0.049, &[30.0, 80.0]).can_rank_fits());
        assert!(flight(0.051, &[30.0, 80.0]).can_rank_fits());
        assert!(flight(0.001, &[]).can_rank_fits(), "nothing rings");
    }

    #[test]
    fn ends_that_go_apart_slowly_swing_and_do_not_bend() {
        let signal = |end, position_m| Signal { end, position_m, ..example::signal(1e4, vec![]) };
        // Each mode has its frequency and the relative movement of the first end; `second_m` is the place of
        // the second sensor.
        let placed = |modes: &[(f64, f64)], second_m: f64, height_m: f64| {
            let signals = [signal(End::First, 0.3), signal(End::Second, second_m)];
            let plateau = |share: fn(f64) -> f64| Plateau {
                ringing_m_s: modes.iter().map(|mode| (0.0, share(mode.1))).collect(),
                ..example::plateau("A", 0.0)
            };
            let frequencies_hz: Vec<f64> = modes.iter().map(|mode| mode.0).collect();
            let plateaus = vec![plateau(|along| along), plateau(|_| 1.0)];
            FlightFit { plateaus, ..flight(0.1, &frequencies_hz) }
                .rigid_modes(&signals, &example::cask(1.0, 5.0, height_m))
        };
        let of_modes = |modes: &[(f64, f64)], second_m: f64| placed(modes, second_m, 0.0);
        let swinging = |modes: &[(f64, f64)]| of_modes(modes, 4.7);
        assert_eq!(swinging(&[(80.0, 1.0), (220.0, -1.0)]), 0, "a uniform beam");
        assert_eq!(swinging(&[(20.0, 1.0), (80.0, 1.0)]), 1, "slower than any cask");
        assert_eq!(swinging(&[(40.0, 1.0), (55.0, -2.0), (120.0, 1.0)]), 2);
        assert_eq!(swinging(&[(40.0, -2.0), (50.0, 1.0), (90.0, 1.0)]), 2);
        assert_eq!(swinging(&[(40.0, -2.0), (120.0, 1.0)]), 1);
        assert_eq!(swinging(&[(60.0, -0.05), (90.0, 1.0)]), 0, "the first end stands on a node");
        assert_eq!(swinging(&[(65.0, 1.0), (108.0, -1.1)]), 2, "contents of half the mass");
        assert_eq!(
            swinging(&[(86.0, 0.9), (106.0, 0.7)]),
            1,
            "a beam goes together in one of two such modes"
        );
        assert_eq!(swinging(&[(86.0, 0.9), (87.0, 0.7)]), 0, "one mode that is fitted as two");
        let close = [(75.0, 1.0), (132.0, -1.0)];
        assert_eq!(placed(&close, 4.7, 0.0), 2, "of a slender cask");
        assert_eq!(placed(&close, 4.7, 2.17), 0, "shear brings the second mode of a thick one near");
        assert_eq!(placed(&[(75.0, -0.5), (120.0, 1.0)], 4.0, 0.0), 0, "beyond the node of the first mode");
        // At 0.06 and 0.86 of its length a beam that bends goes twice as far at the first place.
        assert_eq!(of_modes(&[(45.0, 1.9), (150.0, 1.9)], 4.3), 0);
        assert_eq!(of_modes(&[(45.0, 1.0), (150.0, 1.9)], 4.3), 1, "ends that go as far as one another");
    }

    #[test]
    fn what_limiters_bend_and_a_damped_mode_makes_up_for_is_no_swing() {
        let signal = |end, position_m| Signal { end, position_m, ..example::signal(1e4, vec![]) };
        let swinging = |modes: &[Mode], along: f64, cog_m: f64| {
            let signals = [signal(End::First, 0.705), signal(End::Second, 4.52)];
            let plateau = |size_m_s: f64| Plateau {
                ringing_m_s: modes.iter().map(|_| (0.0, size_m_s)).collect(),
                ..example::plateau("A", 0.0)
            };
            let fit = FlightFit { modes: modes.to_vec(), ..flight(0.1, &[]) };
            let cask = Cask { cog_m, ..example::cask(1.0, 5.0, 0.0) };
            FlightFit { plateaus: vec![plateau(along), plateau(1.0)], ..fit }.rigid_modes(&signals, &cask)
        };
        let mode = |frequency_hz, damping| Mode { frequency_hz, damping, amplitude_m_s: 1.0 };
        // At 0.14 and 0.90 of the length a uniform beam goes 0.6 times as far at the first place; with a
        // limiter of 8 % on the second end 1.1 times.
        assert_eq!(swinging(&[mode(47.0, 0.01)], 1.3, 2.5), 1);
        assert_eq!(swinging(&[mode(47.0, 0.01)], 1.3, 2.7), 0);
        assert_eq!(swinging(&[mode(322.0, 0.01), mode(473.0, 0.02)], 1.3, 2.5), 1);
        assert_eq!(swinging(&[mode(322.0, 0.01), mode(473.0, 0.1)], 1.3, 2.5), 0);
    }

    #[test]
    fn a_mode_that_axial_channels_show_is_no_swing() {
        let signal = |end, axis| Signal { end, axis, ..example::signal(1e4, vec![]) };
        let (first, second) = ((End::First, 1.0), (End::Second, -1.0));
        let channels = [
            (first, Axis::Transverse),
            (second, Axis::Transverse),
            (first, Axis::Axial),
            (second, Axis::Axial),
        ];
        let signals = channels.map(|((end, _), axis)| signal(end, axis));
        let plateau = |((_, sign), axis): ((End, f64), Axis)| {
            let ringing_m_s = if axis == Axis::Axial {
                vec![(0.0, 0.1), (0.0, 1.0)]
            } else {
                vec![(0.0, 1.0), (0.0, 0.05 * sign)]
            };
            Plateau { ringing_m_s, ..example::plateau("A", 0.0) }
        };
        let plateaus = channels.map(plateau).into();
        let flight = FlightFit { plateaus, ..flight(0.1, &[75.0, 126.0]) };
        assert_eq!(flight.rigid_modes(&signals, &example::cask(1.0, 5.0, 0.0)), 0);
    }

    #[test]
    fn a_slow_swing_of_one_end_is_no_mode() {
        let signal = |end| Signal { end, ..example::signal(1e4, vec![]) };
        let signals = [signal(End::First), signal(End::Second)];
        let is_fit_artefact = |length_s: f64, frequency_hz: f64, second_m_s: f64| {
            let plateau =
                |size_m_s: f64| Plateau { ringing_m_s: vec![(0.0, size_m_s)], ..example::plateau("A", 0.0) };
            let plateaus = vec![plateau(1.0), plateau(second_m_s)];
            FlightFit { plateaus, ..flight(length_s, &[frequency_hz]) }.is_fit_artefact(0, &signals)
        };
        assert!(is_fit_artefact(0.04, 20.0, 0.05) && is_fit_artefact(0.1, 15.0, 20.0));
        assert!(!is_fit_artefact(0.04, 20.0, 0.2), "both ends ring");
        assert!(!is_fit_artefact(0.06, 20.0, 0.05), "more than a period is a mode with a node there");
        assert!(is_fit_artefact(0.06, 20.0, 0.005), "nothing at all at the other end");
    }

    #[test]
    fn a_short_window_resolves_few_modes() {
        // 20 ms: lines are 50 Hz wide, half of that is 25.
        assert!(flight(0.02, &[]).resolves_modes());
        assert!(flight(0.02, &[30.0]).resolves_modes());
        assert!(flight(0.02, &[30.0, 56.0]).resolves_modes());
        assert!(!flight(0.02, &[30.0, 54.0]).resolves_modes(), "24 Hz apart");
        assert!(!flight(0.02, &[10.0, 49.0]).resolves_modes(), "no period of the faster one");
        assert!(flight(0.02, &[30.0, 80.0, 151.0]).resolves_modes());
        assert!(
            !flight(0.02, &[30.0, 80.0, 149.0]).resolves_modes(),
            "three pairs in less than three periods"
        );
        assert!(flight(0.02, &[51.0, 54.0]).resolves_modes(), "a period of each is shown");
    }
}
