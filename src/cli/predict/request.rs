//! Turns the options of `predict` and a cask file into the request of a study.

use super::Arguments;
use super::sweep::{MOST_PREDICTIONS, name};
use crate::data::shown::round_off;
use crate::data::{CaskFile, Contact, StudyRequest, Sweep, SweepVariable, Uncertain};
use crate::predict;
use miette::{ensure, miette};

/// Largest step of the curves: half a degree is finer than a drop can be rigged.
const CURVE_STEP_DEG: f64 = 0.5;

/// Fewest swept angles that set the range of the curves; fewer are single points.
const LEAST_CURVE_ANGLES: usize = 10;

/// Largest number of steps of a curve: more are closer than the dots of a picture.
const MOST_CURVE_STEPS: f64 = 1800.0;

/// Returns the request, with the cask file's values unless an option states others.
pub fn request(arguments: &Arguments, file: &CaskFile) -> miette::Result<StudyRequest> {
    let sweeps = &arguments.sweep;
    check_sweeps(arguments)?;
    check_lengths(sweeps, file)?;
    let usual = predict::usual_request(file);
    let (contacts, ks) = cases(arguments, file, &usual);
    let request = StudyRequest {
        contacts,
        ks,
        angle_deg: arguments.angle.unwrap_or(usual.angle_deg),
        sweeps: sweeps.clone(),
        angles_deg: swept_values(sweeps, SweepVariable::Angle)
            .and_then(curve_angles_deg)
            .unwrap_or(usual.angles_deg),
        band_percent: arguments.band,
        uncertain: uncertain(arguments, usual.uncertain),
    };
    check_count(&request, file)?;
    Ok(request)
}

fn swept_values(sweeps: &[Sweep], variable: SweepVariable) -> Option<&[f64]> {
    sweeps.iter().find(|sweep| sweep.variable == variable).map(|sweep| sweep.values.as_slice())
}

/// Returns the lowest and highest value of a sweep.
fn span(values: &[f64]) -> Option<(f64, f64)> {
    Some((*values.first()?, *values.last()?))
}

/// Refuses a variable that is swept twice, or swept and set by its option.
fn check_sweeps(arguments: &Arguments) -> miette::Result<()> {
    let sweeps = &arguments.sweep;
    for (i, sweep) in sweeps.iter().enumerate() {
        let called = name(sweep.variable);
        let is_new = sweeps[..i].iter().all(|other| other.variable != sweep.variable);
        let mend = "one --sweep for each variable; for two ranges of one variable run predict twice";
        ensure!(is_new, help = mend, "--sweep {called} is given twice");
        let option = match sweep.variable {
            SweepVariable::Angle => arguments.angle.map(|_| "--angle"),
            SweepVariable::K => arguments.k.map(|_| "--k"),
            SweepVariable::Friction => arguments.contact.map(|_| "--contact"),
            SweepVariable::Length | SweepVariable::DropHeight => None,
        };
        if let Some(option) = option {
            let mend = format!("leave out {option} to sweep, or --sweep {called} to have the one value");
            return Err(miette!(help = mend, "{option} and --sweep {called} both say what {called} is"));
        }
    }
    Ok(())
}

/// Refuses a section longer than the cask, as in the cask file.
fn check_lengths(sweeps: &[Sweep], file: &CaskFile) -> miette::Result<()> {
    let section_m = file.cask.height_m;
    let shortest_m = swept_values(sweeps, SweepVariable::Length).and_then(span).map(|(from_m, _)| from_m);
    let Some(shortest_m) = shortest_m.filter(|from_m| *from_m < section_m) else { return Ok(()) };
    let path = file.path.display();
    Err(miette!(
        help = format!(
            "let --sweep length begin at {section_m} or above, or correct height_m under [cask] in {path}"
        ),
        "the section of the cask is {section_m} m, and --sweep length begins at {shortest_m} m: a cask is \
         longer than its section"
    ))
}

/// Lists contact laws and ks: both ends of their sweeps, else as given, else the four borderline cases.
fn cases(arguments: &Arguments, file: &CaskFile, usual: &StudyRequest) -> (Vec<Contact>, Vec<f64>) {
    let distinct = |(from, to): (f64, f64)| if from < to { vec![from, to] } else { vec![from] };
    let swept = |variable| swept_values(&arguments.sweep, variable).and_then(span).map(distinct);
    let to_contacts = |coefficients: Vec<f64>| coefficients.into_iter().map(Contact::Coulomb).collect();
    let ks = arguments.k.map(|k| vec![k]).or_else(|| swept(SweepVariable::K));
    let contacts = arguments.contact.map(|contact| vec![contact]);
    match (contacts.or_else(|| swept(SweepVariable::Friction).map(to_contacts)), ks) {
        (Some(contacts), Some(ks)) => (contacts, ks),
        (Some(contacts), None) => (contacts, usual.ks.clone()),
        // A prediction needs a contact law: this is the borderline case that the paper found.
        (None, Some(ks)) if file.contact == Contact::Unknown => (vec![Contact::Rough], ks),
        (None, Some(ks)) => (vec![file.contact], ks),
        (None, None) => (usual.contacts.clone(), usual.ks.clone()),
    }
}

