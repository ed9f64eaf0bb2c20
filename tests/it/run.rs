//! From words for the command line to what the program answered.

use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The exit status, the standard output and the standard error of one run.
pub struct Answer {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

/// Runs the built program.
pub fn dropcheck<S: AsRef<OsStr>>(words: impl IntoIterator<Item = S>) -> Answer {
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_dropcheck"))
        .args(words)
        .env_remove("RUST_BACKTRACE")
        .env("SOURCE_DATE_EPOCH", "0")
        .output()
        .expect("the program starts");
    Answer {
        status: status.code().expect("the program ends by itself"),
        stdout: String::from_utf8(stdout).expect("UTF-8 on standard output"),
        stderr: String::from_utf8(stderr).expect("UTF-8 on standard error"),
    }
}

/// Runs `analyze RECORDING --cask CASK --json -`.
pub fn analyze(recording: &Path, cask: &Path) -> Answer {
    dropcheck([
        OsStr::new("analyze"),
        recording.as_os_str(),
        OsStr::new("--cask"),
        cask.as_os_str(),
        OsStr::new("--json"),
        OsStr::new("-"),
    ])
}

impl Answer {
    /// Standard output as one JSON value, nothing before or after it.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("{error}\nstdout: {}\nstderr: {}", self.stdout, self.stderr))
    }
}

/// The folder of all fixtures.
pub fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// An example of the fixtures: a recording, its cask file or a scene.
pub fn fixture(name: &str) -> PathBuf {
    fixtures().join("examples").join(name)
}

/// What the simulation knows of the example of that stem.
pub fn truth(stem: &str) -> Value {
    read_json(&fixtures().join(format!("reference/{stem}.truth.json")))
}

/// A JSON file below the project's root.
pub fn read_json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The number at a JSON pointer, `None` where it is null or absent.
pub fn number(value: &Value, pointer: &str) -> Option<f64> {
    value.pointer(pointer).and_then(Value::as_f64)
}
