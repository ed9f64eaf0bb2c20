//! The reconstruction and the budget of the hand-made ANF-18 drop, for the tests of this module only.

use crate::data::{
    Adjustment, CheckKind, Consistency, Contribution, Estimate, Method, MethodCandidate, MethodChoice,
    Untested, UntestedMoves,
};

/// Flight fit selected, joint fit beside it.
pub(super) fn choice() -> MethodChoice {
    let candidate = |rung, speed: (f64, f64), k: (f64, f64), consistent, residual: &str| MethodCandidate {
        rung,
        speed: Some(Estimate::new(speed.0, speed.1, "m/s")),
        k: Some(Estimate::new(k.0, k.1, "1")),
        consistent,
        residual: residual.into(),
    };
    MethodChoice {
        rung: Method::Flight,
        reason:
            "Taken: planar motion with modes and drift fitted to the flight; the joint fit of all inputs \
                 within their tolerances would change the speed by +0.02 m/s and k by -0.001, within the \
                 interval."
                .into(),
        candidates: vec![
            candidate(
                Method::Flight,
                (20.56, 0.11),
                (0.5588, 0.0102),
                true,
                "0.032 m/s about 1 mode; rotation against the impulse of the first impact off by -0.8 % of ω \
                 (0.4 u)",
            ),
            candidate(Method::Joint, (20.58, 0.10), (0.5578, 0.0098), true, "χ² = 0.2 for 2 observables"),
        ],
        closures: closures(),
        chi_square: Some((0.22, 2)),
        adjustments: vec![Adjustment {
            input: "drop angle".into(),
            standard_uncertainty: "0.20°".into(),
            moved_in_u: -0.17,
            left_share: 0.365,
        }],
    }
}

fn closures() -> Vec<Consistency> {
    let closure = |name: &str, kind, miss: &str, miss_in_u, beside_others_in_u| Consistency {
        name: name.into(),
        kind,
        channel: None,
        miss: miss.into(),
        miss_in_u,
        beside_others_in_u,
    };
    vec![
        closure("height of the second end at slap-down", CheckKind::Height, "+5 mm", 0.22, 0.03),
        closure(
            "rotation against the impulse of the first impact",
            CheckKind::Turning,
            "-0.8 % of ω",
            -0.41,
            -0.10,
        ),
    ]
}

/// Contributions whose squares add up to the sample's intervals of speed and k.
pub(super) fn budget() -> Vec<Contribution> {
    let contribution =
        |input: &str, standard_uncertainty: &str, tolerance: &'static str, speed_m_s, k| Contribution {
            input: input.into(),
            standard_uncertainty: standard_uncertainty.into(),
            tolerance: Some(tolerance).filter(|key| !key.is_empty()),
            speed_m_s: Some(speed_m_s),
            k: Some(k),
        };
    vec![
        contribution("calibration of A2", "0.50 %", "calibration_percent", 0.035, 0.0001),
        contribution("velocity step of A2", "0.024 m/s", "", 0.030, 0.0001),
        contribution("cross axis of A1", "1.00 %", "cross_axis_percent", 0.025, 0.0040),
        contribution("drop angle", "0.20°", "angle_deg", 0.017, 0.0030),
        contribution("position of A1", "5 mm", "position_m", 0.003, 0.0010),
    ]
}

/// An input that nothing tests.
pub(super) fn untested() -> Untested {
    Untested {
        what: "calibration of A1".into(),
        key: "channel.A1.calibration_percent".into(),
        by: "1 %",
        moves: UntestedMoves { k: Some(0.0156), slap_down_speed_m_s: Some(0.052) },
        remedy: "record the rest before the release",
    }
}
