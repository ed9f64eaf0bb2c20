//! A corpus and a decoder to many mutated inputs: none may panic, hang or take memory without bound.
//!
//! Mutants that end in a way not seen before join the corpus of the run, so that later ones begin behind the first checks.
//! `DROPCHECK_FUZZ` sets the executions of each decoder, `DROPCHECK_KEEP=1` adds what ended in a way of its own to
//! `fixtures/corpus`.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Executions of each decoder in a usual run of the tests, and the time after which it ends in any case.
const USUAL_EXECUTIONS: u64 = 2000;
const USUAL_TIME: Duration = Duration::from_secs(2);
/// No input of a few kilobytes may take so long, in the slowest profile.
const HANG: Duration = Duration::from_secs(5);
/// Inputs stay short: what breaks a decoder is seldom its length.
const LONGEST: usize = 1 << 14;
/// Inputs that end in a way of their own are kept up to so many.
const MOST_KEPT: usize = 2000;

fn folder(target: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "fixtures/corpus", target].iter().collect()
}

/// Mutates `seeds` and the target's corpus; `words` are what its format is made of, `decode` tells how an input ended.
pub(super) fn run(target: &str, seeds: &[Vec<u8>], words: &[&[u8]], decode: impl Fn(&[u8]) -> String) {
    let asked = std::env::var("DROPCHECK_FUZZ").ok().and_then(|text| text.parse::<u64>().ok());
    let mut pool: Vec<Vec<u8>> = seeds.to_vec();
    let mut stored: Vec<_> = std::fs::read_dir(folder(target)).into_iter().flatten().flatten().collect();
    stored.sort_by_key(std::fs::DirEntry::file_name);
    pool.extend(stored.iter().map(|entry| std::fs::read(entry.path()).unwrap()));
    let mut seen = HashSet::new();
    for input in &pool {
        seen.insert(executed(target, input, &decode));
    }
    let (known, begun) = (pool.len(), Instant::now());
    let seed = std::env::var("DROPCHECK_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(1);
    let mut chance = ChaCha8Rng::seed_from_u64(seed);
    let mut executions = 0;
    while executions < asked.unwrap_or(USUAL_EXECUTIONS) {
        if asked.is_none() && begun.elapsed() > USUAL_TIME {
            break;
        }
        let input = mutant(&pool, words, &mut chance);
        executions += 1;
        if seen.insert(executed(target, &input, &decode)) && pool.len() < MOST_KEPT {
            pool.push(input);
        }
    }
    println!("{target}: {executions} executions, {} ends, {:.1?}", seen.len(), begun.elapsed());
    if std::env::var_os("DROPCHECK_KEEP").is_some() {
        keep(target, &pool, known - stored.len());
    }
}

/// How the input ended, without its numbers; panics with the place of the input where it must not end so.
fn executed(target: &str, input: &[u8], decode: &impl Fn(&[u8]) -> String) -> u64 {
    let begun = Instant::now();
    let end = catch_unwind(AssertUnwindSafe(|| decode(input)));
    let took = begun.elapsed();
    let Ok(end) = end else { panic!("{target} panics at {}", set_down(target, input).display()) };
    assert!(took < HANG, "{target} takes {took:?} for {}", set_down(target, input).display());
    let mut hasher = DefaultHasher::new();
    for word in end.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| word.len() > 2).take(24) {
        word.hash(&mut hasher);
    }
    hasher.finish()
}

fn set_down(target: &str, input: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("dropcheck-fuzz-{target}"));
    std::fs::write(&path, input).unwrap();
    path
}

/// Stores the shortest of what the run found, twenty inputs of fifty kilobytes together at most.
fn keep(target: &str, pool: &[Vec<u8>], seeds: usize) {
    std::fs::create_dir_all(folder(target)).unwrap();
    let mut found: Vec<&Vec<u8>> = pool.iter().skip(seeds).collect();
    found.sort_by_key(|input| input.len());
    let mut left = 50_000_usize;
    for input in found.into_iter().take(20) {
        let Some(fewer) = left.checked_sub(input.len()) else { break };
        left = fewer;
        let mut hasher = DefaultHasher::new();
        input.hash(&mut hasher);
        std::fs::write(folder(target).join(format!("{:016x}", hasher.finish())), input).unwrap();
    }
}

fn mutant(pool: &[Vec<u8>], words: &[&[u8]], chance: &mut ChaCha8Rng) -> Vec<u8> {
    let mut input = pool[chance.random_range(0..pool.len())].clone();
    for _ in 0..1 << chance.random_range(0..5) {
        mutate(&mut input, pool, words, chance);
    }
    input.truncate(LONGEST);
    input
}

fn mutate(input: &mut Vec<u8>, pool: &[Vec<u8>], words: &[&[u8]], chance: &mut ChaCha8Rng) {
    const EDGES: [u64; 12] =
        [0, 1, 0x7f, 0x80, 0xff, 0x7fff, 0xffff, 0x7fff_ffff, 0xffff_ffff, 1 << 40, u64::MAX >> 1, u64::MAX];
    let at = chance.random_range(0..=input.len());
    let rest = input.len() - at;
    let most = rest.min(1 << chance.random_range(0..9));
    let span = chance.random_range(0..=most);
    match chance.random_range(0..10) {
        0 | 1 if rest > 0 => input[at] ^= 1 << chance.random_range(0..8),
        2 if rest > 0 => input[at] = chance.random(),
        3 => {
            let edge = EDGES[chance.random_range(0..EDGES.len())].to_le_bytes();
            let width = (1 << chance.random_range(0..4)).min(rest);
            input[at..at + width].copy_from_slice(&edge[..width]);
        }
        4 => drop(input.drain(at..at + span)),
        5 => {
            let block = input[at..at + span].to_vec();
            let times = chance.random_range(1..5);
            (0..times).for_each(|_| drop(input.splice(at..at, block.clone())));
        }
        6 => {
            let other = &pool[chance.random_range(0..pool.len())];
            let from = chance.random_range(0..=other.len());
            input.truncate(at);
            input.extend_from_slice(&other[from..]);
        }
        7 => input.truncate(at),
        _ if !words.is_empty() => {
            let word = words[chance.random_range(0..words.len())];
            let end = at + if chance.random() { span } else { 0 };
            drop(input.splice(at..end, word.iter().copied()));
        }
        _ => {}
    }
}
