//! Predictions over angle and k to the map of what happens, and so of where the closed forms of the paper hold.

use super::{Fall, richest};
use crate::data::{CaskFile, Contact, FlightRegime, Prediction, Regime, RegimeMap};
use rayon::prelude::*;

/// Steps of k from 0 to 1.
const K_STEPS: u32 = 100;

/// The richest body's map for every contact law, k from 0 to 1 in steps of 0.01.
pub(super) fn maps(cask_file: &CaskFile, contacts: &[Contact], angles_deg: &[f64]) -> Vec<RegimeMap> {
    let (body, drop) = (richest(cask_file), cask_file.drop);
    let k: Vec<f64> = (0..=K_STEPS).map(|i| f64::from(i) / f64::from(K_STEPS)).collect();
    let map = |&contact: &Contact| RegimeMap {
        model: body.model,
        contact,
        angle_deg: angles_deg.to_vec(),
        regimes: k
            .par_iter()
            .map(|&k| {
                let fall = Fall { body, drop, contact, k };
                angles_deg.iter().map(|&angle_deg| regime(&fall.at(angle_deg))).collect()
            })
            .collect(),
        k: k.clone(),
    };
    contacts.iter().map(map).collect()
}

/// What a prediction shows. For k = 0 the closed form of Table 2 holds only if contact is kept all the way.
fn regime(prediction: &Prediction) -> Regime {
    match prediction {
        Prediction { slap_down_speed_m_s: None, .. } => Regime::NoSlapDown,
        Prediction { first_end_impacts: 2.., .. } => Regime::FurtherImpacts,
        Prediction { k, regime: FlightRegime::Contact, .. } if *k <= 0.0 => Regime::ClosedForm,
        Prediction { k, .. } if *k <= 0.0 => Regime::LiftOff,
        _ => Regime::ClosedForm,
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{cask_file, steps};
    use super::*;

    /// The regime at an angle, degrees, and k in hundredths.
    fn at(height_m: f64, angle_deg: u8, hundredths: usize) -> Regime {
        let map = &maps(&cask_file(height_m), &[Contact::Rough], &steps(90, 90.0))[0];
        map.regimes[hundredths][usize::from(angle_deg)]
    }

    #[test]
    fn the_map_shows_what_the_closed_forms_need() {
        assert_eq!(at(0.0, 15, 50), Regime::ClosedForm);
        // The pivot would need −0.59 m g.
        assert_eq!(at(0.0, 15, 0), Regime::LiftOff);
        // L again before R: rod at 60° for k ≥ 0.7, a section of 0.792 m at 45° for k ≥ 0.8; not all of these end in a slap-down.
        let again = |regime: Regime| matches!(regime, Regime::FurtherImpacts | Regime::NoSlapDown);
        assert!(again(at(0.0, 60, 80)) && again(at(0.792, 45, 100)));
        assert_eq!(at(0.0, 60, 60), Regime::ClosedForm);
        // Small rebounds that die out before R strikes.
        assert_eq!(at(0.792, 70, 10), Regime::FurtherImpacts);
        assert_eq!(at(0.792, 90, 10), Regime::NoSlapDown);
        assert_eq!(at(0.792, 45, 50), Regime::ClosedForm);
    }

    #[test]
    fn the_map_is_as_wide_as_the_angles_and_as_high_as_k() {
        let map = &maps(&cask_file(0.0), &[Contact::Smooth], &steps(9, 90.0))[0];
        assert_eq!((map.k.len(), map.k[0], map.k[100]), (101, 0.0, 1.0));
        assert_eq!(map.regimes.len(), 101);
        assert!(map.regimes.iter().all(|row| row.len() == 10));
    }
}
