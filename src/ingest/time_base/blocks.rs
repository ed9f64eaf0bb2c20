//! Blocks of samples with a stamp each to one run: sorted, doubles dropped, overlaps trimmed, gaps NaN.

use super::error::{TimeBaseError, check_rate};
use super::fit::{FILL_FACTOR, FILL_FLOOR};
use super::order::{as_f64, is_same, restart, restarted};
use super::pieces::{Content, Piece, pieces};
use super::stamps::{Cut, Interval, ROUND_OFF, Stamps};
use super::uniform::{Block, Number, Placed, Uniform};
use super::{fit, missing};
use crate::data::{Finding, Samples, TimesFinding};
use crate::ingest::clock::RATE_TOLERANCE;
use crate::numerics::robust;

/// What sorting and doubles came to.
#[derive(Default)]
struct Doubles {
    same: usize,
    different: usize,
    span_s: Option<(f64, f64)>,
}

impl Doubles {
    fn add(&mut self, is_equal: bool, from_s: f64, to_s: f64) {
        self.same += usize::from(is_equal);
        self.different += usize::from(!is_equal);
        self.span_s = Some(self.span_s.map_or((from_s, to_s), |s| (s.0.min(from_s), s.1.max(to_s))));
    }
}

/// Blocks on a uniform base at a rate in Hz, their `samples` one after another. Stamps decide where a block lies, to the nearest sample;
/// samples are not moved between. Blocks that follow one another stay where they are.
///
/// # Errors
/// [`TimeBaseError`] where stamps or rate make no record.
pub fn from_blocks(blocks: &[Block], rate_hz: f64, samples: Samples) -> Result<Uniform, TimeBaseError> {
    let count: usize = blocks.iter().map(|block| block.count).sum();
    if count != samples.len() {
        return Err(TimeBaseError::Lengths { times: count, samples: samples.len() });
    }
    let laid = lay(blocks, rate_hz, &Content { samples: &samples, digests: None })?;
    Ok(match samples {
        Samples::F32(samples) => filled(laid, samples).into_uniform(Samples::F32),
        Samples::F64(samples) => filled(laid, samples).into_uniform(Samples::F64),
    })
}

/// Where blocks lie on a uniform base.
pub(in crate::ingest) struct Laid {
    /// Those that are kept, in the order of their stamps.
    pieces: Vec<Piece>,
    /// The place of each one's first sample.
    places: Vec<usize>,
    /// The stamps of all blocks, in the order of the file, s.
    starts_s: Vec<f64>,
    /// Time of the first sample, s.
    pub(in crate::ingest) start_s: f64,
    /// Hz.
    pub(in crate::ingest) sample_rate_hz: f64,
    /// Samples that are missing between blocks, from when to when, s.
    gaps: Vec<missing::Gap>,
    doubles: Doubles,
    issues: Vec<Finding>,
}

/// [`from_blocks`] as far as stamps and lengths tell.
///
/// # Errors
/// As that.
pub(super) fn lay(blocks: &[Block], rate_hz: f64, content: &Content) -> Result<Laid, TimeBaseError> {
    check_rate(rate_hz)?;
    if let Some(index) = blocks.iter().position(|block| !block.start_s.is_finite()) {
        return Err(TimeBaseError::NotFinite { number: index + 1, time_s: blocks[index].start_s });
    }
    let mut pieces = pieces(blocks);
    pieces.retain(|piece| !piece.samples.is_empty());
    let (mut issues, mut doubles) = (Vec::new(), Doubles::default());
    let starts_s: Vec<f64> = pieces.iter().map(|piece| piece.start_s).collect();
    sort(&mut pieces, &mut issues);
    drop_doubles(&mut pieces, rate_hz, &mut doubles, content);
    let present: usize = pieces.iter().map(|piece| piece.samples.len()).sum();
    if present < 2 {
        return Err(TimeBaseError::TooFew { count: present });
    }
    let of_pair = |pair: &[Piece]| Interval {
        length: as_f64(pair[0].samples.len()),
        s: pair[1].start_s - pair[0].start_s,
    };
    let stamps = Stamps(pieces.windows(2).map(of_pair).collect());
    let cut = stamps.cut(rate_hz);
    let tolerance = stamp_tolerance(&stamps, rate_hz, cut);
    issues.extend(hidden_loss(&stamps, rate_hz, tolerance));
    let places = places(&pieces, rate_hz, tolerance, present)?;
    let (start_s, sample_rate_hz) = clock((&pieces, &places), rate_hz, &stamps, &mut issues);
    let time_s = |index: usize| start_s + as_f64(index) / sample_rate_hz;
    let (mut gaps, mut end) = (Vec::new(), 0);
    for (piece, &place) in pieces.iter().zip(&places) {
        if place > end && end > 0 {
            gaps.push(missing::Gap { lost: place - end, from_s: time_s(end - 1), to_s: time_s(place) });
        }
        end = end.max(place + piece.samples.len());
    }
    Ok(Laid { pieces, places, starts_s, start_s, sample_rate_hz, gaps, doubles, issues })
}

