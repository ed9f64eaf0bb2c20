//! Specific force at a point of the cask in a simulated motion.

use super::elastic;
use crate::data::Axis;
use crate::lab::data::{ModeStep, MotionStep, Scene, SceneChannel, SimulatedMotion};

/// Time in which the hook releases, s: that of a quick-release hook, long against a sample.
const RELEASE_S: f64 = 2e-3;

/// Reading of a perfect sensor at the channel's true position along its axis, m/s², at `times_s` (0 at first
/// contact).
///
/// Before first contact the cask falls, slowed by its guides; before its release, if the scene shows it, it
/// hangs at rest. Roll affects the transverse axis, as do the modes that ride on the rigid motion; the
/// sections of an elastic body carry their sensors with them. After the motion's end the last value stays.
pub fn specific_force_m_s2(
    scene: &Scene,
    motion: &SimulatedMotion,
    channel: &SceneChannel,
    times_s: &[f64],
) -> Vec<f64> {
    let drop = &scene.drop;
    let release_s = -scene.fall_s();
    let weight_m_s2 = |angle_rad: f64| {
        drop.gravity_m_s2 * if channel.axis == Axis::Transverse { angle_rad.cos() } else { angle_rad.sin() }
    };
    // A cask that rotates in the fall hung at another angle before it.
    let hanging_m_s2 = weight_m_s2(drop.angle_rad - drop.angular_velocity_rad_s * release_s);
    let guided_m_s2 = scene.extras.guided * weight_m_s2(drop.angle_rad);
    let share = channel.position_m / scene.cask.length_m;
    let bending: Vec<[f64; 2]> = elastic::modes(scene)
        .iter()
        .map(|of| {
            let strength = of.mode.strength;
            [strength * of.shape(share), of.tilt_1_m(strength, share, scene.cask.length_m)]
        })
        .collect();
    let sections = if scene.elastic.is_some() { sections(motion, &bending) } else { Vec::new() };
    let before = |time_s: f64| {
        let hanging = if scene.rest { (0.5 - (time_s - release_s) / RELEASE_S).clamp(0.0, 1.0) } else { 0.0 };
        hanging * hanging_m_s2 + (1.0 - hanging) * guided_m_s2
    };
    // Roll grows as the impulse of the first contact does, and a sensor beside the plane reads its growth.
    let rolls = channel.axis == Axis::Transverse && scene.extras.roll_rad_s * channel.lateral_m != 0.0;
    let roll_m_s2_n =
        if rolls { scene.extras.roll_rad_s * channel.lateral_m / motion.first_impulse_n_s().1 } else { 0.0 };
    let rolled_s = motion.truth.contact_s.unwrap_or(0.0);
    let during = |time_s: f64| {
        let at = Between::new(motion, time_s);
        let (xi_m, eta_m) = (channel.position_m - scene.cask.cog_m, channel.offset_m);
        let [along_m_s2, across_m_s2] = if scene.elastic.is_some() {
            at.section_m_s2(scene, [xi_m, eta_m], &sections)
        } else {
            let [along_m_s2, across_m_s2] = at.rigid_m_s2(scene, [xi_m, eta_m]);
            let bends: f64 =
                bending.iter().enumerate().map(|(i, [shape, _])| shape * at.cubic_slope(at.mode(i))).sum();
            [along_m_s2, across_m_s2 + bends]
        };
        let pressing_n = if time_s < rolled_s { at.pressing_n() } else { 0.0 };
        let own_m_s2 = if channel.axis == Axis::Axial { along_m_s2 } else { across_m_s2 };
        own_m_s2 + roll_m_s2_n * pressing_n
    };
    times_s.iter().map(|&t| if t < 0.0 || motion.steps.is_empty() { before(t) } else { during(t) }).collect()
}

/// Position of a section of an elastic body at a step: w, m, and θ, rad, each with its two rates.
type SectionStep = [[f64; 3]; 2];

