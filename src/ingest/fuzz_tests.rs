//! Bytes to each decoder, by the name of its file in `fixtures/corpus`: `tests/fuzz` looks for harmful ones,
//! the tests below replay what it kept.

use super::{Limits, ReadRequest, RecordingFile, cask_file, csv, hdf5, mcap, mme, number, time_base};
use crate::data::{CaskFile, Samples};
use crate::lab::scene_file;
use std::io::Write as _;
use std::path::Path;
use std::sync::{Arc, LazyLock};
use tempfile::NamedTempFile;

/// Takes bytes apart; none may panic, hang or take memory without bound.
pub type Decoder = fn(&[u8]);

/// Every decoder with its name.
pub const TARGETS: [(&str, Decoder); 12] = [
    ("answer", answer),
    ("cask", |bytes| in_file(bytes, |path| drop(cask_file::parse(path)))),
    ("csv", table),
    ("hdf5", datasets),
    ("json", mcap::fuzz_tests::json),
    ("mcap", messages),
    ("mme", channels),
    ("number", number),
    ("protobuf", mcap::fuzz_tests::protobuf),
    ("ros2", mcap::fuzz_tests::ros2),
    ("scene", scene),
    ("times", times),
];

static TABLE: LazyLock<CaskFile> = LazyLock::new(|| cask_of(&["A1", "A2"]));
static TOPICS: LazyLock<CaskFile> =
    LazyLock::new(|| cask_of(&["/daq/a1.samples", "/pb.samples", "/imu.linear_acceleration.z"]));
static CHANNELS: LazyLock<CaskFile> = LazyLock::new(|| cask_of(&["T0CASK00L100ACZ0", "A"]));
static DATASETS: LazyLock<CaskFile> = LazyLock::new(|| cask_of(&["/a", "/m[1]", "/r.z", "/daq/a1"]));

/// A cask file whose channels have these sources.
fn cask_of(sources: &[&str]) -> CaskFile {
    let channel = |source: &&str| {
        format!(
            "[[channel]]\nname = '{source}'\nend = 'first'\naxis = 'transverse'\nsource = \
             '{source}'\nposition_m = 0\n"
        )
    };
    let head =
        "[cask]\nname = 'c'\nmass_kg = 1\nlength_m = 1\nheight_m = 0\n[drop]\nheight_m = 1\nangle_deg = 1\n";
    let text = head.to_owned() + &sources.iter().map(channel).collect::<String>();
    cask_file::checked(Path::new("c"), &text, None).expect("a sound cask file")
}

fn in_file(bytes: &[u8], read: impl FnOnce(&Path)) {
    let mut file = NamedTempFile::new().expect("a folder for temporary files");
    file.write_all(bytes).expect("room for a short file");
    read(file.path());
}

fn in_memory(bytes: &[u8], read: impl Fn(ReadRequest)) {
    let bytes: Arc<[u8]> = bytes.into();
    let file = RecordingFile::in_memory(Path::new("recording"), &bytes);
    read(ReadRequest::silent(file, Limits::of_memory(0)));
}

fn table(bytes: &[u8]) {
    in_memory(bytes, |request| {
        let _ = csv::list(request);
        let _ = csv::read(request, &TABLE);
    });
}

/// Bytes as a file that the library of the page takes apart.
fn datasets(bytes: &[u8]) {
    in_memory(bytes, |request| {
        let _ = hdf5::list(request);
        let _ = hdf5::read(request, &DATASETS);
    });
}

fn messages(bytes: &[u8]) {
    in_memory(bytes, |request| {
        let _ = mcap::list(request);
        let _ = mcap::read(request, &TOPICS);
    });
}

/// Bytes as a zip in ISO-MME, or parted by form feeds as the index and two channels in a folder.
fn channels(bytes: &[u8]) {
    let take = |request: ReadRequest| {
        let _ = mme::list(request);
        let _ = mme::read(request, &CHANNELS);
    };
    if bytes.starts_with(b"PK") {
        return in_memory(bytes, take);
    }
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    std::fs::create_dir(folder.path().join("Channel")).expect("a folder");
    let parts = bytes.split(|&byte| byte == b'\x0c');
    let names = ["Channel/T1.chn", "Channel/T1.001", "Channel/T1.002"].into_iter();
    for (name, part) in names.zip(parts).chain([("T1.mme", &b""[..])]) {
        std::fs::write(folder.path().join(name), part).expect("room for a short file");
    }
    take(ReadRequest::silent(folder.path(), Limits::of_memory(0)));
}

