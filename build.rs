//! The commit of the sources to `DROPCHECK_COMMIT`, which results name; for a release alone, or every commit
//! would build all anew.

use std::process::Command;

/// What git says, where there is a git and the sources are its.
fn git(words: &[&str]) -> Option<String> {
    let answer = Command::new("git").args(words).output().ok().filter(|answer| answer.status.success())?;
    Some(String::from_utf8(answer.stdout).ok()?.trim().to_owned())
}

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "windows") {
        // The HDF5 library takes StrStrIA from it, and its crate does not say so.
        println!("cargo::rustc-link-lib=shlwapi");
    }
    println!("cargo::rerun-if-env-changed=DROPCHECK_COMMIT");
    if std::env::var("PROFILE").is_ok_and(|profile| profile == "release") {
        println!("cargo::rerun-if-changed=.git/logs/HEAD");
        let is_told = std::env::var_os("DROPCHECK_COMMIT").is_some();
        if let Some(commit) = git(&["rev-parse", "HEAD"]).filter(|_| !is_told) {
            let is_changed = git(&["status", "--porcelain", "-uno"]).is_none_or(|files| !files.is_empty());
            println!(
                "cargo::rustc-env=DROPCHECK_COMMIT={commit}{}",
                if is_changed { "-changed" } else { "" }
            );
        }
    }
}
