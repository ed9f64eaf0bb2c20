//! What the time base must keep: values where times are steady, places where they are not.

use super::*;
use crate::data::{IssueCode, Severity, Span};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::f64::consts::TAU;

fn codes(uniform: &Uniform) -> Vec<IssueCode> {
    uniform.issues.iter().map(|issue| issue.code).collect()
}

fn told(said: Result<Uniform, Refusal>) -> String {
    said.unwrap_err().to_string()
}

fn f64s(values: &[f64]) -> Samples {
    Samples::F64(values.to_vec())
}

#[test]
fn steady_times_leave_samples_alone() {
    let times: Vec<f64> = (0..1000).map(|i| 0.25 + as_f64(i) * 5e-5).collect();
    let values: Vec<f32> = (0..1000_u16).map(f32::from).collect();
    let uniform = from_times(&times, Samples::F32(values.clone()), None).unwrap();
    assert_eq!(uniform.samples, Samples::F32(values));
    assert!((uniform.sample_rate_hz - 20_000.0).abs() < 1e-6, "{}", uniform.sample_rate_hz);
    assert!((uniform.start_s - 0.25).abs() < 1e-12);
    assert!(uniform.issues.is_empty() && uniform.gaps.is_empty() && uniform.time_jitter_s == 0.0);
}

#[test]
fn times_rounded_in_print_do_not_shift_a_long_record() {
    // 30 kHz printed to 1e-6 s: intervals of 33 and 34 µs. The last of 1e5 samples must lie within the
    // rounding.
    for digits in [1e6, 1e7] {
        let times: Vec<f64> =
            (0..100_000).map(|i| (as_f64(i) / 30_000.0 * digits).round() / digits).collect();
        let values: Vec<f64> = (0..100_000).map(as_f64).collect();
        let uniform = from_times(&times, f64s(&values), None).unwrap();
        assert_eq!(uniform.samples, f64s(&values), "samples must not be moved");
        let last_s = uniform.start_s + 99_999.0 / uniform.sample_rate_hz;
        assert!((last_s - 99_999.0 / 30_000.0).abs() < 0.5 / digits, "{last_s}");
        assert!(uniform.issues.is_empty(), "{:?}", uniform.issues);
    }
}

#[test]
fn a_gap_is_filled_and_told() {
    let kept: Vec<usize> = (0..500).filter(|i| !(200..240).contains(i)).collect();
    let times: Vec<f64> = kept.iter().map(|&i| as_f64(i) * 1e-3).collect();
    let values: Vec<f64> = kept.iter().map(|&i| as_f64(i)).collect();
    let uniform = from_times(&times, f64s(&values), None).unwrap();
    assert_eq!(uniform.gaps, [Span { from: 200, to: 240 }]);
    assert_eq!(uniform.samples.len(), 500);
    assert!(uniform.samples.get(239).is_nan() && (uniform.samples.get(240) - 240.0).abs() < 1e-12);
    assert_eq!(codes(&uniform), [IssueCode::Gap]);
    assert_eq!(uniform.issues[0].severity, Severity::Warning);
    assert!(uniform.issues[0].message.starts_with("40 sample(s)"), "{}", uniform.issues[0].message);
    assert_eq!((uniform.issues[0].from_s, uniform.issues[0].to_s), (Some(0.199), Some(0.240)));
}

#[test]
fn gaps_of_a_long_record_are_found_wherever_they_lie() {
    // Threads take 65 536 intervals each: gaps across, at and beside the ends of these.
    let lost = [70..75, 65_530..65_545, 131_072..131_073, 196_600..196_608];
    let kept: Vec<usize> = (0..262_200).filter(|i| !lost.iter().any(|gap| gap.contains(i))).collect();
    let times: Vec<f64> = kept.iter().map(|&i| 3.0 + as_f64(i) * 2e-6).collect();
    let values: Vec<f64> = kept.iter().map(|&i| as_f64(i)).collect();
    let uniform = from_times(&times, f64s(&values), None).unwrap();
    let gaps: Vec<_> = uniform.gaps.iter().map(|gap| gap.from..gap.to).collect();
    assert_eq!(gaps, lost);
    let off = |i: usize| uniform.samples.get(i) - as_f64(i);
    assert!((0..262_200).all(|i| off(i).is_nan() || off(i).abs() < 1e-9));
    assert!((uniform.sample_rate_hz / 5e5 - 1.0).abs() < 1e-12, "{}", uniform.sample_rate_hz);
}

