//! Ways to find the end of the flight to how far off they are, and what they cost.

use super::contest::{Contest, Method};
use crate::lab::chance::Chance;
use crate::lab::data::{TrialPoint, TrialRequest};
use crate::lab::drawn::GRAVITY_M_S2;
use crate::numerics::root::first_root;
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
        let (length_m, half_section_m) = (chance.even(4.5, 5.6), chance.even(0.0, 0.5));
        let reach_m = 0.5 * length_m;
        let angle_rad = chance.between(class.angle_deg).to_radians();
        let turned_rad = angle_rad + chance.between(class.beyond_deg).to_radians();
        let turning_rad_s = chance.between(class.turning_rad_s);
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

    /// How often the height changes its sign, the first time at the known root; `None` where another root is the first.
    fn changes(&self) -> Option<u32> {
        let step_s = self.last_s / f64::from(GRID);
        let height_m = |i: u32| self.at(f64::from(i) * step_s).0;
        let mut changes = (1..GRID).filter(|i| (height_m(*i) > 0.0) != (height_m(i + 1) > 0.0));
        let Some(first) = changes.next() else { return Some(0) };
        let is_root = (f64::from(first) * step_s..=f64::from(first + 1) * step_s).contains(&self.root_s);
        is_root.then(|| 1 + u32::try_from(changes.count()).unwrap_or(u32::MAX))
    }

    /// Where the rivals begin: a height that starts at zero and rises has been left.
    fn start_s(&self) -> f64 {
        let (z, v) = self.at(0.0);
        let bound = self.bound_m_s2();
        if z > TOUCH_M { 0.0 } else { (2.0 * v / bound).max((2.0 * TOUCH_M / bound).sqrt()) }
    }

    /// Steps proved too short to pass a root, and Newton's last one.
    fn march(&self) -> Option<f64> {
        let bound = self.bound_m_s2();
        let found_s = first_root(|t| self.at(t), bound, self.last_s, TOUCH_M)?;
        let (z, v) = self.at(found_s);
        Some(if v < -(2.0 * bound * TOUCH_M).sqrt() { found_s - z / v } else { found_s })
    }

    /// Newton's steps from where the march would step first; `None` where they do not settle.
    fn newton(&self) -> Option<f64> {
        let (begun_s, bound) = (self.start_s(), self.bound_m_s2());
        let (z, v) = self.at(begun_s);
        let mut t = begun_s + (v + (v * v + 2.0 * bound * z.max(0.0)).sqrt()) / bound;
        // Near a simple root six steps reach the last digit from one right digit; a start that needs more than 40 is lost.
        for _ in 0..40 {
            let (z, v) = self.at(t);
            t -= z / v;
            if (z / v).abs() <= 4.0 * f64::EPSILON * t.abs() {
                return Some(t).filter(|root| (0.0..=self.last_s).contains(root));
            }
        }
        None
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
const STEEP: RootClass = RootClass {
    name: "steep, 30 to 70°",
    angle_deg: (30.0, 70.0),
    beyond_deg: (0.0, 40.0),
    turning_rad_s: (2.0, 8.0),
    ..FLAT
};
const CLASSES: [RootClass; 4] = [
    FLAT,
    RootClass { name: "usual, 8 to 30°", angle_deg: (8.0, 30.0), beyond_deg: (0.0, 10.0), ..FLAT },
    STEEP,
    RootClass {
        name: "steep, several roots",
        beyond_deg: (20.0, 100.0),
        turning_rad_s: (4.0, 14.0),
        changes: 2..=u32::MAX,
        ..STEEP
    },
];

/// Root of `f` in `low..high` by bisection to the last bit; `None` where the ends do not differ in sign.
fn bisect(f: impl Fn(f64) -> f64, low: f64, high: f64) -> Option<f64> {
    let (mut a, mut b) = (low, high);
    let sign_a = f(a) > 0.0;
    if sign_a == (f(b) > 0.0) {
        return None;
    }
    // 2^-64 of the bracket is below the spacing of doubles in it.
    for _ in 0..64 {
        let mid = f64::midpoint(a, b);
        if (f(mid) > 0.0) == sign_a { a = mid } else { b = mid }
    }
    Some(f64::midpoint(a, b))
}

fn contest() -> Contest<RootedFlight, f64> {
    Contest {
        family: "root of the flight",
        error_unit: "% of the flight",
        samples: None,
        methods: vec![
            Method::new("march", RootedFlight::march),
            Method::new("bisection", |flight: &RootedFlight| {
                bisect(|t| flight.at(t).0, flight.start_s(), flight.last_s)
            }),
            Method::new("Newton", RootedFlight::newton),
        ],
        error: |flight, found_s| 100.0 * (found_s / flight.root_s - 1.0).abs(),
    }
}

pub(super) fn points(request: &TrialRequest) -> Vec<TrialPoint> {
    contest().points(&CLASSES, request, |class| (class.name.to_owned(), flights(class, request)))
}

/// Flights of a class; one that is not to be had in a thousand attempts is left out.
fn flights(class: &RootClass, request: &TrialRequest) -> Vec<RootedFlight> {
    let draw = |number: u64| {
        let mut chance = Chance::new(request.seed, number);
        (0..1000).map(|_| RootedFlight::with_root(&mut chance, class)).find(|flight| {
            let is_steep = flight.at(flight.root_s).1 < -0.1;
            is_steep && flight.changes().is_some_and(|changes| class.changes.contains(&changes))
        })
    };
    (0..request.either(60_u64, 1000)).into_par_iter().filter_map(draw).collect()
}
