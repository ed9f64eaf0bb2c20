//! Ways to find the end of the flight to how far off they are, and what they cost.

use crate::lab::chance::Chance;
use crate::lab::data::{TrialPart, TrialRequest};
use crate::lab::drawn::GRAVITY_M_S2;
use crate::lab::methods::contest::{Contest, Purpose, by_class};
use crate::lab::methods::rivals::root::{RootMethod, root_by};
use rayon::prelude::*;

/// Height that counts as touching, m.
const TOUCH_M: f64 = 1e-9;
/// Grid on which a flight's changes of sign are counted: two roots closer than a twenty-thousandth of it are one.
const GRID: u32 = 20_000;

/// R's corner in flight: z(τ) = z₀ + ż₀ τ − g τ²/2 + r sin(φ0 − ω τ) − (h/2) cos(φ0 − ω τ), and a root known by construction.
#[derive(Clone, Copy)]
struct RootedFlight {
    height_m: f64,
    rising_m_s: f64,
    turning_rad_s: f64,
    angle_rad: f64,
    reach_m: f64,
    half_section_m: f64,
    /// Root, s.
    root_s: f64,
    /// Time by which S lies deeper than R can reach up, s.
    last_s: f64,
}

impl RootedFlight {
    /// Height and its slope.
    fn at(&self, t: f64) -> (f64, f64) {
        let (sin, cos) = (self.angle_rad - self.turning_rad_s * t).sin_cos();
        let height_m = self.height_m + self.rising_m_s * t - 0.5 * GRAVITY_M_S2 * t * t + self.reach_m * sin
            - self.half_section_m * cos;
        let across_m = self.reach_m * cos + self.half_section_m * sin;
        (height_m, self.rising_m_s - GRAVITY_M_S2 * t - self.turning_rad_s * across_m)
    }

    /// |z̈| ≤ g + ω² ρ.
    fn bound_m_s2(&self) -> f64 {
        GRAVITY_M_S2 + self.turning_rad_s.powi(2) * self.reach_m.hypot(self.half_section_m)
    }

    /// A flight with L on the target at its start and R on it at `root_s`: the rise of S is what makes it so.
    fn with_root(chance: &mut Chance, class: &RootClass) -> Self {
        let mut between = |(low, high): (f64, f64)| chance.even(low, high);
        let (length_m, half_section_m) = (between((4.5, 5.6)), between((0.0, 0.5)));
        let reach_m = 0.5 * length_m;
        let angle_rad = between(class.angle_deg).to_radians();
        let turned_rad = angle_rad + between(class.beyond_deg).to_radians();
        let turning_rad_s = between(class.turning_rad_s);
        let root_s = turned_rad / turning_rad_s;
        let height_m = reach_m * angle_rad.sin() + half_section_m * angle_rad.cos();
        let (sin, cos) = (angle_rad - turning_rad_s * root_s).sin_cos();
        let above_m = height_m - 0.5 * GRAVITY_M_S2 * root_s * root_s + reach_m * sin - half_section_m * cos;
        let rising_m_s = -above_m / root_s;
        let deepest_m = height_m + reach_m.hypot(half_section_m);
        let last_s =
            (rising_m_s + (rising_m_s * rising_m_s + 2.0 * GRAVITY_M_S2 * deepest_m).sqrt()) / GRAVITY_M_S2;
        Self { height_m, rising_m_s, turning_rad_s, angle_rad, reach_m, half_section_m, root_s, last_s }
    }

    /// Whether the known root is the first, and how often the height changes its sign.
    fn signs(&self) -> (bool, u32) {
        let step_s = self.last_s / f64::from(GRID);
        let height_m = |i: u32| self.at(f64::from(i) * step_s).0;
        let mut changes = 0;
        let mut is_first = true;
        for i in 1..GRID {
            if (height_m(i) > 0.0) != (height_m(i + 1) > 0.0) {
                changes += 1;
                is_first &= changes > 1
                    || (f64::from(i + 1) * step_s >= self.root_s && f64::from(i) * step_s <= self.root_s);
            }
        }
        (is_first, changes)
    }

