//! From a body, a drop and a contact law to its motion by time steps: a rigid body on a stiff contact that
//! crushes and springs back.
//!
//! A touch is a pulse: the normal force grows with stiffness K and falls with K/k², so that k² of the work
//! put in comes back; the tangential impulse of each step is the one that stops the slip, at most μ times the
//! normal one. Where L rests, or k = 0 holds it, the steps are Moreau's: velocities that obey the constraint
//! and the friction cone at the end of each step. Nothing here knows an impact law.

use super::rigid::{Answer, Motion, Point, Vector};
use super::setting::{End, Law, Outcome, Pace};
use dropcheck::data::{Body, Drop};
use std::f64::consts::FRAC_PI_2;

/// Steps of a loading, and of an unloading: the leapfrog's frequency is then off by (π/2/500)²/24, 4e-7.
const PULSE_STEPS: f64 = 500.0;

/// A pulse that takes more steps does not end by springing back.
const MOST_PULSE_STEPS: u32 = 100_000;

/// Shortest and longest step of a flight, s. What dips and rises within the shortest sinks by 1e-12 m.
const FLIGHT_STEPS_S: (f64, f64) = (1e-7, 2e-3);

/// The drop is over or never will be, s: a cask that tips over from 75° takes two seconds.
const LONGEST_S: f64 = 10.0;

/// More touches than that are chatter.
const MOST_TOUCHES: u32 = 3000;

/// How L's corner is pressed: the force along the loading line, and along the line back once it has been
/// pressed deepest.
#[derive(Clone, Copy)]
struct Crush {
    loading_n_m: f64,
    /// Height of the corner at which the loading began, m.
    free_m: f64,
    /// Stiffness of the line back, N/m, and the height at which it ends, m.
    back: Option<(f64, f64)>,
}

impl Crush {
    fn force_n(&self, height_m: f64) -> f64 {
        let loading_n = self.loading_n_m * (self.free_m - height_m);
        // Pressed deeper than before, it is crushed on.
        let back_n =
            self.back.map_or(f64::INFINITY, |(unloading_n_m, left_m)| unloading_n_m * (left_m - height_m));
        loading_n.min(back_n).max(0.0)
    }
}

enum Phase {
    Flight,
    Pulse,
    Rest,
    Over(End),
}

struct Simulation<'a> {
    body: &'a Body,
    law: Law,
    pace: Pace,
    gravity_m_s2: f64,
    first_end: Point,
    second_end: Point,
    motion: Motion,
    time_s: f64,
    /// What has been crushed off L: the height below the target at which it touches next, m.
    crushed_m: f64,
    /// L can touch the target.
    touchable: bool,
    touches: u32,
    first_pulse: Option<(f64, f64)>,
    rested: bool,
}

/// Follows a body from first contact until R strikes or never will.
pub fn simulate(body: &Body, drop: &Drop, law: Law, pace: Pace) -> Outcome {
    let mut simulation = Simulation::at_first_contact(body, drop, law, pace);
    let energy_j = |s: &Simulation| s.motion.energy_j(s.body, s.gravity_m_s2);
    let first_j = energy_j(&simulation);
    let (mut least_j, mut energy_rise) = (first_j, 0.0_f64);
    let mut phase = Phase::Pulse;
    let end = loop {
        phase = match phase {
            Phase::Over(end) => break end,
            Phase::Flight => simulation.fly(),
            Phase::Pulse => simulation.pulse(),
            Phase::Rest => simulation.rest(),
        };
        energy_rise = energy_rise.max((energy_j(&simulation) - least_j) / first_j);
        least_j = least_j.min(energy_j(&simulation));
        if simulation.time_s > LONGEST_S || simulation.touches > MOST_TOUCHES {
            phase = Phase::Over(End::Open);
        }
    };
    Outcome {
        end,
        second_end_m_s: simulation.motion.velocity_at_m_s(simulation.second_end),
        angle_rad: simulation.motion.angle_rad,
        time_s: simulation.time_s,
        touches: simulation.touches,
        first_pulse: simulation
            .first_pulse
            .map(|(lasts_s, leaves_m_s)| (lasts_s, leaves_m_s / drop.impact_velocity_m_s)),
        rested: simulation.rested,
        energy_rise,
    }
}

