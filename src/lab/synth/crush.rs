//! Stiffnesses of an end that give a requested pulse and restitution.

use crate::data::{Cask, Contact, Drop, End};
use crate::lab::data::{CrushableEnd, WantedImpact};
use std::f64::consts::FRAC_PI_2;

/// The end whose impact is `pulse`: K = m_eff (π/2 (1 + k)/T)², K_u = K/k².
///
/// m_eff is the effective mass of the corner of `end`: for L at the drop angle under `contact`; for R with
/// the axis flat and sliding freely. The rotation of the body and gravity during the pulse are neglected.
pub fn crushable_end(
    cask: &Cask,
    drop: &Drop,
    contact: Contact,
    end: End,
    pulse: WantedImpact,
) -> CrushableEnd {
    let (reach_m, angle_rad, contact) = match end {
        End::First => (cask.cog_m, drop.angle_rad, contact),
        End::Second => (cask.length_m - cask.cog_m, 0.0, Contact::Smooth),
    };
    let (sin, cos) = angle_rad.sin_cos();
    let across_m = reach_m * cos - cask.height_m / 2.0 * sin;
    let up_m = reach_m * sin + cask.height_m / 2.0 * cos;
    // A newton changes the corner's motion by this much: upwards and along the target for a normal one, along
    // the target for a tangential one.
    let upwards = 1.0 / cask.mass_kg + across_m * across_m / cask.inertia_kg_m2;
    let crosswise = across_m * up_m / cask.inertia_kg_m2;
    let along = 1.0 / cask.mass_kg + up_m * up_m / cask.inertia_kg_m2;
    let sticking = crosswise / along;
    let friction = match contact {
        Contact::Rough | Contact::Unknown => sticking,
        Contact::Smooth => 0.0,
        // Friction beyond the need of sticking has no effect.
        Contact::Coulomb(coefficient) => sticking.signum() * coefficient.min(sticking.abs()),
    };
    let effective_kg = 1.0 / (upwards - friction * crosswise);
    let k = pulse.restitution;
    let loading_n_m = effective_kg * (FRAC_PI_2 * (1.0 + k) / pulse.duration_s).powi(2);
    let peak_n = drop.impact_velocity_m_s * (loading_n_m * effective_kg).sqrt();
    CrushableEnd {
        loading_n_m,
        unloading_n_m: loading_n_m / (k * k),
        yield_n: pulse.yield_share.map(|share| share * peak_n),
        ..CrushableEnd::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::synth::{example, simulate};

    #[test]
    fn the_end_gives_the_pulse_and_the_restitution_asked_for() {
        for contact in [Contact::Rough, Contact::Smooth, Contact::Coulomb(0.2)] {
            let mut scene = example::anf18();
            scene.contact = contact;
            let pulse = WantedImpact { duration_s: 2e-4, restitution: 0.4, yield_share: None };
            scene.first_end = crushable_end(&scene.cask, &scene.drop, contact, End::First, pulse);
            let truth = simulate(&scene).truth;
            // Left out: the turn within the pulse, φ̇ T = 1e-3 rad on arms of m, and g T = 2e-3 m/s of 13.3
            // m/s.
            let contact_s = truth.contact_s.expect("L leaves");
            let k = truth.k.expect("L leaves");
            assert!((contact_s / 2e-4 - 1.0).abs() < 5e-3, "{contact}: {contact_s} s");
            assert!((k - 0.4).abs() < 2e-3, "{contact}: {k}");
        }
    }

    #[test]
    fn the_yield_force_is_a_share_of_the_peak() {
        let mut scene = example::anf18();
        scene.contact = Contact::Smooth;
        let pulse = WantedImpact { duration_s: 2e-4, restitution: 0.4, yield_share: Some(0.5) };
        let yielding = crushable_end(&scene.cask, &scene.drop, scene.contact, End::First, pulse);
        let elastic = CrushableEnd { yield_n: None, ..yielding };
        let peak_n = |end: CrushableEnd, scene: &mut crate::lab::data::Scene| {
            scene.first_end = end;
            simulate(scene).steps.iter().map(|step| step.loads_n[0].1).fold(0.0, f64::max)
        };
        let share = peak_n(yielding, &mut scene) / peak_n(elastic, &mut scene);
        assert!((share - 0.5).abs() < 2e-3, "{share}");
    }
}
