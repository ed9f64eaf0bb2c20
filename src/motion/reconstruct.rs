//! Reconstructs the planar motion of the cask from the velocity steps of the channels, a contact law and the
//! initial motion.

use super::Integrated;
use super::curves::uniform;
use super::histories::{AlongAxis, Histories};
use crate::data::{AxialSource, Events, FlightFit, Motion, MotionCurve, MotionState, Setup, planar};
use crate::numerics::as_f64;

/// The force acts at most this share of the length inward of a corner: half of a limiter's overhang.
const MOST_INWARD: f64 = 0.1;
/// Steps over the flight, for the curves.
const FLIGHT_STEPS: u32 = 200;

/// Reconstructs the motion from first contact to slap-down with its curve; `None` without two transverse
/// channels apart or without their plateaus.
///
/// During contact the channels give ∫f_η of S and Ω by a line over their positions (16); v̇_η = f_η − g cos φ
/// − Ω v_ξ (17); v_ξ comes from the contact law or the axial channels (18). Afterwards S flies freely (8).
pub fn reconstruct(
    integrated: &Integrated,
    fit: &FlightFit,
    events: &Events,
    setup: &Setup,
) -> Option<Motion> {
    let mut curve = MotionCurve::default();
    let mut record = |state: &MotionState| push_state(&mut curve, setup, state);
    let mut motion = follow(integrated, fit, events, setup, &mut record)?;
    let separation = motion.separation;
    let end_s = events.slap_down_s().unwrap_or(fit.to_s);
    let flight = (1..=FLIGHT_STEPS).map(|i| {
        let share = f64::from(i) / f64::from(FLIGHT_STEPS);
        fly_on(integrated, fit, setup, &separation, separation.time_s + (end_s - separation.time_s) * share)
    });
    let height_m = |state: &MotionState| corner_height_m(setup, state, setup.cog_m);
    let left_m = height_m(&separation).min(0.0);
    for state in flight {
        record(&state);
        // Touches in the flight that are followed as one support L at other times.
        if fit.landing.is_none() {
            let above_m = height_m(&state) - left_m;
            motion.lowest_first_end_m = motion.lowest_first_end_m.min(above_m);
            motion.last_first_end_m = above_m;
        }
    }
    motion.curve = uniform(&curve);
    Some(motion)
}

/// The motion without its curve and the motion of L in the flight, which a fit evaluates often.
pub fn outcome(integrated: &Integrated, fit: &FlightFit, events: &Events, setup: &Setup) -> Option<Motion> {
    follow(integrated, fit, events, setup, &mut |_| ())
}

/// The motion with the states of the contact, in steps of equal length.
pub fn with_states(
    integrated: &Integrated,
    fit: &FlightFit,
    events: &Events,
    setup: &Setup,
) -> Option<(Motion, Vec<MotionState>)> {
    let mut states = Vec::new();
    let motion = follow(integrated, fit, events, setup, &mut |state| states.push(*state))?;
    Some((motion, states))
}

