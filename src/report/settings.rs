//! A cask file's tolerances and corrections to lines of the settings.

use super::rounding::plain;
use crate::data::{CaskFile, Contact, Contribution, Setting, TOLERANCES};

/// Whether the cask file leaves this key of `[tolerance]` to its default.
pub(super) fn is_default(file: &CaskFile, key: &str) -> bool {
    file.defaults.iter().any(|d| d.strip_prefix("tolerance.") == Some(key))
}

/// The default that an input of the budget rests on, as a cask file states it, such as "[tolerance]
/// `angle_deg` = 0.4"; `None` where it rests on none.
pub(super) fn to_state(file: &CaskFile, input: &Contribution) -> Option<String> {
    let key = input.tolerance?;
    // Nobody knows a part of a friction that nobody states.
    if key == "friction_percent" && file.contact == Contact::Unknown {
        return Some("[contact] friction".to_owned());
    }
    let row = TOLERANCES.iter().find(|row| row.key == key && is_default(file, key))?;
    Some(format!("[tolerance] {key} = {}", plain(row.in_file(file.tolerances, &file.cask), 3)))
}

/// The tolerances, and the corrections that are switched off; without what `said` says already.
pub(super) fn of_cask_file(file: &CaskFile, said: &[Setting]) -> Vec<Setting> {
    let tolerances = TOLERANCES.iter().map(|tolerance| {
        let (value, unit) = tolerance.shown(file.tolerances);
        Setting {
            name: format!("tolerance of {}", tolerance.name),
            value: format!("± {}{unit} (95 %)", plain(value, 3)),
            origin: if is_default(file, tolerance.key) { "default" } else { "cask file" }.into(),
        }
    });
    let mut made = file.corrections;
    let off = made.by_key().into_iter().filter(|(_, made)| !**made).map(|(name, _)| Setting {
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
        assert_eq!(settings.len(), TOLERANCES.len());
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