impl Laid {
    /// Number of samples, missing ones too.
    pub(in crate::ingest) fn count(&self) -> usize {
        let ends = self.pieces.iter().zip(&self.places).map(|(piece, place)| place + piece.samples.len());
        ends.max().unwrap_or(0)
    }

    /// Number of stretches that are missing between blocks.
    pub(in crate::ingest) fn gap_count(&self) -> usize {
        self.gaps.len()
    }
}

/// The samples at their places.
fn filled<S: Number>(laid: Laid, held: Vec<S>) -> Placed<S> {
    let Laid { pieces, places, starts_s, start_s, sample_rate_hz, gaps, mut doubles, mut issues } = laid;
    let mut samples = in_place(&pieces, &places, held, |held| {
        let mut samples: Vec<S> = Vec::new();
        for (piece, &place) in pieces.iter().zip(&places) {
            if place > samples.len() && !samples.is_empty() {
                samples.resize(place, S::MISSING);
            }
            append(
                &mut samples,
                (piece.start_s, &held[piece.samples.clone()]),
                (place, sample_rate_hz),
                &mut doubles,
            );
        }
        samples
    });
    report_doubles(&doubles, &mut issues);
    let restart = restart(&starts_s).filter(|_| doubles.different > 0);
    issues.extend(restart.map(|at| restarted(&starts_s, at)));
    missing::push_gaps(&gaps, &mut issues);
    let lost: usize = gaps.iter().map(|gap| gap.lost).sum();
    let gaps = missing::mark_non_finite(&mut samples, lost, (start_s, sample_rate_hz), &mut issues);
    Placed { start_s, sample_rate_hz, samples, gaps, time_jitter_s: 0.0, issues }
}

/// The samples as they are held where every block has its place there already, else what `moved` makes of them.
fn in_place<S>(
    pieces: &[Piece],
    places: &[usize],
    mut held: Vec<S>,
    moved: impl FnOnce(&[S]) -> Vec<S>,
) -> Vec<S> {
    let ends = std::iter::once(0).chain(pieces.iter().map(|piece| piece.samples.end));
    let follows =
        |((piece, place), end): ((&Piece, &usize), usize)| piece.samples.start == end && *place == end;
    if !pieces.iter().zip(places).zip(ends).all(follows) {
        return moved(&held);
    }
    held.truncate(pieces.last().map_or(0, |piece| piece.samples.end));
    held
}

fn sort(pieces: &mut [Piece], issues: &mut Vec<Finding>) {
    let Some(first) = (1..pieces.len()).find(|&i| pieces[i].start_s < pieces[i - 1].start_s) else { return };
    let count = pieces.windows(2).filter(|w| w[1].start_s < w[0].start_s).count();
    let (from_s, to_s) = (pieces[first].start_s, pieces[first - 1].start_s);
    issues.push(Finding::from(TimesFinding::BlocksBackward { count }).between(from_s, to_s));
    pieces.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
}

