//! Samples to their zero-phase low-passed selves with initial states that leave no trace of which direction came first.

use crate::numerics::filter::stage::StateVariable;
use nalgebra::DMatrix;

/// Gustafsson, F.: Determining the initial states in forward-backward filtering. *IEEE Trans. Signal Process.* 44 (1996).
///
/// The states at both ends are those for which forward-back and back-forward agree best. They are found apart: `None` where the record is
/// shorter than twice the `memory`, the samples after which a state is forgotten.
pub(super) fn filtered(stage: &StateVariable, samples: &[f64], memory: usize) -> Option<Vec<f64>> {
    let n = samples.len();
    if n < 2 * memory {
        return None;
    }
    let mut forth = samples.to_vec();
    stage.run(forth.iter_mut(), &mut [0.0; 2]);
    stage.run(forth.iter_mut().rev(), &mut [0.0; 2]);
    let mut back = samples.to_vec();
    stage.run(back.iter_mut().rev(), &mut [0.0; 2]);
    stage.run(back.iter_mut(), &mut [0.0; 2]);
    // What each of the two states gives by itself, forward over nothing; and that, sent back.
    let free = [[1.0, 0.0], [0.0, 1.0]].map(|mut state| {
        let mut response = vec![0.0; memory];
        stage.run(response.iter_mut(), &mut state);
        response
    });
    let returned = free.each_ref().map(|response| {
        let mut response = response.clone();
        stage.run(response.iter_mut().rev(), &mut [0.0; 2]);
        response
    });
    let differs = DMatrix::from_fn(memory, 2, |i, k| returned[k][i] - free[k][i]);
    // Seen from the end everything is reversed, and the difference of the two directions changes its sign.
    let gaps = DMatrix::from_fn(memory, 2, |i, side| {
        if side == 0 { back[i] - forth[i] } else { forth[n - 1 - i] - back[n - 1 - i] }
    });
    // A state that the record does not tell stays at rest.
    let parts = differs.svd(true, true);
    let least = 1e-12 * parts.singular_values.max();
    let states = parts.solve(&gaps, least).ok()?;
    for i in 0..memory {
        forth[i] += states[(0, 0)] * returned[0][i] + states[(1, 0)] * returned[1][i];
        forth[n - 1 - i] += states[(0, 1)] * free[0][i] + states[(1, 1)] * free[1][i];
    }
    Some(forth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, SQRT_2};

    #[test]
    fn it_does_not_depend_on_the_direction_and_keeps_a_constant() {
        let stage = StateVariable::new((PI * 0.02).tan(), SQRT_2);
        let x: Vec<f64> = (0..700).map(|i: i32| f64::from((i * 7919) % 1000) / 500.0 - 1.0).collect();
        let reversed: Vec<f64> = x.iter().rev().copied().collect();
        let [y, z] = [&x, &reversed].map(|x| filtered(&stage, x, 155).expect("long enough"));
        // Left to find: what the memory of 1e-6 leaves, of samples up to 1.
        assert!(y.iter().zip(z.iter().rev()).all(|(a, b)| (a - b).abs() < 1e-5));
        let seven = filtered(&stage, &[7.0; 700], 155).expect("long enough");
        assert!(seven.iter().all(|y| (y - 7.0).abs() < 1e-4));
        assert!(filtered(&stage, &[7.0; 300], 155).is_none());
    }
}
