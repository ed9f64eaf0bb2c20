//! `validate`: a campaign of random scenes with known truth to tables of how far off the analysis is and how often it says so.

use super::Outcome;
use super::output::{Folder, print, replace};
use super::progress::with_progress;
use clap::Args;
use dropcheck::data::{CampaignRequest, SceneNumber};
use dropcheck::report::{self, SyntheticFormat};
use dropcheck::validate;
use std::path::{Path, PathBuf};

const AFTER_HELP: &str = "\
Undamaged scenes are U0, U1 …, damaged ones D0, D1 …: with its seed a number names the same scene for ever.

Examples:
  dropcheck validate --campaign 2000
  dropcheck validate --campaign 200 --kinds undamaged,skew,hum --out campaign
  dropcheck validate --campaign 2000 --into docs/validation.md
  dropcheck validate --scene D17 --out scene";

/// What the tables stand between in a document.
const BEGIN: &str = "<!-- campaign: begin -->";
const END: &str = "<!-- campaign: end -->";

/// Files of a campaign's folder.
const NAMES: [&str; 2] = ["campaign.csv", "campaign.md"];

#[derive(Args)]
#[command(after_help = AFTER_HELP)]
#[command(group = clap::ArgGroup::new("what").required(true).args(["campaign", "scene"]))]
pub struct Arguments {
    /// Analyse N random undamaged scenes and N with one damage each
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    campaign: Option<u32>,
    /// Write one scene of the campaign as recording, cask file and truth into --out
    #[arg(long, value_name = "NUMBER", value_parser = number, requires = "out")]
    scene: Option<SceneNumber>,
    /// Seed of everything random
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// all, undamaged, or kinds of damage, separated by commas
    #[arg(long, value_name = "KINDS", default_value = "all", value_delimiter = ',', value_parser = kind)]
    kinds: Vec<&'static str>,
    /// What is stated is exactly true: no deviations within the tolerances
    #[arg(long)]
    exact: bool,
    /// Folder for campaign.csv and campaign.md, or for the files of the scene
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Document in which the tables replace what stands between the lines `<!-- campaign: begin -->` and `<!-- campaign: end -->`
    #[arg(long, value_name = "FILE", conflicts_with = "scene")]
    into: Option<PathBuf>,
}

/// Words of --kinds that are no kind of damage.
const ALL: &str = "all";
const UNDAMAGED: &str = "undamaged";

fn kind(word: &str) -> Result<&'static str, String> {
    let mut words = [ALL, UNDAMAGED].into_iter().chain(validate::kinds().map(|kind| kind.0));
    words.find(|known| *known == word).ok_or_else(|| {
        let known: Vec<&str> = validate::kinds().map(|kind| kind.0).collect();
        format!("no kind of damage; there are all, undamaged, {}", known.join(", "))
    })
}

fn number(word: &str) -> Result<SceneNumber, String> {
    let parsed =
        |digits: &str| digits.parse().map_err(|_| format!("no number behind its letter in {word:?}"));
    match word.split_at_checked(1) {
        Some(("U" | "u", digits)) => parsed(digits).map(SceneNumber::Undamaged),
        Some(("D" | "d", digits)) => parsed(digits).map(SceneNumber::Damaged),
        _ => Err("U and a number for an undamaged scene, D and a number for a damaged one".to_owned()),
    }
}

pub fn run(arguments: &Arguments) -> miette::Result<Outcome> {
    match (arguments.scene, &arguments.out) {
        (Some(number), Some(out)) => one(arguments, number, out),
        _ => campaign(arguments, arguments.campaign.unwrap_or_default()),
    }
}

fn campaign(arguments: &Arguments, scenes: u32) -> miette::Result<Outcome> {
    let folder = arguments.out.as_deref().map(|out| Folder::checked(out, &NAMES, &[])).transpose()?;
    let document =
        arguments.into.as_deref().map(|path| parts(path).map(|parts| (path, parts))).transpose()?;
    let has = |word| arguments.kinds.contains(&word);
    let damages = validate::kinds().map(|kind| kind.0);
    let request = CampaignRequest {
        scenes,
        seed: arguments.seed,
        undamaged: has(ALL) || has(UNDAMAGED),
        kinds: damages.filter(|kind| has(ALL) || has(kind)).collect(),
        exact: arguments.exact,
    };
    let campaign = with_progress("campaign", |progress| dropcheck::campaign(&request, progress));
    let tables = validate::markdown(&campaign);
    if let Some(folder) = &folder {
        let csv = validate::csv(&campaign).map_err(report::ReportError::from)?;
        let [csv_name, tables_name] = NAMES.map(str::to_owned);
        folder.write(&[(csv_name, csv), (tables_name, tables.clone().into_bytes())])?;
    }
    if let Some((path, (before, after))) = &document {
        replace(path, format!("{before}\n{tables}{after}").as_bytes())?;
    }
    if folder.is_none() && document.is_none() {
        print(&tables)?;
    }
    Ok(Outcome::Clear)
}

/// What stands before and after the tables in a document, the lines that mark them included.
fn parts(path: &Path) -> miette::Result<(String, String)> {
    let text = std::fs::read_to_string(path)
        .map_err(|source| miette::miette!("{} cannot be read: {source}", path.display()))?;
    let found = text.find(BEGIN).map(|at| at + BEGIN.len()).zip(text.find(END));
    match found.filter(|(begin, end)| begin <= end) {
        Some((begin, end)) => Ok((text[..begin].to_owned(), text[end..].to_owned())),
        None => Err(miette::miette!(
            help = format!("write the lines {BEGIN} and {END} where the tables are to stand"),
            "{} does not say where the tables go",
            path.display()
        )),
    }
}

/// Writes the files of one scene.
fn one(arguments: &Arguments, number: SceneNumber, out: &Path) -> miette::Result<Outcome> {
    let name = format!("{number}.mcap");
    let names = report::synthetic_names(&name);
    let folder = Folder::checked(out, &names.each_ref().map(String::as_str), &[])?;
    let (scene, recording) = dropcheck::campaign_scene(arguments.seed, number, arguments.exact);
    // Protobuf, unlike JSON, holds samples that are infinite.
    folder.write(&report::synthetic_files(&scene, &recording, &name, SyntheticFormat::McapProtobuf)?)?;
    let files = names.each_ref().map(|name| report::printable(&folder.file(name)));
    print(&format!("Written: {}\n", files.join(", ")))?;
    Ok(Outcome::Clear)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_named_by_a_letter_and_a_number() {
        assert_eq!(number("U0"), Ok(SceneNumber::Undamaged(0)));
        assert_eq!(number("d17"), Ok(SceneNumber::Damaged(17)));
        for word in ["", "17", "Ux", "ü3", "D-1"] {
            assert!(number(word).is_err(), "{word}");
        }
    }

    #[test]
    fn the_tables_replace_what_stands_between_the_marks() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.md");
        std::fs::write(&path, format!("a\n{BEGIN}\nold\n{END}\nb\n")).expect("a file");
        let (before, after) = parts(&path).expect("marks");
        assert_eq!((before, after), (format!("a\n{BEGIN}"), format!("{END}\nb\n")));
        std::fs::write(&path, format!("{END}{BEGIN}")).expect("a file");
        assert!(parts(&path).is_err());
    }
}