    /// The root for an axis so flat that sin φ ≈ φ and cos φ ≈ 1 − φ²/2: a quadratic equation   (41)
    fn closed_form_s(&self) -> Option<f64> {
        let (r, h, w, phi) = (self.reach_m, self.half_section_m, self.turning_rad_s, self.angle_rad);
        // z = c + b τ + a τ²
        let a = -0.5 * GRAVITY_M_S2 + 0.5 * h * w * w;
        let b = self.rising_m_s - r * w - h * phi * w;
        let c = self.height_m + r * phi - h * (1.0 - 0.5 * phi * phi);
        let discriminant = b * b - 4.0 * a * c;
        // b < 0 where R comes down: this form does not cancel.
        (discriminant >= 0.0 && b < 0.0).then(|| 2.0 * c / (-b + discriminant.sqrt()))
    }
}

/// Flights of one kind: angle at the start, how far past flat R strikes, ω, and how often the height may change its sign.
struct RootClass {
    name: &'static str,
    angle_deg: (f64, f64),
    beyond_deg: (f64, f64),
    turning_rad_s: (f64, f64),
    changes: std::ops::RangeInclusive<u32>,
}

const FLAT: RootClass = RootClass {
    name: "flat, 3 to 8°",
    angle_deg: (3.0, 8.0),
    beyond_deg: (0.0, 2.0),
    turning_rad_s: (3.0, 8.0),
    changes: 1..=1,
};
const USUAL: RootClass =
    RootClass { name: "usual, 8 to 30°", angle_deg: (8.0, 30.0), beyond_deg: (0.0, 10.0), ..FLAT };
const STEEP: RootClass = RootClass {
    name: "steep, 30 to 70°",
    angle_deg: (30.0, 70.0),
    beyond_deg: (0.0, 40.0),
    turning_rad_s: (2.0, 8.0),
    ..FLAT
};
const SEVERAL: RootClass = RootClass {
    name: "steep, several roots",
    beyond_deg: (20.0, 100.0),
    turning_rad_s: (4.0, 14.0),
    changes: 2..=u32::MAX,
    ..STEEP
};
const CLASSES: [RootClass; 4] = [FLAT, USUAL, STEEP, SEVERAL];

/// A method of the library, or the closed form that holds for flat drops only.
#[derive(Clone, Copy, PartialEq)]
enum RootFinder {
    By(RootMethod),
    ClosedForm,
}

fn contest() -> Contest<RootFinder, RootedFlight, f64> {
    Contest {
        purpose: Purpose::of_calls("root of the flight", "% of the flight"),
        methods: RootMethod::ALL.into_iter().map(RootFinder::By).chain([RootFinder::ClosedForm]).collect(),
        default: RootFinder::By(RootMethod::default()),
        name: |way| match way {
            RootFinder::By(method) => method.words().to_owned(),
            RootFinder::ClosedForm => "closed form (small angles)".to_owned(),
        },
        run: |way, flight| match way {
            RootFinder::By(method) => {
                root_by(method, |t| flight.at(t), flight.bound_m_s2(), flight.last_s, TOUCH_M)
            }
            RootFinder::ClosedForm => flight.closed_form_s(),
        },
        error: |flight, found_s| 100.0 * (found_s / flight.root_s - 1.0).abs(),
        parts: |_| 1,
    }
}

pub(super) fn run(request: &TrialRequest, progress: &dyn Fn(f64)) -> TrialPart {
    let contest = contest();
    let part = by_class(&CLASSES, progress, |class| {
        contest.points(class.name, &flights(class, request), 16, request)
    });
    progress(1.0);
    part
}

/// Flights of a class; one that is not to be had in a thousand attempts is left out.
fn flights(class: &RootClass, request: &TrialRequest) -> Vec<RootedFlight> {
    let count: u64 = if request.quick { 60 } else { 1000 };
    let draw = |number: u64| {
        let mut chance = Chance::new(request.seed, number);
        (0..1000).map(|_| RootedFlight::with_root(&mut chance, class)).find(|flight| {
            let steep = flight.at(flight.root_s).1 < -0.1;
            steep && {
                let (is_first, changes) = flight.signs();
                is_first && class.changes.contains(&changes)
            }
        })
    };
    (0..count).into_par_iter().filter_map(draw).collect()
}