/// Follows the motion over the contact, passing each state to `record`, and its flight.
fn follow(
    integrated: &Integrated,
    fit: &FlightFit,
    events: &Events,
    setup: &Setup,
    record: &mut dyn FnMut(&MotionState),
) -> Option<Motion> {
    let contact_s = events.first_contact_s()?;
    let separation_s = events.separation_s()?;
    let line = AlongAxis::new(&integrated.signals, setup.cog_m)?;
    let (before_rad_s, events_s) = (setup.angular_velocity_rad_s, (contact_s, separation_s));
    let histories = Histories::new(integrated, fit, &line, before_rad_s, events_s, setup.contact_steps)?
        .scale_time(setup.second_s);
    let mut body = OnTarget::start(setup, contact_s);
    let contact = body.state;
    let step_s = (separation_s - contact_s) / as_f64(setup.contact_steps) * setup.second_s;
    record(&body.state);
    let (mut turned_rad2_s, mut turning_m2_s, mut crush_m) = (0.0, 0.0, 0.0_f64);
    for i in 1..=setup.contact_steps {
        let before = body.state;
        // The offset of a sensor already contains the effect of the rotation in the fall.
        turned_rad2_s +=
            (before.angular_velocity_rad_s.powi(2) - contact.angular_velocity_rad_s.powi(2)) * step_s;
        let (transverse_m_s, gained_rad_s) = histories.state_at(i, turned_rad2_s);
        let axial_m_s = histories.axial_mean(i, gained_rad_s);
        let rotation_rad_s = gained_rad_s - setup.angular_velocity_rad_s;
        let middle = body.advance(setup, step_s, transverse_m_s, rotation_rad_s, axial_m_s);
        let (_, below_m) = planar::arms_m(body.angle_by, setup.cog_m, setup.height_m);
        crush_m = crush_m.max(below_m - body.state.height_m);
        let inward_m = (setup.inward * crush_m).min(MOST_INWARD * setup.length_m);
        turning_m2_s += angular_impulse_m2_s(setup, &before, &body.state, middle, inward_m);
        record(&body.state);
    }
    let separation = body.state;
    let (slip_m_s, rebound_m_s) = corner(setup, &separation, setup.cog_m);
    let impulse_ratio = (separation.horizontal_velocity_m_s - contact.horizontal_velocity_m_s)
        / (separation.vertical_velocity_m_s - contact.vertical_velocity_m_s
            + setup.gravity_m_s2 * (separation.time_s - contact_s));
    let strikes = |t| fly_on(integrated, fit, setup, &separation, clock_time_s(integrated, setup, t));
    let slap_down = events.slap_down_s().map(strikes);
    let height_m = |state: &MotionState| corner_height_m(setup, state, setup.cog_m);
    let touch_height_m = fit.landing.as_ref().map(|landing| {
        let begins = fly(setup, &separation, clock_time_s(integrated, setup, landing.begin_s));
        height_m(&begins) - height_m(&separation).min(0.0)
    });
    let behind_m = setup.cog_m - setup.length_m;
    Some(Motion {
        contact,
        separation,
        impact_m_s: setup.impact_velocity_m_s,
        rebound_m_s,
        slip_m_s,
        impulse_ratio,
        angular_impulse_m2_s: turning_m2_s,
        crush_m,
        slap_down,
        second_end_m_s: slap_down.map(|s| corner(setup, &s, behind_m)),
        second_end_height_m: slap_down.map(|s| corner_height_m(setup, &s, behind_m)),
        touch_height_m,
        lowest_first_end_m: f64::INFINITY,
        last_first_end_m: f64::INFINITY,
        curve: MotionCurve::default(),
    })
}

/// Rotates sine and cosine of an angle by `by_rad`; exact to rounding, and quick for the small steps of a
/// contact.
fn rotate((sin, cos): (f64, f64), by_rad: f64) -> (f64, f64) {
    // Below 0.01 the next terms of both series are less than 1e-16.
    let square = by_rad * by_rad;
    let (s, c) = if by_rad.abs() < 0.01 {
        let s = by_rad * (1.0 - square / 6.0 * (1.0 - square / 20.0));
        (s, 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0)))
    } else {
        by_rad.sin_cos()
    };
    (sin * c + cos * s, cos * c - sin * s)
}

/// Angular impulse about S over mass in one step of the contact, m²/s: ∫((a − d) f_z − b f_x) dt with the
/// arms of (1)   (32)
fn angular_impulse_m2_s(
    setup: &Setup,
    before: &MotionState,
    after: &MotionState,
    middle: (f64, f64),
    inward_m: f64,
) -> f64 {
    let (a_m, b_m) = planar::arms_m(middle, setup.cog_m, setup.height_m);
    let up_m_s = after.vertical_velocity_m_s - before.vertical_velocity_m_s
        + setup.gravity_m_s2 * (after.time_s - before.time_s);
    let along_m_s = after.horizontal_velocity_m_s - before.horizontal_velocity_m_s;
    (a_m - inward_m) * up_m_s - b_m * along_m_s
}

/// Converts a time of the recording to the corrected clock, s.
fn clock_time_s(integrated: &Integrated, setup: &Setup, time_s: f64) -> f64 {
    integrated.contact_s + (time_s - integrated.contact_s) * setup.second_s
}

