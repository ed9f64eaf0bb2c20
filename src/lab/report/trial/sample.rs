//! A small trial for the tests of its files.

use crate::lab::data::{Trial, TrialLine, TrialMachine, TrialMap, TrialPoint, TrialRequest};

pub(super) fn trial() -> Trial {
    let point = |method: &str, is_default: bool, error: f64, time_ns: f64| TrialPoint {
        family: "filter".into(),
        method: method.into(),
        class: "order 2".into(),
        is_default,
        median_error: error,
        p95_error: 2.0 * error,
        error_unit: "of the peak".into(),
        time_ns,
        time_quartiles_ns: [0.9 * time_ns, 1.1 * time_ns],
        time_per: "sample".into(),
        cases: 3,
    };
    let map = TrialMap {
        name: "rate".into(),
        title: "Rate".into(),
        stress: "rate".into(),
        is_log: true,
        stresses: vec![100.0, 1e3, 1e4],
        error: "error".into(),
        limit: 0.01,
        lines: vec![
            TrialLine {
                method: "a".into(),
                errors: vec![Some(1e-3), Some(0.1), Some(1e9)],
                noticed: vec![None, Some(false), Some(true)],
            },
            TrialLine {
                method: "b".into(),
                errors: vec![Some(0.0), None, Some(1e-3)],
                noticed: vec![Some(false); 3],
            },
        ],
    };
    Trial {
        schema: "dropcheck.validation/1".into(),
        version: "0.1.0".into(),
        request: TrialRequest { quick: true, seed: 1 },
        machine: TrialMachine {
            processor: "processor".into(),
            cores: 2,
            system: "linux".into(),
            is_optimised: true,
        },
        peers: "None was tried.".into(),
        points: vec![
            point("state-variable", true, 1e-14, 8.0),
            point("scipy sosfiltfilt", false, 1e-9, 19.0),
        ],
        is_on_front: vec![true, false],
        maps: vec![map],
    }
}