#[test]
fn disorder_and_doubles_are_put_right() {
    let mut rows: Vec<(f64, f64)> = (0..100).map(|i| (as_f64(i) * 0.01, as_f64(i))).collect();
    rows.swap(10, 50);
    rows.insert(70, rows[69]);
    let times: Vec<f64> = rows.iter().map(|r| r.0).collect();
    let values: Vec<f64> = rows.iter().map(|r| r.1).collect();
    let uniform = from_times(&times, f64s(&values), None).unwrap();
    assert_eq!(uniform.samples, f64s(&(0..100).map(as_f64).collect::<Vec<_>>()));
    assert_eq!(codes(&uniform), [IssueCode::DisorderedBlocks, IssueCode::DuplicateBlocks]);
    assert!(uniform.issues.iter().all(|i| i.severity == Severity::Note));
    let doubled =
        from_times(&[0.0, 0.1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0], f64s(&[1.0; 12]), None);
    assert_eq!(doubled.unwrap().samples.len(), 11);
    let mut values = [1.0; 12];
    values[2] = 5.0;
    let times = [0.0, 0.1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
    let differing = from_times(&times, f64s(&values), None).unwrap();
    assert_eq!(differing.issues[0].severity, Severity::Warning);
    assert_eq!(differing.samples, f64s(&[1.0; 11]));
}

#[test]
fn a_flat_top_stays_flat_where_jitter_is_interpolated() {
    // Cut off at 0.8: a cubic alone overshoots by a twentieth of the step into the flat.
    let times: Vec<f64> =
        (0..400).map(|i| (as_f64(i) + 0.3 * (TAU * as_f64(i) / 37.0).sin()) / 2000.0).collect();
    let values: Vec<f64> = times.iter().map(|t| (TAU * 25.0 * t).sin().clamp(-0.8, 0.8)).collect();
    let uniform = from_times(&times, f64s(&values), None).unwrap();
    assert_eq!(codes(&uniform), [IssueCode::TimeJitter]);
    assert!((0..uniform.samples.len()).all(|i| uniform.samples.get(i).abs() <= 0.8));
}

#[test]
fn jitter_is_interpolated_with_its_error_known() {
    // 50 Hz at 2 kHz with a slow clock wander of 30 % of an interval: cubic error h⁴ω⁴·3/128 ≈ 1.4e-5 of the
    // amplitude.
    let times: Vec<f64> = (0..4000)
        .map(|i| {
            (as_f64(i) + 0.3 * (TAU * as_f64(i) / 311.0).sin() + 1e-4 * (as_f64(i) * 0.7).sin()) / 2000.0
        })
        .collect();
    let values: Vec<f64> = times.iter().map(|t| (TAU * 50.0 * t).sin()).collect();
    let uniform = from_times(&times, f64s(&values), None).unwrap();
    assert_eq!(codes(&uniform), [IssueCode::TimeJitter]);
    assert!((uniform.time_jitter_s * 2000.0 - 0.3 / 2_f64.sqrt()).abs() < 0.01, "{}", uniform.time_jitter_s);
    for i in 2..uniform.samples.len() - 2 {
        let t = uniform.start_s + as_f64(i) / uniform.sample_rate_hz;
        let error = uniform.samples.get(i) - (TAU * 50.0 * t).sin();
        assert!(error.abs() < 3e-5, "{i}: {error}");
    }
}

#[test]
fn a_late_stamp_is_not_a_gap() {
    let mut times: Vec<f64> = (0..100).map(|i| as_f64(i) * 0.01).collect();
    times[40] += 0.006;
    let uniform = from_times(&times, f64s(&[0.0; 100]), None).unwrap();
    assert_eq!(uniform.samples.len(), 100);
    assert!(!codes(&uniform).contains(&IssueCode::Gap), "{:?}", uniform.issues);
}

#[test]
fn coarse_stamps_are_taken_as_even() {
    let times: Vec<f64> = (0..1000).map(|i| (as_f64(i) * 0.1).floor() * 1e-3).collect();
    let values: Vec<f64> = (0..1000).map(as_f64).collect();
    let uniform = from_times(&times, f64s(&values), None).unwrap();
    assert_eq!(uniform.samples, f64s(&values));
    assert!((uniform.sample_rate_hz / 10_000.0 - 1.0).abs() < 1e-3, "{}", uniform.sample_rate_hz);
    assert_eq!(codes(&uniform), [IssueCode::Clock]);
}

#[test]
fn missing_samples_are_gaps_too() {
    let times: Vec<f64> = (0..10).map(as_f64).collect();
    let mut values = [1.0; 10];
    values[3] = f64::NAN;
    values[4] = f64::INFINITY;
    let uniform = from_times(&times, f64s(&values), None).unwrap();
    assert_eq!(uniform.gaps, [Span { from: 3, to: 5 }]);
    assert!(uniform.samples.get(4).is_nan());
    assert_eq!(codes(&uniform), [IssueCode::NonFinite]);
    let uniform = from_claims(1.0, &Claims::of_cask(Some(10.0)), f64s(&values)).unwrap();
    assert_eq!(uniform.gaps, [Span { from: 3, to: 5 }]);
    assert_eq!((uniform.issues[0].from_s, uniform.issues[0].to_s), (Some(1.3), Some(1.4)));
}

#[test]
fn a_declared_rate_wins() {
    let times: Vec<f64> = (0..100).map(|i| as_f64(i) * 0.01).collect();
    let uniform = from_times(&times, f64s(&[0.0; 100]), Some(200.0)).unwrap();
    assert!((uniform.sample_rate_hz - 200.0).abs() < 1e-12);
    assert_eq!(uniform.issues[0].severity, Severity::Warning);
    assert!(from_times(&times, f64s(&[0.0; 100]), Some(100.0)).unwrap().issues.is_empty());
}

#[test]
fn what_is_no_time_base_says_why() {
    let cases: [(&[f64], &str); 5] = [
        (&[], "at least two"),
        (&[1.0], "at least two"),
        (&[0.0, f64::NAN, 2.0], "time number 2"),
        (&[3.0, 3.0, 3.0], "all times are 3 s"),
        (&[0.0, 1e-4, 2e-4, 3e-4, 1.7e9, 1.7e9 + 1e-3], "jump from 0.0003 s to 1700000000 s"),
    ];
    for (times, expected) in cases {
        let error = from_times(times, f64s(&vec![0.0; times.len()]), None).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    assert!(told(from_times(&[0.0, 1.0], f64s(&[1.0]), None)).contains("2 times but 1 samples"));
    assert!(
        told(from_claims(0.0, &Claims::of_cask(Some(0.0)), f64s(&[1.0, 2.0])))
            .contains("the sample rate is 0 Hz")
    );
}

/// A block and its samples.
fn block(first: usize, count: usize) -> (Block, Vec<f64>) {
    let block = Block { start_s: 5.0 + as_f64(first) / 1000.0, count };
    (block, (first..first + count).map(as_f64).collect())
}

fn of_blocks(blocks: Vec<(Block, Vec<f64>)>) -> Result<Uniform, Refusal> {
    let (blocks, samples): (Vec<_>, Vec<_>) = blocks.into_iter().unzip();
    from_blocks(&blocks, 1000.0, Samples::F64(samples.concat()))
}

#[test]
fn blocks_in_any_order_make_one_run() {
    let uniform = of_blocks(vec![block(100, 50), block(0, 100), block(100, 50), block(150, 30)]).unwrap();
    assert_eq!(uniform.samples, f64s(&(0..180).map(as_f64).collect::<Vec<_>>()));
    assert!((uniform.start_s - 5.0).abs() < 1e-12 && (uniform.sample_rate_hz - 1000.0).abs() < 1e-9);
    assert_eq!(codes(&uniform), [IssueCode::DisorderedBlocks, IssueCode::DuplicateBlocks]);
    assert!(uniform.issues.iter().all(|i| i.severity == Severity::Note));
}

#[test]
fn a_missing_block_is_a_gap_and_an_overlap_is_trimmed() {
    let uniform = of_blocks(vec![block(0, 100), block(200, 100), block(290, 20)]).unwrap();
    assert_eq!(uniform.gaps, [Span { from: 100, to: 200 }]);
    assert_eq!(uniform.samples.len(), 310);
    assert!((uniform.samples.get(309) - 309.0).abs() < 1e-12);
    assert_eq!(codes(&uniform), [IssueCode::DuplicateBlocks, IssueCode::Gap]);
    let mut other = block(100, 50);
    other.1 = vec![-1.0; 50];
    let uniform = of_blocks(vec![block(0, 100), block(100, 50), other]).unwrap();
    assert!((uniform.samples.get(120) - 120.0).abs() < 1e-12);
    assert_eq!(uniform.issues[0].severity, Severity::Warning);
}

#[test]
fn blocks_with_jittering_stamps_are_joined() {
    // A computer's clock: ±3 samples about blocks of 100, the stamps' own rate 200 ppm low.
    let blocks = (0..200).map(|i| {
        let mut b = block(i * 100, 100);
        b.0.start_s = 5.0 + as_f64(i) * 0.1 * (1.0 + 2e-4) + 0.003 * (as_f64(i) * 1.7).sin();
        b
    });
    let uniform = of_blocks(blocks.collect()).unwrap();
    assert_eq!(uniform.samples.len(), 20_000);
    assert!(uniform.gaps.is_empty());
    // The stamps' scatter of 2.1 ms over 200 blocks leaves the slope good to 2.1e-3/(5.8 s·√200) = 2.6e-5.
    assert!((uniform.sample_rate_hz / 1000.0 - 1.0 + 2e-4).abs() < 8e-5, "{}", uniform.sample_rate_hz);
    assert_eq!(codes(&uniform), [IssueCode::Clock]);
}

#[test]
fn blocks_with_missing_samples_of_their_own_say_so() {
    let mut broken = block(200, 10);
    broken.1 = vec![f64::NAN; 10];
    let uniform = of_blocks(vec![block(0, 100), broken]).unwrap();
    assert_eq!(codes(&uniform), [IssueCode::Gap, IssueCode::NonFinite]);
    assert!(uniform.issues[1].message.starts_with("10 sample(s)"), "{}", uniform.issues[1].message);
}

#[test]
fn blocks_that_make_no_record_say_why() {
    let mut far = block(100, 10);
    far.0.start_s = 1.7e9;
    for (blocks, expected) in [(vec![], "at least two"), (vec![block(0, 100), far], "times jump")] {
        let error = of_blocks(blocks).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    let still = from_blocks(&[block(0, 10).0], 0.0, f64s(&[1.0; 10])).unwrap_err();
    assert!(still.to_string().contains("must be above zero"), "{still}");
}

#[test]
fn even_stretches_do_not_hide_jitter() {
    // Every thousandth time is a multiple of 2 ms to 1e-3 of it; the ones between jitter by 21 % of the
    // interval RMS.
    let times: Vec<f64> =
        (0..100_000).map(|i| (as_f64(i) + 0.3 * (TAU * as_f64(i) / 500.0).sin()) * 2e-6).collect();
    let uniform = from_times(&times, f64s(&vec![0.0; 100_000]), None).unwrap();
    assert_eq!(codes(&uniform), [IssueCode::TimeJitter]);
    assert!((uniform.time_jitter_s / 2e-6 - 0.3 / 2_f64.sqrt()).abs() < 0.01, "{}", uniform.time_jitter_s);
}

#[test]
fn a_clock_that_changes_its_rate_or_begins_anew_is_no_jitter() {
    let told = |times_s: &[f64]| {
        let uniform = from_times(times_s, Samples::F64(vec![1.0; times_s.len()]), None).unwrap();
        uniform.issues.iter().any(|issue| issue.severity == Severity::Warning)
    };
    let even = |i: usize| as_f64(i) * 1e-4;
    assert!(!told(&(0..6000).map(even).collect::<Vec<_>>()));
    let slower = |i: usize| even(i) + 0.03 * (even(i) - 0.1).clamp(0.0, 0.1);
    assert!(told(&(0..6000).map(slower).collect::<Vec<_>>()));
    // A tenth of an interval early or late is jitter.
    let late = |i: usize| even(i) + 1e-5 * (as_f64(i * i % 7) - 3.0) / 3.0;
    assert!(!told(&(0..6000).map(late).collect::<Vec<_>>()));
}

#[test]
fn a_step_that_changes_for_good_is_no_jitter_and_stamps_that_wander_are() {
    let told = |count: usize, time_in_intervals: &dyn Fn(usize) -> f64| {
        let times_s: Vec<f64> = (0..count).map(|i| 1e-4 * time_in_intervals(i)).collect();
        let uniform = from_times(&times_s, Samples::F64(vec![1.0; count]), None).unwrap();
        uniform.issues.iter().any(|issue| issue.message.contains("changed its rate"))
    };
    // From a row on 2 or 1 % longer, printed to a tenth of an interval.
    for from in [146, 700, 1300] {
        for longer in [0.02, 0.01] {
            let rounded =
                |i: usize| (10.0 * (as_f64(i) + longer * as_f64(i.saturating_sub(from)))).round() / 10.0;
            assert!(told(1480, &rounded), "{longer} longer from {from} on");
        }
    }
    // Within a tenth of what a stated rate may be off.
    assert!(!told(1480, &|i| as_f64(i) + 1e-4 * as_f64(i.saturating_sub(146))));
    let mut chance = ChaCha8Rng::seed_from_u64(7);
    let mut chance = move || chance.random_range(-1.0..1.0);
    // Stamps early or late by up to 0.3 of an interval, each by itself or each beside the one before; a
    // recorder that goes on at another phase after each pause.
    for count in [200, 1480, 6000] {
        let each: Vec<f64> = (0..count).map(|_| 0.3 * chance()).collect();
        assert!(!told(count, &|i| as_f64(i) + each[i]));
        let walk: Vec<f64> = each
            .iter()
            .scan(0.0, |sum, x| {
                *sum += 0.1 * x;
                Some(*sum)
            })
            .collect();
        assert!(!told(count, &|i| as_f64(i) + walk[i]));
        assert!(!told(count, &|i| as_f64(i) + 7.4 * (as_f64(i) / 150.0).floor()));
    }
}

#[test]
fn times_that_begin_anew_are_refused() {
    let told = |found: Result<Uniform, Refusal>| match found {
        Err(error) => error.to_string().contains("begin anew "),
        Ok(_) => false,
    };
    // Stamps of blocks, and of single samples; then such that are late, or the same recording twice.
    let numbers = |starts_s: &[f64], is_copy: bool| -> bool {
        let count = |i: usize| if is_copy { i % 6 } else { i };
        let blocks: Vec<Block> = starts_s.iter().map(|&start_s| Block { start_s, count: 100 }).collect();
        let values = (0..100 * starts_s.len()).map(|i| as_f64(count(i / 100))).collect();
        let of_blocks = told(from_blocks(&blocks, 100.0, Samples::F64(values)));
        let values = (0..starts_s.len()).map(|i| as_f64(count(i))).collect();
        let of_times = told(from_times(starts_s, Samples::F64(values), Some(1.0)));
        assert_eq!(of_times, of_blocks, "{starts_s:?}");
        of_blocks
    };
    let run = |from: f64, count: u32| (0..count).map(move |i| from + f64::from(i));
    assert!(numbers(&run(0.0, 6).chain(run(0.0, 5)).collect::<Vec<_>>(), false));
    assert!(numbers(&run(1.0, 6).chain(run(0.5, 9)).collect::<Vec<_>>(), false));
    let three: Vec<f64> = (0..3).flat_map(|i| run(0.1 * f64::from(i), 40)).collect();
    assert!(numbers(&three, false));
    assert!(!numbers(&run(0.0, 6).chain(run(0.0, 6)).collect::<Vec<_>>(), true));
    assert!(!numbers(&run(6.0, 6).chain(run(0.0, 6)).collect::<Vec<_>>(), false));
    assert!(!numbers(&[0.0, 2.0, 3.0, 4.0, 1.0, 5.0, 6.0], false));
    // Rows written twice, and rows in another's place, are no second run.
    let rows = |order: &[std::ops::Range<u32>]| {
        let times_s: Vec<f64> = order.iter().cloned().flatten().map(f64::from).collect();
        let values = times_s.iter().map(|time_s| (0.3 * time_s).sin()).collect();
        told(from_times(&times_s, Samples::F64(values), Some(1.0)))
    };
    assert!(!rows(&[0..40, 20..90]));
    assert!(!rows(&[0..20, 40..60, 20..40, 60..90]));
}
