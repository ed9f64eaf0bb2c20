//! Ways to fit the flight to how far off they leave the velocity step, and what they cost.

use super::contest::{Contest, Method};
use super::drops::{CALM, DropClass, NOISY, ONE_MODE, Prepared, SLOW_MODE};
use crate::data::Signal;
use crate::lab::data::{Scene, TrialPoint, TrialRequest};
use crate::lab::plan::DropPlan;
use crate::lab::synth;
use crate::motion;
use crate::numerics::damped_modes::{Form, Seeds, Series, fit};

/// Means of the velocity over the window, as the program takes them.
const POINTS: u16 = 240;

/// Lowest and highest mode sought, Hz, the first over the window's length.
const LEAST_PERIODS: f64 = 0.6;
const HIGHEST_HZ: f64 = 400.0;

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
        let steps_m_s = velocity_steps_m_s(&drop.drop.scene, length_s);
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

    /// A plateau, with drift or with so many damped modes, sought one after another   (20)
    fn fitted(&self, drift: bool, modes: usize) -> Option<Vec<f64>> {
        let series: Vec<Series> = self.drop.signals.iter().map(|s| self.series(s)).collect();
        let mut fitted = fit(&series, &[], None, Form::free(drift))?;
        if modes > 0 {
            let lowest_hz = LEAST_PERIODS / (self.window.to_s - self.window.from_s);
            let seeds = Seeds::new(&series, (lowest_hz, HIGHEST_HZ), None);
            for _ in 0..modes {
                fitted = fit(&series, &fitted.modes, Some(&seeds), Form::free(false))?;
            }
        }
        Some(fitted.series.iter().map(|s| s.plateau).collect())
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

/// ∫ of the rigid body's specific force over the contact at each channel, m/s: trapezoids of a five-thousandth, off by 1e-7 of it.
fn velocity_steps_m_s(scene: &Scene, contact_s: f64) -> Vec<f64> {
    const STEPS: u32 = 5000;
    let rigid = Scene { modes: Vec::new(), ..scene.clone() };
    let still = synth::simulate(&rigid);
    let step_s = contact_s / f64::from(STEPS);
    let times_s: Vec<f64> = (0..=STEPS).map(|n| f64::from(n) * step_s).collect();
    let step_m_s = |channel| {
        let force = synth::specific_force_m_s2(&rigid, &still, channel, &times_s);
        let ends: f64 = force.first().into_iter().chain(force.last()).sum();
        step_s * (force.iter().sum::<f64>() - 0.5 * ends)
    };
    rigid.channels.iter().map(step_m_s).collect()
}

fn contest() -> Contest<TrueFlight, Vec<f64>> {
    let shapes = [
        ("mean", false, 0),
        ("line", true, 0),
        ("1 mode", false, 1),
        ("2 modes", false, 2),
        ("3 modes", false, 3),
    ];
    let rivals = shapes.map(|(name, drift, modes)| {
        Method::new(name, move |flight: &TrueFlight| flight.fitted(drift, modes))
    });
    let mut methods = vec![Method::new("most probable (BIC)", TrueFlight::most_probable)];
    methods.extend(rivals);
    Contest {
        family: "flight fit",
        error_unit: "% of the velocity step",
        matters: 0.1,
        samples: None,
        methods,
        error: |flight, found_m_s| flight.error_percent(&found_m_s),
    }
}

pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    contest().points(&CLASSES, request, |class| {
        let drops = class.prepared(request.either(8, 40), request);
        (class.name.to_owned(), drops.into_iter().filter_map(TrueFlight::of).collect())
    })
}