/// Like [`fly`], with the touch of L in between, which changes the velocities as the channels show.
fn fly_on(
    integrated: &Integrated,
    fit: &FlightFit,
    setup: &Setup,
    state: &MotionState,
    time_s: f64,
) -> MotionState {
    let touched =
        fit.landing.as_ref().map(|landing| (landing, clock_time_s(integrated, setup, landing.time_s)));
    let touched = touched.filter(|(_, touched_s)| *touched_s < time_s);
    // The line over the channels is only fitted if there is a touch, since every step of the fit calls this.
    let line = || AlongAxis::new(&integrated.signals, setup.cog_m);
    let Some(((landing, touched_s), line)) = touched.and_then(|touched| Some((touched, line()?))) else {
        return fly(setup, state, time_s);
    };
    let before = fly(setup, state, touched_s);
    let [across_m_s, turned_rad_s, along_m_s] = line.step_sums(&landing.steps_m_s);
    let along_m_s = landing.along_m_s.map_or(along_m_s, |[along_m_s, _]| along_m_s);
    let [across_m_s, turned_rad_s, along_m_s] =
        [across_m_s, turned_rad_s, along_m_s].map(|change| change * setup.second_s);
    let (sin, cos) = before.angle_rad.sin_cos();
    let behind = MotionState {
        angular_velocity_rad_s: before.angular_velocity_rad_s - turned_rad_s,
        horizontal_velocity_m_s: before.horizontal_velocity_m_s + along_m_s * cos - across_m_s * sin,
        vertical_velocity_m_s: before.vertical_velocity_m_s + across_m_s * cos + along_m_s * sin,
        ..before
    };
    fly(setup, &behind, time_s)
}

/// Ballistic motion of S from `state` to `time_s`   (8)
fn fly(setup: &Setup, state: &MotionState, time_s: f64) -> MotionState {
    let t = time_s - state.time_s;
    MotionState {
        time_s,
        angle_rad: state.angle_rad - state.angular_velocity_rad_s * t,
        height_m: state.height_m + state.vertical_velocity_m_s * t - setup.gravity_m_s2 * t * t / 2.0,
        vertical_velocity_m_s: state.vertical_velocity_m_s - setup.gravity_m_s2 * t,
        ..*state
    }
}

/// Horizontal and vertical velocity of the lower corner `behind_m` behind S, m/s   (3)
pub(super) fn corner(setup: &Setup, state: &MotionState, behind_m: f64) -> (f64, f64) {
    let arms = planar::arms_m(state.angle_rad.sin_cos(), behind_m, setup.height_m);
    let cog_m_s = (state.horizontal_velocity_m_s, state.vertical_velocity_m_s);
    planar::corner_m_s(cog_m_s, state.angular_velocity_rad_s, arms)
}

/// Height of that corner over the target, m: z_C = z_S − b.
pub(super) fn corner_height_m(setup: &Setup, state: &MotionState, behind_m: f64) -> f64 {
    state.height_m - planar::arms_m(state.angle_rad.sin_cos(), behind_m, setup.height_m).1
}

/// The body while L is on the target.
struct OnTarget {
    state: MotionState,
    /// Sine and cosine of its inclination.
    angle_by: (f64, f64),
    transverse_m_s: f64,
    axial_m_s: f64,
    last_transverse_m_s: f64,
    last_axial_m_s: f64,
}

impl OnTarget {
    fn start(setup: &Setup, time_s: f64) -> Self {
        let (sin, cos) = setup.angle_rad.sin_cos();
        let (a_m, b_m) = planar::arms_m((sin, cos), setup.cog_m, setup.height_m);
        let (w, along_m_s) = (setup.angular_velocity_rad_s, setup.horizontal_velocity_m_s);
        let down_m_s = planar::falling_m_s(setup.impact_velocity_m_s, w, a_m);
        let state = MotionState {
            time_s,
            angle_rad: setup.angle_rad,
            angular_velocity_rad_s: w,
            horizontal_velocity_m_s: along_m_s,
            vertical_velocity_m_s: down_m_s,
            height_m: b_m,
        };
        Self {
            state,
            angle_by: (sin, cos),
            transverse_m_s: down_m_s * cos - along_m_s * sin,
            axial_m_s: down_m_s * sin + along_m_s * cos,
            last_transverse_m_s: 0.0,
            last_axial_m_s: 0.0,
        }
    }

