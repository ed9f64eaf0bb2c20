//! Blocks of samples with a stamp each to one run: sorted, doubles dropped, overlaps trimmed, gaps NaN.

use super::error::{self, check_lengths, check_rate};
use super::fit::{FILL_FACTOR, FILL_FLOOR};
use super::missing;
use super::order::{is_same, no_mixture};
use super::pieces::{Block, Piece, Uniform, are_same, pieces};
use super::stamps::{Intervals, ROUND_OFF, StampCut, line};
use crate::data::{Finding, Samples, Span, TimesFinding};
use crate::ingest::clock::RATE_TOLERANCE;
use crate::ingest::refusal::Refusal;
use crate::numerics::{as_count, as_f64, robust};

/// What sorting and doubles came to.
#[derive(Default)]
struct Doubles {
    count: usize,
    different: usize,
    span_s: Option<(f64, f64)>,
}

impl Doubles {
    fn add(&mut self, is_equal: bool, from_s: f64, to_s: f64) {
        self.count += 1;
        self.different += usize::from(!is_equal);
        self.span_s = Some(self.span_s.map_or((from_s, to_s), |s| (s.0.min(from_s), s.1.max(to_s))));
    }
}

/// Blocks on a uniform base at a rate in Hz, their `samples` one after another. Stamps decide where a block
/// lies, to the nearest sample; samples are not moved between. Blocks that follow one another stay where they
/// are.
///
/// # Errors
/// A refusal where stamps or rate make no record.
pub fn from_blocks(blocks: &[Block], rate_hz: f64, samples: Samples) -> Result<Uniform, Refusal> {
    let count: usize = blocks.iter().map(|block| block.count).sum();
    check_lengths(count, samples.len())?;
    let laid = lay(blocks, rate_hz, &samples)?;
    Ok(laid.filled(samples))
}

/// Where blocks lie on a uniform base.
pub(super) struct Laid {
    /// Those that are kept, in the order of their stamps.
    pieces: Vec<Piece>,
    /// Time of the first sample, s.
    start_s: f64,
    /// At which the blocks follow one another, Hz.
    sample_rate_hz: f64,
    /// The cask file's, where its stamps contradict it, Hz.
    pub(super) stated_hz: Option<f64>,
    /// What is to be said of the rate.
    pub(super) of_rate: Vec<Finding>,
    /// Samples that are missing between blocks, from when to when, s.
    gaps: Vec<missing::Gap>,
    doubles: Doubles,
    issues: Vec<Finding>,
}

/// [`from_blocks`] as far as stamps and lengths tell.
///
/// # Errors
/// As that.
pub(super) fn lay(blocks: &[Block], rate_hz: f64, samples: &Samples) -> Result<Laid, Refusal> {
    check_rate(rate_hz)?;
    if let Some(index) = blocks.iter().position(|block| !block.start_s.is_finite()) {
        return Err(error::not_finite(index + 1, blocks[index].start_s));
    }
    let mut pieces = pieces(blocks);
    pieces.retain(|piece| !piece.samples.is_empty());
    let (mut issues, mut doubles) = (Vec::new(), Doubles::default());
    sort(&mut pieces, &mut issues, samples)?;
    drop_doubles(&mut pieces, rate_hz, &mut doubles, samples);
    let present: usize = pieces.iter().map(|piece| piece.samples.len()).sum();
    if present < 2 {
        return Err(error::too_few(present));
    }
    let stamps = Intervals::between(&pieces, |piece| (piece.start_s, piece.samples.len()));
    let cut = stamps.cut(rate_hz);
    let tolerance = stamp_tolerance(&stamps, rate_hz, cut);
    issues.extend(hidden_loss(&stamps, rate_hz, tolerance));
    place(&mut pieces, rate_hz, tolerance, present)?;
    let (start_s, sample_rate_hz) = clock(&pieces, rate_hz, &stamps, &mut issues);
    let time_s = |index: usize| start_s + as_f64(index) / sample_rate_hz;
    let (mut gaps, mut end) = (Vec::new(), 0);
    for piece in &pieces {
        if piece.place > end && end > 0 {
            let lost = piece.place - end;
            gaps.push(missing::Gap { lost, from_s: time_s(end - 1), to_s: time_s(piece.place) });
        }
        end = end.max(piece.end());
    }
    let (stated_hz, of_rate) = (None, Vec::new());
    Ok(Laid { pieces, start_s, sample_rate_hz, stated_hz, of_rate, gaps, doubles, issues })
}