/// Angles for the curves of a sweep that is more than a few points, in steps of at most half a degree.
fn curve_angles_deg(swept: &[f64]) -> Option<Vec<f64>> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "cut to 1800 before the cast")]
    let divide_evenly = |from: f64, to: f64, steps: f64| -> Vec<f64> {
        let steps = steps.min(MOST_CURVE_STEPS).ceil() as u32;
        (0..=steps).map(|i| round_off(from + (to - from) * f64::from(i) / f64::from(steps))).collect()
    };
    let (from, to) = span(swept).filter(|_| swept.len() >= LEAST_CURVE_ANGLES)?;
    let step = swept[1] - swept[0];
    // Every step of the sweep is divided equally, so that its angles are among those of the curve.
    Some(divide_evenly(from, to, ((to - from) / step).round() * (step / CURVE_STEP_DEG).ceil()))
}

/// Distributions for Monte Carlo: those of the cask file, each replaced by the options if they state it.
fn uncertain(arguments: &Arguments, usual: Uncertain) -> Uncertain {
    let geometry = arguments.geometry_tolerance.map(|percent| percent / 100.0);
    let swept = |variable| swept_values(&arguments.sweep, variable).and_then(span);
    Uncertain {
        k: arguments.k_range.or(arguments.k.map(|k| (k, k))).or(swept(SweepVariable::K)).unwrap_or(usual.k),
        friction: arguments
            .friction_range
            .or(swept(SweepVariable::Friction))
            .or(usual.friction.filter(|_| arguments.contact.is_none())),
        angle_deg: arguments.angle_tolerance.unwrap_or(usual.angle_deg),
        length: geometry.unwrap_or(usual.length),
        height: geometry.unwrap_or(usual.height),
        cog: geometry.unwrap_or(usual.cog),
        draws: arguments.draws,
        seed: arguments.seed.unwrap_or(usual.seed),
        ..usual
    }
}

