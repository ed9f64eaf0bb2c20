//! The analytical prediction of rebound, flight and slap-down.
use crate::data::{Body, BodyModel, Cask, Contact, Drop, Prediction};

/// The rod or body of a cask.
#[must_use]
pub fn body(cask: &Cask, model: BodyModel) -> Body {
    match model {
        BodyModel::Rod => Body {
            model,
            mass_kg: cask.mass_kg,
            length_m: cask.length_m,
            height_m: 0.0,
            cog_m: cask.length_m / 2.0,
            inertia_kg_m2: cask.mass_kg * cask.length_m.powi(2) / 12.0,
        },
        BodyModel::Body => Body {
            model,
            mass_kg: cask.mass_kg,
            length_m: cask.length_m,
            height_m: cask.height_m,
            cog_m: cask.cog_m,
            inertia_kg_m2: cask.inertia_kg_m2,
        },
    }
}

/// First impact, flight and slap-down of `body` with restitution `k`.
#[must_use]
pub fn predict(body: &Body, drop: &Drop, contact: Contact, k: f64) -> Prediction {
    let _ = drop;
    Prediction {
        model: body.model,
        contact,
        k,
        slap_down_speed_m_s: None,
        vertical_velocity_m_s: None,
        horizontal_velocity_m_s: None,
        angular_velocity_rad_s: 0.0,
        flight_time_s: None,
        energy_ratio: None,
        slap_down_angle_deg: None,
        first_end_impacts: 1,
        impulse_ratio: 0.0,
    }
}