impl Laid {
    /// The samples at their places; of a block less what of it is already there.
    pub(super) fn filled(self, held: Samples) -> Uniform {
        let count = self.pieces.iter().map(Piece::end).max().unwrap_or(0);
        let Self { pieces, start_s, sample_rate_hz, stated_hz, of_rate, gaps, mut doubles, mut issues } =
            self;
        let (mut stretches, mut end) = (Vec::with_capacity(pieces.len()), 0_usize);
        for piece in &pieces {
            let overlap = end.saturating_sub(piece.place).min(piece.samples.len());
            let (from, to) = (piece.samples.start + overlap, piece.samples.end);
            stretches.push((Span { from, to }, piece.place + overlap));
            end = end.max(piece.end());
        }
        let kept: usize = stretches.iter().map(|(span, _)| span.to - span.from).sum();
        let is_in_place =
            [held.len(), kept] == [count; 2] && stretches.iter().all(|(span, to)| span.from == *to);
        let mut samples = if is_in_place {
            held
        } else {
            let laid = held.distribute(count, &stretches);
            for (piece, (span, _)) in pieces.iter().zip(&stretches) {
                let from = piece.samples.start;
                let mut doubled = (0..span.from - from)
                    .map(|i| is_same(laid.get(piece.place + i), held.get(from + i)))
                    .peekable();
                if doubled.peek().is_some() {
                    let to_s = piece.start_s + as_f64(span.from - from) / sample_rate_hz;
                    doubles.add(doubled.all(|is_same| is_same), piece.start_s, to_s);
                }
            }
            laid
        };
        if let Some((from_s, to_s)) = doubles.span_s {
            let Doubles { count, different, .. } = doubles;
            let found = TimesFinding::BlocksTwice { count, different };
            issues.push(Finding::from(found).span(from_s, to_s));
        }
        missing::push_gaps(&gaps, &mut issues);
        let lost: usize = gaps.iter().map(|gap| gap.lost).sum();
        let gaps = missing::mark(&mut samples, lost, |i| start_s + as_f64(i) / sample_rate_hz, &mut issues);
        issues.extend(of_rate);
        let sample_rate_hz = stated_hz.unwrap_or(sample_rate_hz);
        Uniform { start_s, span_s: None, sample_rate_hz, samples, gaps, time_jitter_s: 0.0, issues }
    }
}

fn sort(pieces: &mut [Piece], issues: &mut Vec<Finding>, samples: &Samples) -> Result<(), Refusal> {
    let Some(first) = (1..pieces.len()).find(|&i| pieces[i].start_s < pieces[i - 1].start_s) else {
        return Ok(());
    };
    let starts_s: Vec<f64> = pieces.iter().map(|piece| piece.start_s).collect();
    let mut order: Vec<usize> = (0..pieces.len()).collect();
    order.sort_by(|&a, &b| starts_s[a].total_cmp(&starts_s[b]));
    let is_copy = |a: usize, b: usize| {
        let (one, other) = (&pieces[a], &pieces[b]);
        starts_s[a].total_cmp(&starts_s[b]).is_eq()
            && one.samples.len() == other.samples.len()
            && are_same(samples, one, other)
    };
    no_mixture(&starts_s, order.into_iter(), is_copy)?;
    let count = pieces.windows(2).filter(|w| w[1].start_s < w[0].start_s).count();
    let (from_s, to_s) = (pieces[first].start_s, pieces[first - 1].start_s);
    issues.push(Finding::from(TimesFinding::BlocksBackward { count }).span(from_s, to_s));
    pieces.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    Ok(())
}

/// Drops blocks that start where the one before does.
fn drop_doubles(pieces: &mut Vec<Piece>, rate_hz: f64, doubles: &mut Doubles, samples: &Samples) {
    pieces.dedup_by(|later, kept| {
        let is_double = (later.start_s - kept.start_s) * rate_hz < 0.5 && later.samples.len() > 1;
        if is_double {
            let is_equal = later.samples.len() == kept.samples.len() && are_same(samples, later, kept);
            doubles.add(is_equal, kept.start_s, later.start_s + as_f64(later.samples.len()) / rate_hz);
            if later.samples.len() > kept.samples.len() {
                std::mem::swap(later, kept);
            }
        }
        is_double
    });
}

