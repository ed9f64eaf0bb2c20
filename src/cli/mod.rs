//! Parses the command line, runs its command, and turns the outcome into an exit status.

mod analyze;
mod batch;
mod check;
mod complaint;
mod embedded;
mod help;
mod init;
mod inspect;
#[cfg(feature = "lab")]
mod lab;
mod limits;
mod lines;
mod merge;
mod output;
mod pdf;
mod predict;
mod progress;
mod protected_folders;
mod replace;
mod rerun;

pub use crate::report::message;
#[cfg(feature = "lab")]
pub use embedded::synthetic;
pub use embedded::{analysis, listing, prediction, write};

use crate::data::Program;
use anstream::ColorChoice;
use clap::{Parser, Subcommand};
use std::ffi::OsString;

/// Text after the help, without the lab's commands if the build lacks them.
fn after_help() -> String {
    let lines = include_str!("help/main.txt").split_inclusive('\n');
    lines.filter(|line| cfg!(feature = "lab") || !line.contains("dropcheck synth")).collect()
}

/// Version and, if the build knows it, commit, as "0.2.0 (0123abc)".
fn version() -> &'static str {
    let words: &'static str = Program::current().words().leak();
    words.split_once(' ').map_or(words, |(_, version)| version)
}

/// What accelerometers on both ends of a dropped cask say about its slap-down.
#[derive(Parser)]
#[command(name = "dropcheck", version = version(), after_help = after_help(), max_term_width = 100)]
pub struct CommandLine {
    #[command(subcommand)]
    pub command: Command,
    /// Colours: auto shows them on a terminal
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto",
          value_parser = ["auto", "always", "never"])]
    color: String,
    /// Print no tables and no progress: files, --json -, errors and the exit status alone
    #[arg(short, long, global = true)]
    quiet: bool,
}

impl CommandLine {
    /// Sets colours and quiet mode.
    fn set_output(&self) {
        let colours = match self.color.as_str() {
            "always" => ColorChoice::Always,
            "never" => ColorChoice::Never,
            _ => ColorChoice::Auto,
        };
        colours.write_global();
        output::set_quiet(self.quiet);
    }
}

#[derive(Subcommand)]
pub enum Command {
    /// Analyse one recording: table, and with --out a report
    Analyze(analyze::Arguments),
    /// Before the drop: hold a recording at rest against the cask file
    Check(check::Arguments),
    /// Analyse a campaign of recordings into one table
    Batch(batch::Arguments),
    /// Put the shards of a campaign together: the files that one run would have written
    Merge(merge::Arguments),
    /// Predict the slap-down by the analytical model, without a recording
    Predict(predict::Arguments),
    /// List what a recording holds: sources, rates, units, gaps
    Inspect(inspect::Arguments),
    /// Write a commented cask file to fill in, from what a recording holds
    Init(init::Arguments),
    /// Make a synthetic recording of a scene, with its cask file and its truth
    #[cfg(feature = "lab")]
    Synth(lab::synth::Arguments),
    /// Measure speed against accuracy of every method and where each fails; or the analysis on random scenes
    #[cfg(feature = "lab")]
    Validate(lab::validate::Arguments),
    /// Write what a shell completes the command line by
    Completions(help::CompletionArguments),
    /// Write the manual pages
    Man(help::ManArguments),
}

/// Outcome of a command that ran to its end; its number is the exit status.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ending {
    /// The result is accepted.
    Clear,
    /// A person should look at the result.
    NeedsALook,
    /// One recording of several could not be analysed.
    NotDone,
}

impl Ending {
    /// Outcome for a result at which a person should look, or need not.
    pub fn from_review(needs_a_look: bool) -> Self {
        if needs_a_look { Self::NeedsALook } else { Self::Clear }
    }

    /// Applies `--exit-zero`: results that need a look end like the others.
    pub fn with_exit_zero(self, exit_zero: bool) -> Self {
        if exit_zero && self == Self::NeedsALook { Self::Clear } else { self }
    }
}

/// Runs the command given by the words after the program's name, and returns its exit status.
#[must_use]
pub fn main(words: &[OsString]) -> u8 {
    let named = std::iter::once("dropcheck".into()).chain(words.iter().cloned());
    let outcome = CommandLine::try_parse_from(named).map(|line| {
        line.set_output();
        run(&line.command, words)
    });
    match outcome {
        Ok(Ok(ending)) => ending as u8,
        Ok(Err(complaint)) => {
            complaint::complain(&complaint);
            2
        }
        Err(help_or_fault) => {
            // If the output is closed, nobody can be informed.
            let _ = help_or_fault.print();
            u8::try_from(help_or_fault.exit_code()).unwrap_or(2)
        }
    }
}

fn run(command: &Command, words: &[OsString]) -> miette::Result<Ending> {
    match command {
        Command::Analyze(arguments) => analyze::run(arguments, rerun::to_text(words)),
        Command::Check(arguments) => check::run(arguments),
        Command::Batch(arguments) => batch::run(arguments),
        Command::Merge(arguments) => merge::run(arguments),
        Command::Predict(arguments) => predict::run(arguments),
        Command::Inspect(arguments) => inspect::run(arguments),
        Command::Init(arguments) => init::run(arguments),
        #[cfg(feature = "lab")]
        Command::Synth(arguments) => lab::synth::run(arguments),
        #[cfg(feature = "lab")]
        Command::Validate(arguments) => lab::validate::run(arguments),
        Command::Completions(arguments) => help::completions(arguments),
        Command::Man(arguments) => help::man(arguments),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_well_formed() {
        CommandLine::command().debug_assert();
    }

    #[test]
    fn the_worst_outcome_is_the_greatest() {
        assert!(Ending::Clear < Ending::NeedsALook && Ending::NeedsALook < Ending::NotDone);
    }
}