    /// Advances the motion by one step, given ∫f_η of S and Ω at its end, and for a measured axial velocity
    /// ∫f_ξ and the position of its measurement; sine and cosine of the inclination in its middle.
    fn advance(
        &mut self,
        setup: &Setup,
        step_s: f64,
        integral_m_s: f64,
        rotation_rad_s: f64,
        axial: Option<(f64, f64)>,
    ) -> (f64, f64) {
        let spin = -self.state.angular_velocity_rad_s;
        let mean_spin = f64::midpoint(spin, rotation_rad_s);
        let (sin_m, cos_m) = rotate(self.angle_by, spin * step_s / 2.0);
        let gained_m_s = integral_m_s - self.last_transverse_m_s;
        self.last_transverse_m_s = integral_m_s;
        let g = setup.gravity_m_s2;
        self.transverse_m_s += gained_m_s - (g * cos_m + mean_spin * self.axial_m_s) * step_s;
        let angle_rad = self.state.angle_rad + mean_spin * step_s;
        self.angle_by = rotate(self.angle_by, mean_spin * step_s);
        let (sin, cos) = self.angle_by;
        self.axial_m_s = match (setup.axial, axial) {
            (AxialSource::Measured, Some((axial_m_s, position_m))) => {
                let turned = mean_spin * mean_spin - setup.angular_velocity_rad_s.powi(2);
                let gained = axial_m_s - self.last_axial_m_s + turned * (position_m - setup.cog_m) * step_s;
                self.last_axial_m_s = axial_m_s;
                self.axial_m_s + gained + (mean_spin * self.transverse_m_s - g * sin_m) * step_s
            }
            (AxialSource::Sliding { friction }, _) => {
                // f_x = μ f_z: f_ξ = f_η tan(φ + atan μ) = f_η (sin φ + μ cos φ)/(cos φ − μ sin φ)   (18)
                let gained = gained_m_s * (sin_m + friction * cos_m) / (cos_m - friction * sin_m);
                self.axial_m_s + gained + (mean_spin * self.transverse_m_s - g * sin_m) * step_s
            }
            // ẋ_C = 0: v_ξ cos φ = v_η sin φ − Ω b   (18)
            _ => {
                let (_, b_m) = planar::arms_m(self.angle_by, setup.cog_m, setup.height_m);
                (self.transverse_m_s * sin - rotation_rad_s * b_m) / cos
            }
        };
        let vertical_m_s = self.axial_m_s * sin + self.transverse_m_s * cos;
        self.state = MotionState {
            time_s: self.state.time_s + step_s,
            angle_rad,
            angular_velocity_rad_s: -rotation_rad_s,
            horizontal_velocity_m_s: self.axial_m_s * cos - self.transverse_m_s * sin,
            vertical_velocity_m_s: vertical_m_s,
            height_m: self.state.height_m
                + f64::midpoint(self.state.vertical_velocity_m_s, vertical_m_s) * step_s,
        };
        (sin_m, cos_m)
    }
}

