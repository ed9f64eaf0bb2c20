//! Parses `[VARIABLE=]FROM:TO:STEP` into the values of a sweep.

use super::words::{check_order, number};
use crate::data::SweepVariable::{Angle, DropHeight, Friction, K, Length};
use crate::data::shown::round_off;
use crate::data::{Sweep, SweepVariable};

/// Largest number of predictions of one run, and so of values of one sweep: nobody reads a longer table, and
/// it fills hundreds of megabytes.
pub const MOST_PREDICTIONS: usize = 200_000;

/// A variable that can be swept, with its names on the command line.
struct Sweepable {
    variable: SweepVariable,
    names: &'static [&'static str],
    /// Smallest and largest value, and the end of the sentence that states the range.
    range: (f64, f64),
    lies: &'static str,
    example: &'static str,
}

impl Sweepable {
    const fn new(
        variable: SweepVariable,
        names: &'static [&'static str],
        range: (f64, f64),
        lies: &'static str,
        example: &'static str,
    ) -> Self {
        Self { variable, names, range, lies, example }
    }
}

const DEGREES: &str = "lies between 0 (flat) and 90 (upright) degrees";
const LENGTHS: &str = "lies between 0.01 and 100 m: it is the length of the cask, in metres";
const HEIGHTS: &str = "lies between 0.001 and 1000 m: it is the height of the drop, in metres";
const FRICTIONS: &[&str] = &["friction", "contact", "mu", "μ", "µ"];
const DROPS: &[&str] = &["height", "drop_height", "drop_height_m"];

const SWEEPABLE: [Sweepable; 5] = [
    Sweepable::new(Angle, &["angle", "angle_deg", "phi", "φ"], (0.0, 90.0), DEGREES, "5:45:5"),
    Sweepable::new(K, &["k", "restitution"], (0.0, 1.0), "lies between 0 and 1", "k=0:1:0.1"),
    Sweepable::new(Friction, FRICTIONS, (0.0, f64::INFINITY), "is 0 or more", "friction=0:1:0.1"),
    Sweepable::new(Length, &["length", "length_m"], (0.01, 100.0), LENGTHS, "length=4:6:0.1"),
    Sweepable::new(DropHeight, DROPS, (0.001, 1000.0), HEIGHTS, "height=1:9:0.5"),
];

/// Returns the name of the variable on the command line.
pub fn name(variable: SweepVariable) -> &'static str {
    SWEEPABLE.iter().find(|entry| entry.variable == variable).map_or("", |entry| entry.names[0])
}

pub fn parse(text: &str) -> Result<Sweep, String> {
    let (entry, values) = match text.split_once('=') {
        Some((word, values)) if word.contains(':') || values.contains('=') => {
            return Err("give --sweep once for each variable".into());
        }
        Some((word, values)) => (find(word)?, values),
        None => (lookup(text).unwrap_or(&SWEEPABLE[0]), text),
    };
    let parts: Vec<&str> = values.split(':').collect();
    let [from, to, step] = parts[..] else {
        let unit = if entry.variable == Angle { ", in degrees" } else { "" };
        return Err(format!("give FROM:TO:STEP{unit}, such as --sweep {}", entry.example));
    };
    let (from, to, step) = (number(from)?, number(to)?, number(step)?);
    for (word, value) in [("FROM", from), ("TO", to)] {
        let inside = (entry.range.0..=entry.range.1).contains(&value);
        if !inside {
            return Err(format!("{word} is {value}: {} {}", entry.names[0], entry.lies));
        }
    }
    check_order(from, to)?;
    if step <= 0.0 {
        return Err(format!("STEP is {step}: it must be above 0"));
    }
    Ok(Sweep { variable: entry.variable, values: values_of(from, to, step)? })
}

