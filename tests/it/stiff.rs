//! From the predictions to their distance from drops that `lab::synth` steps on ends that crush, over angle,
//! k, friction and bodies.
//!
//! `synth` knows forces alone. On stiff ends each drop is stepped with a contact of a length and with one of
//! half of it. What is left is of first order in the length (gravity and the turn while a pulse lasts, the
//! depth of the crush), so that twice the second less the first is the limit, and their difference says
//! whether it has been reached.

use dropcheck::data::{Body, BodyModel, Cask, Contact, Drop, End, Prediction, Rung};
use dropcheck::lab::data::{CrushableEnd, Scene, SceneExtras, Truth, WantedImpact};
use dropcheck::lab::synth;
use dropcheck::predict::{body, predict_by, predict_grazing};
use rayon::prelude::*;

/// Length of a stiff contact, s.
const STIFF_S: f64 = 2e-5;

/// The same where L may come to rest on it, which has to be stepped as finely as a contact: longer; and k of
/// an impact that stands for none.
const RESTED_S: f64 = 2e-3;
const RESTED_K: f64 = 4e-3;

/// A case is decided where the two lengths agree this well, as a share of the speed, of the time and of a
/// radian; and with k = 0.
const CONVERGED: [f64; 2] = [2e-3, 2e-2];

/// How far a prediction may be from the limit, as such a share; and with k = 0.
const AGREES: [f64; 2] = [1e-3, 4e-3];

/// Further impacts than these use up the digits.
const MOST_RETURNS: u32 = 12;

const ANGLES_DEG: [f64; 7] = [5.0, 10.0, 15.0, 25.0, 35.0, 45.0, 60.0];
const CONTACTS: [Contact; 5] =
    [Contact::Rough, Contact::Coulomb(0.6), Contact::Coulomb(0.3), Contact::Coulomb(0.1), Contact::Smooth];

struct Case {
    cask: Cask,
    angle_deg: f64,
    contact: Contact,
    k: f64,
}

/// The grid for four bodies from 9 m.
fn cases(restitutions: &[f64]) -> Vec<Case> {
    let anf_18 = Cask::block("ANF-18", 4466.0, 5.512, 0.792);
    let casks = [
        Cask::block("rod", 4466.0, 5.512, 0.0),
        Cask::block("VHLW", 20_950.0, 4.486, 1.156),
        Cask { name: "lopsided".to_owned(), cog_m: 2.4, inertia_kg_m2: 10_800.0, ..anf_18.clone() },
        anf_18,
    ];
    let mut cases = Vec::new();
    for cask in &casks {
        for (angle_deg, contact) in ANGLES_DEG.into_iter().flat_map(|a| CONTACTS.map(|contact| (a, contact)))
        {
            cases.extend(restitutions.iter().map(|&k| Case { cask: cask.clone(), angle_deg, contact, k }));
        }
    }
    cases
}

impl Case {
    fn words(&self) -> String {
        format!("{} {}° k {} friction {}", self.cask.name, self.angle_deg, self.k, self.contact)
    }

    fn body(&self) -> Body {
        body(&self.cask, if self.cask.height_m > 0.0 { BodyModel::Body } else { BodyModel::Rod })
    }

    fn drop(&self) -> Drop {
        Drop::from_height(9.0, self.angle_deg.to_radians())
    }

    /// What becomes of the drop whose first contact lasts so long.
    fn stepped(&self, duration_s: f64, restitution: f64) -> Truth {
        let (cask, drop) = (self.cask.clone(), self.drop());
        let wanted = WantedImpact { duration_s, restitution, yield_share: None };
        let scene = Scene {
            name: String::new(),
            seed: 1,
            first_end: synth::crushable_end(&cask, &drop, self.contact, End::First, wanted),
            second_end: CrushableEnd { loading_n_m: 1e9, unloading_n_m: 1e9, ..CrushableEnd::default() },
            contact: self.contact,
            modes: vec![],
            elastic: None,
            before_s: 0.0,
            after_s: 0.0,
            rest: false,
            clock_error: 0.0,
            swapped_ends: false,
            channels: vec![],
            extras: SceneExtras::default(),
            cask,
            drop,
        };
        synth::simulate(&scene).truth
    }
}

/// Speed and velocities of R, m/s, time, s, and angle at the slap-down, rad.
type Numbers = [f64; 5];

fn numbers_of_truth(t: &Truth) -> Option<Numbers> {
    Some([t.speed?, t.vx?, t.vz?, t.slap_t?, t.angle_hit_deg?.to_radians()])
}

fn numbers_of_prediction(p: &Prediction) -> Option<Numbers> {
    let [speed, along, up] = [p.slap_down_speed_m_s, p.horizontal_velocity_m_s, p.vertical_velocity_m_s];
    Some([speed?, along?, up?, p.flight_time_s?, p.slap_down_angle_deg?.to_radians()])
}

fn are_near(a: &Numbers, b: &Numbers, share: f64) -> bool {
    let scales = [b[0], b[0], b[0], b[3], 1.0];
    a.iter().zip(b).zip(scales).all(|((a, b), scale)| (a - b).abs() <= share * scale)
}

