//! The command line of dropcheck.

mod cli;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(ended) = dropcheck::ingest::serve_hdf5() {
        return ended;
    }
    let command_line = cli::CommandLine::parse();
    match cli::run(&command_line.command) {
        Ok(outcome) => outcome.into(),
        Err(complaint) => {
            cli::complain(&complaint);
            ExitCode::from(2)
        }
    }
}
