//! Writes the completions of the command line for a shell, and its manual pages.

use super::output::print_bytes;
use super::{CommandLine, Ending};
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use miette::{IntoDiagnostic, WrapErr};
use std::path::PathBuf;

#[derive(Args)]
#[command(after_help = include_str!("help/completions.txt"))]
pub struct CompletionArguments {
    /// The shell
    shell: Shell,
}

#[derive(Args)]
pub struct ManArguments {
    /// Folder for the pages, dropcheck.1 and one a command
    dir: PathBuf,
}

/// Prints the completions of a shell.
pub fn completions(arguments: &CompletionArguments) -> miette::Result<Ending> {
    let mut out = Vec::new();
    clap_complete::generate(arguments.shell, &mut CommandLine::command(), "dropcheck", &mut out);
    print_bytes(&out)?;
    Ok(Ending::Clear)
}

/// Writes the manual pages.
pub fn man(arguments: &ManArguments) -> miette::Result<Ending> {
    std::fs::create_dir_all(&arguments.dir)
        .and_then(|()| clap_mangen::generate_to(CommandLine::command(), &arguments.dir))
        .into_diagnostic()
        .wrap_err_with(|| format!("{}: the pages cannot be written there", arguments.dir.display()))?;
    Ok(Ending::Clear)
}
