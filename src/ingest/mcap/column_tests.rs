//! Tests of the samples of one field.

use super::*;
use crate::data::Severity;

fn block(samples: &[f64]) -> Value {
    Value::Array(Samples::F64(samples.to_vec()))
}

#[test]
fn a_rate_comes_from_the_cask_file_else_the_message_else_the_stamps() {
    let column = |stated: Option<f64>| {
        let mut column = Column::default();
        for i in 0..4 {
            let time = (1_700_000_000_000_000_000 + i * 2_000_000, TimeOrigin::Stamp);
            column.take(block(&[1.0, 2.0]), time, stated);
        }
        column
    };
    let rate = |stated, declared| {
        column(stated).uniform(1_700_000_000_000_000_000, declared).unwrap().sample_rate_hz
    };
    assert!((rate(None, None) - 1000.0).abs() < 1e-6);
    assert!((rate(Some(1000.0), None) - 1000.0).abs() < 1e-9);
    assert!((rate(Some(500.0), Some(1000.0)) - 1000.0).abs() < 1e-9);
    assert!(matches!(column(Some(0.0)).uniform(0, None), Err(ColumnError::StatedRate(_))));
}

#[test]
fn a_rate_that_contradicts_the_stamps_by_far_tears_no_blocks_apart() {
    let column = |nanoseconds: &dyn Fn(i64) -> i64| {
        let mut column = Column::default();
        for i in 0..10_i32 {
            let first = f64::from(2 * i);
            column.take(
                block(&[first, first + 1.0]),
                (nanoseconds(i.into()), TimeOrigin::Stamp),
                Some(1000.0),
            );
        }
        column
    };
    for declared_hz in [100.0, 10_000.0] {
        let uniform = column(&|i| 2_000_000 * i).uniform(0, Some(declared_hz)).unwrap();
        assert_eq!((uniform.samples.len(), uniform.gaps.len()), (20, 0), "{declared_hz}");
        assert!((uniform.sample_rate_hz - declared_hz).abs() < 1e-9);
        let message = &uniform.issues[0].message;
        assert!(
            message.contains("1000 Hz by the recorded times") && message.contains("the first was taken"),
            "{message}"
        );
    }
    // Stamps of a writer that hurries after the samples say nothing of their rate.
    let hurried = column(&|i| if i % 2 == 0 { 40_000_000 * i } else { 40_000_000 * (i - 1) + 1000 });
    let uniform = hurried.uniform(0, Some(50.0)).unwrap();
    assert!(uniform.issues.iter().all(|issue| !issue.message.contains("declared")), "{:?}", uniform.issues);
}

#[test]
fn a_few_long_blocks_at_another_rate_are_told() {
    let told = |stated_hz: f64| {
        let mut column = Column::default();
        for i in 0..2_i64 {
            let samples: Vec<f64> = (0..2000).map(f64::from).collect();
            // 2000 samples at 10 kHz.
            column.take(block(&samples), (200_000_000 * i, TimeOrigin::Stamp), Some(stated_hz));
        }
        let issues = column.uniform(0, None).unwrap().issues;
        issues.iter().any(|i| i.severity == Severity::Warning && i.message.contains("as at 10000.0 Hz"))
    };
    assert!(told(10_200.0) && told(9_800.0) && !told(10_010.0) && !told(10_000.0));
}

/// So many blocks of `count` samples that rise, stamped as at `rate_hz` but cut to `cut_ns`.
fn stamped(blocks: u32, (count, rate_hz): (u32, f64), cut_ns: i64, stated: Option<f64>) -> Column {
    let mut column = Column::default();
    for i in 0..blocks {
        let samples: Vec<f64> = (count * i..count * (i + 1)).map(f64::from).collect();
        #[allow(clippy::cast_possible_truncation, reason = "a short record")]
        let time_ns = (f64::from(count * i) / rate_hz * 1e9).round() as i64;
        column.take(block(&samples), (time_ns / cut_ns * cut_ns, TimeOrigin::Stamp), stated);
    }
    column
}