/// Drops blocks that start where the one before does.
fn drop_doubles(pieces: &mut Vec<Piece>, rate_hz: f64, doubles: &mut Doubles, content: &Content) {
    pieces.dedup_by(|later, kept| {
        let is_double = (later.start_s - kept.start_s) * rate_hz < 0.5 && later.samples.len() > 1;
        if is_double {
            let is_equal = later.samples.len() == kept.samples.len() && content.are_same(later, kept);
            doubles.add(is_equal, kept.start_s, later.start_s + as_f64(later.samples.len()) / rate_hz);
            if later.samples.len() > kept.samples.len() {
                std::mem::swap(later, kept);
            }
        }
        is_double
    });
}

fn are_same<S: Number>(a: &[S], b: &[S]) -> bool {
    a.iter().zip(b).all(|(x, y)| is_same(x.to_f64(), y.to_f64()))
}

/// Fewer stamps than this say nothing about how they jitter.
const JUDGED_STAMPS: usize = 8;

/// By how many samples a stamp may miss the end of the block before and still follow it without a gap.
///
/// Half a sample for stamps of the sampling clock. Stamps of a computer's clock jitter by many samples; then six times the median
/// miss (four standard deviations of a normal law are 5.9 medians), but less than half a block, since whole blocks get lost.
fn stamp_tolerance(stamps: &Stamps, rate_hz: f64, cut: Option<Cut>) -> f64 {
    // Two stamps that are cut to a millisecond are up to that nearer or farther than their blocks.
    let cut_samples = cut.map_or(0.0, |cut| cut.unit_s * rate_hz * (1.0 + ROUND_OFF));
    if cut.is_some_and(|cut| cut.is_whole) {
        return cut_samples.max(0.5);
    }
    let half_block = 0.5 * stamps.0.iter().map(|interval| interval.length).fold(f64::INFINITY, f64::min);
    let misses = stamps.0.iter().map(|interval| interval.miss(rate_hz).abs());
    let mut misses: Vec<f64> = misses.filter(|&miss| miss < half_block).collect();
    let median = if misses.len() < JUDGED_STAMPS { 0.0 } else { robust::median(&mut misses) };
    if median <= 0.5 { 0.5 } else { (6.0 * median).max(cut_samples).min(half_block) }
}

/// A warning where blocks are shorter than nine of ten others by no more than what stamps leave open: samples may be missing behind them.
fn hidden_loss(stamps: &Stamps, rate_hz: f64, tolerance: f64) -> Option<Finding> {
    let mut lengths: Vec<f64> = stamps.0.iter().map(|interval| interval.length).collect();
    let usual = robust::median(&mut lengths);
    let lacking: Vec<f64> =
        lengths.iter().map(|length| usual - length).filter(|lack| (0.5..=tolerance).contains(lack)).collect();
    let alike = lengths.iter().filter(|length| (usual - **length).abs() < 0.5).count();
    let most = lacking.iter().copied().fold(0.0, f64::max);
    let found = TimesFinding::ShortBlocks { count: lacking.len(), lacking: most, off_s: tolerance / rate_hz };
    (tolerance > 0.5 && !lacking.is_empty() && 10 * alike >= 9 * lengths.len()).then(|| found.into())
}

/// The place of each block's first sample on the base.
fn places(
    pieces: &[Piece],
    rate_hz: f64,
    tolerance: f64,
    present: usize,
) -> Result<Vec<usize>, TimeBaseError> {
    let limit = FILL_FACTOR.mul_add(as_f64(present), FILL_FLOOR);
    let mut places = vec![0];
    for pair in pieces.windows(2) {
        let place = places[places.len() - 1];
        let end = place + pair[0].samples.len();
        let steps = (pair[1].start_s - pair[0].start_s) * rate_hz;
        let miss = steps - as_f64(pair[0].samples.len());
        if miss.abs() <= tolerance {
            places.push(end);
        } else if as_f64(end) + miss > limit {
            return Err(TimeBaseError::Jump {
                from_s: pair[0].start_s,
                to_s: pair[1].start_s,
                lost: miss,
                sample_rate_hz: rate_hz,
            });
        } else {
            places.push(place + fit::whole(steps.round()));
        }
    }
    Ok(places)
}

