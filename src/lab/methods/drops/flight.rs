//! Ways to fit the flight to how far off they leave the velocity step, and what they cost.

use super::sample::{self, DropClass, NOISY, Prepared};
use crate::data::Signal;
use crate::lab::data::{Scene, SimulatedMotion, TrialPart, TrialRequest};
use crate::lab::methods::contest::{Contest, Purpose, by_class};
use crate::lab::methods::rivals::shape::{Shape, fit_shape};
use crate::lab::plan::DropPlan;
use crate::lab::synth;
use crate::motion;
use crate::numerics::damped_modes::Series;

/// Means of the velocity over the window, as the program takes them.
const POINTS: u16 = 240;

/// Lowest and highest mode sought, Hz, the first over the window's length.
const LEAST_PERIODS: f64 = 0.6;
const HIGHEST_HZ: f64 = 400.0;

/// Nothing rings.
pub(super) const CALM: DropClass = DropClass { name: "calm", make: |_, _, _| {} };
pub(super) const ONE_MODE: DropClass = DropClass {
    name: "one mode, 2 to 5 periods",
    make: |plan, flight_s, share| plan.modes = vec![DropPlan::mode(1, (2.0 + 3.0 * share) / flight_s)],
};
pub(super) const SLOW_MODE: DropClass = DropClass {
    name: "slow mode, 0.7 to 1.2 periods",
    make: |plan, flight_s, share| plan.modes = vec![DropPlan::mode(1, (0.7 + 0.5 * share) / flight_s)],
};

const CLASSES: [DropClass; 5] = [
    CALM,
    NOISY,
    ONE_MODE,
    DropClass {
        name: "two modes",
        make: |plan, flight_s, share| {
            let frequency_hz = (2.0 + 2.0 * share) / flight_s;
            plan.modes = vec![DropPlan::mode(1, frequency_hz), DropPlan::mode(2, 2.757 * frequency_hz)];
        },
    },
    SLOW_MODE,
];

/// What the program does, or a shape that is named.
#[derive(Clone, Copy, PartialEq)]
enum FlightFitting {
    MostProbable,
    By(Shape),
}

/// A drop with its true flight.
struct TrueFlight {
    drop: Prepared,
    window: motion::Window,
    left_s: f64,
    /// True velocity step of each signal, m/s.
    steps_m_s: Vec<f64>,
}

impl TrueFlight {
    fn of(drop: Prepared) -> Option<Self> {
        let truth = drop.drop.motion.truth;
        let (length_s, slap_s) = (truth.contact_s?, truth.slap_t?);
        let left_s = drop.contact_s + length_s;
        let window = motion::Window {
            from_s: left_s + 0.1 * length_s + 3e-4,
            to_s: drop.contact_s + slap_s - 5e-4,
            drift: true,
            angular_velocity_rad_s: truth.omega_rebound?,
        };
        let rigid = Scene { modes: Vec::new(), ..drop.drop.scene.clone() };
        let still = synth::simulate(&rigid);
        let step_m_s = |i: usize| velocity_step_m_s(&rigid, &still, i, length_s);
        let steps_m_s = (0..drop.signals.len()).map(step_m_s).collect();
        Some(Self { drop, window, left_s, steps_m_s })
    }

    /// The program's own.
    fn most_probable(&self) -> Option<Vec<f64>> {
        let cog_m = self.drop.drop.stated.cask.cog_m;
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
    fn error_percent(&self, found_m_s: &[f64]) -> f64 {
        let off = |(found, step): (&f64, &f64)| 100.0 * (found - step).abs() / step.abs();
        found_m_s.iter().zip(&self.steps_m_s).map(off).fold(0.0, f64::max)
    }
}

/// ∫ of the rigid body's specific force over the contact at channel `i`, m/s: trapezoids of a five-thousandth, off by 1e-7 of it.
fn velocity_step_m_s(scene: &Scene, still: &SimulatedMotion, i: usize, contact_s: f64) -> f64 {
    const STEPS: u32 = 5000;
    let step_s = contact_s / f64::from(STEPS);
    let times_s: Vec<f64> = (0..=STEPS).map(|n| f64::from(n) * step_s).collect();
    let force = synth::specific_force_m_s2(scene, still, &scene.channels[i], &times_s);
    let ends: f64 = force.first().into_iter().chain(force.last()).sum();
    step_s * (force.iter().sum::<f64>() - 0.5 * ends)
}

fn contest() -> Contest<FlightFitting, TrueFlight, Vec<f64>> {
    Contest {
        // A step that was not had is wholly off.
        purpose: Purpose::of_calls("flight fit", "% of the velocity step"),
        methods: [FlightFitting::MostProbable].into_iter().chain(Shape::ALL.map(FlightFitting::By)).collect(),
        default: FlightFitting::MostProbable,
        name: |fitting| match fitting {
            FlightFitting::MostProbable => "most probable (BIC)".to_owned(),
            FlightFitting::By(shape) => shape.words().to_owned(),
        },
        run: |fitting, flight| match fitting {
            FlightFitting::MostProbable => flight.most_probable(),
            FlightFitting::By(shape) => flight.by_shape(shape),
        },
        error: |flight, found_m_s| flight.error_percent(&found_m_s),
        parts: |_| 1,
    }
}

pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let (contest, count) = (contest(), if request.quick { 8 } else { 40 });
    let mut part = by_class(&CLASSES, progress, |class| {
        let drops = sample::prepared(&sample::plans(class, count, request));
        let flights: Vec<TrueFlight> = drops.into_iter().filter_map(TrueFlight::of).collect();
        contest.points(class.name, &flights, 1, request)
    });
    let off = "error of the worst channel's velocity step, %";
    let map = |kind| sample::grown(&contest, kind, off, TrueFlight::of, request);
    part.maps = ["mode_frequency", "white_noise"].into_iter().filter_map(map).collect();
    progress(1.0);
    part
}
