//! `validate`: runs the acceptance of the program, or a campaign of random scenes with known truth into
//! tables of the analysis's errors.

use super::super::Ending;
use super::super::output::{Folder, print};
use super::{campaign, trial};
use crate::lab::data::{CampaignRequest, SceneNumber, TrialRequest};
use crate::lab::report::SyntheticFormat;
use crate::{lab, report};
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(after_help = include_str!("../help/validate.txt"))]
#[command(group = clap::ArgGroup::new("what").args(["campaign", "scene"]))]
pub struct Arguments {
    /// Analyse N random undamaged scenes and N of other kinds, with one damage each or none
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    campaign: Option<u32>,
    /// Write one scene of the campaign as recording, cask file and truth into --out
    #[arg(long, value_name = "NUMBER", requires = "out")]
    scene: Option<SceneNumber>,
    /// Try the ways of working on fewer scenes
    #[arg(long, conflicts_with = "what")]
    quick: bool,
    /// Folder of your own reference recordings, with their expected values in reference.toml; they are part
    /// of what is accepted
    #[arg(long, value_name = "DIR", conflicts_with = "what")]
    reference: Option<PathBuf>,
    /// Seed of everything random
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// all, undamaged, sound (all kinds of sound drops), or kinds, separated by commas
    #[arg(long, value_name = "KINDS", default_value = "all", value_delimiter = ',', value_parser = kinds(),
        hide_possible_values = true, requires = "campaign")]
    kinds: Vec<String>,
    /// What is stated is exactly true: no deviations within the tolerances
    #[arg(long, requires = "what")]
    exact: bool,
    /// Folder for the page, pictures and tables of the trial, for campaign.md, or for the files of the scene
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    parts: campaign::CampaignParts,
}

fn kinds() -> PossibleValuesParser {
    lab::campaign::WORDS.into_iter().chain(lab::campaign::kinds().map(|kind| kind.name)).into()
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    match (arguments.scene, &arguments.out, arguments.campaign) {
        (Some(number), Some(out), _) => write_scene(arguments, number, out),
        (_, out, Some(scenes)) => {
            let kinds = arguments.kinds.iter().cloned().collect();
            let request = CampaignRequest { scenes, seed: arguments.seed, kinds, exact: arguments.exact };
            campaign::run(&request, &arguments.parts, out.as_deref())
        }
        (_, out, None) => {
            let request = TrialRequest { quick: arguments.quick, seed: arguments.seed };
            trial::run(request, arguments.reference.as_deref(), out.as_deref())
        }
    }
}

/// Writes the files of one scene.
fn write_scene(arguments: &Arguments, number: SceneNumber, out: &Path) -> miette::Result<Ending> {
    let name = format!("{number}.mcap");
    let names = lab::report::synthetic_names(&name);
    let folder = Folder::prepare(out, &names.each_ref().map(String::as_str), &[])?;
    let (scene, recording) = lab::campaign::scene(arguments.seed, number, arguments.exact);
    // Protobuf, unlike JSON, can hold infinite samples.
    folder.write(&lab::report::synthetic_files(&scene, &recording, &name, SyntheticFormat::McapProtobuf)?)?;
    let files = names.each_ref().map(|name| report::sanitize(&folder.file(name)));
    print(&format!("Written: {}\n", files.join(", ")))?;
    Ok(Ending::Clear)
}
