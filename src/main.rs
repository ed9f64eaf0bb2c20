//! The command line of dropcheck.

use std::ffi::OsString;
use std::process::ExitCode;

fn main() -> ExitCode {
    if let Some(ended) = dropcheck::serve_hdf5() {
        return ended;
    }
    let words: Vec<OsString> = std::env::args_os().skip(1).collect();
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    if words.first().is_some_and(|word| word == "validate")
        && words.iter().any(|word| word.to_string_lossy().starts_with("--campaign"))
    {
        again_with_memory_given_back(&words);
    }
    ExitCode::from(dropcheck::command::main(&words))
}

/// Starts this program in its own place with limits above which glibc gives freed pieces back to the system:
/// without them a campaign of scenes leaves more and more holes of all sizes (docs/scale.md). Returns where
/// they are set already or it cannot be started.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn again_with_memory_given_back(words: &[OsString]) {
    use std::os::unix::process::CommandExt;
    const NAME: &str = "GLIBC_TUNABLES";
    const LIMITS: &str = "glibc.malloc.mmap_threshold=65536:glibc.malloc.trim_threshold=262144";
    if std::env::var_os(NAME).is_none()
        && let Ok(program) = std::env::current_exe()
    {
        // Whatever prevents it, the campaign goes on as it is.
        let _ = std::process::Command::new(program).args(words).env(NAME, LIMITS).exec();
    }
}