/// Start and rate of the base: the nominal rate while the stamps keep to it, else the one they run at.
fn clock(
    (pieces, places): (&[Piece], &[usize]),
    rate_hz: f64,
    stamps: &Stamps,
    issues: &mut Vec<Finding>,
) -> (f64, f64) {
    let off = |piece: &Piece, place: usize| piece.start_s - pieces[0].start_s - as_f64(place) / rate_hz;
    let offs: Vec<f64> = pieces.iter().zip(places).map(|(piece, &place)| off(piece, place)).collect();
    let worst_s = offs.iter().fold(0.0_f64, |m, o| m.max(o.abs()));
    if worst_s * rate_hz <= 1.0 {
        return (pieces[0].start_s, rate_hz);
    }
    let (low_s, high_s) = offs.iter().fold((0.0_f64, 0.0_f64), |(low, high), &o| (low.min(o), high.max(o)));
    let n = as_f64(offs.len());
    let mean_place = places.iter().map(|&p| as_f64(p)).sum::<f64>() / n;
    let mean_s = offs.iter().sum::<f64>() / n;
    let (mut square, mut cross) = (0.0, 0.0);
    for (&place, &o) in places.iter().zip(&offs) {
        square += (as_f64(place) - mean_place).powi(2);
        cross += (as_f64(place) - mean_place) * (o - mean_s);
    }
    let slope_s = if square > 0.0 { cross / square } else { 0.0 };
    let fitted_hz = 1.0 / (1.0 / rate_hz + slope_s);
    let left = places.iter().zip(&offs).map(|(&p, &o)| o - mean_s - slope_s * (as_f64(p) - mean_place));
    let rms_s = (left.map(|r| r * r).sum::<f64>() / n).sqrt();
    let is_far = (fitted_hz / rate_hz - 1.0).abs() > RATE_TOLERANCE;
    if let Some(cut_s) = stamps.unit_s(rate_hz).filter(|unit_s| high_s - low_s <= unit_s * (1.0 + ROUND_OFF))
    {
        // Exact stamps of whole milliseconds look like stamps of another rate that are cut to them.
        let if_exact_hz = (is_far && stamps.cut(rate_hz).is_none()).then_some(fitted_hz);
        issues.push(TimesFinding::StampsCut { cut_s, rate_hz, if_exact_hz }.into());
        return (pieces[0].start_s + mean_s, rate_hz);
    }
    let found = TimesFinding::StampsRunOff { stamps_hz: fitted_hz, stated_hz: rate_hz, rms_s, is_far };
    issues.push(found.into());
    (pieces[0].start_s + mean_s - slope_s * mean_place, fitted_hz)
}

/// Appends a block, its start in s and its samples, less what of it is already there.
fn append<S: Number>(
    samples: &mut Vec<S>,
    (start_s, block): (f64, &[S]),
    (place, rate_hz): (usize, f64),
    doubles: &mut Doubles,
) {
    let overlap = if samples.is_empty() { 0 } else { samples.len().saturating_sub(place).min(block.len()) };
    if overlap > 0 {
        let is_equal = are_same(&samples[place..place + overlap], &block[..overlap]);
        doubles.add(is_equal, start_s, start_s + as_f64(overlap) / rate_hz);
    }
    samples.extend_from_slice(&block[overlap..]);
}

fn report_doubles(doubles: &Doubles, issues: &mut Vec<Finding>) {
    let Some((from_s, to_s)) = doubles.span_s else { return };
    let &Doubles { same, different, .. } = doubles;
    let found = TimesFinding::BlocksTwice { count: same + different, different };
    issues.push(Finding::from(found).between(from_s, to_s));
}