fn values_of(from: f64, to: f64, step: f64) -> Result<Vec<f64>, String> {
    // A step that misses TO by a rounding error still includes it.
    let count = ((to - from) / step + 1e-9).floor() + 1.0;
    #[allow(clippy::cast_precision_loss, reason = "200 000 is exact")]
    if count > MOST_PREDICTIONS as f64 {
        return Err(format!("these are more than {MOST_PREDICTIONS} values: take a larger STEP"));
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 200 000")]
    let count = count as u32;
    Ok((0..count).map(|i| round_off(from + f64::from(i) * step).min(to)).collect())
}

fn lookup(word: &str) -> Option<&'static Sweepable> {
    let word = word.trim().to_lowercase();
    SWEEPABLE.iter().find(|entry| entry.names.contains(&word.as_str()))
}

fn find(word: &str) -> Result<&'static Sweepable, String> {
    let all = SWEEPABLE.map(|entry| entry.names[0]).join(", ");
    lookup(word).ok_or_else(|| format!("no variable {word}: known are {all} (of the drop)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<f64> {
        parse(text).unwrap().values
    }

    #[test]
    fn a_sweep_includes_both_ends_and_shows_round_values() {
        let tenths = values("0:1:0.1");
        assert_eq!(tenths.len(), 11);
        assert_eq!((tenths[3].to_bits(), tenths[10].to_bits()), (0.3_f64.to_bits(), 1.0_f64.to_bits()));
        assert_eq!(values("5:45:5").len(), 9);
        assert_eq!(values("0:90:7").last(), Some(&84.0));
        assert_eq!(values("30:30:1"), [30.0]);
        assert_eq!(values("k=1e-9:5e-9:1e-9").len(), 5);
    }

    #[test]
    fn a_rounding_never_leads_out_of_the_range() {
        assert!(values("k=0:1:0.333333333334").iter().all(|k| *k <= 1.0));
    }

    #[test]
    fn every_variable_has_its_name_and_a_german_one_its_comma() {
        for (text, variable) in [
            ("0:90:1", SweepVariable::Angle),
            ("angle=0:90:1", SweepVariable::Angle),
            ("K=0,1:0,9:0,1", SweepVariable::K),
            ("friction=0:1:0.1", SweepVariable::Friction),
            ("μ=0:1:0.1", SweepVariable::Friction),
            ("length=4:6:0.5", SweepVariable::Length),
            ("height=1:9:1", SweepVariable::DropHeight),
        ] {
            let swept = parse(text).unwrap();
            assert_eq!(swept.variable, variable, "{text}");
            assert!(parse(&format!("{}=0.5:0.6:0.1", name(variable))).is_ok(), "{text}");
        }
        assert_eq!(values("k=0,1:0,9:0,1").len(), 9);
    }

    #[test]
    fn a_slip_is_told_with_its_remedy() {
        for (text, words) in [
            ("5:45", "FROM:TO:STEP, in degrees, such as --sweep 5:45:5"),
            ("5", "FROM:TO:STEP, in degrees"),
            ("length", "--sweep length=4:6:0.1"),
            ("k=0:1", "such as --sweep k=0:1:0.1"),
            ("height=9", "height=1:9:0.5"),
            ("45:5:5", "exchange"),
            ("5:45:0", "above 0"),
            ("5:45:-5", "above 0"),
            ("5:100:5", "TO is 100: angle lies between 0 (flat) and 90"),
            ("-5:45:5", "FROM is -5: angle"),
            ("k=0:1.2:0.1", "k lies between 0 and 1"),
            ("friction=-1:1:0.1", "friction is 0 or more"),
            ("length=0:6:1", "length lies between 0.01"),
            ("length=4000:6000:100", "in metres"),
            ("height=0:9:1", "height lies between 0.001"),
            ("0:90:nan", "no finite number"),
            ("0:inf:1", "no finite number"),
            ("0:90:1e-9", "larger STEP"),
            ("angel=0:90:1", "no variable angel: known are angle"),
            ("frict=0:1:1", "no variable frict: known are angle, k, friction"),
            ("mass=1:2:1", "known are angle, k, friction, length, height (of the drop)"),
            ("0:90:5,k=0:1:0.1", "once for each variable"),
            ("k=0:1:0.1,angle=0:90:1", "once for each variable"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