impl<'a> Simulation<'a> {
    /// L on the target, the body falling without rotation.
    fn at_first_contact(body: &'a Body, drop: &Drop, law: Law, pace: Pace) -> Self {
        let mut simulation = Self {
            body,
            law,
            pace,
            gravity_m_s2: drop.gravity_m_s2,
            first_end: Point::first_end(body),
            second_end: Point::second_end(body),
            motion: Motion {
                position_m: Vector { x: 0.0, z: 0.0 },
                angle_rad: drop.angle_rad,
                velocity_m_s: Vector { x: 0.0, z: -drop.impact_velocity_m_s },
                turn_rad_s: 0.0,
            },
            time_s: 0.0,
            crushed_m: 0.0,
            touchable: true,
            touches: 0,
            first_pulse: None,
            rested: false,
        };
        simulation.motion.position_m.z = -simulation.motion.height_m(simulation.first_end);
        simulation
    }

    fn second_end_strikes(&self, motion: &Motion) -> bool {
        motion.height_m(self.second_end) < 0.0 && motion.velocity_at_m_s(self.second_end).z < 0.0
    }

    fn first_end_touches(&self, motion: &Motion) -> bool {
        self.touchable
            && motion.height_m(self.first_end) < -self.crushed_m
            && motion.velocity_at_m_s(self.first_end).z < 0.0
    }

    fn over(&self) -> Phase {
        Phase::Over(if self.motion.angle_rad.cos() > 0.0 { End::SlapDown } else { End::Never })
    }

    /// Exact steps so short that no corner can pass the target, then a bisection of the one in which it does.
    fn fly(&mut self) -> Phase {
        let lands = |s: &Self, motion: &Motion| s.second_end_strikes(motion) || s.first_end_touches(motion);
        while !lands(self, &self.motion) {
            let step_s = self.safe_step_s();
            let next = self.motion.flown(self.gravity_m_s2, step_s);
            if !lands(self, &next) {
                self.motion = next;
                self.time_s += step_s;
                if self.time_s > LONGEST_S {
                    return Phase::Over(End::Open);
                }
                continue;
            }
            let (mut before_s, mut after_s) = (0.0, step_s);
            for _ in 0..60 {
                let middle_s = f64::midpoint(before_s, after_s);
                let landed = lands(self, &self.motion.flown(self.gravity_m_s2, middle_s));
                *(if landed { &mut after_s } else { &mut before_s }) = middle_s;
            }
            self.motion = self.motion.flown(self.gravity_m_s2, after_s);
            self.time_s += after_s;
        }
        if self.second_end_strikes(&self.motion) {
            return self.over();
        }
        let corner = self.motion.velocity_at_m_s(self.first_end);
        // Where nothing limits the friction a slow touch may still stop a fast slip: then it is no rest.
        let slips = self.law.friction.is_infinite() && corner.x.abs() > 10.0 * self.pace.rest_m_s;
        if -corner.z < self.pace.rest_m_s && !slips { Phase::Rest } else { Phase::Pulse }
    }

    /// The time that no corner needs less of to reach the target, s: its distance over the largest speed it
    /// can have.
    fn safe_step_s(&self) -> f64 {
        let motion = &self.motion;
        let speed_m_s = motion.velocity_m_s.x.hypot(motion.velocity_m_s.z)
            + motion.turn_rad_s.abs() * self.second_end.distance_m().max(self.first_end.distance_m())
            + self.gravity_m_s2 * FLIGHT_STEPS_S.1;
        let mut gap_m = motion.height_m(self.second_end);
        if self.touchable {
            gap_m = gap_m.min(motion.height_m(self.first_end) + self.crushed_m);
        }
        (gap_m / speed_m_s).clamp(FLIGHT_STEPS_S.0, FLIGHT_STEPS_S.1)
    }