/// Movement of the section by `bending` in each mode, w and θ, at every step.
fn sections(motion: &SimulatedMotion, bending: &[[f64; 2]]) -> Vec<SectionStep> {
    let at_step = |modes: &[ModeStep]| {
        let sum = |of: usize, quantity: fn(&ModeStep) -> f64| -> f64 {
            bending.iter().zip(modes).map(|(weights, mode)| weights[of] * quantity(mode)).sum()
        };
        [0, 1].map(|of| [sum(of, |m| m.q_m), sum(of, |m| m.rate_m_s), sum(of, |m| m.rate_m_s2)])
    };
    motion.modes.chunks_exact(bending.len()).map(at_step).collect()
}

/// Reading of a perfect angular-rate sensor at this place, rad/s, positive if R goes down, at `times_s`: the
/// rotation of the cask, and of its section there as it bends.
pub fn rotation_rad_s(scene: &Scene, motion: &SimulatedMotion, position_m: f64, times_s: &[f64]) -> Vec<f64> {
    let length_m = scene.cask.length_m;
    let modes = elastic::modes(scene);
    let tilts = modes.iter().map(|of| of.tilt_1_m(of.mode.strength, position_m / length_m, length_m));
    let tilts_1_m: Vec<f64> = tilts.collect();
    let released_s = if scene.rest { -scene.fall_s() } else { f64::NEG_INFINITY };
    let reads = |time_s: f64| {
        if time_s < 0.0 || motion.steps.is_empty() {
            let turns = ((time_s - released_s) / RELEASE_S + 0.5).clamp(0.0, 1.0);
            return turns * scene.drop.angular_velocity_rad_s;
        }
        let at = Between::new(motion, time_s);
        let bending = tilts_1_m.iter().enumerate().map(|(i, tilt)| tilt * at.cubic(at.mode(i)));
        -at.value(5) - bending.sum::<f64>()
    };
    times_s.iter().map(|&time_s| reads(time_s)).collect()
}

