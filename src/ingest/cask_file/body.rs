//! `[cask]` and `[drop]` to a body and its fall, each number within the range of what is dropped.

use super::section::Section;
use crate::data::planar::first_arm_m;
use crate::data::{Cask, Drop, block_inertia_kg_m2};
use crate::ingest::IngestError;
use std::ops::RangeInclusive;
use std::path::Path;

/// v0²/(g l), 2 h/l for a fall: below, the body settles in thousands of touches rather than strikes, and
/// above it turns for hundreds of times its fall. 9 m are 3 for 5.5 m, 0.3 m are 0.1.
const IMPACTS: RangeInclusive<f64> = 5e-2..=5e3;
/// A centre of gravity nearer to an end than this share of the length would have nearly the whole mass there.
const COG_SHARE: f64 = 0.1;
/// Inertia over m l² of a mass within a tenth of the length, 1/12 of its square; a homogeneous rod has 1/12.
const LEAST_INERTIA: f64 = 1e-2 / 12.0;

/// Mass over the box about a cask, kg/m³: an empty drum has 100, and a mass in tonnes makes 1 to 5 of a
/// cask's 1000 to 5000.
const LEAST_DENSITY_KG_M3: f64 = 5.0;

/// Standard value where the file gives no gravity: the contract's default.
const DEFAULT_GRAVITY_M_S2: f64 = 9.81;

/// `[cask]`; its name is that of the file at `path` where it gives none.
pub(crate) fn cask(table: &Section, path: &Path) -> Result<Cask, IngestError> {
    let mass_kg = table.required_number("mass_kg")?;
    let length_m = table.required_number("length_m")?;
    // A scene may leave it out: what it simulates is then a thin rod.
    let height_m = table.given("height_m")?.unwrap_or(0.0);
    if height_m > length_m {
        let message =
            format!("the section is longer than the cask: height_m {height_m} is none of 0 to {length_m} m");
        let mend = "length_m runs along the axis between the two ends that strike, height_m across it; \
                    perhaps they are exchanged";
        return Err(table.refuse("height_m", message, mend));
    }
    let cog = table.given("cog_m")?;
    let inside = COG_SHARE * length_m..=(1.0 - COG_SHARE) * length_m;
    if let Some(cog_m) = cog.filter(|cog_m| !inside.contains(cog_m)) {
        let what = if cog_m < length_m { "at the very end of" } else { "outside" };
        let what =
            format!("the centre of gravity lies {what} the cask: cog_m {cog_m} with length_m {length_m}");
        let why = "cog_m counts along the axis from the first end (the one that touches first), in metres";
        return Err(table.outside("cog_m", &what, &inside, why));
    }
    let cog_m = cog.unwrap_or(length_m / 2.0);
    let inertia = table.given("inertia_kg_m2")?;
    if let Some(inertia) = inertia {
        inertia_is_possible(table, inertia, mass_kg, [length_m, height_m, cog_m])?;
    }
    let width_m = table.given("width_m")?;
    let box_m3 = length_m * height_m * width_m.unwrap_or(height_m);
    if mass_kg < LEAST_DENSITY_KG_M3 * box_m3 {
        let least = LEAST_DENSITY_KG_M3 * box_m3;
        let message = format!("no cask of this size weighs {mass_kg} kg, but {least:.0} kg or more");
        let mend = "mass_kg counts in kilograms: 4.466 t are 4466; lengths count in metres";
        return Err(table.refuse("mass_kg", message, mend));
    }
    let of_file = || path.file_stem().map_or("cask".into(), |stem| stem.to_string_lossy()).into_owned();
    let name = table.text("name")?.unwrap_or_else(of_file);
    Ok(Cask {
        name,
        mass_kg,
        length_m,
        height_m,
        width_m,
        cog_m,
        inertia_kg_m2: inertia.unwrap_or_else(|| block_inertia_kg_m2(mass_kg, length_m, height_m)),
        is_body: height_m > 0.0 || cog.is_some() || inertia.is_some(),
    })
}

/// Whether mass within length and section can have this inertia: at most with all of it in the corners, the
/// centre of gravity kept; at least with all of it in a tenth of the length.
fn inertia_is_possible(
    table: &Section,
    inertia_kg_m2: f64,
    mass_kg: f64,
    [length_m, height_m, cog_m]: [f64; 3],
) -> Result<(), IngestError> {
    // Θ ≤ m (c (l − c) + h²/4).
    let most = mass_kg * (cog_m * (length_m - cog_m) + height_m * height_m / 4.0);
    let least = mass_kg * length_m * length_m * LEAST_INERTIA;
    if (least..=most).contains(&inertia_kg_m2) {
        return Ok(());
    }
    let four_digits = |value: f64| format!("{value:.3e}").parse().unwrap_or(value);
    let homogeneous = four_digits(block_inertia_kg_m2(mass_kg, length_m, height_m));
    let (least, most) = (four_digits(least), four_digits(most));
    let message = format!(
        "no cask of this mass and size has an inertia_kg_m2 of {inertia_kg_m2}, but at least {least} and at \
         most {most}"
    );
    let mend = format!(
        "it counts about the centre of gravity, not about an end, in kg m²; a homogeneous cask of this mass, \
         length and section has {homogeneous}"
    );
    Err(table.refuse("inertia_kg_m2", message, &mend))
}

/// `[drop]`, whose ranges hold of the height and the velocity that it leaves out too.
pub(crate) fn drop(table: &Section, cask: &Cask) -> Result<Drop, IngestError> {
    let gravity_m_s2 = table.given("gravity_m_s2")?.unwrap_or(DEFAULT_GRAVITY_M_S2);
    let velocity = table.given("impact_velocity_m_s")?;
    let height = table.given("height_m")?;
    let height_m = match (&velocity, height) {
        (_, Some(height_m)) => height_m,
        // h = v0² / (2 g).
        (Some(velocity_m_s), None) => velocity_m_s.powi(2) / (2.0 * gravity_m_s2),
        (None, None) => table.required_number("height_m")?,
    };
    let angle_rad = table.required_number("angle_deg")?.to_radians();
    let angular_velocity_rad_s = table.given("angular_velocity_deg_s")?.map_or(0.0, f64::to_radians);
    let horizontal_velocity_m_s = table.given("horizontal_velocity_m_s")?.unwrap_or(0.0);
    // v0 = √(2 g h) − ω a   (3)
    let a_m = first_arm_m(cask.cog_m, cask.height_m, angle_rad);
    let of_fall_m_s = (2.0 * gravity_m_s2 * height_m).sqrt() - angular_velocity_rad_s * a_m;
    let impact_velocity_m_s = velocity.unwrap_or(of_fall_m_s);
    let what = format!("height_m gives an impact at {impact_velocity_m_s:.3} m/s");
    table.allows("impact_velocity_m_s", impact_velocity_m_s, &what)?;
    let ratio = impact_velocity_m_s.powi(2) / (gravity_m_s2 * cask.length_m);
    if !IMPACTS.contains(&ratio) {
        let key = if velocity.is_some() { "impact_velocity_m_s" } else { "height_m" };
        let length_m = cask.length_m;
        let what = format!("{key} is no drop of a cask of {length_m} m: v0²/(g l) is {ratio:.3e}");
        return Err(table.outside(key, &what, &IMPACTS, "check both values and their units"));
    }
    Ok(Drop {
        height_m,
        angle_rad,
        impact_velocity_given: velocity.is_some(),
        impact_velocity_m_s,
        gravity_m_s2,
        angular_velocity_rad_s,
        horizontal_velocity_m_s,
        contact_duration_s: 0.0,
    })
}
