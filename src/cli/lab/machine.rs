//! The machine at hand to what a trial says of it.

use dropcheck::lab::data::TrialMachine;

/// What this program runs on.
pub fn machine() -> TrialMachine {
    TrialMachine {
        processor: processor().unwrap_or_else(|| "a processor that does not say its name".to_owned()),
        cores: std::thread::available_parallelism().map_or(1, usize::from),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        is_optimised: !cfg!(debug_assertions),
    }
}

/// Its name where the system tells it: Linux in a file, Windows in the environment.
fn processor() -> Option<String> {
    let told = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let name = text.lines().find_map(|line| line.strip_prefix("model name"))?;
        Some(name.trim_start_matches([' ', '\t', ':']).trim().to_owned())
    });
    told.or_else(|| std::env::var("PROCESSOR_IDENTIFIER").ok()).filter(|name| !name.is_empty())
}
