//! The analog part of the chain: mounting, resonance, AC coupling, anti-alias filter, sampling.

use super::SensedDrop;
use crate::data::Axis;
use crate::lab::data::{Scene, SceneChannel};
use crate::numerics::as_f64;
use std::f64::consts::{FRAC_PI_8, PI};

/// The analog part runs on a grid this much finer than the samples, so that frequencies above half their rate
/// fold.
const OVERSAMPLING: f64 = 8.0;

/// Grid points per period of the resonance and of the cut-off: prewarped trapezoids are then within 1 %.
const POINTS_A_PERIOD: f64 = 20.0;

/// Points processed at a time.
const BLOCK: usize = 1 << 16;

/// The analog signal at `count` samples of a true rate, m/s².
pub(super) fn sample_analog(
    scene: &Scene,
    seat: &SceneChannel,
    drive: &SensedDrop,
    rate_hz: f64,
    count: usize,
) -> Vec<f64> {
    let chain = &seat.chain;
    let highest_hz = chain.resonance.map_or(0.0, |r| r.0).max(chain.anti_alias_hz.unwrap_or(0.0));
    let is_filtered = highest_hz > 0.0 || chain.ac_time_constant_s.is_some();
    let factor =
        if is_filtered { OVERSAMPLING.max((POINTS_A_PERIOD * highest_hz / rate_hz).ceil()) } else { 1.0 };
    let fine_hz = factor * rate_hz;
    let across = if seat.axis == Axis::Transverse { Axis::Axial } else { Axis::Transverse };
    let mounted = Mounted { seat, other: SceneChannel { axis: across, ..seat.clone() }, drive };
    let mut filters = Filters::initial(scene, &mounted, fine_hz);
    let stride = super::count(factor);
    let points = (count - 1) * stride + 1;
    let mut samples = Vec::with_capacity(count);
    let (mut signal, mut still_at) = (0.0, None);
    for from in (0..points).step_by(BLOCK) {
        let times_s: Vec<f64> =
            (from..points.min(from + BLOCK)).map(|i| as_f64(i) / fine_hz - scene.before_s).collect();
        for (i, force) in (from..).zip(mounted.force_m_s2(&times_s)) {
            // At rest and in free fall the input repeats: a step that changes no filter state changes none
            // the next time.
            if still_at != Some(force) {
                let before = filters.states();
                signal = filters.next(force);
                still_at = (filters.states() == before).then_some(force);
            }
            if i % stride == 0 {
                samples.push(signal);
            }
        }
    }
    samples
}

/// A sensor as it sits on its block.
struct Mounted<'a> {
    seat: &'a SceneChannel,
    other: SceneChannel,
    drive: &'a SensedDrop<'a>,
}

impl Mounted<'_> {
    /// f = f₁ cos τ + f₂ sin τ + c (f₂ cos τ − f₁ sin τ): tilt τ, cross-axis sensitivity c.
    fn force_m_s2(&self, times_s: &[f64]) -> Vec<f64> {
        let chain = &self.seat.chain;
        let (sin, cos) = chain.tilt_rad.sin_cos();
        let own = (self.drive.force_m_s2)(self.seat, times_s);
        let (along, aside) = (cos - chain.cross_axis * sin, sin + chain.cross_axis * cos);
        if aside.abs() <= 0.0 {
            return own;
        }
        let other = (self.drive.force_m_s2)(&self.other, times_s);
        own.iter().zip(other).map(|(own, other)| own * along + other * aside).collect()
    }
}

/// The filters in their order.
struct Filters {
    resonance: Option<SecondOrder>,
    high_pass: Option<HighPass>,
    anti_alias: Option<[SecondOrder; 2]>,
}

impl Filters {
    /// Filters in the state that hanging, release and fall leave at the first sample.
    fn initial(scene: &Scene, mounted: &Mounted, fine_hz: f64) -> Self {
        let chain = &mounted.seat.chain;
        let force = |time_s: f64| mounted.force_m_s2(&[time_s]).first().copied().unwrap_or(0.0);
        let start_s = -scene.before_s;
        let first = force(start_s);
        let high_pass = chain.ac_time_constant_s.map(|constant_s| {
            let release_s = -scene.fall_s();
            let hanging = force(release_s.min(start_s) - 1.0);
            // Before the release the filter has settled; since then its memory fades as e^(−t/T).
            let faded = (-(start_s - release_s).max(0.0) / constant_s).exp();
            HighPass::new(constant_s, fine_hz, hanging * faded)
        });
        let settled = high_pass.as_ref().map_or(first, |filter| first - filter.low);
        // Fourth-order Butterworth: two pairs of poles with damping cos(π/8) and cos(3π/8).
        let anti_alias = chain.anti_alias_hz.map(|cutoff_hz| {
            [FRAC_PI_8, 3.0 * FRAC_PI_8]
                .map(|angle_rad: f64| SecondOrder::new((cutoff_hz, angle_rad.cos()), fine_hz, settled))
        });
        Self {
            resonance: chain.resonance.map(|r| SecondOrder::new(r, fine_hz, first)),
            high_pass,
            anti_alias,
        }
    }

