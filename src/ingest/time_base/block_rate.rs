//! What is claimed of a channel's rate, and the stamps of its blocks, to the rate at which the blocks are
//! laid.

use super::blocks::{self, Laid};
use super::error::check_rate;
use super::pieces::{Block, Piece, Uniform, are_same, overlaps, pieces};
use super::stamps::{Intervals, Told};
use crate::data::{Samples, TimesFinding};
use crate::ingest::clock::{Claims, RATE_TOLERANCE};
use crate::ingest::refusal::Refusal;
use crate::ingest::shown;
use crate::ingest::statement::Statement;

/// A rate this far from that of a few stamps is worth a warning: every velocity is off by as much, and a
/// stamp 1 ms late in blocks of 0.2 s stays below.
const FEW_APART: f64 = 5e-3;

/// From one block of so many on that carries the stamp of the one before the stamps are too coarse, rather
/// than blocks sent again.
const SHARED_OF: usize = 10;
/// Fewer may as well be sent again, corrected.
const LEAST_SHARED: usize = 3;

/// Blocks on a uniform base by what is claimed of their rate, their `samples` one after another.
///
/// # Errors
/// [`Refusal`] where claims and stamps give no rate, or stamps no record.
pub(crate) fn place(blocks: &[Block], claims: &Claims, samples: Samples) -> Result<Uniform, Refusal> {
    Ok(lay(blocks, claims, &samples)?.filled(samples))
}

fn lay(blocks: &[Block], claims: &Claims, samples: &Samples) -> Result<Laid, Refusal> {
    claims.cask_hz.map_or(Ok(()), check_rate)?;
    no_shared_stamps(blocks, samples)?;
    let nearest_hz = claims.cask_hz.or(claims.stated.first().map(|stated| stated.rate_hz));
    let told = Intervals::of(blocks).told(nearest_hz);
    let Some(nearest_hz) = nearest_hz else {
        return blocks::lay(blocks, alone(blocks, told)?, samples);
    };
    let is_window = |told: &Told| nearest_hz < told.rate_hz && overlaps(samples, blocks, nearest_hz);
    let own = told.filter(|told| !told.is_few && !is_window(told));
    let own = own.map(|told| Statement::by("the stamps of its blocks", told.rate_hz, told.uncertainty));
    let taken = claims.weigh(own.as_ref())?;
    let mut issues = taken.issues;
    // Between many blocks a rate shows in every one, between few it looks like samples that are missing.
    if let Some(Told { rate_hz: stamps_hz, is_few: true, .. }) = told
        && (taken.rate_hz / stamps_hz - 1.0).abs() > FEW_APART
    {
        issues.push(TimesFinding::FewBlocks { stamps_hz, taken_hz: taken.rate_hz }.into());
    }
    let is_borne_out =
        |own: &Statement| (nearest_hz / own.rate_hz - 1.0).abs() <= RATE_TOLERANCE.max(own.rounding);
    // Blocks stay where the stamps have them while these bear a statement out; at another rate steady stamps
    // would leave a gap behind every block, or let each cover the next.
    let laid_hz = own.filter(|own| !is_borne_out(own)).map_or(nearest_hz, |own| own.rate_hz);
    let mut laid = blocks::lay(blocks, laid_hz, samples)?;
    laid.stated_hz = claims.cask_hz.filter(|hz| hz.total_cmp(&laid_hz).is_ne());
    laid.of_rate = issues;
    Ok(laid)
}

/// The rate that stamps tell where nothing states one.
fn alone(blocks: &[Block], told: Option<Told>) -> Result<f64, Refusal> {
    const REMEDY: &str = "write `sample_rate_hz` in this channel of the cask file";
    let problem = match told {
        _ if blocks.len() < 2 => "it is one block of samples without a sample rate".to_owned(),
        None => "no rate is stated, and the stamps of its blocks are too uneven to tell one".to_owned(),
        Some(told) if told.is_few => {
            format!("no rate is stated, and the stamps of {} blocks are too few to tell one", blocks.len())
        }
        Some(told) if told.uncertainty > RATE_TOLERANCE => format!(
            "no rate is stated, and the stamps of its blocks tell their {} Hz to ± {} % only",
            shown::hz(told.rate_hz),
            shown::digits(100.0 * told.uncertainty, 2)
        ),
        Some(told) => return Ok(told.rate_hz),
    };
    Err(Refusal::new(problem, REMEDY))
}

/// Refuses blocks of which many carry the stamp of the one before though their samples differ: nothing tells
/// where one is lost.
fn no_shared_stamps(blocks: &[Block], samples: &Samples) -> Result<(), Refusal> {
    let pieces = pieces(blocks);
    let is_shared = |pair: &&[Piece]| {
        let [one, other] = pair else { return false };
        one.start_s.total_cmp(&other.start_s).is_eq()
            && (one.samples.len() != other.samples.len() || !are_same(samples, one, other))
    };
    let count = pieces.windows(2).filter(is_shared).count();
    if count < LEAST_SHARED || SHARED_OF * count <= blocks.len() {
        return Ok(());
    }
    let problem = format!(
        "{count} of {} messages carry the same stamp as the one before though their samples differ: the \
         stamps are coarser than a block is long, and do not tell whether one is lost",
        blocks.len()
    );
    Err(Refusal::new(problem, "have the recorder stamp finer, or write longer blocks"))
}
