//! Bytes from libFuzzer to the decoder that `DROPCHECK_TARGET` names.
#![no_main]

use dropcheck::ingest::fuzz_tests::TARGETS;
use std::sync::LazyLock;

static DECODE: LazyLock<fn(&[u8])> = LazyLock::new(|| {
    let named = std::env::var("DROPCHECK_TARGET").unwrap_or_default();
    let target = TARGETS.iter().find(|(name, _)| *name == named);
    target.expect("DROPCHECK_TARGET is none of dropcheck::ingest::fuzz_tests::TARGETS").1
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| DECODE(bytes));
