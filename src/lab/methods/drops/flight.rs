//! Ways to fit the flight to how far off they leave the velocity step, and what they cost.

use super::method_map::{self, MethodStress};
use super::sample::{self, Class, Prepared};
use super::scene::STANDARD_GRAVITY_M_S2;
use super::summary::{Subject, by_class, point};
use crate::data::Signal;
use crate::lab::data::{BendingMode, Scene, TrialPart, TrialPoint, TrialRequest};
use crate::lab::methods::rivals::shape::{Shape, fit_shape};
use crate::lab::methods::timing::{Effort, Work, in_turn};
use crate::lab::synth;
use crate::motion;
use crate::numerics::damped_modes::Series;
use rayon::prelude::*;
use std::hint::black_box;

/// Means of the velocity over the window, as the program takes them.
const POINTS: u16 = 240;

/// Lowest and highest mode sought, Hz, the first over the window's length.
const LEAST_PERIODS: f64 = 0.6;
const HIGHEST_HZ: f64 = 400.0;

/// Nothing rings.
pub(super) const CALM: Class = Class { name: "calm", make: |_, _, _| {} };
pub(super) const NOISY: Class = Class {
    name: "5 g of noise",
    make: |plan, _, _| plan.each_chain(|c| c.white_noise_m_s2 = 5.0 * STANDARD_GRAVITY_M_S2),
};
pub(super) const ONE_MODE: Class = Class {
    name: "one mode, 2 to 5 periods",
    make: |plan, flight_s, share| plan.modes = vec![mode(1, (2.0 + 3.0 * share) / flight_s)],
};
pub(super) const SLOW_MODE: Class = Class {
    name: "slow mode, 0.7 to 1.2 periods",
    make: |plan, flight_s, share| plan.modes = vec![mode(1, (0.7 + 0.5 * share) / flight_s)],
};

const CLASSES: [Class; 5] = [
    CALM,
    NOISY,
    ONE_MODE,
    Class {
        name: "two modes",
        make: |plan, flight_s, share| {
            let frequency_hz = (2.0 + 2.0 * share) / flight_s;
            plan.modes = vec![mode(1, frequency_hz), mode(2, 2.757 * frequency_hz)];
        },
    },
    SLOW_MODE,
];

const STRESSES: [MethodStress; 2] = [
    MethodStress {
        name: "flight-fit-periods",
        title: "Velocity step by each flight fit, one strong mode ringing ever slower",
        axis: "periods of the mode in the flight",
        error: "error of the worst channel's velocity step, %",
        values: &[8.0, 5.0, 3.0, 2.0, 1.5, 1.2, 1.0, 0.8, 0.7, 0.6, 0.5, 0.35, 0.2],
        apply: |plan, flight_s, periods| plan.modes = vec![mode(1, periods / flight_s)],
    },
    MethodStress {
        name: "flight-fit-noise",
        title: "Velocity step by each flight fit under white noise, nothing ringing",
        axis: "RMS of the noise, g",
        error: "error of the worst channel's velocity step, %",
        values: &[0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0],
        apply: |plan, _, g| plan.each_chain(|c| c.white_noise_m_s2 = g * STANDARD_GRAVITY_M_S2),
    },
];

/// What the program takes.
const MOST_PROBABLE: &str = "most probable (BIC)";

/// A mode as strong as the uniform beam's.
fn mode(order: u8, frequency_hz: f64) -> BendingMode {
    BendingMode { order, frequency_hz, damping: 0.03, strength: 1.0 }
}

/// A drop with its true flight.
struct Flight<'a> {
    drop: &'a Prepared,
    window: motion::Window,
    left_s: f64,
    /// True velocity step of each signal, m/s.
    steps_m_s: Vec<f64>,
}

impl<'a> Flight<'a> {
    fn of(drop: &'a Prepared) -> Option<Self> {
        let truth = drop.drawn.truth();
        let (length_s, slap_s) = (truth.contact_s?, truth.slap_t?);
        let left_s = drop.contact_s + length_s;
        let window = motion::Window {
            from_s: left_s + 0.1 * length_s + 3e-4,
            to_s: drop.contact_s + slap_s - 5e-4,
            drift: true,
            angular_velocity_rad_s: truth.omega_rebound?,
        };
        let rigid = Scene { modes: Vec::new(), ..drop.drawn.scene.clone() };
        let still = synth::simulate(&rigid);
        let step_m_s = |i: usize| velocity_step_m_s(&rigid, &still, i, length_s);
        let steps_m_s = (0..drop.signals.len()).map(step_m_s).collect();
        Some(Self { drop, window, left_s, steps_m_s })
    }