/// Whether the highest rung, to which every touch is an impact, is the limit; `None` where two lengths do not
/// decide.
fn compared(case: &Case) -> Option<Result<(), String>> {
    let is_rest = case.k == 0.0;
    let [coarse, fine] = [1.0, 0.5].map(|share| {
        let contact_s = if is_rest { RESTED_S } else { STIFF_S };
        case.stepped(share * contact_s, if is_rest { share * RESTED_K } else { case.k })
    });
    let prediction = predict_grazing(&case.body(), &case.drop(), case.contact, case.k, 0.0);
    let returns = (!is_rest).then_some(fine.relands);
    if !is_rest && (coarse.relands != fine.relands || fine.relands > MOST_RETURNS) {
        return None;
    }
    let told = numbers_of_prediction(&prediction);
    let [Some(coarse), Some(fine)] = [&coarse, &fine].map(numbers_of_truth) else {
        // The stepping ends with the cask upright, and says no more of one that turns over.
        return told.is_none().then_some(Ok(()));
    };
    if !are_near(&coarse, &fine, CONVERGED[usize::from(is_rest)]) {
        return None;
    }
    let limit: Numbers = std::array::from_fn(|i| 2.0 * fine[i] - coarse[i]);
    let is_right = told.is_some_and(|told| are_near(&told, &limit, AGREES[usize::from(is_rest)]))
        && returns.is_none_or(|returns| prediction.first_end_impacts == returns + 1);
    let words = || format!("{}: {told:?}, stepped {limit:?}, {returns:?} returns", case.words());
    Some(if is_right { Ok(()) } else { Err(words()) })
}

/// Compares all cases, of which at least so many must be decided and at most so many differ.
fn hold(cases: &[Case], least_decided: usize, most_differ: usize) {
    let compared: Vec<_> = cases.par_iter().filter_map(compared).collect();
    println!("{} of {} decided", compared.len(), cases.len());
    let differ: Vec<&str> = compared.iter().filter_map(|case| Some(case.as_ref().err()?.as_str())).collect();
    assert!(
        differ.len() <= most_differ,
        "{} of {} differ:\n{}",
        differ.len(),
        cases.len(),
        differ.join("\n")
    );
    assert!(compared.len() >= least_decided, "only {} of {} decided", compared.len(), cases.len());
}

#[test]
fn the_prediction_is_the_limit_of_stiff_ends() {
    hold(&cases(&[0.2, 0.5, 0.8, 1.0]), 530, 0);
}

/// With k = 0 L flies where it would have to be pulled, slides on or rests. One rough end at rest would have
/// to be pulled to stick and yet sinks when let go: its hops grow out of nothing, so that no limit exists.
#[test]
fn without_rebound_it_is_the_limit_of_ends_that_give_nothing_back() {
    let is_held = |case: &Case| {
        let is_steep = (15.0..=35.0).contains(&case.angle_deg);
        is_steep && case.cask.name != "rod" && case.contact != Contact::Coulomb(0.1)
    };
    hold(&cases(&[0.0]).into_iter().filter(is_held).collect::<Vec<_>>(), 36, 1);
}

/// A half-sine of the stepped length in place of its pulse, which grows as a quarter sine and springs back k
/// times as fast. Left is a tenth of what the length changes where L sticks all the way, a third where it
/// slides; and 0.1 and 0.3 % of the speed.
#[test]
fn a_pulse_of_finite_length_is_that_of_a_soft_contact() {
    let cases: Vec<Case> =
        cases(&[0.2, 0.5, 0.8]).into_iter().filter(|case| case.angle_deg <= 45.0).collect();
    let pulses =
        cases.par_iter().flat_map_iter(|case| [2e-3, 1e-2, 2e-2].map(|duration_s| (case, duration_s)));
    let changes: Vec<f64> = pulses
        .filter_map(|(case, duration_s)| {
            let truth = case.stepped(duration_s, case.k);
            let (contact_duration_s, k, speed) = (truth.contact_s?, truth.k?, truth.speed?);
            if truth.relands > 0 || truth.slap_t? < contact_duration_s + 2e-3 {
                return None;
            }
            let drop = Drop { contact_duration_s, ..case.drop() };
            let off = |rung| {
                let prediction = predict_by(rung, &case.body(), &drop, case.contact, k);
                let is_one_flight = prediction.first_end_impacts == 1;
                Some((prediction.slap_down_speed_m_s.filter(|_| is_one_flight)? / speed - 1.0).abs())
            };
            let (changes, left) = (off(Rung::FurtherImpacts)?, off(Rung::FinitePulse)?);
            let (share, least) = if case.contact == Contact::Rough { (0.1, 1e-3) } else { (0.3, 3e-3) };
            assert!(
                left <= share * changes + least,
                "{} T {duration_s}: {changes:.4} {left:.4}",
                case.words()
            );
            Some(changes)
        })
        .collect();
    let most = changes.iter().copied().fold(0.0, f64::max);
    assert!(changes.len() > 700 && most > 0.1, "{} {most}", changes.len());
}
