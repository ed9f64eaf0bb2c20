//! The changes of contact of a simulated drop to what a perfect measurement would say of it.

use super::body::{CornerMotion, SceneBody};
use super::contact::CornerPassage;
use crate::lab::data::{ImpactTruth, Scene, SimulatedMotion, Truth};

/// A change of a contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactChange {
    /// Touch or leave; `None` within a contact.
    pub(super) passage: Option<CornerPassage>,
    /// 0 is L, 1 is R.
    pub(super) end: usize,
    /// After first contact, s.
    pub(super) time_s: f64,
    /// The state of the rigid motion there.
    pub(super) state: [f64; 6],
    /// The motion of that end's corner without bending.
    pub(super) corner: CornerMotion,
    /// The same with all that bends.
    pub(super) local: CornerMotion,
}

/// A contact of an end, with the pauses in which bending lifts its corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct ContactSpan<'a> {
    /// After first contact, s.
    from_s: f64,
    /// The change with which it ends; `None` while it lasts.
    left: Option<&'a ContactChange>,
}

/// The first touch of R.
fn strike(events: &[ContactChange]) -> Option<&ContactChange> {
    events.iter().find(|e| e.end == 1 && e.passage == Some(CornerPassage::Touch))
}

/// The contacts of an end, in order, of which L's first begins the drop; [`Truth`] says which pauses part
/// them.
pub(super) fn contacts<'a>(scene: &Scene, events: &'a [ContactChange], end: usize) -> Vec<ContactSpan<'a>> {
    let period_s = scene.elastic.map_or(0.0, |body| 1.0 / body.first_bending_hz);
    let struck_s = strike(events).map_or(f64::INFINITY, |e| e.time_s);
    let mut spans = if end == 0 { vec![ContactSpan { from_s: 0.0, left: None }] } else { Vec::new() };
    for event in events.iter().filter(|e| e.end == end) {
        let is_pause = |span: &ContactSpan| {
            let left_s = span.left.map_or(f64::INFINITY, |left| left.time_s);
            let has_struck = end == 0 && left_s < struck_s && struck_s <= event.time_s;
            event.time_s - left_s < period_s.min(left_s - span.from_s) && !has_struck
        };
        match (event.passage, spans.last_mut()) {
            (Some(CornerPassage::Touch), Some(last)) if is_pause(last) => last.left = None,
            (Some(CornerPassage::Touch), _) => spans.push(ContactSpan { from_s: event.time_s, left: None }),
            (Some(CornerPassage::Leave), Some(last)) => last.left = Some(event),
            _ => {}
        }
    }
    spans
}

/// Reads the truth off the motion and its events, which are in order; without any, only what the scene itself
/// says.
pub(super) fn truth(body: &SceneBody, motion: &SimulatedMotion, events: &[ContactChange]) -> Truth {
    let (scene, strike) = (body.scene, strike(events));
    let [of_first, of_second] = [0, 1].map(|end| contacts(scene, events, end));
    let first = of_first.first().copied();
    let leave = first.and_then(|span| span.left);
    let before_s = strike.map_or(0.0, |e| e.time_s);
    let left_before = leave.filter(|e| e.time_s < before_s).zip(strike);
    let before: Vec<_> = of_first.iter().filter(|span| span.from_s < before_s).collect();
    let is_down = |span: &&&ContactSpan| span.left.is_none_or(|left| left.time_s >= before_s);
    let (v0, cask) = (scene.drop.impact_velocity_m_s, &scene.cask);
    Truth {
        v0,
        // Free of the last digits of the conversion.
        angle_deg: (scene.drop.angle_rad.to_degrees() * 1e9).round() / 1e9,
        k: leave.map(|e| e.corner.rising_m_s / v0),
        rebound_velocity: leave.map(|e| e.corner.rising_m_s),
        contact_s: leave.map(|e| e.time_s),
        omega_rebound: leave.map(|e| -e.state[5]),
        angle_sep_deg: leave.map(|e| e.state[2].to_degrees()),
        vx_corner_after: leave.map(|e| e.corner.sliding_m_s),
        slap_t: strike.map(|e| e.time_s),
        flight_s: left_before.map(|(left, struck)| struck.time_s - left.time_s),
        vx: strike.map(|e| e.corner.sliding_m_s),
        vz: strike.map(|e| e.corner.rising_m_s),
        speed: strike.map(|e| e.corner.sliding_m_s.hypot(e.corner.rising_m_s)),
        local_speed: strike.map(|e| e.local.sliding_m_s.hypot(e.local.rising_m_s)),
        omega: strike.map(|e| -e.state[5]),
        angle_hit_deg: strike.map(|e| e.state[2].to_degrees()),
        energy_ratio: strike.map(|e| kinetic_j(scene, &e.state) / (0.5 * cask.mass_kg * v0 * v0)),
        relands: u32::try_from(before.len().saturating_sub(1)).unwrap_or(u32::MAX),
        first_down_at_slap: strike.is_some() && before.last().is_some_and(|span| is_down(&span)),
        impacts: [(0, first), (1, of_second.first().copied())].map(|(end, span)| {
            span.map_or_else(ImpactTruth::default, |span| impact(body, motion, end, &span))
        }),
    }
}