/// Fewer stamps than this say nothing about how they jitter.
const JUDGED_STAMPS: usize = 8;

/// By how many samples a stamp may miss the end of the block before and still follow it without a gap.
///
/// Half a sample for stamps of the sampling clock. Stamps of a computer's clock jitter by many samples; then
/// six times the median miss (four standard deviations of a normal law are 5.9 medians), but less than half a
/// block, since whole blocks get lost.
fn stamp_tolerance(stamps: &Intervals, rate_hz: f64, cut: Option<StampCut>) -> f64 {
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

/// A warning where blocks are shorter than nine of ten others by no more than what stamps leave open: samples
/// may be missing behind them.
fn hidden_loss(stamps: &Intervals, rate_hz: f64, tolerance: f64) -> Option<Finding> {
    let mut lengths: Vec<f64> = stamps.0.iter().map(|interval| interval.length).collect();
    let usual = robust::median(&mut lengths);
    let lacking: Vec<f64> =
        lengths.iter().map(|length| usual - length).filter(|lack| (0.5..=tolerance).contains(lack)).collect();
    let alike = lengths.iter().filter(|length| (usual - **length).abs() < 0.5).count();
    let most = lacking.iter().copied().fold(0.0, f64::max);
    let found = TimesFinding::ShortBlocks { count: lacking.len(), lacking: most, off_s: tolerance / rate_hz };
    (tolerance > 0.5 && !lacking.is_empty() && 10 * alike >= 9 * lengths.len()).then(|| found.into())
}

/// Gives each block the place of its first sample on the base.
fn place(pieces: &mut [Piece], rate_hz: f64, tolerance: f64, present: usize) -> Result<(), Refusal> {
    let limit = FILL_FACTOR.mul_add(as_f64(present), FILL_FLOOR);
    for later in 1..pieces.len() {
        let [before, piece] = &mut pieces[later - 1..=later] else { continue };
        let steps = (piece.start_s - before.start_s) * rate_hz;
        let miss = steps - as_f64(before.samples.len());
        if miss.abs() > tolerance && as_f64(before.end()) + miss > limit {
            return Err(error::jump(before.start_s, piece.start_s, miss, rate_hz));
        }
        piece.place =
            if miss.abs() <= tolerance { before.end() } else { before.place + as_count(steps.round()) };
    }
    Ok(())
}

/// Start and rate of the base: the nominal rate while the stamps keep to it, else the one they run at.
fn clock(pieces: &[Piece], rate_hz: f64, stamps: &Intervals, issues: &mut Vec<Finding>) -> (f64, f64) {
    let first_s = pieces[0].start_s;
    let off = |piece: &Piece| {
        let place = as_f64(piece.place);
        (place, piece.start_s - first_s - place / rate_hz)
    };
    let offs: Vec<(f64, f64)> = pieces.iter().map(off).collect();
    let (low_s, high_s) =
        offs.iter().fold((0.0_f64, 0.0_f64), |(low, high), o| (low.min(o.1), high.max(o.1)));
    if high_s.max(-low_s) * rate_hz <= 1.0 {
        return (first_s, rate_hz);
    }
    let ((mean_place, mean_s), slope_s) = line(&offs);
    let fitted_hz = 1.0 / (1.0 / rate_hz + slope_s);
    let left = offs.iter().map(|(place, o)| o - mean_s - slope_s * (place - mean_place));
    let rms_s = (left.map(|r| r * r).sum::<f64>() / as_f64(offs.len())).sqrt();
    let is_far = (fitted_hz / rate_hz - 1.0).abs() > RATE_TOLERANCE;
    let is_cut = |unit_s: &f64| high_s - low_s <= unit_s * (1.0 + ROUND_OFF);
    if let Some(cut_s) = stamps.unit_s(rate_hz).filter(is_cut) {
        // Exact stamps of whole milliseconds look like stamps of another rate that are cut to them.
        let if_exact_hz = (is_far && stamps.cut(rate_hz).is_none()).then_some(fitted_hz);
        issues.push(TimesFinding::StampsCut { cut_s, rate_hz, if_exact_hz }.into());
        return (first_s + mean_s, rate_hz);
    }
    let found = TimesFinding::StampsRunOff { stamps_hz: fitted_hz, stated_hz: rate_hz, rms_s, is_far };
    issues.push(found.into());
    (first_s + mean_s - slope_s * mean_place, fitted_hz)
}