/// A time between two steps of the motion.
///
/// Velocities are interpolated by the cubic through their values and slopes at both: its slope is an
/// acceleration whose integral is exactly the change of velocity, whatever the step.
struct Between<'a> {
    places: [usize; 2],
    steps: [&'a MotionStep; 2],
    modes: [&'a [ModeStep]; 2],
    /// Share of the step that has passed.
    share: f64,
    step_s: f64,
}

impl<'a> Between<'a> {
    fn new(motion: &'a SimulatedMotion, at_s: f64) -> Self {
        let steps = &motion.steps;
        let next = steps.partition_point(|step| step.time_s <= at_s).clamp(1, steps.len().max(2) - 1);
        let places = [next - 1, next.min(steps.len() - 1)];
        let count = motion.modes.len() / steps.len();
        let modes = places.map(|i| &motion.modes[i * count..(i + 1) * count]);
        let steps = places.map(|i| &steps[i]);
        let [from_s, to_s] = steps.map(|step| step.time_s);
        let step_s = to_s - from_s;
        let share = if step_s > 0.0 { ((at_s - from_s) / step_s).clamp(0.0, 1.0) } else { 1.0 };
        Self { places, steps, modes, share, step_s }
    }

    /// Quantity `i` of the state at both ends, and its rate.
    fn state(&self, i: usize) -> [[f64; 2]; 2] {
        [self.steps.map(|step| step.state[i]), self.steps.map(|step| step.rates[i])]
    }

    /// The rate of the coordinate of mode `i` at both ends, m/s, and its own rate, m/s².
    fn mode(&self, i: usize) -> [[f64; 2]; 2] {
        [self.modes.map(|modes| modes[i].rate_m_s), self.modes.map(|modes| modes[i].rate_m_s2)]
    }

    /// Value of the cubic through quantity `i` of the state and its rates at both ends.
    fn value(&self, i: usize) -> f64 {
        self.cubic(self.state(i))
    }

    /// Slope at step `i`.
    fn slope(&self, i: usize) -> f64 {
        self.cubic_slope(self.state(i))
    }

    /// Value of the cubic through these values with these slopes.
    fn cubic(&self, [values, slopes]: [[f64; 2]; 2]) -> f64 {
        let (s, h) = (self.share, self.step_s);
        let r = 1.0 - s;
        r * r * ((1.0 + 2.0 * s) * values[0] + s * h * slopes[0])
            + s * s * ((1.0 + 2.0 * r) * values[1] - r * h * slopes[1])
    }

    /// Slope of the cubic.
    fn cubic_slope(&self, [values, slopes]: [[f64; 2]; 2]) -> f64 {
        let (s, r) = (self.share, 1.0 - self.share);
        if self.step_s <= 0.0 {
            return slopes[1];
        }
        let mean = (values[1] - values[0]) / self.step_s;
        6.0 * s * r * mean + r * (1.0 - 3.0 * s) * slopes[0] + s * (1.0 - 3.0 * r) * slopes[1]
    }

    /// Normal force on L, N.
    fn pressing_n(&self) -> f64 {
        let [from_n, to_n] = self.steps.map(|step| step.loads_n[0].1);
        from_n + self.share * (to_n - from_n)
    }

    /// Specific force of the rigid body at a place from S, m along and across the axis, in these axes, m/s².
    fn rigid_m_s2(&self, scene: &Scene, [xi_m, eta_m]: [f64; 2]) -> [f64; 2] {
        let (angle_rad, omega, alpha) = (self.value(2), self.value(5), self.slope(5));
        let (along, up) = (self.slope(3), self.slope(4));
        let (sin, cos) = angle_rad.sin_cos();
        let (x_m, z_m) = (xi_m * cos - eta_m * sin, xi_m * sin + eta_m * cos);
        // The acceleration of the point less that of free fall, in the fixed frame, is rotated to the body's
        // axes.
        let point_x = along - alpha * z_m - omega * omega * x_m;
        let point_z = up + alpha * x_m - omega * omega * z_m + scene.drop.gravity_m_s2;
        [point_x * cos + point_z * sin, point_z * cos - point_x * sin]
    }

    /// Acceleration of a point of an elastic body, whose section there moves by w across the axis and turns
    /// by θ, in the axes of the section: that of the axis at w, with ẅ across and −2 φ̇ ẇ along; then −η (φ̇
    /// + θ̇)² across and −η (φ̈ + θ̈) along.
    fn section_m_s2(&self, scene: &Scene, [xi_m, eta_m]: [f64; 2], sections: &[SectionStep]) -> [f64; 2] {
        let between = |which: usize| {
            let [from, to] = self.places.map(|i| sections[i][which]);
            let [places, rates, slopes] = [0, 1, 2].map(|i| [from[i], to[i]]);
            [self.cubic([places, rates]), self.cubic([rates, slopes]), self.cubic_slope([rates, slopes])]
        };
        let ([w_m, w_m_s, w_m_s2], [tilt, tilt_rate, tilt_rate_s]) = (between(0), between(1));
        let [along, across] = self.rigid_m_s2(scene, [xi_m, w_m]);
        let (along, across) = (along - 2.0 * self.value(5) * w_m_s, across + w_m_s2);
        let (sin, cos) = tilt.sin_cos();
        let turning = self.value(5) + tilt_rate;
        [
            along * cos + across * sin - eta_m * (self.slope(5) + tilt_rate_s),
            across * cos - along * sin - eta_m * turning * turning,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::example::{anf18, channel, just_before};
    use super::super::simulate;
    use super::*;
    use crate::data::Contact;
    use crate::lab::data::BendingMode;
    use crate::numerics::quadrature::running_integral;

    #[test]
    fn at_rest_falling_and_flying_it_reads_what_it_must() {
        let mut scene = anf18();
        scene.rest = true;
        let motion = simulate(&scene);
        let (sin, cos) = scene.drop.angle_rad.sin_cos();
        let centre = |axis| channel(axis, scene.cask.cog_m, 0.0);
        let read = |at: &SceneChannel, t: f64| specific_force_m_s2(&scene, &motion, at, &[t])[0];
        // 9 m take 1.3546 s.
        for (axis, rest) in [(Axis::Transverse, 9.81 * cos), (Axis::Axial, 9.81 * sin)] {
            assert!((read(&centre(axis), -1.4) - rest).abs() < 1e-12);
            assert!((read(&centre(axis), -(18.0_f64 / 9.81).sqrt()) - rest / 2.0).abs() < 1e-9);
            assert!(read(&centre(axis), -1.3).abs() < 1e-12);
            // In the flight after the impact S reads nothing; 1e-9 is the rounding of velocity over a step.
            assert!(read(&centre(axis), 0.04).abs() < 1e-9);
        }
        let omega = motion.truth.omega_rebound.expect("L leaves");
        let off = read(&channel(Axis::Transverse, 0.15, 0.3), 0.04);
        assert!((off + omega * omega * 0.3).abs() < 1e-9, "{off}");
        let along = read(&channel(Axis::Axial, 0.15, 0.3), 0.04);
        assert!((along + omega * omega * (0.15 - scene.cask.cog_m)).abs() < 1e-8, "{along}");
        // Guides that take 4 % of g are read in the fall, which lasts 1/√0.96 of the free one: 1.3825 s.
        scene.extras.guided = 0.04;
        for (at_s, wanted) in [(-1.39, cos), (-1.36, 0.04 * cos), (-0.01, 0.04 * cos)] {
            let held = specific_force_m_s2(&scene, &motion, &centre(Axis::Transverse), &[at_s])[0];
            assert!((held - 9.81 * wanted).abs() < 1e-9, "{at_s}: {held}");
        }
        scene.extras.guided = 0.0;
        scene.rest = false;
        assert!(specific_force_m_s2(&scene, &motion, &centre(Axis::Transverse), &[-1.4])[0].abs() < 1e-12);
    }

    #[test]
    fn its_integral_is_the_change_of_velocity() {
        // Smooth and elastic: acceleration does not step. In body axes v̇_η = f_η − g cos φ − φ̇ v_ξ.
        let mut scene = anf18();
        scene.contact = Contact::Smooth;
        let motion = simulate(&scene);
        let last = just_before(&motion, motion.truth.contact_s.expect("L leaves"));
        let end_s = motion.steps[last].time_s;
        let steps = 20_000_u32;
        let times_s: Vec<f64> = (0..=steps).map(|i| end_s * f64::from(i) / f64::from(steps)).collect();
        let read =
            |axis| specific_force_m_s2(&scene, &motion, &channel(axis, scene.cask.cog_m, 0.0), &times_s);
        let (across, along) = (read(Axis::Transverse), read(Axis::Axial));
        let angle: Vec<f64> = times_s.iter().map(|t| Between::new(&motion, *t).value(2)).collect();
        let upwards: Vec<f64> =
            (0..angle.len()).map(|i| across[i] * angle[i].cos() + along[i] * angle[i].sin() - 9.81).collect();
        let gained = running_integral(&upwards, end_s / f64::from(steps)).last().copied().expect("samples");
        let wanted = motion.steps[last].state[4] - motion.steps[0].state[4];
        // The force has kinks, at which the trapezoid of 0.3 µs is off by less than a sample's share of it.
        assert!((gained / wanted - 1.0).abs() < 1e-6, "{gained}, not {wanted}");
    }

    #[test]
    fn a_sensor_beside_the_plane_reads_the_roll_that_builds_up() {
        let mut scene = anf18();
        scene.extras.roll_rad_s = 2.0;
        let motion = simulate(&scene);
        let beside = SceneChannel { lateral_m: 0.3, ..channel(Axis::Transverse, 0.15, 0.0) };
        let times_s: Vec<f64> = (0..=10_000).map(|i| 1e-6 * f64::from(i)).collect();
        let read = |at: &SceneChannel| specific_force_m_s2(&scene, &motion, at, &times_s);
        let more: Vec<f64> = read(&beside)
            .iter()
            .zip(read(&channel(Axis::Transverse, 0.15, 0.0)))
            .map(|(a, b)| a - b)
            .collect();
        let gained = running_integral(&more, 1e-6);
        // 2 rad/s × 0.3 m as L leaves, and all of it by then; the trapezoid over steps of ω h ≤ 0.1 is within
        // 1e-3.
        assert!((gained[10_000] / 0.6 - 1.0).abs() < 1e-3 && (gained[6_000] / 0.6 - 1.0).abs() < 1e-3);
        assert!(more[1..5_000].iter().all(|x| *x > 0.0));
    }

    #[test]
    fn between_steps_it_follows_the_force() {
        // Smooth, without bending: what a sensor on S reads, times the mass, is the normal force, which has
        // no kink within a phase.
        let mut scene = anf18();
        scene.contact = Contact::Smooth;
        let motion = simulate(&scene);
        let peak_n = motion.steps.iter().map(|step| step.loads_n[0].1).fold(0.0, f64::max);
        let sensor = [Axis::Transverse, Axis::Axial].map(|axis| channel(axis, scene.cask.cog_m, 0.0));
        let last = just_before(&motion, motion.truth.contact_s.expect("L leaves"));
        for i in (1..last).filter(|i| motion.steps[i + 1].time_s > motion.steps[*i].time_s) {
            let t = f64::midpoint(motion.steps[i].time_s, motion.steps[i + 1].time_s);
            let [across, along] = [0, 1].map(|n| specific_force_m_s2(&scene, &motion, &sensor[n], &[t])[0]);
            let force = across.hypot(along) * scene.cask.mass_kg;
            let [low, high] = [i, i + 1].map(|n| motion.steps[n].loads_n[0].1);
            // A sine stands at most (ω h)²/8 of its peak above its chord; ω² h² is up to 0.1² times m/m_eff,
            // below 4.
            assert!((force - f64::midpoint(low, high)).abs() < 5e-3 * peak_n, "at {t} s");
        }
    }

    #[test]
    fn a_mode_rings_at_its_frequency_with_its_damping() {
        let mut scene = anf18();
        scene.modes = vec![BendingMode { order: 2, frequency_hz: 150.0, damping: 0.02, strength: 0.5 }];
        let motion = simulate(&scene);
        let mut still = scene.clone();
        still.modes.clear();
        let calm = simulate(&still);
        let at = channel(Axis::Transverse, 0.15, 0.0);
        let omega = std::f64::consts::TAU * 150.0;
        let damped = omega * (1.0 - 0.02_f64 * 0.02).sqrt();
        let period_s = std::f64::consts::TAU / damped;
        let ringing = |t: f64| {
            specific_force_m_s2(&scene, &motion, &at, &[t])[0]
                - specific_force_m_s2(&still, &calm, &at, &[t])[0]
        };
        let peak =
            (0..100).map(|i| ringing(0.02 + period_s * f64::from(i) / 100.0).abs()).fold(0.0, f64::max);
        assert!(peak > 1.0, "{peak}");
        for i in 0..20 {
            let t = 0.02 + period_s * f64::from(i) / 20.0;
            let wanted = ringing(t) * (-0.02 * omega * period_s).exp();
            // The cubic between steps of ω h ≤ 0.1 is within 1e-5 of the peak.
            assert!((ringing(t + period_s) - wanted).abs() < 2e-5 * peak, "{i}");
        }
    }

    #[test]
    fn bending_is_of_the_size_that_the_impulse_gives() {
        // A pulse short against the period starts q̇ at impulse · shape / mass.
        let mut scene = anf18();
        scene.first_end.loading_n_m *= 400.0;
        scene.first_end.unloading_n_m *= 400.0;
        scene.contact = Contact::Smooth;
        scene.modes = vec![BendingMode { order: 1, frequency_hz: 30.0, damping: 0.0, strength: 1.0 }];
        let motion = simulate(&scene);
        let left = just_before(&motion, motion.truth.contact_s.expect("L leaves"));
        let impulse_m_s = motion.steps[left].state[4] - motion.steps[0].state[4];
        let wanted = 2.0 * impulse_m_s * scene.drop.angle_rad.cos();
        // 0.25 ms: ω T = 0.05, of which cos takes 1e-3; gravity and the turn are below that.
        assert!((motion.modes[left].rate_m_s / wanted - 1.0).abs() < 2e-3);
    }
}