/// Kinetic energy of the rigid motion, J.
fn kinetic_j(scene: &Scene, y: &[f64; 6]) -> f64 {
    let cask = &scene.cask;
    0.5 * (cask.mass_kg * (y[3] * y[3] + y[4] * y[4]) + cask.inertia_kg_m2 * y[5] * y[5])
}

/// What happens in a contact of an end.
fn impact(body: &SceneBody, motion: &SimulatedMotion, end: usize, span: &ContactSpan) -> ImpactTruth {
    let (mass_kg, gravity_m_s2) = (body.scene.cask.mass_kg, body.scene.drop.gravity_m_s2);
    let until_s = span.left.map_or(f64::INFINITY, |left| left.time_s);
    let [from, to] =
        [motion.count_before(|time_s| time_s < span.from_s), motion.count_before(|time_s| time_s <= until_s)];
    let (mut force_n, mut deceleration_m_s2, mut deepest) = (0.0_f64, 0.0_f64, (0.0, from));
    for (i, step) in (from..to).zip(&motion.steps[from..to]) {
        let (t, n) = step.loads_n[end];
        let (sin, cos) = step.state[2].sin_cos();
        force_n = force_n.max(n);
        deceleration_m_s2 = deceleration_m_s2.max((n * cos - t * sin) / mass_kg);
        let crush_m = if n > 0.0 { -body.corner(end, &motion.state(i)).height_m } else { 0.0 };
        if crush_m > deepest.0 {
            deepest = (crush_m, i);
        }
    }
    let energy_j = |state: &[f64; 6]| kinetic_j(body.scene, state) + mass_kg * gravity_m_s2 * state[1];
    let last = span.left.map_or(&motion.steps[deepest.1].state, |left| &left.state);
    ImpactTruth {
        contact_s: span.left.map(|left| left.time_s - span.from_s),
        crush_m: Some(deepest.0),
        force_n: Some(force_n),
        deceleration_m_s2: Some(deceleration_m_s2),
        energy_j: Some(energy_j(&motion.steps[from].state) - energy_j(last)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::example::anf18;
    use super::*;
    use crate::lab::data::ElasticBody;
    use CornerPassage::{Leave, Touch};

    fn change((end, passage, time_s): (usize, CornerPassage, f64)) -> ContactChange {
        let at = CornerMotion { x_m: 0.0, z_m: 0.0, height_m: 0.0, sliding_m_s: 0.0, rising_m_s: 0.0 };
        ContactChange { passage: Some(passage), end, time_s, state: [0.0; 6], corner: at, local: at }
    }

    #[test]
    fn a_pause_of_a_bending_corner_is_no_flight() {
        let mut scene = anf18();
        // L leaves after 5 ms, touches 3 ms later for 1 ms, then 10 ms later; R strikes for a while.
        let events =
            [(0, Leave, 5e-3), (0, Touch, 8e-3), (0, Leave, 9e-3), (0, Touch, 19e-3), (0, Leave, 20e-3)];
        let events: Vec<ContactChange> = events.into_iter().map(change).collect();
        let ends = |scene: &Scene, events: &[ContactChange]| {
            let spans = contacts(scene, events, 0);
            spans.iter().filter_map(|span| Some(span.left?.time_s)).collect::<Vec<f64>>()
        };
        assert_eq!(ends(&scene, &events), [5e-3, 9e-3, 20e-3], "a body that does not bend");
        scene.elastic = Some(ElasticBody { first_bending_hz: 100.0, damping: 0.01 });
        assert_eq!(ends(&scene, &events), [9e-3, 20e-3], "longer than the contact of 9 ms");
        scene.elastic = Some(ElasticBody { first_bending_hz: 400.0, damping: 0.01 });
        assert_eq!(ends(&scene, &events), [5e-3, 9e-3, 20e-3], "longer than a period of 2.5 ms");
        scene.elastic = Some(ElasticBody { first_bending_hz: 100.0, damping: 0.01 });
        let struck = [(0, Leave, 5e-3), (1, Touch, 6e-3), (0, Touch, 8e-3), (0, Leave, 9e-3)].map(change);
        assert_eq!(ends(&scene, &struck), [5e-3, 9e-3], "R strikes in the pause");
    }
}