/// Adds a state to the curve.
fn push_state(curve: &mut MotionCurve, setup: &Setup, state: &MotionState) {
    let behind_m = setup.cog_m - setup.length_m;
    let second = corner(setup, state, behind_m);
    curve.time_s.push(state.time_s);
    curve.angle_rad.push(state.angle_rad);
    curve.angular_velocity_rad_s.push(state.angular_velocity_rad_s);
    curve.first_end_vertical_m_s.push(corner(setup, state, setup.cog_m).1);
    curve.second_end_vertical_m_s.push(second.1);
    curve.second_end_horizontal_m_s.push(second.0);
    curve.first_end_height_m.push(corner_height_m(setup, state, setup.cog_m));
    curve.second_end_height_m.push(corner_height_m(setup, state, behind_m));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{At, CONTACT_STEPS, End, Signal, example};

    /// A half sine of 6 ms from 10 ms on whose area is `step_m_s`, at 100 kHz over 80 ms.
    fn signal(name: &str, end: End, position_m: f64, step_m_s: f64) -> Signal {
        let peak = step_m_s * std::f64::consts::PI / (2.0 * 0.006);
        let force = |t: f64| {
            if (0.0..0.006).contains(&t) { peak * (std::f64::consts::PI * t / 0.006).sin() } else { 0.0 }
        };
        Signal {
            name: name.into(),
            end,
            position_m,
            noise_m_s2: 0.1,
            free_fall_s: 0.25,
            ..example::signal(1e5, (0..8000).map(|i| force(f64::from(i) * 1e-5 - 0.01)).collect())
        }
    }

    fn motion(first_m_s: f64, second_m_s: f64, axial: AxialSource) -> Motion {
        let signals = [signal("A1", End::First, 0.5, first_m_s), signal("A2", End::Second, 4.5, second_m_s)];
        let fit = example::flight(
            0.017,
            0.07,
            vec![example::plateau("A1", first_m_s), example::plateau("A2", second_m_s)],
        );
        let events = Events { separation: Some(At::exact(0.016)), ..example::events(0.01, 0.07) };
        reconstruct(&Integrated::new(&signals, 0.01), &fit, &events, &setup(axial))
            .expect("two channels apart")
    }

    fn setup(axial: AxialSource) -> Setup {
        Setup {
            length_m: 5.0,
            height_m: 0.6,
            cog_m: 2.5,
            angle_rad: 0.25,
            impact_velocity_m_s: 13.0,
            is_of_fall: true,
            angular_velocity_rad_s: 0.0,
            horizontal_velocity_m_s: 0.0,
            gravity_m_s2: 9.81,
            axial,
            second_s: 1.0,
            inward: 0.0,
            contact_steps: CONTACT_STEPS,
        }
    }

    #[test]
    fn without_force_the_cask_falls_on() {
        let m = motion(0.0, 0.0, AxialSource::Sliding { friction: 0.0 });
        let fallen_m_s = 13.0 + 9.81 * 0.006;
        assert!((m.separation.vertical_velocity_m_s + fallen_m_s).abs() < 1e-9);
        assert!(m.separation.horizontal_velocity_m_s.abs() < 1e-9);
        assert!(m.separation.angular_velocity_rad_s.abs() < 1e-12);
    }

    #[test]
    fn what_the_rotation_pulls_before_the_fit_begins_is_no_rotation() {
        // Sensors on both skins whose flight is fitted from 1 and from 20 ms behind the separation on.
        let rotation_rad_s = |from_s: f64| {
            let off_axis = |signal: Signal, offset_m: f64| {
                let turning = |i: i32| {
                    let share = ((f64::from(i) * 1e-5 - 0.01) / 0.006).clamp(0.0, 1.0);
                    26.0 / 4.0 * (1.0 - (std::f64::consts::PI * share).cos()) / 2.0
                };
                let pulled = |(i, force): (i32, &f64)| force - turning(i).powi(2) * offset_m;
                let force_m_s2 = (0..).zip(&signal.force_m_s2).map(pulled).collect();
                Signal { offset_m, force_m_s2, ..signal }
            };
            let signals = [
                off_axis(signal("A1", End::First, 0.5, 19.0), 0.3),
                off_axis(signal("A2", End::Second, 4.5, -7.0), -0.3),
            ];
            let integrated = Integrated::new(&signals, 0.01);
            let read = signals.iter().zip(&integrated.velocities);
            let steps = read.map(|(s, v)| example::plateau(&s.name, v.velocity_at(from_s))).collect();
            let events = Events { separation: Some(At::exact(0.016)), ..example::events(0.01, 0.07) };
            let setup = setup(AxialSource::Sticking);
            let fit = example::flight(from_s, 0.07, steps);
            let m = reconstruct(&integrated, &fit, &events, &setup).expect("two channels apart");
            m.separation.angular_velocity_rad_s
        };
        assert!((rotation_rad_s(0.017) - 6.5).abs() < 0.02, "{}", rotation_rad_s(0.017));
        assert!((rotation_rad_s(0.036) - 6.5).abs() < 0.02, "{}", rotation_rad_s(0.036));
    }

    #[test]
    fn rotation_is_the_slope_of_the_steps_over_position() {
        let m = motion(19.0, -7.0, AxialSource::Sticking);
        assert!((m.separation.angular_velocity_rad_s - 26.0 / 4.0).abs() < 1e-9);
    }

    #[test]
    fn the_contact_laws_hold_to_the_end_of_the_contact() {
        // The trapezoid over 200 steps of 30 µs leaves 1e-4 of the velocities.
        assert!(motion(19.0, -7.0, AxialSource::Sticking).slip_m_s.abs() < 1e-9);
        let smooth = motion(19.0, -7.0, AxialSource::Sliding { friction: 0.0 });
        assert!(smooth.separation.horizontal_velocity_m_s.abs() < 2e-3, "{smooth:?}");
    }

    #[test]
    fn the_flight_is_ballistic_and_the_curve_uniform() {
        let m = motion(19.0, -7.0, AxialSource::Sticking);
        let struck = m.slap_down.expect("a time is given");
        let flown_s = struck.time_s - m.separation.time_s;
        let expected = m.separation.vertical_velocity_m_s - 9.81 * flown_s;
        assert!((struck.vertical_velocity_m_s - expected).abs() < 1e-12);
        let steps: Vec<f64> = m.curve.time_s.windows(2).map(|w| w[1] - w[0]).collect();
        assert!(steps.iter().all(|s| (s - steps[0]).abs() < 1e-12));
    }
}
