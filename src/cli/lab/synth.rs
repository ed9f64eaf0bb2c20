//! `synth`: simulates the recording of a scene file, and writes it with its cask file and its truth.

use super::super::Ending;
use super::super::output::{Folder, print};
use super::super::replace::parent_of;
use crate::lab::data::{SyntheticRecording, Truth};
use crate::lab::report::SyntheticFormat;
use crate::report::rounding::optional_fixed;
use crate::{lab, report};
use clap::Args;
use miette::{ensure, miette};
use std::path::{Path, PathBuf};

/// Suffix of the recording after the scene's name, so that its cask file does not replace the scene file.
const SUFFIX: &str = "-synth.mcap";

#[derive(Args)]
#[command(after_help = include_str!("../help/synth.txt"))]
pub struct Arguments {
    /// The scene file (TOML)
    scene: PathBuf,
    /// The recording: .mcap, .h5, .hdf5 or .csv [default: the scene's name with -synth.mcap, beside it]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Seed of everything random [default: the scene's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Encoding of the blocks in MCAP [default: json]
    #[arg(long, value_parser = ["json", PROTOBUF])]
    encoding: Option<String>,
}

const PROTOBUF: &str = "protobuf";

pub fn run(arguments: &Arguments) -> miette::Result<Ending> {
    let before = paths(arguments).map(|file| file.exists());
    let (files, recording) = write_recording(arguments)?;
    let shown = |(file, was_there): (&PathBuf, bool)| {
        let replaced = if was_there { " (replaced)" } else { "" };
        report::sanitize(&file.display().to_string()) + replaced
    };
    let files: Vec<String> = files.iter().zip(before).map(shown).collect();
    print(&format!("Written: {}\n{}", files.join(", "), summary(&recording)))?;
    Ok(Ending::Clear)
}

/// Paths of recording, cask file and truth.
fn paths(arguments: &Arguments) -> [PathBuf; 3] {
    let out = arguments.out.clone().unwrap_or_else(|| default_out(&arguments.scene));
    let name = out.file_name().unwrap_or_default().to_string_lossy().into_owned();
    lab::report::synthetic_names(&name).map(|name| out.with_file_name(name))
}

/// Simulates the recording and writes its files: recording, cask file, truth.
pub fn write_recording(arguments: &Arguments) -> miette::Result<([PathBuf; 3], SyntheticRecording)> {
    let files = paths(arguments);
    let format = format(&files[0], arguments.encoding.as_deref())?;
    let names = files.each_ref().map(|file| file.file_name().unwrap_or_default().to_string_lossy());
    let place = parent_of(&files[0]);
    // A file may be named through a link; the folder itself must not be one.
    let place = place.canonicalize().unwrap_or_else(|_| place.to_path_buf());
    let folder = Folder::prepare(&place, &names.each_ref().map(|name| &**name), &[&arguments.scene])?;

    let mut scene_file = lab::scene_file::read(&arguments.scene)?;
    if let Some(seed) = arguments.seed {
        scene_file.scene.seed = seed;
    }
    let recording = lab::synthesise(&scene_file.scene);
    folder.write(&lab::report::synthetic_files(&scene_file, &recording, &names[0], format)?)?;
    Ok((files, recording))
}

fn default_out(scene: &Path) -> PathBuf {
    let mut name = scene.file_stem().unwrap_or_default().to_os_string();
    name.push(SUFFIX);
    scene.with_file_name(name)
}

fn format(out: &Path, encoding: Option<&str>) -> miette::Result<SyntheticFormat> {
    let path = out.display();
    let ending = out.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let format = match (ending.as_str(), encoding) {
        ("mcap", Some(PROTOBUF)) => return Ok(SyntheticFormat::McapProtobuf),
        ("mcap", _) => return Ok(SyntheticFormat::McapJson),
        ("h5" | "hdf5", _) => SyntheticFormat::Hdf5,
        ("csv", _) => SyntheticFormat::Csv,
        _ => {
            let mend = "end the name of --out in .mcap, .h5, .hdf5 or .csv";
            return Err(miette!(help = mend, "{path}: its ending names no format that synth writes"));
        }
    };
    let mend = "leave --encoding out, or end the name of --out in .mcap";
    ensure!(encoding.is_none(), help = mend, "--encoding is for MCAP, and {path} is none");
    Ok(format)
}

/// The most important true values; all are in the file.
fn summary(recording: &SyntheticRecording) -> String {
    let Truth { k, speed, .. } = recording.truth;
    let (seed, k, speed) = (recording.seed, optional_fixed(k, 4), optional_fixed(speed, 3));
    format!("  seed {seed}, k {k}, slap-down {speed} m/s; more in the last\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_tells_the_format_and_mcap_alone_has_encodings() {
        let format_of = |name: &str, encoding| format(Path::new(name), encoding);
        assert!(matches!(format_of("a.MCAP", None), Ok(SyntheticFormat::McapJson)));
        assert!(matches!(format_of("a.mcap", Some(PROTOBUF)), Ok(SyntheticFormat::McapProtobuf)));
        assert!(matches!(format_of("a.hdf5", None), Ok(SyntheticFormat::Hdf5)));
        let refused = |name: &str, encoding| format_of(name, encoding).unwrap_err().to_string();
        assert!(refused("a.csv", Some("json")).contains("--encoding is for MCAP"));
        assert!(refused("a.toml", None).contains("names no format"));
        assert!(refused("", None).contains("names no format"));
    }

    #[test]
    fn the_default_is_beside_the_scene_and_its_cask_file_is_not_the_scene() {
        let out = default_out(Path::new("scenes/drop.toml"));
        assert_eq!(out, Path::new("scenes/drop-synth.mcap"));
        assert_eq!(lab::report::synthetic_names("drop-synth.mcap")[1], "drop-synth.toml");
    }
}
