//! `[tolerance]` and `[corrections]` to how well the stated things are known and what may be corrected.

use super::section::Section;
use crate::data::{Cask, Corrections, TOLERANCES, Tolerances};
use crate::ingest::IngestError;

/// A tolerance above this share says that nothing is known, percent.
const LARGEST_PERCENT: f64 = 100.0;

/// `[tolerance]`, with the defaults of what it leaves out; `left_out` are the keys that the whole file does.
pub(super) fn tolerances(
    table: &Section,
    cask: &Cask,
    left_out: &[String],
) -> Result<Tolerances, IngestError> {
    let mut stated = Tolerances::with_defaults(left_out, cask.length_m);
    for tolerance in &TOLERANCES {
        let key = tolerance.key;
        let Some(given) = table.given(key)? else { continue };
        if key.ends_with("_percent") && given > LARGEST_PERCENT {
            let message = format!("{key} is {given}, more than the thing itself");
            let mend = "the half-width of the 95 % interval, in percent: 1.5 means ± 1.5 %";
            return Err(table.refuse(key, message, mend));
        }
        tolerance.set(&mut stated, given, cask);
    }
    Ok(stated)
}

/// `[corrections]`; what it leaves out is made.
pub(super) fn corrections(table: &Section) -> Result<Corrections, IngestError> {
    let mut made = Corrections::default();
    for (key, made) in made.switches() {
        *made = table.flag(key)?.unwrap_or(*made);
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::super::checked;
    use std::path::Path;

    const CASK: &str =
        "[cask]\nmass_kg = 1000\nlength_m = 5\nheight_m = 0.8\n[drop]\nheight_m = 9\nangle_deg = 15\n";

    fn parsed(more: &str) -> Result<crate::data::CaskFile, String> {
        checked(Path::new("c.toml"), &format!("{CASK}{more}"), None).map_err(|e| e.to_string())
    }

    #[test]
    fn what_is_left_out_is_a_default_and_said_to_be_one() {
        let stated = "[tolerance]\nangle_deg = 1\ncalibration_percent = 5\nclock_percent = 2\n";
        let file = parsed(stated).expect("a sound file");
        assert!((file.tolerances.clock - 0.02).abs() < 1e-12);
        assert!((file.tolerances.angle_rad.to_degrees() - 1.0).abs() < 1e-12);
        assert!((file.tolerances.calibration - 0.05).abs() < 1e-12);
        assert!(file.defaults.iter().any(|d| d == "tolerance.position_m"));
        assert!(!file.defaults.iter().any(|d| d == "tolerance.angle_deg"));
    }

    #[test]
    fn a_correction_can_be_switched_off() {
        let file = parsed("[corrections]\nzero_shift = false\n").expect("a sound file");
        assert!(!file.corrections.zero_shift && file.corrections.offset);
    }

    #[test]
    fn nonsense_is_named_with_its_line() {
        let said = |more: &str| parsed(more).expect_err("nonsense");
        assert!(said("[tolerance]\nangle_deg = -1\n").contains("line 9"));
        assert!(said("[tolerance]\ninertia_percent = 120\n").contains("more than the thing itself"));
        assert!(said("[tolerance]\nclock_percent = 101\n").contains("more than the thing itself"));
        assert!(said("[tolerance]\nclock_percent = -0.1\n").contains("line 9"));
        assert!(said("[tolerance]\nangle = 1\n").contains("angle"));
        assert!(said("[corrections]\noffset = \"no\"\n").contains("not true or false"));
    }
}
