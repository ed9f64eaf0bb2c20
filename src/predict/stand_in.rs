//! Stand-in for the study, dropped by the merge.

use crate::data::{
    CaskFile, Contact, Drop, MonteCarlo, PredictionRow, Request, Study, SweepVariable, Uncertain,
};

/// Stand-in.
#[must_use]
pub fn default_uncertain(_file: &CaskFile) -> Uncertain {
    Uncertain {
        k: (0.0, 1.0),
        friction: None,
        angle_deg: 0.5,
        drop_height: 0.0,
        size: 0.005,
        cog: 0.005,
        inertia: 0.02,
        draws: 1000,
        seed: 1,
    }
}

/// Stand-in.
#[must_use]
pub fn study(file: &CaskFile, request: &Request) -> Study {
    let of = |v: SweepVariable| request.sweeps.iter().find(|s| s.variable == v).map(|s| s.values.clone());
    let angles = of(SweepVariable::Angle).unwrap_or_else(|| vec![request.angle_deg]);
    let ks = of(SweepVariable::K).unwrap_or_else(|| request.ks.clone());
    let contacts = of(SweepVariable::Friction)
        .map_or_else(|| request.contacts.clone(), |f| f.into_iter().map(Contact::Coulomb).collect());
    let lengths = of(SweepVariable::Length).unwrap_or_else(|| vec![file.cask.length_m]);
    let heights = of(SweepVariable::DropHeight).unwrap_or_else(|| vec![file.drop.height_m]);
    let mut rows = Vec::new();
    for &angle_deg in &angles {
        for &length_m in &lengths {
            for &drop_height_m in &heights {
                for body in super::bodies(&file.cask) {
                    for &contact in &contacts {
                        for &k in &ks {
                            let drop = Drop { angle_rad: angle_deg.to_radians(), ..file.drop };
                            rows.push(PredictionRow {
                                angle_deg,
                                length_m,
                                drop_height_m,
                                prediction: super::predict(&body, &drop, contact, k),
                            });
                        }
                    }
                }
            }
        }
    }
    Study {
        cask_file: file.clone(),
        request: request.clone(),
        rows,
        ladders: vec![],
        curves: vec![],
        sections: vec![],
        critical: vec![],
        ranges: vec![],
        monte_carlo: MonteCarlo {
            model: crate::data::BodyModel::Rod,
            contact: file.contact,
            uncertain: request.uncertain,
            band_percent: request.band_percent,
            angle_deg: vec![],
            no_slap_down: vec![],
            quantiles: vec![],
        },
        sensitivities: vec![],
        maps: vec![],
    }
}