/// Refuses a table that is too long to be written and read.
fn check_count(request: &StudyRequest, file: &CaskFile) -> miette::Result<()> {
    let is_swept = |variable| swept_values(&request.sweeps, variable).is_some();
    let mut factors: Vec<(usize, String)> =
        request.sweeps.iter().map(|s| (s.values.len(), name(s.variable).to_owned())).collect();
    if !is_swept(SweepVariable::Friction) {
        factors.push((request.contacts.len(), "contact".to_owned()));
    }
    if !is_swept(SweepVariable::K) {
        factors.push((request.ks.len(), "k".to_owned()));
    }
    factors.push((predict::bodies(&file.cask).len(), "rod, body".to_owned()));
    let predictions = factors.iter().fold(1_usize, |product, (count, _)| product.saturating_mul(*count));
    if predictions <= MOST_PREDICTIONS {
        return Ok(());
    }
    let product: Vec<String> = factors
        .iter()
        .filter(|(count, _)| *count > 1)
        .map(|(count, what)| format!("{count} ({what})"))
        .collect();
    let longest = request.sweeps.iter().max_by_key(|sweep| sweep.values.len());
    let longest = longest.map_or("", |sweep| name(sweep.variable));
    Err(miette!(
        help = format!("take a larger STEP or a shorter range for {longest}, or give --k and --contact"),
        "{} = {predictions} predictions are too many; at most {MOST_PREDICTIONS}",
        product.join(" × ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Words {
        #[command(flatten)]
        arguments: Arguments,
    }

    const CASK: &str = "[cask]\nmass_kg = 4466\nlength_m = 5.512\nheight_m = 0.792\n\
                        [drop]\nheight_m = 9\nangle_deg = 15\n[contact]\nfriction = 0.3\n";

    fn file() -> CaskFile {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cask.toml");
        std::fs::write(&path, CASK).unwrap();
        crate::ingest::cask_file(&path).unwrap()
    }

    fn asked(options: &str) -> miette::Result<StudyRequest> {
        let words = ["predict", "--cask", "cask.toml"].into_iter().chain(options.split_whitespace());
        request(&Words::try_parse_from(words).unwrap().arguments, &file())
    }

    #[test]
    fn options_choose_the_cases_and_sweeps_stand_for_them() {
        use Contact::{Coulomb, Rough, Smooth};
        for (options, contacts, ks) in [
            ("", vec![Rough, Smooth], vec![0.0, 1.0]),
            ("--k 0.5", vec![Coulomb(0.3)], vec![0.5]),
            ("--contact smooth", vec![Smooth], vec![0.0, 1.0]),
            ("--contact 0,4 --k 0", vec![Coulomb(0.4)], vec![0.0]),
            ("--sweep k=0.2:0.8:0.1", vec![Coulomb(0.3)], vec![0.2, 0.8]),
            ("--sweep friction=0:1:0.1", vec![Coulomb(0.0), Coulomb(1.0)], vec![0.0, 1.0]),
            ("--sweep k=0.5:0.5:1 --contact rough", vec![Rough], vec![0.5]),
            ("--sweep length=4:6:1", vec![Rough, Smooth], vec![0.0, 1.0]),
        ] {
            let asked = asked(options).unwrap();
            assert_eq!((asked.contacts, asked.ks), (contacts, ks), "{options}");
            assert!((asked.angle_deg - 15.0).abs() < f64::EPSILON);
        }
    }

    #[test]
    fn monte_carlo_draws_from_ranges_sweeps_and_options_in_this_order() {
        let usual = predict::default_uncertain(&file());
        assert_eq!((usual.k, usual.seed), ((0.0, 1.0), 1), "--help states other defaults");
        // The page uses the same request.
        assert_eq!(asked("").unwrap(), predict::usual_request(&file()));
        for (options, k, friction) in [
            ("", usual.k, Some((0.3, 0.3))),
            ("--k 0.5", (0.5, 0.5), Some((0.3, 0.3))),
            ("--contact 0.4", usual.k, None),
            ("--k 0.5 --k-range 0.3:0.7 --contact 0.4 --friction-range 0:1", (0.3, 0.7), Some((0.0, 1.0))),
            ("--sweep k=0.2:0.8:0.1 --sweep friction=0:1:0.1", (0.2, 0.8), Some((0.0, 1.0))),
            ("--sweep k=0.2:0.8:0.1 --k-range 0.3:0.7", (0.3, 0.7), Some((0.3, 0.3))),
        ] {
            let uncertain = asked(options).unwrap().uncertain;
            assert_eq!((uncertain.k, uncertain.friction), (k, friction), "{options}");
        }
        let asked = asked("--angle-tolerance 2 --geometry-tolerance 3 --draws 7 --seed 9 --band 10").unwrap();
        let Uncertain { angle_deg, length, height, cog, inertia, draws, seed, .. } = asked.uncertain;
        assert_eq!((angle_deg, length, height, cog, draws, seed), (2.0, 0.03, 0.03, 0.03, 7, 9));
        assert_eq!((asked.uncertain.impact_velocity, inertia), (usual.impact_velocity, usual.inertia));
        assert!((asked.band_percent - 10.0).abs() < f64::EPSILON);
    }

    #[test]
    fn curves_go_over_a_fine_sweep_of_the_angle_and_else_over_all_angles() {
        let angles = |options: &str| asked(options).unwrap().angles_deg;
        let all = angles("");
        assert_eq!(
            (all.len(), all[1].to_bits(), all[180].to_bits()),
            (181, 0.5_f64.to_bits(), 90_f64.to_bits())
        );
        assert_eq!(angles("--sweep 5:45:5"), all);
        assert_eq!(angles("--sweep 5:45:0.25").len(), 161);
        let filled = angles("--sweep 5:45:4");
        assert_eq!((filled.len(), filled[8].to_bits()), (81, 9_f64.to_bits()));
        let thinned = angles("--sweep 0:90:0.01");
        assert_eq!((thinned.len(), thinned[1].to_bits()), (1801, 0.05_f64.to_bits()));
    }

    #[test]
    fn what_contradicts_itself_or_is_too_much_is_told_with_its_remedy() {
        for (options, message, help) in [
            ("--angle 5 --sweep 0:9:1", "--angle and --sweep angle both", "leave out --angle"),
            ("--k 0 --sweep k=0:1:1", "--k and --sweep k both", "leave out --k"),
            (
                "--contact rough --sweep mu=0:1:1",
                "--contact and --sweep friction both",
                "leave out --contact",
            ),
            ("--sweep 0:9:1 --sweep angle=9:20:1", "--sweep angle is given twice", "run predict twice"),
            ("--sweep length=0.5:6:0.1", "the section of the cask is 0.792 m", "at 0.792 or above"),
            (
                "--sweep 0:90:0.01 --sweep k=0:1:0.05",
                "9001 (angle) × 21 (k) × 2 (rod, body) = 378042 predictions",
                "larger STEP or a shorter range for angle",
            ),
            ("--sweep 0:90:0.002", "2 (contact) × 2 (k)", "or give --k and --contact"),
        ] {
            let complaint = asked(options).unwrap_err();
            assert!(complaint.to_string().contains(message), "{options}: {complaint}");
            let remedy = complaint.help().map(|help| help.to_string()).unwrap_or_default();
            assert!(remedy.contains(help), "{options}: {remedy}");
        }
    }
}