    /// Bits of the filter states.
    fn states(&self) -> [u64; 7] {
        let memory =
            |filter: Option<&SecondOrder>| filter.map_or([0.0; 2], |filter| [filter.band, filter.low]);
        let pair = self.anti_alias.as_ref();
        let [[a, b], [c, d], [e, f]] =
            [self.resonance.as_ref(), pair.map(|p| &p[0]), pair.map(|p| &p[1])].map(memory);
        [a, b, c, d, e, f, self.high_pass.as_ref().map_or(0.0, |filter| filter.low)].map(f64::to_bits)
    }

    fn next(&mut self, force: f64) -> f64 {
        let mounted = self.resonance.iter_mut().fold(force, |signal, filter| filter.next(signal));
        let coupled = self.high_pass.iter_mut().fold(mounted, |signal, filter| filter.next(signal));
        self.anti_alias.iter_mut().flatten().fold(coupled, |signal, filter| filter.next(signal))
    }
}

/// ω²/(s² + 2 ζ ω s + ω²) in trapezoidal state-variable form, prewarped at ω.
struct SecondOrder {
    gain: f64,
    damping: f64,
    first: f64,
    band: f64,
    low: f64,
}

impl SecondOrder {
    /// Oscillator with this frequency, Hz, and share of critical damping; settled at `start`.
    fn new((frequency_hz, damping): (f64, f64), rate_hz: f64, start: f64) -> Self {
        let gain = (PI * frequency_hz / rate_hz).tan();
        Self { gain, damping, first: 1.0 / (1.0 + gain * (gain + 2.0 * damping)), band: 0.0, low: start }
    }

    fn next(&mut self, input: f64) -> f64 {
        let high = self.first * (input - (self.gain + 2.0 * self.damping) * self.band - self.low);
        let band = self.gain * high + self.band;
        let low = self.gain * band + self.low;
        self.band = self.gain * high + band;
        self.low = self.gain * band + low;
        low
    }
}

/// T s/(1 + T s) by the trapezoid.
struct HighPass {
    share: f64,
    low: f64,
}

impl HighPass {
    /// Filter with time constant T, s, with its low-pass at `low`.
    fn new(constant_s: f64, rate_hz: f64, low: f64) -> Self {
        let half_step = 0.5 / (rate_hz * constant_s);
        Self { share: half_step / (1.0 + half_step), low }
    }

    fn next(&mut self, input: f64) -> f64 {
        let change = self.share * (input - self.low);
        let low = self.low + change;
        self.low = low + change;
        input - low
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_PI, TAU};

    /// Amplitude of the filter's answer to a sine, from the last of 60 periods.
    #[allow(clippy::cast_precision_loss, reason = "small counts")]
    fn gain(mut next: impl FnMut(f64) -> f64, frequency_hz: f64, rate_hz: f64) -> f64 {
        let period = super::super::count(rate_hz / frequency_hz);
        let wave = |i: usize| (TAU * i as f64 / period as f64).sin();
        let out: Vec<f64> = (0..60 * period).map(|i| next(wave(i))).collect();
        out[59 * period..].iter().fold(0.0_f64, |peak, x| peak.max(x.abs()))
    }

    #[test]
    fn the_resonance_rises_to_half_the_inverse_damping_and_passes_what_is_slow() {
        let filter = || SecondOrder::new((5_000.0, 0.1), 1e6, 0.0);
        // 1/(2ζ) at ω; 200 points a period find the peak of a sine to 1.2e-4.
        let (mut at, mut below) = (filter(), filter());
        assert!((gain(|x| at.next(x), 5_000.0, 1e6) / 5.0 - 1.0).abs() < 3e-4);
        assert!((gain(|x| below.next(x), 100.0, 1e6) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_anti_alias_filter_is_a_butterworth_of_fourth_order() {
        for (frequency_hz, wanted) in [(500.0, 0.5_f64.powi(8)), (1_000.0, 1.0), (4_000.0, 4_f64.powi(8))] {
            let mut pair = [FRAC_PI_8, 3.0 * FRAC_PI_8]
                .map(|angle_rad: f64| SecondOrder::new((1_000.0, angle_rad.cos()), 1e6, 0.0));
            let amplitude = gain(|x| pair.iter_mut().fold(x, |x, f| f.next(x)), frequency_hz, 1e6);
            // |H|² = 1/(1 + (f/fc)⁸); warping at 4e-3 of the rate is (π 4e-3)²/3 = 5e-5, to the fourth power
            // 2e-4.
            let wanted = 1.0 / (1.0_f64 + wanted).sqrt();
            assert!((amplitude / wanted - 1.0).abs() < 1e-3, "{frequency_hz}: {amplitude}, not {wanted}");
        }
    }

    #[test]
    fn ac_coupling_of_half_a_hertz_loses_12_percent_of_a_step_in_40_ms() {
        let mut filter = HighPass::new(FRAC_1_PI, 1e5, 0.0);
        let last = (0..=4000).map(|_| filter.next(1.0)).last().expect("samples");
        // T = 1/(2π 0.5 Hz) = 0.318 s; e^(−0.04/T) = 0.8819; the trapezoid is late by half a step of 10 µs.
        assert!((last - (-0.04_f64 / FRAC_1_PI).exp()).abs() < 1e-5 / FRAC_1_PI, "{last}");
        assert!((1.0 - last - 0.12).abs() < 0.002);
    }
}
