//! Derives the results of a perfect measurement from the changes of contact of a simulated drop.

use super::body::CornerMotion;
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
    /// Motion of the corner including bending.
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
fn second_end_touch(events: &[ContactChange]) -> Option<&ContactChange> {
    events.iter().find(|e| e.end == 1 && e.passage == Some(CornerPassage::Touch))
}

/// Contacts of an end, in order; L's first begins the drop, and [`Truth`] defines the pauses that separate
/// them.
pub(super) fn contacts<'a>(scene: &Scene, events: &'a [ContactChange], end: usize) -> Vec<ContactSpan<'a>> {
    let period_s = scene.elastic.map_or(0.0, |body| 1.0 / body.first_bending_hz);
    let struck_s = second_end_touch(events).map_or(f64::INFINITY, |e| e.time_s);
    let begun = |from_s| ContactSpan { from_s, left: None };
    let mut spans: Vec<ContactSpan> = (end == 0).then(|| begun(0.0)).into_iter().collect();
    for event in events.iter().filter(|e| e.end == end) {
        let Some(passage) = event.passage else { continue };
        let last = spans.last_mut();
        let is_pause = last.as_ref().and_then(|span| Some((span.from_s, span.left?.time_s))).is_some_and(
            |(from_s, left_s)| {
                let has_struck = end == 0 && left_s < struck_s && struck_s <= event.time_s;
                event.time_s - left_s < period_s.min(left_s - from_s) && !has_struck
            },
        );
        match (passage, last) {
            (CornerPassage::Leave, Some(last)) => last.left = Some(event),
            (CornerPassage::Touch, Some(last)) if is_pause => last.left = None,
            _ => spans.push(begun(event.time_s)),
        }
    }
    spans
}

/// Reads the truth off the motion and its events, which are in order; without events, only the values that
/// the scene itself states.
pub(super) fn truth(scene: &Scene, motion: &SimulatedMotion, events: &[ContactChange]) -> Truth {
    let strike = second_end_touch(events);
    let [of_first, of_second] = [0, 1].map(|end| contacts(scene, events, end));
    let leave = of_first.first().and_then(|span| span.left);
    let before_s = strike.map_or(0.0, |e| e.time_s);
    let left_before = leave.filter(|e| e.time_s < before_s).zip(strike);
    let before: Vec<_> = of_first.iter().filter(|span| span.from_s < before_s).collect();
    let is_down = |span: &&&ContactSpan| span.left.is_none_or(|left| left.time_s >= before_s);
    let (v0, cask) = (scene.drop.impact_velocity_m_s, &scene.cask);
    Truth {
        v0,
        // The last digits of the conversion are rounded off.
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
        impacts: [(0, &of_first), (1, &of_second)]
            .map(|(end, spans)| spans.first().and_then(|span| impact(scene, motion, end, span))),
    }
}

/// Kinetic energy of the rigid motion, J.
fn kinetic_j(scene: &Scene, y: &[f64; 6]) -> f64 {
    let cask = &scene.cask;
    0.5 * (cask.mass_kg * (y[3] * y[3] + y[4] * y[4]) + cask.inertia_kg_m2 * y[5] * y[5])
}

/// Impact of an end in one contact.
fn impact(scene: &Scene, motion: &SimulatedMotion, end: usize, span: &ContactSpan) -> Option<ImpactTruth> {
    let until_s = span.left.map_or(f64::INFINITY, |left| left.time_s);
    let from = motion.count_before(|time_s| time_s < span.from_s);
    let to = motion.count_before(|time_s| time_s <= until_s);
    let steps = &motion.steps[from..to];
    let deepest = steps.iter().min_by(|a, b| a.heights_m[end].total_cmp(&b.heights_m[end]))?;
    let weight_n = scene.cask.mass_kg * scene.drop.gravity_m_s2;
    let energy_j = |state: &[f64; 6]| kinetic_j(scene, state) + weight_n * state[1];
    let last = span.left.map_or(&deepest.state, |left| &left.state);
    Some(ImpactTruth {
        contact_s: span.left.map(|left| left.time_s - span.from_s),
        crush_m: -deepest.heights_m[end],
        force_n: steps.iter().map(|step| step.loads_n[end].1).fold(0.0, f64::max),
        energy_j: energy_j(&steps[0].state) - energy_j(last),
    })
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
