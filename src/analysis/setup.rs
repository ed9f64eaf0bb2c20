//! Reads geometry, initial motion and the contact law from a cask file.

use crate::data::{AssumedFriction, AxialSource, CONTACT_STEPS, CaskFile, Contact, Setup};

/// Estimate of a friction that is not stated, as a share of the friction that sticking needs: the middle of
/// the effects of 0.1 and more, with a standard uncertainty that includes no friction and sticking. It also
/// applies to the impulse ratio under a stated coefficient, since an end that yields along the target springs
/// back along it (Maw, Barber & Fawcett 1976).
const MIDDLE: f64 = 0.6;
const U_UNKNOWN: f64 = 0.33;

/// Determines the axial velocity of a contact without an axial channel from its contact law. The friction is
/// known to `file.tolerances`; sticking needs a friction of `needed`, and more has no further effect.
pub(super) fn apply_law(file: &CaskFile, contact: Contact, needed: f64) -> (AxialSource, AssumedFriction) {
    let share_u = file.tolerances.friction / 2.0;
    let sliding = |friction: f64| AxialSource::Sliding { friction };
    let (axial, ratio, u) = match contact {
        Contact::Rough => (AxialSource::Sticking, needed, share_u * needed),
        Contact::Smooth => (sliding(0.0), 0.0, share_u * needed),
        Contact::Coulomb(mu) if file.has_open_friction() => {
            let limit = needed.clamp(-mu, mu);
            (sliding(MIDDLE * limit), MIDDLE * limit, U_UNKNOWN * limit)
        }
        Contact::Coulomb(mu) if mu < needed.abs() => {
            let friction = mu * needed.signum();
            (sliding(friction), friction, share_u * mu)
        }
        Contact::Coulomb(mu) => {
            let missing = (needed.abs() - (1.0 - 2.0 * share_u) * mu).max(0.0);
            (AxialSource::Sticking, needed, missing / 2.0)
        }
        Contact::Unknown => (sliding(MIDDLE * needed), MIDDLE * needed, U_UNKNOWN * needed),
    };
    (axial, AssumedFriction { ratio, u: u.abs() })
}

/// Sets up geometry and initial motion of a cask file, with L sticking to the target.
pub fn sticking(cask_file: &CaskFile) -> Setup {
    Setup {
        length_m: cask_file.cask.length_m,
        height_m: cask_file.cask.height_m,
        cog_m: cask_file.cask.cog_m,
        angle_rad: cask_file.drop.angle_rad,
        impact_velocity_m_s: cask_file.drop.impact_velocity_m_s,
        is_of_fall: !cask_file.drop.impact_velocity_given,
        angular_velocity_rad_s: cask_file.drop.angular_velocity_rad_s,
        horizontal_velocity_m_s: cask_file.drop.horizontal_velocity_m_s,
        gravity_m_s2: cask_file.drop.gravity_m_s2,
        axial: AxialSource::Sticking,
        inward: 0.0,
        second_s: 1.0,
        contact_steps: CONTACT_STEPS,
    }
}
