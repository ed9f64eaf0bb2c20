//! `--max-memory`: parses a size and limits the reading of a recording to it.

use crate::ingest::{LEAST_MEMORY_BYTES, Limits};
use clap::Args;

/// Limit of the memory for reading.
#[derive(Args)]
pub struct Bounds {
    /// Memory that reading may take; every size that a file claims is held against it [default: 4GiB]
    #[arg(long, value_name = "SIZE", value_parser = parse_limits)]
    max_memory: Option<Limits>,
}

impl Bounds {
    /// Returns the limits that were given, else the usual ones.
    pub fn limits(&self) -> Limits {
        self.max_memory.unwrap_or_default()
    }
}

/// Parses limits such as "2GB", "1.5 GiB", "500MB", in thousands or 1024 as the unit is defined.
fn parse_limits(text: &str) -> Result<Limits, String> {
    /// Each unit is larger than the one before by this factor.
    const UNITS: [(&str, f64); 2] = [("b kb mb gb tb", 1000.0), ("b kib mib gib tib", 1024.0)];
    let lower = text.trim().to_lowercase().replace(',', ".");
    let number = lower.trim_end_matches(char::is_alphabetic);
    let unit = &lower[number.len()..];
    let place = |units: &str| units.split(' ').zip(0..).find(|(u, _)| *u == unit).map(|(_, place)| place);
    let factor = UNITS.iter().find_map(|(units, factor)| Some(factor.powi(place(units)?)));
    let factor = factor.ok_or_else(|| "a size needs its unit, such as 8GB or 500MB".to_owned())?;
    let number: f64 = number.trim().parse().map_err(|_| "no number stands before the unit".to_owned())?;
    let bytes = number * factor;
    #[allow(clippy::cast_precision_loss, reason = "a small constant")]
    let least_bytes = LEAST_MEMORY_BYTES as f64;
    if !(bytes >= least_bytes && bytes < 1e18) {
        return Err(format!("reading needs {} MiB at least", LEAST_MEMORY_BYTES >> 20));
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in range, tested above")]
    Ok(Limits::of_memory(bytes as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_as_people_write_them() {
        for (text, bytes) in
            [("2GB", 2_000_000_000), ("1.5 GiB", 3 << 29), ("500 mb", 500_000_000), ("0,5GiB", 1 << 29)]
        {
            assert_eq!(parse_limits(text), Ok(Limits::of_memory(bytes)), "{text}");
        }
        for text in ["", "2", "GB", "1MB", "-3GB", "nanGB", "1e30TB", "many"] {
            assert!(parse_limits(text).is_err(), "{text}");
        }
    }
}
