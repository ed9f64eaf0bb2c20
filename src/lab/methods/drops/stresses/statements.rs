//! Something stated wrongly, ever more, to the plan whose cask file says it.

use super::{COMMON, Contact, Stress};

pub(in super::super) const STATEMENTS: &[Stress] = &[
    Stress {
        name: "friction-stated-rough",
        title: "Stated rough, but the first end slides with this friction",
        axis: "true friction coefficient",
        is_log: false,
        values: &[1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.35, 0.3, 0.2, 0.1, 0.05, 0.0],
        tells_k: true,
        apply: |plan, _, friction| plan.contact = Contact::Coulomb(friction),
    },
    Stress {
        name: "friction-stated-truly",
        title: "Friction between smooth and rough, stated as it is",
        axis: "friction coefficient",
        is_log: false,
        values: &[1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.35, 0.3, 0.2, 0.1, 0.05, 0.0],
        apply: |plan, _, friction| {
            plan.contact = Contact::Coulomb(friction);
            plan.stated_contact = plan.contact;
        },
        ..COMMON
    },
    Stress {
        name: "angle-misstated",
        title: "Stated drop angle too steep",
        axis: "stated less true angle, degrees",
        values: &[0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0],
        tells_k: true,
        apply: |plan, _, degrees| plan.angle_error_deg = degrees,
        ..COMMON
    },
    Stress {
        name: "angle-misstated-flat",
        title: "Stated drop angle too flat",
        axis: "true less stated angle, degrees",
        values: &[0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 9.0],
        apply: |plan, _, degrees| plan.angle_error_deg = -degrees,
        ..COMMON
    },
    Stress {
        name: "scale-first",
        title: "First end's channel reads too much",
        axis: "scale error, %",
        values: &[0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 20.0, 50.0],
        tells_k: true,
        apply: |plan, _, percent| plan.chains[0].scale = 1.0 + percent / 100.0,
        ..COMMON
    },
    Stress {
        name: "scale-second",
        title: "Second end's channel reads too much",
        axis: "scale error, %",
        values: &[0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 20.0, 50.0],
        apply: |plan, _, percent| plan.chains[1].scale = 1.0 + percent / 100.0,
        ..COMMON
    },
    Stress {
        name: "tilt",
        title: "First end's sensor seated askew",
        axis: "tilt towards the axis, degrees",
        values: &[0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 20.0],
        apply: |plan, _, degrees| plan.chains[0].tilt_rad = degrees.to_radians(),
        ..COMMON
    },
];
