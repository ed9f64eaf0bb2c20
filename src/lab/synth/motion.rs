//! Simulates the motion of the cask of a scene, from first contact to past the slap-down.

use super::body::{CASK_STATE, ELASTIC_STATE, SceneBody, WHOLE_STATE};
use super::contact::CornerPassage;
use super::truth::{self, ContactChange};
use crate::lab::data::{ModeStep, MotionStep, Scene, SimulatedMotion, Truth};
use ode_solvers::{Dopri5, OutputType, SVector, System};
use std::f64::consts::FRAC_PI_2;

/// Error of one step, relative and absolute in m, rad and their rates.
///
/// A stiff end unloads within micrometres; a tenth of this tolerance is the rounding of its force at rest.
const TOLERANCE: f64 = 1e-11;

/// Tolerance for an elastic body: its modes of kilohertz alone would require steps of a microsecond.
const ELASTIC_TOLERANCE: f64 = 1e-9;

/// Longest step in the flight, s: the step could miss a graze of g step²/8 = 0.3 µm depth.
const LONGEST_STEP_S: f64 = 5e-4;

/// Longest step times the greatest angular frequency: acceleration interpolated between steps is then within
/// 1e-5.
const LONGEST_STEP_RAD: f64 = 0.1;

/// Longest motion if R does not strike, s.
const LONGEST_S: f64 = 3.0;

/// Bounds on the work for a scene that rattles without end: steps, and changes of a contact.
const MOST_STEPS: usize = 400_000;
const MOST_SWITCHES: usize = 20_000;

/// Halvings of a step in the search of an event: 2^-60 of a step is below the rounding of its times.
const HALVINGS: u32 = 60;

/// The body between two changes of its contacts, for the integrator.
#[derive(Clone, Copy)]
struct Segment<'a> {
    body: &'a SceneBody<'a>,
    tolerance: f64,
    /// True if the integration stops where a contact changes or the cask stands upright.
    watched: bool,
}

impl<const N: usize> System<f64, SVector<f64, N>> for Segment<'_> {
    fn system(&self, _time_s: f64, y: &SVector<f64, N>, rates: &mut SVector<f64, N>) {
        let y = y.as_slice();
        rates.copy_from_slice(&self.body.rates(y, &self.body.loads(y))[..N]);
    }

    fn solout(&mut self, _time_s: f64, y: &SVector<f64, N>, _rates: &SVector<f64, N>) -> bool {
        let y = y.as_slice();
        self.watched && (is_upright(y) || self.body.phase_margins(y).iter().any(|value| *value < 0.0))
    }
}

/// True if the cask stands upright: beyond that the upper corners would strike, which the scene does not
/// model.
fn is_upright(y: &[f64]) -> bool {
    y[2].abs() >= FRAC_PI_2
}

/// Follows the drop from first contact to `after_s` past the slap-down.
///
/// If R does not strike, the motion ends with the cask upright or after 3 s. Bending modes beyond
/// `MOST_MODES` are ignored. The result is the same to the bit at every run.
pub fn simulate(scene: &Scene) -> SimulatedMotion {
    follow(scene, tolerance(scene), usize::MAX)
}

/// Like [`simulate`], but stops without a slap-down if L touches again before R strikes.
///
/// A cask that stands on L while its contents rattle needs hundreds of thousands of steps, which show
/// nothing.
pub fn simulate_one_flight(scene: &Scene) -> SimulatedMotion {
    follow(scene, tolerance(scene), 0)
}

fn tolerance(scene: &Scene) -> f64 {
    if scene.elastic.is_some() { ELASTIC_TOLERANCE } else { TOLERANCE }
}

/// Like [`simulate`] with a given tolerance, so that its convergence can be tested, and with at most `most`
/// returns of L.
///
/// The size of the state enters the integrator's norm of errors: a cask without contents has no places for
/// them.
fn follow(scene: &Scene, tolerance: f64, most: usize) -> SimulatedMotion {
    if scene.elastic.is_some() {
        follow_state::<ELASTIC_STATE>(scene, tolerance, most)
    } else if scene.extras.contents.is_empty() {
        follow_state::<CASK_STATE>(scene, tolerance, most)
    } else {
        follow_state::<WHOLE_STATE>(scene, tolerance, most)
    }
}