/// Bytes as what the process answers that takes an HDF5 file apart; packed datasets are read from a sound
/// file.
fn answer(bytes: &[u8]) {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/examples/vhlw-rest.h5"));
    let limits = Limits::of_memory(0);
    hdf5::answer_by(bytes);
    let _ = hdf5::list(ReadRequest::silent(path, limits));
    hdf5::answer_by(bytes);
    let _ = hdf5::read(ReadRequest::silent(path, limits), &DATASETS);
}

fn scene(bytes: &[u8]) {
    in_file(bytes, |path| drop(scene_file::read(path)));
}

fn number(bytes: &[u8]) {
    for decimal in *b".," {
        let _ = number::of_cell(bytes, decimal);
        let Some((value, used)) = number::leading(bytes, decimal) else { continue };
        let text = std::str::from_utf8(&bytes[..used]).expect("ASCII");
        let same = text.replace(char::from(decimal), ".").parse::<f64>().expect("a number");
        assert_eq!(value.to_bits(), same.to_bits(), "{text}");
    }
    let _ = number::leading_json(bytes);
    let _ = number::is_missing(bytes);
    let _ = number::is_grouped(&String::from_utf8_lossy(bytes), Some(b'.'));
}

fn times(bytes: &[u8]) {
    let times_s: Vec<f64> = bytes.as_chunks().0.iter().map(|&eight| f64::from_le_bytes(eight)).collect();
    let samples = Samples::F64(times_s.iter().map(|t| t * 2.0).collect());
    let _ = time_base::from_times(&times_s, samples, None);
    let Some((&rate_hz, starts_s)) = times_s.split_first() else { return };
    let blocks: Vec<_> = starts_s.iter().map(|&start_s| time_base::Block { start_s, count: 3 }).collect();
    let _ = time_base::from_blocks(&blocks, rate_hz, Samples::F32([1.0, f32::NAN, 3.0].repeat(blocks.len())));
}

/// Reads what is kept; the integration tests read it by the same file.
#[cfg(test)]
#[path = "../../tests/it/stored.rs"]
mod stored;

#[cfg(test)]
mod tests {
    use super::stored::stored;
    use super::*;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};
    use std::panic::catch_unwind;
    use std::time::{Duration, Instant};

    /// Mutants of each target's inputs; the search for new ones is that of `tests/fuzz`.
    const MUTANTS: usize = 2000;
    /// No input of a few kilobytes may take so long, in the slowest profile.
    const HANG: Duration = Duration::from_secs(5);

    #[test]
    fn stored_inputs_and_their_mutants_do_no_harm() {
        for (target, decode) in TARGETS {
            let stored: Vec<Vec<u8>> = stored(&format!("corpus/{target}.jsonl")).into_values().collect();
            let mut chance = ChaCha8Rng::seed_from_u64(1);
            let mutants = (0..MUTANTS).map(|_| mutant(&stored, &mut chance));
            for input in stored.iter().cloned().chain(mutants) {
                let begun = Instant::now();
                let is_harmless = catch_unwind(|| decode(&input)).is_ok() && begun.elapsed() < HANG;
                assert!(is_harmless, "{target}: \"{}\"", input.escape_ascii());
            }
        }
    }

    /// A stored input with a few bytes taken out, alike, doubled, or with the end of another.
    fn mutant(stored: &[Vec<u8>], chance: &mut ChaCha8Rng) -> Vec<u8> {
        let any = |chance: &mut ChaCha8Rng| &stored[chance.random_range(0..stored.len())];
        let mut input = any(chance).clone();
        for _ in 0..chance.random_range(1..8) {
            let at = chance.random_range(0..=input.len());
            let end = (at + chance.random_range(0..16)).min(input.len());
            match chance.random_range(0..4) {
                0 => drop(input.drain(at..end)),
                1 => input[at..end].fill(chance.random()),
                2 => input.extend_from_within(at..end),
                _ => {
                    let other = any(chance);
                    input.truncate(at);
                    input.extend_from_slice(&other[chance.random_range(0..=other.len())..]);
                }
            }
        }
        input
    }
}