#[test]
fn stamps_cut_to_milliseconds_tell_what_they_resolve() {
    for stated in [Some(1e5), None] {
        for (blocks, count) in [(90, 512), (90, 1024), (60, 700), (700, 512)] {
            let uniform = stamped(blocks, (count, 1e5), 1_000_000, stated).uniform(0, None).unwrap();
            let part = (uniform.sample_rate_hz / 1e5 - 1.0).abs();
            assert!(
                part < if stated.is_some() { 1e-12 } else { 1e-3 },
                "{stated:?} {blocks} {count}: {part}"
            );
            assert_eq!(
                (uniform.samples.len(), uniform.gaps.len()),
                ((blocks * count) as usize, 0),
                "{count}"
            );
            assert!(
                uniform.issues.iter().all(|issue| issue.severity == Severity::Note),
                "{:?}",
                uniform.issues
            );
            assert!(uniform.start_s.abs() < 1e-3);
        }
        // Exact ones, though they are whole milliseconds.
        let uniform = stamped(20, (500, 1e5), 1_000_000, stated).uniform(0, None).unwrap();
        assert!((uniform.sample_rate_hz / 1e5 - 1.0).abs() < 1e-12 && uniform.issues.is_empty());
    }
    // A block that is lost is a gap still.
    let mut lossy = stamped(40, (512, 1e5), 1_000_000, Some(1e5));
    lossy.blocks.remove(20);
    lossy.samples = Samples::F64(vec![0.0; 39 * 512]);
    let uniform = lossy.uniform(0, None).unwrap();
    assert!(
        uniform.gaps.len() == 1 && uniform.samples.len().abs_diff(40 * 512) <= 100,
        "{}",
        uniform.samples.len()
    );
    // Few blocks do not tell their rate so.
    let issues = stamped(30, (512, 1e5), 1_000_000, None).uniform(0, None).unwrap().issues;
    assert!(issues.iter().any(|issue| issue.message.contains("give sample_rate_hz")), "{issues:?}");
    // One interval of ten that differs may as well be a gap.
    let issues = stamped(11, (512, 1e5), 1_000_000, None).uniform(0, None).unwrap().issues;
    assert!(issues.iter().any(|issue| issue.severity == Severity::Warning), "{issues:?}");
}

#[test]
fn exact_stamps_of_whole_milliseconds_are_not_taken_for_cut_ones() {
    // Blocks of 10 and of 20 ms, and a rate that is wrong in the messages or in the cask file.
    for (apart, count) in
        [(0.98, 1000), (0.99, 2000), (0.998, 1000), (1.002, 1000), (1.01, 2000), (1.02, 1000)]
    {
        let wrong_hz = Some(1e5 * apart);
        for (stated, declared) in [(wrong_hz, None), (Some(1e5), wrong_hz), (None, wrong_hz)] {
            let uniform = stamped(46, (count, 1e5), 1, stated).uniform(0, declared).unwrap();
            let told = uniform.issues.iter().any(|issue| issue.severity == Severity::Warning);
            assert!(told, "{apart} {stated:?} {declared:?}: {:?}", uniform.issues);
        }
    }
    // Samples that are lost between them, a millisecond each.
    for lost in 1..6 {
        let mut column = Column::default();
        for i in 0..46_i64 {
            let lost_so_far = i * lost / 46;
            column.take(
                block(&[1.0; 1000]),
                ((10 * i + lost_so_far) * 1_000_000, TimeOrigin::Stamp),
                Some(1e5),
            );
        }
        let uniform = column.uniform(0, None).unwrap();
        let gaps = i64::try_from(uniform.gaps.len()).unwrap();
        assert_eq!(gaps, lost - 1, "{:?}", uniform.issues);
    }
}

#[test]
fn a_stated_rate_joins_blocks_whatever_their_stamps_are_cut_to() {
    for (count, cut_ms) in [(100, 1), (102, 1), (110, 1), (128, 1), (1024, 10), (1020, 5), (2048, 20)] {
        // In the messages, or in the cask file against another there.
        for (stated, declared) in [(Some(1e5), None), (Some(98_000.0), Some(1e5)), (None, Some(1e5))] {
            let column = stamped(300_000 / count, (count, 1e5), cut_ms * 1_000_000, stated);
            let total = (300_000 / count * count) as usize;
            let uniform =
                column.uniform(0, declared).unwrap_or_else(|error| panic!("{count} {cut_ms}: {error}"));
            assert!(
                (uniform.sample_rate_hz / 1e5 - 1.0).abs() < 1e-12,
                "{count} {cut_ms}: {:?}",
                uniform.issues
            );
            assert_eq!((uniform.samples.len(), uniform.gaps.len()), (total, 0), "{count} {cut_ms}");
            let grave = uniform.issues.iter().filter(|issue| issue.severity != Severity::Note);
            assert_eq!(grave.count(), 0, "{count} {cut_ms} {:?}", uniform.issues);
        }
    }
}

