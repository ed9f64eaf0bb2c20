//! Positions of the body in a fall, from its first contact to the slap-down.

use super::super::held::HeldBody;
use super::super::path::Track;
use super::super::state::State;
use super::Fall;
use crate::data::{BodyPath, Contact, Drop, FlightRegime, GRAZE_SHARE, Pose};

/// Places shown between first contact and slap-down, both among them.
const POSES: u32 = 7;

/// The path of a fall at an angle, with an impulse as first impact; `None` if L does not go from its one
/// impact to the slap-down in one flight, or held on the target all the way.
pub(super) fn path(fall: &Fall, angle_deg: f64) -> Option<BodyPath> {
    let (body, drop) = (&fall.body, Drop { contact_duration_s: 0.0, ..fall.drop_at(angle_deg) });
    let start = State::falling(body, drop.angle_rad, &drop);
    let (struck, end) = Track::new(body, &drop, fall.contact, Some(GRAZE_SHARE)).from(&start, &drop, fall.k);
    let (_, flight_s) = end.second_end?;
    let shares = (0..POSES).map(|i| f64::from(i) / f64::from(POSES - 1));
    let from_x_m = start.arms_m(body).0;
    let poses = match (end.regime, fall.contact) {
        (FlightRegime::Free, _) if end.impacts == 1 => shares
            .map(|share| {
                let at = struck.after.after(share * flight_s, drop.gravity_m_s2);
                let along_m = from_x_m + at.horizontal_velocity_m_s * share * flight_s;
                Pose { time_s: share * flight_s, along_m, height_m: at.height_m, angle_rad: at.angle_rad }
            })
            .collect(),
        (FlightRegime::Contact, Contact::Rough | Contact::Smooth) => {
            let slides = fall.contact == Contact::Smooth;
            let held = HeldBody { body, gravity_m_s2: drop.gravity_m_s2, slides, start: struck.after };
            shares
                .map(|share| {
                    let (angle_rad, time_s) = held.state_at_share(share);
                    let (a, b) = State { angle_rad, ..struck.after }.arms_m(body);
                    let slid_m = from_x_m + struck.after.horizontal_velocity_m_s * time_s;
                    Pose { time_s, along_m: if slides { slid_m } else { a }, height_m: b, angle_rad }
                })
                .collect()
        }
        _ => return None,
    };
    Some(BodyPath { body: *body, contact: fall.contact, k: fall.k, poses })
}

#[cfg(test)]
mod tests {
    use super::super::tests::rough_rod;
    use super::*;

    #[test]
    fn a_rough_end_that_is_held_stays_and_a_smooth_bodys_centre_falls_upright() {
        let rod = rough_rod(0.0);
        let smooth = Fall { contact: Contact::Smooth, ..rod };
        for (fall, moves) in
            [(smooth, false), (Fall { k: 1.0, ..smooth }, false), (Fall { k: 1.0, ..rod }, true)]
        {
            let path = path(&fall, 15.0).expect("one way");
            let along: Vec<f64> = path.poses.iter().map(|pose| pose.along_m).collect();
            // [P] Fig. 2: without friction S moves in the vertical only; Fig. 3: with it to R's side.
            assert_eq!(along.iter().any(|x| (x - along[0]).abs() > 1e-9), moves);
            let last = path.poses[6];
            let second_m = last.height_m + fall.body.length_m / 2.0 * last.angle_rad.sin();
            assert!(second_m.abs() < 1e-6, "R is {second_m} m above the target");
            let flight_s = fall.predict(15.0).flight_time_s.expect("R strikes");
            // Simpson with 64 steps: 1e-7 of the time.
            assert!((last.time_s / flight_s - 1.0).abs() < 1e-6);
        }
    }
}