    /// One touch: L is crushed with stiffness K and springs back with K/k².
    fn pulse(&mut self) -> Phase {
        self.touches += 1;
        let compliance_per_kg = Answer::of(self.body, &self.motion, self.first_end).by_z.z;
        let free_m = -self.crushed_m;
        let crush = Crush {
            loading_n_m: (FRAC_PI_2 / self.pace.loading_s).powi(2) / compliance_per_kg,
            free_m,
            back: None,
        };
        let step_s = self.pace.loading_s / PULSE_STEPS;
        for _ in 0..MOST_PULSE_STEPS {
            let (next, taken_s) = self.pulse_step(step_s, crush);
            let (before, after) = (self.sinking_m_s(&self.motion), self.sinking_m_s(&next));
            if after > 0.0 {
                self.motion = next;
                self.time_s += taken_s;
                continue;
            }
            // The deepest crush lies within this step: end the step there.
            let last_s = taken_s * (before / (before - after)).clamp(0.0, 1.0);
            let (last, last_s) = self.pulse_step(last_s, crush);
            self.motion = last;
            self.time_s += last_s;
            return self.spring_back(crush);
        }
        Phase::Over(End::Open)
    }

    /// The unloading, along a line that gives back k² of the work.
    fn spring_back(&mut self, crush: Crush) -> Phase {
        let k = self.law.k;
        let deepest_m = (crush.free_m - self.motion.height_m(self.first_end)).max(0.0);
        let left_m = crush.free_m - deepest_m * (1.0 - k * k);
        self.crushed_m = -left_m;
        if k == 0.0 {
            return Phase::Rest;
        }
        let crush = Crush { back: Some((crush.loading_n_m / (k * k), left_m)), ..crush };
        let step_s = k * self.pace.loading_s / PULSE_STEPS;
        for _ in 0..MOST_PULSE_STEPS {
            if self.motion.drifted(step_s / 2.0).height_m(self.first_end) >= left_m {
                self.touchable = self.law.again;
                let leaves_m_s = self.motion.velocity_at_m_s(self.first_end).z;
                self.first_pulse.get_or_insert((self.time_s, leaves_m_s));
                return Phase::Flight;
            }
            let (next, taken_s) = self.pulse_step(step_s, crush);
            self.motion = next;
            self.time_s += taken_s;
        }
        Phase::Over(End::Open)
    }

    /// Drift, kick, drift. The step ends where the slip does, so that what follows, sticking or the slip the
    /// other way, begins with a step of its own.
    fn pulse_step(&self, step_s: f64, crush: Crush) -> (Motion, f64) {
        let slip_m_s = self.motion.velocity_at_m_s(self.first_end).x;
        let (next, braked_m_s) = self.kicked(step_s, crush, slip_m_s);
        let share = slip_m_s / (slip_m_s - braked_m_s);
        if share > 1e-3 && share < 1.0 {
            return (self.kicked(share * step_s, crush, slip_m_s).0, share * step_s);
        }
        (next, step_s)
    }

    /// The motion after a step whose tangential impulse stops the slip or is as large as friction allows, and
    /// the slip that is left where friction brakes the slip at first to the end, past zero too.
    fn kicked(&self, step_s: f64, crush: Crush, slip_m_s: f64) -> (Motion, f64) {
        let middle = self.motion.drifted(step_s / 2.0).pulled(self.gravity_m_s2, step_s);
        let normal_n_s = crush.force_n(middle.height_m(self.first_end)) * step_s;
        let answer = Answer::of(self.body, &middle, self.first_end);
        let stopping_n_s = answer.stopping_n_s(normal_n_s);
        if self.law.friction.is_infinite() {
            let impulse = Vector { x: stopping_n_s, z: normal_n_s };
            return (middle.pushed(self.body, answer.arm_m, impulse).drifted(step_s / 2.0), slip_m_s);
        }
        let most_n_s = self.law.friction * normal_n_s;
        let impulse = Vector { x: stopping_n_s.clamp(-most_n_s, most_n_s), z: normal_n_s };
        let next = middle.pushed(self.body, answer.arm_m, impulse).drifted(step_s / 2.0);
        (next, answer.by_x.x * (-slip_m_s.signum() * most_n_s - stopping_n_s))
    }

    fn sinking_m_s(&self, motion: &Motion) -> f64 {
        -motion.velocity_at_m_s(self.first_end).z
    }

