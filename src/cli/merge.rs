//! `merge`: joins the shards of a campaign, as `--jsonl` wrote them on any machines, into the files that one
//! run would have written.

use super::lines::{read_schema, refuse_other_file};
use super::{Ending, batch};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = "Example:\n  dropcheck merge shard-*.jsonl --out campaign")]
pub struct Arguments {
    /// What `--jsonl` wrote, of every shard
    #[arg(required = true, value_name = "SHARD.jsonl")]
    shards: Vec<PathBuf>,
    /// Folder for the campaign's files
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Exit status 0 also where results want a look; 2 stays for what could not be analysed
    #[arg(long)]
    exit_zero: bool,
}

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let (shards, out) = (&arguments.shards[..], arguments.out.as_path());
    let ending = match read_schema(&shards[0])?.as_str() {
        batch::SHARD_SCHEMA => batch::merge(shards, out)?,
        #[cfg(feature = "lab")]
        crate::lab::campaign::SCHEMA => super::lab::campaign::merge(shards, out)?,
        _ => return Err(refuse_other_file(&shards[0])),
    };
    Ok(ending.with_exit_zero(arguments.exit_zero))
}
