//! The command line of dropcheck.

use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(ended) = dropcheck::serve_hdf5() {
        return ended;
    }
    let words: Vec<_> = std::env::args_os().skip(1).collect();
    ExitCode::from(dropcheck::command::main(&words))
}
