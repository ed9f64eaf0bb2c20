//! The library in Rust alone beside the C library, over files that both are asked about.

use super::super::answer::{Object, Storage};
use super::super::room::File;
use super::super::{find, list};
use super::*;
use crate::data::{Listing, Samples};
use crate::ingest::{Limits, ReadRequest, RecordingFile};
use std::path::Path;

/// An object with its attributes in order, and without what neither the reader nor its numbers depend on.
fn plain(object: &Object) -> Object {
    let mut object = object.clone();
    match &mut object {
        Object::Group { attributes, .. } => attributes.sort_by(|one, other| one.0.cmp(&other.0)),
        Object::Dataset(told) => {
            told.attributes.sort_by(|one, other| one.0.cmp(&other.0));
            // Behind a user block the C library tells an address also where there is none.
            if let Storage::Contiguous(at) = &mut told.storage
                && told.stored_bytes == 0
            {
                *at = None;
            }
            // References to what is stored elsewhere take other room in memory.
            if told.is_records && told.fields.is_empty() {
                told.value_bytes = 0;
            }
            if let Storage::Chunked { chunks: Some(chunks), .. } = &mut told.storage {
                chunks.sort_by_key(|chunk| (chunk.row, chunk.column));
            }
        }
        Object::Broken(_) => object = Object::Broken(Vec::new()),
        _ => {}
    }
    object
}

fn listed(file: RecordingFile) -> Listing {
    let request = ReadRequest { file, limits: Limits::default(), progress: &|_| () };
    let mut listing = list::list(request).unwrap();
    listing.facts.clear();
    listing
}

/// Asks both libraries about the file at `path` and holds that they answer the same; what the one in Rust
/// alone refuses.
pub(in super::super) fn refused_of(path: &Path) -> Vec<String> {
    let bytes: Arc<[u8]> = std::fs::read(path).unwrap().into();
    let memory = RecordingFile::in_memory(path, &bytes);
    let on_disk = File::open(path, Limits::default());
    let (on_disk, in_memory) = match (on_disk, File::open(memory, Limits::default())) {
        (Ok(on_disk), Ok(in_memory)) => (on_disk, in_memory),
        (_, Err(refusal)) => return vec![format!("{refusal:?}")],
        (Err(refusal), Ok(_)) => panic!("{refusal:?}"),
    };
    let (mut refused, walked) = (Vec::new(), [on_disk.walk(), in_memory.walk()]);
    for ((path, expected), (also, object)) in walked[0].iter().zip(&walked[1]) {
        assert_eq!(path, also);
        match &**object {
            Object::Broken(words) if !matches!(**expected, Object::Broken(_)) => {
                let words: Vec<_> = words.iter().map(|word| String::from_utf8_lossy(word)).collect();
                refused.push(format!("{path}: {}", words.join(": ")));
            }
            told => assert_eq!(plain(told), plain(expected), "{path}"),
        }
    }
    assert_eq!(walked[0].len(), walked[1].len());
    let listings = [listed(path.into()), listed(memory)];
    // A filter that is not undone in memory leaves a channel without its rate and range.
    if refused.is_empty() && listings[1].channels.iter().all(|channel| channel.unreadable.is_none()) {
        assert_eq!(listings[1], listings[0]);
    }
    for channel in &listings[1].channels {
        let Ok(column) = find::locate(&in_memory, &channel.source) else { continue };
        let samples = find::locate(&on_disk, &channel.source).unwrap().samples();
        let same = |one: &Samples, other: &Samples| {
            let bits =
                |samples: &Samples| (0..samples.len()).map(|i| samples.get(i).to_bits()).collect::<Vec<_>>();
            bits(one) == bits(other)
        };
        match (column.samples(), samples) {
            (Ok(samples), Ok(expected)) => assert!(same(&samples, &expected), "{}", channel.source),
            (Err(_), Err(_)) => {}
            (Err(refusal), Ok(_)) => refused.push(format!("{}: {refusal:?}", channel.source)),
            (Ok(_), Err(refusal)) => panic!("{}: {refusal:?}", channel.source),
        }
    }
    refused
}

#[test]
fn the_examples_are_read_the_same() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/examples/*.h5");
    let mut count = 0;
    for path in glob::glob(examples.to_str().unwrap()).unwrap() {
        assert_eq!(refused_of(&path.unwrap()), Vec::<String>::new());
        count += 1;
    }
    assert_eq!(count, 3);
}

#[test]
fn the_reader_is_named_as_it_is() {
    let (name, version) = READER.split_once(' ').unwrap();
    let locked = include_str!("../../../../Cargo.lock");
    assert!(locked.contains(&format!("name = \"{name}\"\nversion = \"{version}\"")));
}

#[test]
fn a_changed_byte_is_no_panic() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/examples/damaged-clipped.h5");
    let sound = std::fs::read(&path).unwrap();
    let (mut state, mut opened) = (1_u64, 0);
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).unwrap() % below
    };
    for _ in 0..600 {
        let mut bytes = sound.clone();
        // All but the numbers lies in the beginning.
        for _ in 0..=next(3) {
            let (at, bits) = (next(8000), u8::try_from(next(256)).unwrap());
            bytes[at] = bits;
        }
        let bytes: Arc<[u8]> = bytes.into();
        let Ok(file) = File::open(RecordingFile::in_memory(&path, &bytes), Limits::default()) else {
            continue;
        };
        opened += 1;
        for channel in listed(RecordingFile::in_memory(&path, &bytes)).channels {
            let _ = find::locate(&file, &channel.source).map(|column| column.samples());
        }
    }
    assert!(opened > 100);
}
