//! `predict`: the analytical prediction at one angle or over a sweep, to a table, JSON and CSV.

use super::Outcome;
use super::output::{Folder, JsonTarget, print};
use clap::Args;
use dropcheck::data::{BodyModel, CaskFile, Contact, Drop};
use dropcheck::predict::{body, predict};
use dropcheck::report::{self, PredictionRow};
use std::path::PathBuf;

const AFTER_HELP: &str = "\
Without --k and --contact: the four borderline cases, rough and smooth, k = 0 and 1.
With --k alone the contact is the cask file's; with --contact alone k is 0 and 1.

Examples:
  dropcheck predict --cask cask.toml
  dropcheck predict --cask cask.toml --k 0.5 --contact 0.4
  dropcheck predict --cask cask.toml --sweep 5:45:5 --out sweep";

/// Rows of a sweep: more is a slip of the pen.
const MOST_ANGLES: f64 = 10_000.0;

#[derive(Args)]
#[command(after_help = AFTER_HELP)]
pub struct Arguments {
    /// The cask file (TOML)
    #[arg(long)]
    cask: PathBuf,
    /// Inclination at first contact, 0 to 90 degrees [default: the cask file's]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = angle)]
    angle: Option<f64>,
    /// Coefficient of restitution, 0 to 1
    #[arg(long, value_name = "K", allow_negative_numbers = true, value_parser = restitution)]
    k: Option<f64>,
    /// Contact of the first end: rough, smooth or a Coulomb coefficient
    #[arg(long, value_name = "C", allow_negative_numbers = true, value_parser = contact)]
    contact: Option<Contact>,
    /// Sweep the angle, degrees
    #[arg(long, value_name = "FROM:TO:STEP", conflicts_with = "angle", allow_hyphen_values = true, value_parser = sweep)]
    sweep: Option<Sweep>,
    /// Folder for prediction.json and prediction.csv
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the predictions as JSON to a file; with - to standard output, and nothing else there
    #[arg(long, value_name = "FILE|-")]
    json: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> miette::Result<Outcome> {
    let inputs = [arguments.cask.as_path()];
    let names = ["prediction.json", "prediction.csv"];
    let folder = arguments.out.as_deref().map(|dir| Folder::checked(dir, &names, &inputs)).transpose()?;
    let json = JsonTarget::checked(arguments.json.as_deref(), &inputs)?;

    let file = dropcheck::ingest::cask_file(&arguments.cask)?;
    let rows = rows(arguments, &file);

    if let Some(folder) = &folder {
        folder.write(&[
            (names[0].to_owned(), report::prediction_json(&rows)?),
            (names[1].to_owned(), report::prediction_csv(&rows)?),
        ])?;
    }
    json.write(|| report::prediction_json(&rows))?;
    if !json.is_standard_output() {
        print(&report::prediction_table(&rows, &file))?;
    }
    Ok(Outcome::Clear)
}

/// Every case at every angle, of the rod and, where the cask file describes one, of the body.
fn rows(arguments: &Arguments, file: &CaskFile) -> Vec<PredictionRow> {
    let angles_deg = match (arguments.sweep, arguments.angle) {
        (Some(sweep), _) => sweep.angles_deg(),
        (None, Some(angle_deg)) => vec![angle_deg],
        (None, None) => vec![rounded(file.drop.angle_rad.to_degrees())],
    };
    let contacts = match (arguments.contact, arguments.k) {
        (Some(contact), _) => vec![contact],
        (None, Some(_)) => vec![file.contact],
        (None, None) => vec![Contact::Rough, Contact::Smooth],
    };
    let ks = arguments.k.map_or_else(|| vec![0.0, 1.0], |k| vec![k]);
    let models: &[BodyModel] =
        if file.cask.is_body { &[BodyModel::Rod, BodyModel::Body] } else { &[BodyModel::Rod] };
    let mut rows = Vec::new();
    for &angle_deg in &angles_deg {
        let drop = Drop { angle_rad: angle_deg.to_radians(), ..file.drop };
        for &model in models {
            let body = body(&file.cask, model);
            for &contact in &contacts {
                for &k in &ks {
                    rows.push(PredictionRow { angle_deg, prediction: predict(&body, &drop, contact, k) });
                }
            }
        }
    }
    rows
}

/// Angles from, to and step, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sweep {
    from_deg: f64,
    step_deg: f64,
    count: u32,
}

