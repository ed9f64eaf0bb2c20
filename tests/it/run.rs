//! From words for the command line to what the program answered.

use serde_json::Value;
use std::collections::BTreeMap;
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

/// Words for the command line: texts and paths.
macro_rules! words {
    ($($word:expr),*) => { [$(std::ffi::OsStr::new(&$word)),*] };
}
pub(crate) use words;

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
    dropcheck(words!["analyze", recording, "--cask", cask, "--json", "-"])
}

/// Opens a page in a browser and holds it to what a script of `tests/browser` checks; passes with a word
/// where the tools are missing.
#[track_caller]
pub fn in_a_browser(script: &str, page: &Path) {
    let has_tools = Command::new("python3")
        .args([
            "-c",
            "import axe_core_python, selenium, shutil, sys\n\
             sys.exit(not all(map(shutil.which, ('chromedriver', 'pdftotext'))))",
        ])
        .output();
    if !has_tools.is_ok_and(|answer| answer.status.success()) {
        println!(
            "skipped: tests/browser/{script} needs chromedriver, pdftotext, selenium and axe-core-python"
        );
        return;
    }
    let path = root().join("tests/browser").join(script);
    let Output { status, stdout, stderr } =
        Command::new("python3").arg(path).arg(page).output().expect("python");
    let [stdout, stderr] = [stdout, stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(status.success(), "{stdout}{stderr}");
}

impl Answer {
    /// Standard output as one JSON value, nothing before or after it.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("{error}\nstdout: {}\nstderr: {}", self.stdout, self.stderr))
    }
}

/// The project's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every file below a folder, sorted.
fn all_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(all_below(&path));
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Those whose name ends so.
pub fn files_below(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = all_below(folder);
    found.retain(|path| path.extension().is_some_and(|own| own == extension));
    found
}

/// Every file below a folder by its path from there, with its bytes.
pub fn tree(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let from_here = |path: &Path| path.strip_prefix(folder).expect("below").to_owned();
    let bytes = |path: &Path| std::fs::read(path).expect("a file");
    all_below(folder).iter().map(|path| (from_here(path), bytes(path))).collect()
}

/// The folder of all fixtures.
pub fn fixtures() -> PathBuf {
    root().join("fixtures")
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

/// What a result says of its data, as JSON.
pub fn findings(result: &Value) -> String {
    result["quality"].to_string()
}

/// The number at a JSON pointer, `None` where it is null or absent.
pub fn number(value: &Value, pointer: &str) -> Option<f64> {
    value.pointer(pointer).and_then(Value::as_f64)
}