#[test]
fn what_coarse_stamps_hide_is_told() {
    // Samples gone from one block of many alike.
    let mut column = Column::default();
    let mut taken = 0;
    for i in 0..88_i64 {
        let count = if i == 40 { 492 } else { 512 };
        let time_ns = (i * 512 * 10_000) / 1_000_000 * 1_000_000;
        column.take(block(&vec![1.0; count]), (time_ns, TimeOrigin::Stamp), Some(1e5));
        taken += count;
    }
    let uniform = column.uniform(0, None).unwrap();
    assert_eq!(uniform.samples.len(), taken);
    let told = |uniform: &Uniform| uniform.issues.iter().any(|issue| issue.severity == Severity::Warning);
    assert!(told(&uniform), "{:?}", uniform.issues);
    // A rate that blocks just longer than a tick seem to have.
    let uniform = stamped(46, (1024, 1e5), 10_000_000, None).uniform(0, None).unwrap();
    assert!(told(&uniform), "{:?}", uniform.issues);
}

#[test]
fn even_stamps_on_a_coarse_grid_tell_no_odd_rate() {
    let told = |column: Column| {
        let uniform = column.uniform(0, None).unwrap();
        uniform.issues.iter().filter(|issue| issue.severity == Severity::Warning).count()
    };
    // Blocks of 10.15 and 10.2 ms that are stamped each 10 ms, as if at 101.5 and 102 kHz.
    for count in [1015, 1020] {
        for blocks in [1, 2, 5] {
            let column = stamped(46 / blocks, (blocks * count, 1e5), 10_000_000, None);
            assert_eq!(told(column), 1, "{count} {blocks}");
        }
    }
    // Exact ones: at a usual rate, of blocks that are not alike, fine, or over so long that it does not matter.
    assert_eq!(told(stamped(46, (500, 5e4), 1, None)), 0);
    assert_eq!(told(stamped(46, (512, 1e5), 1, None)), 0);
    assert_eq!(told(stamped(1200, (512, 51_200.0), 1, None)), 0);
    let mut column = Column::default();
    let mut taken = 0;
    for i in 0..46_i64 {
        let count = if i % 3 == 0 { 512 } else { 1024 };
        column.take(block(&vec![1.0; count]), (taken * 1_000_000 / 512 * 10, TimeOrigin::Stamp), None);
        taken += i64::try_from(count).unwrap();
    }
    assert_eq!(told(column), 0);
}

#[test]
fn blocks_that_share_coarse_stamps_are_laid_one_behind_another() {
    let stamped = |lost: Option<i64>, stated: Option<f64>| {
        let (mut column, mut taken) = (Column::default(), 0_i64);
        for i in (0..90).filter(|i| Some(*i) != lost) {
            let stamp_ns = i * 512 * 10_000 / 10_000_000 * 10_000_000;
            let samples: Vec<f64> = (taken..taken + 512).map(|i| seconds_from(i, 0)).collect();
            column.take(block(&samples), (stamp_ns, TimeOrigin::Stamp), stated);
            taken += 512;
        }
        column
    };
    for (stated, declared) in [(Some(1e5), None), (None, Some(1e5))] {
        let uniform = stamped(None, stated).uniform(0, declared).unwrap();
        assert!((uniform.sample_rate_hz - 1e5).abs() < 1e-6 && uniform.gaps.is_empty());
        assert!(
            uniform.samples.len() == 90 * 512 && (0.0..0.01).contains(&uniform.start_s),
            "{}",
            uniform.start_s
        );
        let [issue] = &uniform.issues[..] else { panic!("{:?}", uniform.issues) };
        assert!(issue.severity == Severity::Warning && issue.message.contains("same stamp"), "{issue:?}");
    }
    // Without a rate, at another one or with a block lost they are not laid so.
    for (lost, stated) in [(None, None), (None, Some(9e4)), (Some(45), Some(1e5))] {
        match stamped(lost, stated).uniform(0, None) {
            Err(error) => assert!(error.to_string().contains("carry the same stamp"), "{error}"),
            Ok(uniform) => {
                assert!(uniform.issues.iter().any(|issue| issue.message.contains("too coarse")));
            }
        }
    }
    // A block that was sent again, corrected, is none of these.
    let mut column = Column::default();
    for i in [0, 1, 2, 2, 3, 4, 5, 6] {
        let value = if column.blocks.len() == 3 { 2.0 } else { 1.0 };
        column.take(block(&[value; 1000]), (10_000_000 * i, TimeOrigin::Stamp), Some(1e5));
    }
    assert_eq!(column.uniform(0, None).unwrap().samples.len(), 7000);
}

