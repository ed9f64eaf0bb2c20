//! Samples to their zero-phase low-passed selves with initial states that leave no trace of which direction came first.

use super::stage::{Stage, forward_and_back};
use crate::numerics::filter::stage::{Sample, constant};
use nalgebra::{DMatrix, DVector};

/// Singular values below this share of the largest are taken for 0: the states that they belong to are not told by the record.
const RANK: f64 = 1e-12;

/// Gustafsson, F.: Determining the initial states in forward-backward filtering. *IEEE Trans. Signal Process.* 44 (1996).
///
/// `memory`: samples after which a state is forgotten.
pub(super) fn filtered<T: Sample>(stages: &[Stage<T>], samples: &[T], memory: usize) -> Vec<T> {
    let n = samples.len();
    let mut forth = samples.to_vec();
    forward_and_back(stages, &mut forth, false);
    let mut back: Vec<T> = samples.iter().rev().copied().collect();
    forward_and_back(stages, &mut back, false);
    back.reverse();
    // Two states that do not reach each other are found apart; else both at once.
    let reach = if 2 * memory < n { memory } else { n };
    let free: Vec<Vec<T>> = free_responses(stages, reach);
    let returned: Vec<Vec<T>> = free.iter().map(|response| one_back(stages, response)).collect();
    let wide = |value: T| value.to_f64().unwrap_or(0.0);
    let differs = |i: usize, k: usize| wide(returned[k][i]) - wide(free[k][i]);
    let gap = |i: usize| wide(back[i]) - wide(forth[i]);
    let order = free.len();
    let (at_start, at_end) = if reach < n {
        // Seen from the end everything is reversed, and the difference of the two directions changes its sign.
        let matrix = DMatrix::from_fn(reach, order, differs);
        let sides = DMatrix::from_fn(reach, 2, |i, side| if side == 0 { gap(i) } else { -gap(n - 1 - i) });
        let found = least_squares(matrix, &sides);
        (found.column(0).into_owned(), found.column(1).into_owned())
    } else {
        let both = |i: usize, k: usize| {
            if k < order { differs(i, k) } else { -differs(n - 1 - i, k - order) }
        };
        let sides = DMatrix::from_fn(n, 1, |i, _| gap(i));
        let found = least_squares(DMatrix::from_fn(n, 2 * order, both), &sides);
        (found.rows(0, order).column(0).into_owned(), found.rows(order, order).column(0).into_owned())
    };
    let corrected = |weights: &DVector<f64>, columns: &[Vec<T>], i: usize| -> f64 {
        weights.iter().zip(columns).map(|(w, column)| w * wide(column[i])).sum()
    };
    for i in 0..reach {
        forth[i] = forth[i] + constant(corrected(&at_start, &returned, i));
        forth[n - 1 - i] = forth[n - 1 - i] + constant(corrected(&at_end, &free, i));
    }
    forth
}

/// What each remembered number gives by itself, forward over `count` samples of nothing.
fn free_responses<T: Sample>(stages: &[Stage<T>], count: usize) -> Vec<Vec<T>> {
    let mut responses = Vec::new();
    for (i, stage) in stages.iter().enumerate() {
        for k in 0..stage.order() {
            let mut response = vec![T::zero(); count];
            let mut state = vec![T::zero(); stage.order()];
            state[k] = T::one();
            stage.run(response.iter_mut(), &mut state);
            for later in &stages[i + 1..] {
                later.run(response.iter_mut(), &mut vec![T::zero(); later.order()]);
            }
            responses.push(response);
        }
    }
    responses
}

/// Back through all stages, from rest.
fn one_back<T: Sample>(stages: &[Stage<T>], response: &[T]) -> Vec<T> {
    let mut back = response.to_vec();
    for stage in stages {
        stage.run(back.iter_mut().rev(), &mut vec![T::zero(); stage.order()]);
    }
    back
}

/// The least-squares solution; of several the shortest.
fn least_squares(matrix: DMatrix<f64>, sides: &DMatrix<f64>) -> DMatrix<f64> {
    let unknowns = matrix.ncols();
    let nothing = DMatrix::zeros(unknowns, sides.ncols());
    if matrix.iter().chain(sides.iter()).any(|x| !x.is_finite()) {
        return nothing;
    }
    let rank = |matrix: DMatrix<f64>, sides: &DMatrix<f64>| {
        let parts = matrix.svd(true, true);
        let least = RANK * parts.singular_values.max();
        parts.solve(sides, least)
    };
    if matrix.nrows() <= unknowns {
        return rank(matrix, sides).unwrap_or(nothing);
    }
    let qr = matrix.qr();
    let mut turned = sides.clone();
    qr.q_tr_mul(&mut turned);
    rank(qr.r(), &turned.rows(0, unknowns).into_owned()).unwrap_or(nothing)
}
