//! A cask file to geometry and initial motion.

use crate::data::{AssumedFriction, AxialSource, CONTACT_STEPS, CaskFile, Contact, Setup};

/// A friction that nobody states lies between none and what sticking needs, and more than that does as much:
/// in the middle of what 0.1 and more give, as a share of what sticking needs, and with a standard
/// uncertainty that takes both ends in. So does the impulse ratio under a stated coefficient, as a share of
/// it: an end that gives along the target springs back along it (Maw, Barber & Fawcett 1976).
const MIDDLE: f64 = 0.6;
const U_UNKNOWN: f64 = 0.33;

/// The axial velocity of a contact without an axial channel: by its law. The file states the friction to
/// `file.tolerances`, or the default stands there; sticking needs a friction of `needed`, and more does as
/// much.
pub(super) fn by_law(file: &CaskFile, contact: Contact, needed: f64) -> (AxialSource, AssumedFriction) {
    let share_u = file.tolerances.friction / 2.0;
    let sliding = |friction: f64| AxialSource::Sliding { friction };
    let (axial, ratio, u) = match contact {
        Contact::Rough => (AxialSource::Sticking, needed, share_u * needed),
        Contact::Smooth => (sliding(0.0), 0.0, share_u * needed),
        Contact::Coulomb(mu) if file.has_open_friction() => {
            let most = needed.clamp(-mu, mu);
            (sliding(MIDDLE * most), MIDDLE * most, U_UNKNOWN * most)
        }
        Contact::Coulomb(mu) if mu < needed.abs() => {
            let friction = mu * needed.signum();
            (sliding(friction), friction, share_u * mu)
        }
        Contact::Coulomb(mu) => {
            let short = (needed.abs() - (1.0 - 2.0 * share_u) * mu).max(0.0);
            (AxialSource::Sticking, needed, short / 2.0)
        }
        Contact::Unknown => (sliding(MIDDLE * needed), MIDDLE * needed, U_UNKNOWN * needed),
    };
    (axial, AssumedFriction { ratio, u: u.abs() })
}

/// Geometry and initial motion of a cask file, L sticking to the target.
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