    /// L on the target until it lifts off or R strikes.
    fn rest(&mut self) -> Phase {
        self.rested = true;
        let step_s = self.pace.rest_step_s;
        let mut slip_m_s = self.motion.velocity_at_m_s(self.first_end).x;
        // The constraint holds at the middle of each step: up to the first middle gravity has half a step.
        let mut pull_s = step_s / 2.0;
        while self.time_s < LONGEST_S {
            let middle = self.motion.drifted(step_s / 2.0).pulled(self.gravity_m_s2, pull_s);
            pull_s = step_s;
            let answer = Answer::of(self.body, &middle, self.first_end);
            let let_go = self.law.lets_go && self.needs_pull(&answer, slip_m_s);
            let impulse = if let_go { None } else { self.resting_n_s(&answer) };
            slip_m_s = answer.slip_after_m_s(impulse.unwrap_or(Vector { x: 0.0, z: 0.0 }));
            let pushed = impulse.map_or(middle, |i| middle.pushed(self.body, answer.arm_m, i));
            let next = pushed.drifted(step_s / 2.0);
            if self.second_end_strikes(&next) {
                self.end_between(&next, step_s);
                return self.over();
            }
            self.motion = next;
            self.time_s += step_s;
            self.crushed_m = -self.motion.height_m(self.first_end);
            if impulse.is_some() {
                continue;
            }
            // Free from the middle on: gravity's half step of the beginning is made up for.
            self.motion = self.motion.pulled(self.gravity_m_s2, step_s / 2.0);
            if answer.velocity_m_s.z < 0.0 && self.law.friction.is_finite() && !self.law.lets_go {
                // It sinks, and no force of the friction cone holds it: only a pulse stops it (Painlevé).
                return Phase::Pulse;
            }
            self.touchable = self.law.again;
            return Phase::Flight;
        }
        Phase::Over(End::Open)
    }

    /// The impulse of a step at rest, N s; `None` where L lifts off.
    fn resting_n_s(&self, answer: &Answer) -> Option<Vector> {
        let holds = self.law.holds && self.law.k == 0.0;
        if !holds && answer.velocity_m_s.z >= 0.0 && self.law.friction.is_finite() {
            return None;
        }
        let friction = self.law.friction;
        let stuck = answer.holding_n_s();
        let pushes = |normal_n_s: f64| holds || normal_n_s > 0.0;
        let sticks = friction.is_infinite() || stuck.x.abs() <= friction * stuck.z.abs();
        if friction.is_infinite() || (sticks && pushes(stuck.z)) {
            return pushes(stuck.z).then_some(stuck);
        }
        // Sliding: friction against the slip that is left, which is why both ways are tried; a held end may
        // also be pulled.
        for (slip, normal) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
            let (impulse, left_m_s) = answer.sliding_n_s(-slip * normal * friction);
            if left_m_s * slip >= 0.0 && impulse.z * normal >= 0.0 && pushes(impulse.z) {
                return Some(impulse);
            }
        }
        None
    }

    /// Whether L, which slid like this a step ago, does not slide and would have to be pulled to go on so.
    fn needs_pull(&self, answer: &Answer, slip_m_s: f64) -> bool {
        let from_rest = Vector { x: answer.velocity_m_s.x - slip_m_s, ..answer.velocity_m_s };
        let slides = slip_m_s.abs() > self.pace.rest_m_s || self.law.friction == 0.0;
        !slides && Answer { velocity_m_s: from_rest, ..*answer }.holding_n_s().z <= 0.0
    }

    /// The motion where R reaches the target within a step, on the line between its ends.
    fn end_between(&mut self, next: &Motion, step_s: f64) {
        let (before_m, after_m) = (self.motion.height_m(self.second_end), next.height_m(self.second_end));
        let share = (before_m / (before_m - after_m)).clamp(0.0, 1.0);
        let mix = |from: f64, to: f64| from + share * (to - from);
        let now = self.motion;
        self.motion = Motion {
            position_m: Vector {
                x: mix(now.position_m.x, next.position_m.x),
                z: mix(now.position_m.z, next.position_m.z),
            },
            angle_rad: mix(now.angle_rad, next.angle_rad),
            velocity_m_s: Vector {
                x: mix(now.velocity_m_s.x, next.velocity_m_s.x),
                z: mix(now.velocity_m_s.z, next.velocity_m_s.z),
            },
            turn_rad_s: mix(now.turn_rad_s, next.turn_rad_s),
        };
        self.time_s += share * step_s;
    }
}