fn follow_state<const N: usize>(scene: &Scene, tolerance: f64, most: usize) -> SimulatedMotion {
    let mut body = SceneBody::new(scene);
    let mut events: Vec<ContactChange> = Vec::new();
    let (mut time_s, mut end_s, mut is_over) = (0.0, LONGEST_S, false);
    let mut y = SVector::<f64, N>::from_column_slice(&body.at_first_contact()[..N]);
    // The capacity is the maximum: memory is used only for what is written, whereas a growing vector would
    // leave holes of all sizes.
    let (steps, modes) = (Vec::with_capacity(MOST_STEPS), Vec::with_capacity(MOST_STEPS * body.modes.len()));
    let mut motion = SimulatedMotion { steps, modes, truth: Truth::default() };
    keep(&mut motion, &body, time_s, y.as_slice());
    while time_s < end_s && !is_upright(y.as_slice()) && events.len() < MOST_SWITCHES {
        let segment = Segment { body: &body, tolerance, watched: true };
        let (solver, whole) = segment.integrate(&y, end_s - time_s, MOST_STEPS - motion.steps.len());
        let Some(one_before) = solver.x_out().len().checked_sub(2) else { break };
        let step = |i: usize| (solver.x_out()[i], solver.y_out()[i]);
        let [before, last] = [one_before, one_before + 1].map(step);
        let change = segment.first_change(&before, &last);
        let (offset_s, state) = change.map_or(last, |c| (before.0 + c.after_s, c.state));
        for (offset_s, state) in (1..=one_before).map(step) {
            keep(&mut motion, &body, time_s + offset_s, state.as_slice());
        }
        (time_s, y) = (time_s + offset_s, state);
        let now = y.as_slice();
        keep(&mut motion, &body, time_s, now);
        if let Some(Fallen { watch, .. }) = change {
            let end = watch / 2;
            let passage = body.corners[end].switch(watch % 2, body.corner(end, now).height_m);
            // The state is kept twice, also under the forces of the next phase: acceleration may step.
            keep(&mut motion, &body, time_s, now);
            let struck = events.iter().any(|e| e.end == 1);
            if end == 1 && passage == Some(CornerPassage::Touch) && !struck {
                end_s = time_s + scene.after_s;
            }
            let [corner, local] = [&[][..], &body.ends].map(|modes| body.bent_corner(modes, end, now));
            let state = std::array::from_fn(|i| now[i]);
            events.push(ContactChange { passage, end, time_s, state, corner, local });
            let has_returned = most < usize::MAX && end == 0 && passage == Some(CornerPassage::Touch);
            is_over = has_returned && !struck && truth::contacts(scene, &events, 0).len() > most + 1;
        }
        if !whole || is_over || motion.steps.len() >= MOST_STEPS {
            break;
        }
    }
    motion.truth = truth::truth(scene, &motion, &events);
    motion
}

/// A watch that has fallen below zero.
#[derive(Clone, Copy)]
struct Fallen<const N: usize> {
    /// Since the step before, s.
    after_s: f64,
    watch: usize,
    state: SVector<f64, N>,
}

/// A state, and the time after another at which it is reached, s.
type Reached<const N: usize> = (f64, SVector<f64, N>);

impl Segment<'_> {
    /// The integrator with its steps from `from` on, times from there, and true if it reached its end or a
    /// stop.
    fn integrate<const N: usize>(
        &self,
        from: &SVector<f64, N>,
        span_s: f64,
        most: usize,
    ) -> (Dopri5<f64, SVector<f64, N>, Self>, bool) {
        let longest_s = LONGEST_STEP_S.min(LONGEST_STEP_RAD / self.body.fastest_rad_s());
        let mut solver = Dopri5::from_param(
            *self,
            0.0,
            span_s,
            0.0,
            *from,
            self.tolerance,
            self.tolerance,
            // Safety factor, β and the bounds on the change of step are the method's own defaults.
            0.9,
            0.04,
            0.2,
            10.0,
            longest_s,
            0.0,
            u32::try_from(most).unwrap_or(u32::MAX),
            // A test of stiffness is omitted: the error control alone decides the step.
            u32::MAX,
            OutputType::Sparse,
        );
        let is_whole = solver.integrate().is_ok();
        (solver, is_whole)
    }

    /// The state `offset_s` after `from`.
    fn state_at<const N: usize>(&self, from: &SVector<f64, N>, offset_s: f64) -> SVector<f64, N> {
        if offset_s <= 0.0 {
            return *from;
        }
        let unwatched = Segment { watched: false, ..*self };
        unwatched.integrate(from, offset_s, MOST_STEPS).0.y_out().last().copied().unwrap_or(*from)
    }

    /// The first margin to fall below zero between two steps.
    fn first_change<const N: usize>(&self, before: &Reached<N>, after: &Reached<N>) -> Option<Fallen<N>> {
        let fallen = self.body.phase_margins(after.1.as_slice());
        let change = |watch: usize| {
            // The change is the end of the bracket at which the margin has fallen: the next phase begins in
            // its own range.
            let (mut low_s, mut high_s, mut state) = (0.0, after.0 - before.0, after.1);
            for _ in 0..HALVINGS {
                let middle_s = f64::midpoint(low_s, high_s);
                let there = self.state_at(&before.1, middle_s);
                if self.body.phase_margins(there.as_slice())[watch] < 0.0 {
                    (high_s, state) = (middle_s, there);
                } else {
                    low_s = middle_s;
                }
            }
            Fallen { after_s: high_s, watch, state }
        };
        let changes = (0..fallen.len()).filter(|watch| fallen[*watch] < 0.0).map(change);
        changes.min_by(|a, b| a.after_s.total_cmp(&b.after_s))
    }
}

/// Records the state of one time.
fn keep(motion: &mut SimulatedMotion, body: &SceneBody, time_s: f64, y: &[f64]) {
    let loads_n = body.loads(y);
    let all = body.rates(y, &loads_n);
    let [state, rates] = [y, &all[..]].map(|all| std::array::from_fn(|i| all[i]));
    let heights_m = [0, 1].map(|end| body.corner(end, y).height_m);
    motion.steps.push(MotionStep { time_s, state, rates, loads_n, heights_m });
    let mode = |i| ModeStep { q_m: y[i], rate_m_s: y[i + 1], rate_m_s2: all[i + 1] };
    motion.modes.extend((6..).step_by(2).take(body.modes.len()).map(mode));
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;
