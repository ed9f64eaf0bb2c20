//! Tests of the samples of one field.

use super::*;

fn block(samples: &[f64]) -> Value {
    Value::Array(Samples::F64(samples.to_vec()))
}

fn number(value: f64) -> Value {
    Value::Number { value, is_narrow: value < 0.2 }
}

fn stamp(ns: i64) -> MessageTime {
    MessageTime { ns, is_stamp: Some(true), log_ns: ns }
}

/// What the messages `range` of a topic give: numbers, blocks from `blocks_from` on.
fn take(column: &mut Column, range: std::ops::Range<i64>, blocks_from: i64) {
    for i in range {
        let is_stamp = Some(i != 4);
        column.state_unit(if i < 4 { "g" } else { "m/s^2" });
        #[allow(clippy::cast_precision_loss, reason = "a handful")]
        let value = 0.1 * i as f64;
        let value = if i < blocks_from { number(value) } else { block(&[value, f64::NAN, -value]) };
        column.take(value, MessageTime { ns: i, is_stamp, log_ns: i }, None);
    }
}

#[test]
fn a_column_in_two_parts_is_the_column_in_one() {
    for (parted_at, blocks_from) in (0..6).flat_map(|at| [(at, 6), (at, 2), (at, 0)]) {
        let [mut whole, mut first, mut second] = [(); 3].map(|()| Column::default());
        take(&mut whole, 0..6, blocks_from);
        take(&mut first, 0..parted_at, blocks_from);
        take(&mut second, parted_at..6, blocks_from);
        first.append(&mut second);
        assert!(second.is_empty() && second.samples.is_empty());
        assert_eq!(format!("{first:?}"), format!("{whole:?}"), "{parted_at} {blocks_from}");
        // A listing shows the same of samples that did not fit in memory.
        let mut late = Column::default();
        take(&mut first, 6..9, blocks_from);
        take(&mut late, 6..9, blocks_from);
        whole.forget();
        whole.append(&mut late);
        assert_eq!(whole.extent(), first.extent());
    }
}

#[test]
fn numbers_beside_arrays_are_blocks_of_one() {
    let mut column = Column::default();
    column.take(number(1.0), stamp(0), None);
    column.take(block(&[2.0, 3.0]), stamp(1), None);
    column.take(number(4.0), stamp(2), None);
    assert_eq!((column.counts, column.samples), (vec![1, 2, 1], Samples::F64(vec![1.0, 2.0, 3.0, 4.0])));
}

#[test]
fn a_clock_that_starts_at_zero_is_no_missing_stamp() {
    let column = |step_ns: i64| {
        let mut column = Column::default();
        let zero = MessageTime::of(Some(&Value::Stamp(0)), 1_700_000_000_000_000_000);
        column.take(block(&[1.0, 2.0]), zero, None);
        column.take(block(&[3.0, 4.0]), stamp(step_ns), None);
        column.settle_clock();
        column
    };
    assert_eq!(column(2_000_000).span_ns(), Some((0, 2_000_000)));
    assert_eq!(column(2_000_000).bad_stamps, 0);
    // A clock that is set: there zero is no time.
    assert_eq!(column(1_700_000_000_002_000_000).span_ns().unwrap().0, 1_700_000_000_000_000_000);
}

#[test]
fn a_zero_stamp_falls_back_to_the_log_time() {
    let time = |stamp: Value| MessageTime::of(Some(&stamp), 7);
    assert_eq!(time(Value::Stamp(0)), MessageTime { ns: 7, is_stamp: Some(false), log_ns: 7 });
    assert_eq!(time(Value::Stamp(3)), MessageTime { log_ns: 7, ..stamp(3) });
    assert_eq!(time(Value::Missing), MessageTime { ns: 7, is_stamp: None, log_ns: 7 });
}