#[test]
fn messages_that_contradict_their_stamps_by_far_are_told() {
    for stated_hz in [15_000.0, 14_800.0, 20_000.0, 6700.0, 5000.0] {
        let column = || stamped(40, (100, 1e4), 1, Some(stated_hz));
        let error = column().uniform(0, None).unwrap_err().to_string();
        for part in [&format!("state a sample rate of {stated_hz} Hz"), "say 10000 Hz"] {
            assert!(error.contains(part), "{error}");
        }
        let uniform = column().uniform(0, Some(1e4)).unwrap();
        assert!(uniform.issues.is_empty() && uniform.samples.len() == 4000, "{:?}", uniform.issues);
    }
    // Windows that overlap, with the same samples.
    let mut windows = Column::default();
    for i in 0..40_u32 {
        let samples: Vec<f64> = (40 * i..40 * i + 100).map(f64::from).collect();
        windows.take(block(&samples), (i64::from(i) * 4_000_000, TimeOrigin::Stamp), Some(1e4));
    }
    let uniform = windows.uniform(0, None).unwrap();
    assert_eq!(uniform.samples.len(), 1660);
    assert!((uniform.sample_rate_hz - 1e4).abs() < 1e-9);
}

#[test]
fn one_block_without_a_rate_is_an_error() {
    let mut column = Column::default();
    column.take(block(&[1.0, 2.0]), (5, TimeOrigin::LogTime), None);
    assert!(matches!(column.uniform(0, None), Err(ColumnError::NoRate)));
}

#[test]
fn a_rejected_chunk_leaves_no_trace() {
    let mut column = Column::default();
    let number = |value| Value::Number { value, is_narrow: true };
    column.take(number(1.0), (1, TimeOrigin::Stamp), None);
    column.mark();
    column.take(number(2.0), (2, TimeOrigin::LogTimeForBadStamp), None);
    column.malformed("x");
    column.roll_back();
    assert_eq!(column.span_ns(), Some((1, 1)));
    assert_eq!(column.tally, Tally { messages: 1, stamps: 1, ..Tally::default() });
    assert_eq!(column.samples, Samples::F32(vec![1.0]));
}

#[test]
fn a_column_in_two_parts_is_the_column_in_one() {
    let number = |value, is_narrow| Value::Number { value, is_narrow };
    let take = |column: &mut Column, i: i64| {
        let origin = if i == 4 { TimeOrigin::LogTimeForBadStamp } else { TimeOrigin::Stamp };
        if i == 3 {
            column.malformed("cut");
        }
        column.unit = Some(if i < 4 { "g" } else { "m/s^2" }.into());
        #[allow(clippy::cast_precision_loss, reason = "a handful")]
        column.take(number(0.1 * i as f64, i < 2), (i, origin), None);
    };
    for parted_at in 0..6 {
        let (mut whole, mut first) = (Column::default(), Column::default());
        (0..6).for_each(|i| take(&mut whole, i));
        (0..parted_at).for_each(|i| take(&mut first, i));
        let mut second = Column::default();
        (parted_at..6).for_each(|i| take(&mut second, i));
        assert!(first.continues_with(&second));
        first.append(&mut second);
        assert!(second.is_empty() && second.samples.is_empty());
        assert_eq!(format!("{first:?}"), format!("{whole:?}"), "{parted_at}");
    }
    let mut blocks = Column::default();
    blocks.take(block(&[1.0]), (0, TimeOrigin::Stamp), None);
    let mut numbers = Column::default();
    numbers.take(number(1.0, true), (1, TimeOrigin::Stamp), None);
    assert!(!blocks.continues_with(&numbers));
}

#[test]
fn a_clock_that_starts_at_zero_is_no_missing_stamp() {
    let column = |step_ns: i64| {
        let mut column = Column::default();
        column.take(block(&[1.0, 2.0]), message_time(&Value::Stamp(0), 1_700_000_000_000_000_000), None);
        column.take(
            block(&[3.0, 4.0]),
            message_time(&Value::Stamp(step_ns), 1_700_000_000_002_000_000),
            None,
        );
        column.settle_clock();
        column
    };
    assert_eq!(column(2_000_000).span_ns(), Some((0, 2_000_000)));
    assert_eq!(column(2_000_000).tally.bad_stamps, 0);
    // A clock that is set: there zero is no time.
    assert_eq!(column(1_700_000_000_002_000_000).span_ns().unwrap().0, 1_700_000_000_000_000_000);
}

#[test]
fn a_zero_stamp_falls_back_to_the_log_time() {
    assert_eq!(message_time(&Value::Stamp(0), 7), (7, TimeOrigin::LogTimeForBadStamp));
    assert_eq!(message_time(&Value::Stamp(3), 7), (3, TimeOrigin::Stamp));
    assert_eq!(message_time(&Value::Missing, 7), (7, TimeOrigin::LogTime));
}
