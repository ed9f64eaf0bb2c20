//! A cask file's tolerances and corrections to lines of the settings.

use super::rounding::plain;
use crate::data::{CaskFile, Contact, Setting, Tolerances};

/// A tolerance of the cask file.
pub(super) struct Tolerance {
    /// Its key in `[tolerance]`.
    pub key: &'static str,
    name: &'static str,
    unit: &'static str,
    value: fn(&Tolerances) -> f64,
}

impl Tolerance {
    const fn new(
        key: &'static str,
        name: &'static str,
        unit: &'static str,
        value: fn(&Tolerances) -> f64,
    ) -> Self {
        Self { key, name, unit, value }
    }

    /// Whether the budget calls one of its inputs so: "calibration of A2" is of the "calibration of a
    /// channel".
    pub(super) fn is_of(&self, input: &str) -> bool {
        input.starts_with(self.name.split(" a ").next().unwrap_or(self.name))
    }
}

/// All of them, in the cask file's order.
pub(super) const TOLERANCES: [Tolerance; 13] = [
    Tolerance::new("angle_deg", "drop angle", "°", |t| t.angle_rad.to_degrees()),
    Tolerance::new("impact_velocity_percent", "impact velocity", " %", |t| 100.0 * t.impact_velocity),
    Tolerance::new("calibration_percent", "calibration of a channel", " %", |t| 100.0 * t.calibration),
    Tolerance::new("cross_axis_percent", "cross axis of a channel", " %", |t| 100.0 * t.cross_axis),
    Tolerance::new("position_m", "position of a sensor", " mm", |t| 1e3 * t.position_m),
    Tolerance::new("length_m", "length", " %", |t| 100.0 * t.length),
    Tolerance::new("height_m", "section", " %", |t| 100.0 * t.height),
    Tolerance::new("angular_velocity_deg_s", "rotation at first contact", "°/s", |t| {
        t.angular_velocity_rad_s.to_degrees()
    }),
    Tolerance::new("horizontal_velocity_m_s", "sideways velocity at first contact", " m/s", |t| {
        t.horizontal_velocity_m_s
    }),
    Tolerance::new("cog_m", "centre of gravity", " mm", |t| 1e3 * t.cog_m),
    Tolerance::new("inertia_percent", "inertia", " %", |t| 100.0 * t.inertia),
    Tolerance::new("friction_percent", "friction of the first contact", " %", |t| 100.0 * t.friction),
    Tolerance::new("clock_percent", "recorder's clock", " %", |t| 100.0 * t.clock),
];

/// Whether the cask file leaves this key of `[tolerance]` to its default.
pub(super) fn is_default(file: &CaskFile, key: &str) -> bool {
    file.defaults.iter().any(|d| d.strip_prefix("tolerance.") == Some(key))
}

/// The key to state in place of a default that an input of the budget rests on; `None` where it rests on
/// none.
pub(super) fn to_state(file: &CaskFile, input: &str) -> Option<String> {
    let own = TOLERANCES.iter().find(|tolerance| tolerance.is_of(input))?;
    // Nobody knows a part of a friction that nobody states.
    if own.key == "friction_percent" && file.contact == Contact::Unknown {
        return Some("[contact] friction".to_owned());
    }
    is_default(file, own.key).then(|| format!("[tolerance] {}", own.key))
}

/// The tolerances, and the corrections that are switched off; without what `said` says already.
pub(super) fn of_cask_file(file: &CaskFile, said: &[Setting]) -> Vec<Setting> {
    let tolerances = TOLERANCES.iter().map(|t| Setting {
        name: format!("tolerance of {}", t.name),
        value: format!("± {}{} (95 %)", plain((t.value)(&file.tolerances), 3), t.unit),
        origin: if is_default(file, t.key) { "default" } else { "cask file" }.into(),
    });
    let made = &file.corrections;
    let corrections =
        [("offset", made.offset), ("zero_shift", made.zero_shift), ("skew", made.skew), ("hum", made.hum)];
    let off = corrections.into_iter().filter(|(_, made)| !made).map(|(name, _)| Setting {
        name: format!("correction {name}"),
        value: "switched off".into(),
        origin: "cask file".into(),
    });
    let mut settings: Vec<Setting> = tolerances.chain(off).collect();
    settings.retain(|own| said.iter().all(|other| other.name != own.name));
    settings
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;

    #[test]
    fn tolerances_have_their_unit_and_their_origin() {
        let settings = of_cask_file(&sample::cask_file(), &[]);
        let said = |name: &str| settings.iter().find(|s| s.name == name).expect(name);
        assert_eq!(said("tolerance of drop angle").value, "± 0.4° (95 %)");
        assert_eq!(said("tolerance of drop angle").origin, "cask file");
        assert_eq!(said("tolerance of position of a sensor").value, "± 10 mm (95 %)");
        assert_eq!(said("tolerance of inertia").origin, "default");
        assert_eq!(settings.len(), 13);
    }

    #[test]
    fn only_a_correction_that_is_off_is_said_and_only_once() {
        let mut file = sample::cask_file();
        file.corrections.hum = false;
        let settings = of_cask_file(&file, &[]);
        let off: Vec<&str> =
            settings.iter().map(|s| s.name.as_str()).filter(|n| n.starts_with("correction")).collect();
        assert_eq!(off, ["correction hum"]);
        assert_eq!(of_cask_file(&file, &settings), []);
    }
}
