//! Work of the trial to the errors and times of scipy on it, where Python has it.

use dropcheck::lab::data::{TrialPart, TrialPeerWork, TrialPoint};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const SCRIPT: &str = include_str!("../../../benches/peer_methods.py");

/// Longer than this no peer is waited for: the work takes a tenth of it.
const PATIENCE: Duration = Duration::from_mins(2);

/// The peers' points, and a sentence on what became of them.
pub fn peers(work: &[TrialPeerWork], quick: bool) -> (TrialPart, String) {
    match tried(work, quick) {
        Ok((version, points)) => {
            (TrialPart { points, maps: Vec::new() }, format!("{version} was given the same samples."))
        }
        Err(reason) => (TrialPart::default(), format!("No program of others was tried: {reason}.")),
    }
}

/// What the script says: its versions and points; or why there are none.
fn tried(work: &[TrialPeerWork], quick: bool) -> Result<(String, Vec<TrialPoint>), String> {
    let folder = tempfile::tempdir().map_err(|e| format!("no scratch folder ({e})"))?;
    written(work, folder.path()).map_err(|e| format!("the samples could not be handed over ({e})"))?;
    let answer = folder.path().join("answer.json");
    let mut child = Command::new("python3")
        .args(["-", if quick { "quick" } else { "full" }])
        .arg(folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|_| "there is no python3".to_owned())?;
    if let Some(mut input) = child.stdin.take() {
        // A Python that ended early says so by its exit status.
        let _ = input.write_all(SCRIPT.as_bytes());
    }
    let begun = Instant::now();
    let status = loop {
        match child.try_wait() {
            Ok(Some(status)) => break status,
            Ok(None) if begun.elapsed() < PATIENCE => std::thread::sleep(Duration::from_millis(20)),
            _ => {
                // Whether or not it could still be ended, its answer is not waited for.
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("scipy took more than {} s", PATIENCE.as_secs()));
            }
        }
    };
    if !status.success() {
        return Err("python3 has no scipy".to_owned());
    }
    let text = std::fs::read(&answer).map_err(|_| "the script gave no answer".to_owned())?;
    serde_json::from_slice(&text).map_err(|_| "the script's answer could not be read".to_owned())
}

/// The work as files: a list, and samples and truth of each as little-endian doubles.
fn written(work: &[TrialPeerWork], folder: &Path) -> std::io::Result<()> {
    let bytes = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let mut list = Vec::new();
    for (i, one) in work.iter().enumerate() {
        std::fs::write(folder.join(format!("{i}.samples")), bytes(&one.samples))?;
        std::fs::write(folder.join(format!("{i}.truth")), bytes(&one.truth))?;
        list.push(serde_json::json!({
            "family": one.family,
            "class": one.class,
            "low_pass": one.low_pass,
            "drop": one.drop,
            "error_unit": one.error_unit,
        }));
    }
    std::fs::write(folder.join("work.json"), serde_json::Value::from(list).to_string())
}