    /// The program's own.
    fn most_probable(&self) -> Option<Vec<f64>> {
        let cog_m = self.drop.drawn.stated.cask.cog_m;
        let integrated = motion::Integrated::over(&self.drop.signals, self.drop.contact_s);
        let drive = motion::drive(&integrated, None, self.left_s, self.window.from_s, cog_m);
        let fit = motion::fit_flight(&integrated, &self.window, drive.as_ref(), cog_m)?;
        Some(fit.plateaus.iter().map(|p| p.velocity_step_m_s).collect())
    }

    fn by_shape(&self, shape: Shape) -> Option<Vec<f64>> {
        let series: Vec<Series> = self.drop.signals.iter().map(|s| self.series(s)).collect();
        let lowest_hz = LEAST_PERIODS / (self.window.to_s - self.window.from_s);
        let fit = fit_shape(shape, &series, (lowest_hz, HIGHEST_HZ))?;
        Some(fit.series.iter().map(|s| s.plateau).collect())
    }

    /// The velocity of a signal over the window, in means.
    fn series(&self, signal: &Signal) -> Series {
        let velocity = motion::Velocity::of(signal, self.drop.contact_s - 2e-3, self.window.to_s);
        let bin_s = (self.window.to_s - self.window.from_s) / f64::from(POINTS);
        let begins_s = |i: u16| self.window.from_s + f64::from(i) * bin_s;
        Series {
            time_s: (0..POINTS).map(|i| (f64::from(i) + 0.5) * bin_s).collect(),
            value: (0..POINTS).map(|i| velocity.mean(begins_s(i), begins_s(i) + bin_s)).collect(),
            steps_s: Vec::new(),
            floor: 1e-3,
        }
    }

    /// The worst channel's error, % of its step.
    fn error_percent(&self, found_m_s: Option<Vec<f64>>) -> Option<f64> {
        let off = |(found, step): (f64, &f64)| 100.0 * (found - step).abs() / step.abs();
        Some(found_m_s?.into_iter().zip(&self.steps_m_s).map(off).fold(0.0, f64::max))
    }
}

/// ∫ of the rigid body's specific force over the contact at channel `i`, m/s: trapezoids of a five-thousandth, off by 1e-7 of it.
fn velocity_step_m_s(
    scene: &Scene,
    still: &crate::lab::data::SimulatedMotion,
    i: usize,
    contact_s: f64,
) -> f64 {
    const STEPS: u32 = 5000;
    let step_s = contact_s / f64::from(STEPS);
    let times_s: Vec<f64> = (0..=STEPS).map(|n| f64::from(n) * step_s).collect();
    let force = synth::specific_force_m_s2(scene, still, &scene.channels[i], &times_s);
    let ends: f64 = force.first().into_iter().chain(force.last()).sum();
    step_s * (force.iter().sum::<f64>() - 0.5 * ends)
}

pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let count = if request.quick { 8 } else { 40 };
    let mut part = by_class(&CLASSES, progress, |class| {
        of_class(class, &sample::prepared(&sample::plans(class, count, request)), request)
    });
    let names: Vec<&str> = [MOST_PROBABLE].into_iter().chain(Shape::ALL.map(Shape::words)).collect();
    for stress in &STRESSES {
        part.maps.push(method_map::map(stress, request, &names, &errors_percent));
    }
    progress(1.0);
    part
}

/// The error of every method on one drop, the program's own first.
fn errors_percent(drop: &Prepared) -> Vec<Option<f64>> {
    let Some(flight) = Flight::of(drop) else { return Vec::new() };
    let by_shape = Shape::ALL.map(|shape| flight.error_percent(flight.by_shape(shape)));
    [flight.error_percent(flight.most_probable())].into_iter().chain(by_shape).collect()
}

fn of_class(class: &Class, drops: &[Prepared], request: &TrialRequest) -> Vec<TrialPoint> {
    let Some(timed) = drops.iter().find_map(Flight::of) else { return Vec::new() };
    let timed = &timed;
    let mut work: Vec<Work> = vec![Box::new(|| {
        black_box(timed.most_probable());
    })];
    for shape in Shape::ALL {
        work.push(Box::new(move || {
            black_box(timed.by_shape(black_box(shape)));
        }));
    }
    let timings = in_turn(&mut work, Effort::of(request.quick));
    let subject = |method, is_default| Subject {
        family: "flight fit",
        method,
        class: class.name,
        is_default,
        error_unit: "% of the velocity step",
    };
    let errors: Vec<Vec<Option<f64>>> = drops.par_iter().map(errors_percent).collect();
    let methods = [MOST_PROBABLE].into_iter().chain(Shape::ALL.map(Shape::words));
    let points = methods.zip(timings).enumerate().map(|(i, (method, timing))| {
        let of_method: Vec<Option<f64>> = errors.iter().filter_map(|e| e.get(i).copied()).collect();
        // A step that was not had is wholly off.
        point(subject(method, method == MOST_PROBABLE), &of_method, 100.0, timing)
    });
    points.collect()
}
