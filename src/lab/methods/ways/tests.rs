//! Drops of a class to how far off first contact and the flight fit are, held by bounds that theory gives.

use super::*;
use crate::data::{CoarseEvent, Signal};
use crate::lab::data::Scene;
use crate::lab::drawn::DrawnDrop;
use crate::{condition, events, lab::synth, motion};

const REQUEST: TrialRequest = TrialRequest { quick: true, seed: 1 };

/// A recording up to where first contact is sought.
struct Prepared {
    drop: DrawnDrop,
    signals: Vec<Signal>,
    coarse: CoarseEvent,
    /// True first contact, s from the first sample.
    contact_s: f64,
}

/// The recordings of a class, read and conditioned.
fn prepared(class: &DropClass, count: u64) -> Vec<Prepared> {
    let prepared = |plan: &DropPlan| {
        let drop = plan.draw();
        let written = drop.record();
        let (recording, file) = (drop.read(&written).expect("a recording that is read"), &drop.stated);
        let velocity_m_s = file.drop.transverse_velocity_m_s();
        let coarse = events::Changes::new(&recording.channels).locate(velocity_m_s).expect("an impact");
        let reach = condition::Reach::for_drop(&file.cask, &file.drop);
        let (signals, _) = condition::condition(&recording, &coarse, &reach, file.corrections);
        Prepared { contact_s: written.first_contact_s, signals, coarse, drop }
    };
    class.plans(count, &REQUEST).par_iter().map(prepared).collect()
}

/// The largest error but one in twenty.
fn p95(mut errors: Vec<f64>) -> f64 {
    errors.sort_by(f64::total_cmp);
    errors[(95 * (errors.len() - 1)).div_ceil(100)]
}

#[test]
fn first_contact_is_found() {
    // The chord of a pulse's rise from 2 % to 30 % meets zero within 1 % of its length. 5 g of noise over the
    // slope π peak/T of 400 g add 0.4 % of the length, three times that at the 95th percentile; a rise of 25
    // samples a pulse is known to half a sample.
    let classes: [(DropClass, f64); 5] = [
        (
            DropClass {
                name: "clean, 100 kHz",
                make: |plan, _, _| {
                    plan.rate_hz = 1e5;
                    plan.chain.white_noise_m_s2 = 0.02 * STANDARD_GRAVITY_M_S2;
                },
            },
            1.0,
        ),
        (NOISY, 2.2),
        (DropClass { name: "20 ms pulse", make: |plan, _, _| plan.ends[0].duration_s = 0.02 }, 1.0),
        (
            DropClass {
                name: "25 a pulse",
                make: |plan, _, _| plan.rate_hz = 25.0 / plan.ends[0].duration_s,
            },
            2.0,
        ),
        (
            DropClass {
                name: "force plateau",
                make: |plan, _, share| plan.ends[0].yield_share = Some(0.4 + 0.4 * share),
            },
            1.0,
        ),
    ];
    for (class, bound_percent) in classes {
        let error_percent = |drop: Prepared| {
            let found = events::first_contact(&drop.signals, &drop.coarse).expect("a first contact");
            100.0 * (found.time_s - drop.contact_s).abs() / drop.drop.contact_s()
        };
        let worst = p95(prepared(&class, 12).into_iter().map(error_percent).collect());
        assert!(worst < bound_percent, "{}: {worst} % of the pulse", class.name);
    }
}

/// ∫ of the rigid body's specific force over the contact at each channel, m/s: trapezoids of a
/// five-thousandth, off by 1e-7 of it.
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

/// How far off the flight fit leaves the worst channel's velocity step, % of the step.
fn step_error_percent(of: &Prepared) -> f64 {
    let (truth, cog_m) = (of.drop.motion.truth, of.drop.stated.cask.cog_m);
    let (length_s, slap_s) = truth.contact_s.zip(truth.slap_t).expect("a slap-down");
    let left_s = of.contact_s + length_s;
    let window = motion::Window {
        from_s: left_s + 0.1 * length_s + 3e-4,
        to_s: of.contact_s + slap_s - 5e-4,
        drift: true,
        angular_velocity_rad_s: truth.omega_rebound.expect("a separation"),
    };
    let integrated = motion::Integrated::new(&of.signals, of.contact_s);
    let drive = motion::contact_drive(&integrated, None, left_s, window.from_s, cog_m, 0.0);
    let fit = motion::fit_flights(&integrated, &window, drive.as_ref(), cog_m, 3).swap_remove(0);
    let steps_m_s = velocity_steps_m_s(&of.drop.scene, length_s);
    let off = |(found_m_s, step_m_s): (f64, &f64)| 100.0 * (found_m_s - step_m_s).abs() / step_m_s.abs();
    fit.plateaus.iter().map(|p| p.velocity_step_m_s).zip(&steps_m_s).map(off).fold(0.0, f64::max)
}

#[test]
fn the_flight_fit_tells_ringing_from_the_step() {
    let two_modes = DropClass {
        name: "two modes",
        make: |plan, flight_s, share| {
            let frequency_hz = (2.0 + 2.0 * share) / flight_s;
            plan.modes = vec![DropPlan::mode(1, frequency_hz), DropPlan::mode(2, 2.757 * frequency_hz)];
        },
    };
    // Noise of 0.1 g at 20 kHz gathers 0.98 √((T + L/3)/20 000) = 1.1e-3 m/s by the middle of a flight of 60
    // ms; three times that of a step of 1 m/s is 0.33 %, of 5 g fifty times as much. A mode's mean is known
    // to 0.5 % of it.
    for (class, bound_percent) in
        [(CALM, 0.5), (NOISY, 16.5), (ONE_MODE, 0.5), (two_modes, 0.5), (SWINGING, 0.5)]
    {
        let worst = p95(prepared(&class, 8).iter().map(step_error_percent).collect());
        assert!(worst < bound_percent, "{}: {worst} % of the step", class.name);
    }
}

#[test]
fn quantiles_are_values_of_drops() {
    let bits = |values: [f64; 2]| values.map(f64::to_bits);
    assert_eq!(bits(median_and_p95(vec![3.0, 1.0, 2.0])), bits([2.0, 3.0]));
    assert_eq!(bits(median_and_p95(vec![f64::NAN, 1.0])), bits([1.0, f64::NAN]));
    assert!(median_and_p95(Vec::new()).iter().all(|error| error.is_nan()));
}