impl Sweep {
    fn angles_deg(self) -> Vec<f64> {
        (0..self.count).map(|i| rounded(self.from_deg + f64::from(i) * self.step_deg)).collect()
    }
}

/// Free of the last digits of a conversion, so that 15° is shown as 15.
fn rounded(angle_deg: f64) -> f64 {
    (angle_deg * 1e9).round() / 1e9
}

fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| "not a number".to_owned())?;
    if value.is_finite() { Ok(value) } else { Err("not a finite number".into()) }
}

fn angle(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if (0.0..=90.0).contains(&value) {
        Ok(value)
    } else {
        Err("the angle lies between 0 and 90 degrees".into())
    }
}

fn restitution(text: &str) -> Result<f64, String> {
    let value = number(text)?;
    if (0.0..=1.0).contains(&value) { Ok(value) } else { Err("k lies between 0 and 1".into()) }
}

fn contact(text: &str) -> Result<Contact, String> {
    match text.trim() {
        "rough" => return Ok(Contact::Rough),
        "smooth" => return Ok(Contact::Smooth),
        _ => {}
    }
    let value =
        number(text).map_err(|_| "give rough, smooth or a friction coefficient such as 0.4".to_owned())?;
    if value >= 0.0 {
        Ok(Contact::Coulomb(value))
    } else {
        Err("a friction coefficient is not negative".into())
    }
}

fn sweep(text: &str) -> Result<Sweep, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let [from, to, step] = parts[..] else {
        return Err("give FROM:TO:STEP in degrees, such as 5:45:5".into());
    };
    let (from_deg, to_deg, step_deg) = (angle(from)?, angle(to)?, number(step)?);
    if to_deg < from_deg {
        return Err(format!("TO ({to_deg}) lies below FROM ({from_deg})"));
    }
    if step_deg <= 0.0 {
        return Err("STEP must be above 0".into());
    }
    // A step that ends a rounding short of TO still includes it.
    let count = ((to_deg - from_deg) / step_deg + 1e-9).floor() + 1.0;
    if count > MOST_ANGLES {
        return Err(format!("that is {count:.0} angles; at most {MOST_ANGLES:.0}: take a larger STEP"));
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 10 000")]
    Ok(Sweep { from_deg, step_deg, count: count as u32 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sweep_includes_both_ends() {
        let angles = sweep("0:1:0.1").unwrap().angles_deg();
        assert_eq!(angles.len(), 11);
        assert_eq!(angles[10].to_bits(), 1.0_f64.to_bits());
        assert_eq!(sweep("5:45:5").unwrap().angles_deg().len(), 9);
    }

    #[test]
    fn what_is_out_of_range_is_said() {
        for (text, words) in [
            ("5:45", "FROM:TO:STEP"),
            ("45:5:5", "below"),
            ("5:45:0", "above 0"),
            ("5:100:5", "between 0 and 90"),
            ("0:90:0.001", "larger STEP"),
        ] {
            assert!(sweep(text).unwrap_err().contains(words), "{text}");
        }
        assert!(restitution("1.2").unwrap_err().contains("between 0 and 1"));
        assert!(angle("-1").unwrap_err().contains("0 and 90"));
        assert!(angle("NaN").is_err());
        assert!(contact("-0.1").unwrap_err().contains("not negative"));
        assert!(contact("sticky").unwrap_err().contains("rough, smooth"));
    }

    #[test]
    fn contacts_are_read() {
        assert_eq!(contact("rough"), Ok(Contact::Rough));
        assert_eq!(contact("0.4"), Ok(Contact::Coulomb(0.4)));
    }
}
