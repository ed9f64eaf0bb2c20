//! Motion just after L strikes, from the motion before and the contact law; for the thin uniform rod also by
//! \[P\] Table 1.

use super::state::{State, arms_m};
use crate::data::{Body, Contact};

/// Coulomb coefficient of a contact law: rough is friction without limit, smooth is zero; an unknown one
/// counts as rough.
pub(super) fn coefficient(contact: Contact) -> f64 {
    match contact {
        Contact::Rough | Contact::Unknown => f64::INFINITY,
        Contact::Smooth => 0.0,
        Contact::Coulomb(coefficient) => coefficient,
    }
}

/// An impact of L: the motion after it and its impulses.
pub(super) struct Struck {
    pub after: State,
    /// I_x, N s.
    pub horizontal_impulse_n_s: f64,
    /// I_z, N s.
    pub vertical_impulse_n_s: f64,
    /// |I_x/I_z| with which L's corner stays at rest once it has stopped: μ* of (6).
    pub friction_to_stick: f64,
    /// True if the corner does not slide when it leaves.
    pub sticks: bool,
}

/// A stretch of the impact with one ratio of the impulses.
struct Stretch {
    /// dI_x / dI_z.
    ratio: f64,
    /// I_z until the sliding stops, N s; without end in the last stretch.
    length_n_s: Option<f64>,
    /// True if the corner sticks in the impact.
    sticks: bool,
}

/// The corner's velocity and its response: Δẋ_C = n_xx I_x − n_xz I_z, Δż_C = n_zz I_z − n_xz I_x.
struct ContactPoint {
    n_xx: f64,
    n_zz: f64,
    n_xz: f64,
    slip_m_s: f64,
    approach_m_s: f64,
}

impl ContactPoint {
    /// L's corner, per unit mass and impulse: n_xx = (1 + b²/r²)/m, n_zz = (1 + a²/r²)/m, n_xz = a b/(r² m),
    /// r² = Θ/m   (2) (3)
    fn new(body: &Body, before: &State, a: f64, b: f64) -> Self {
        let (m, theta) = (body.mass_kg, body.inertia_kg_m2);
        let w = before.angular_velocity_rad_s;
        Self {
            n_xx: b * b / theta + 1.0 / m,
            n_zz: a * a / theta + 1.0 / m,
            n_xz: a * b / theta,
            slip_m_s: before.horizontal_velocity_m_s - b * w,
            approach_m_s: before.vertical_velocity_m_s + a * w,
        }
    }

    /// dI_x/dI_z once the corner does not slide: the ratio that sticking needs, or the available friction;
    /// and true if it sticks   (6)
    fn ratio_from_rest(&self, friction: f64) -> (f64, bool) {
        let needed = self.n_xz / self.n_xx;
        if needed.abs() <= friction { (needed, true) } else { (friction * needed.signum(), false) }
    }

    /// The corner slides until it stops, if it does; then it sticks or slides the way it is driven.
    fn stretches(&self, friction: f64) -> (Option<Stretch>, Stretch) {
        let (ratio, sticks) = self.ratio_from_rest(friction);
        let last = Stretch { ratio, length_n_s: None, sticks };
        if self.slip_m_s == 0.0 {
            return (None, last);
        }
        let against = -friction * self.slip_m_s.signum();
        let slip_rate = self.n_xx * against - self.n_xz;
        if slip_rate * self.slip_m_s >= 0.0 {
            return (None, Stretch { ratio: against, length_n_s: None, sticks: false });
        }
        let length_n_s = Some(-self.slip_m_s / slip_rate);
        (Some(Stretch { ratio: against, length_n_s, sticks: false }), last)
    }
}

/// The motion just after L's corner strikes with restitution `k`.
///
/// I_x = m Δẋ, I_z = m Δż, Θ Δω = a I_z − b I_x   (2). While the corner slides I_x = ± μ I_z against the
/// sliding; when it stops it sticks if friction suffices. The normal force returns k² of the work that it
/// absorbed (Stronge 1990); without sliding before the impact that is ż_C' = −k ż_C   (3)–(6).
pub(super) fn strike_first_end(body: &Body, before: &State, contact: Contact, k: f64) -> Struck {
    let (a, b) = arms_m(body, before.angle_rad, body.cog_m);
    let mut point = ContactPoint::new(body, before, a, b);
    let friction = coefficient(contact);
    let (mut impulse_x, mut impulse_z) = (0.0, 0.0);
    if friction.is_infinite() && point.slip_m_s != 0.0 {
        // Friction without limit stops the sliding before the normal force has had any effect.
        impulse_x = -point.slip_m_s / point.n_xx;
        point.approach_m_s -= point.n_xz * impulse_x;
        point.slip_m_s = 0.0;
    }
    let (first, last) = point.stretches(friction);
    // A corner at rest on the target may still jam, if friction presses it on (Painlevé).
    let jams = || point.approach_m_s == 0.0 && first.as_ref().is_some_and(|s| normal_rate(&point, s) < 0.0);
    if point.approach_m_s < 0.0 || jams() {
        let (in_first, in_last) = normal_impulses(&point, first.as_ref(), &last, k);
        impulse_z = in_first + in_last;
        impulse_x += last.ratio * in_last + first.map_or(0.0, |s| s.ratio * in_first);
    }
    Struck {
        after: State {
            horizontal_velocity_m_s: before.horizontal_velocity_m_s + impulse_x / body.mass_kg,
            vertical_velocity_m_s: before.vertical_velocity_m_s + impulse_z / body.mass_kg,
            angular_velocity_rad_s: before.angular_velocity_rad_s
                + (a * impulse_z - b * impulse_x) / body.inertia_kg_m2,
            ..*before
        },
        horizontal_impulse_n_s: impulse_x,
        vertical_impulse_n_s: impulse_z,
        friction_to_stick: (point.n_xz / point.n_xx).abs(),
        sticks: last.sticks,
    }
}

/// dż_C/dI_z in a stretch.
fn normal_rate(point: &ContactPoint, stretch: &Stretch) -> f64 {
    point.n_zz - point.n_xz * stretch.ratio
}

/// I_z in the first and in the last stretch.
///
/// ż_C grows linearly with I_z; the work ∫ ż_C dI_z is −C at the end of the compression and −(1 − k²) C at
/// the end.
fn normal_impulses(point: &ContactPoint, first: Option<&Stretch>, last: &Stretch, k: f64) -> (f64, f64) {
    let rate = normal_rate(point, last);
    let Some((length, first_rate)) =
        first.and_then(|s| s.length_n_s.map(|length| (length, normal_rate(point, s))))
    else {
        return (0.0, -(k + 1.0) * point.approach_m_s / rate);
    };
    let v = point.approach_m_s;
    let at_stop = v + first_rate * length;
    if at_stop <= 0.0 {
        // The sliding stops while the contact is still compressed.
        let work = -(v + at_stop) * length * 0.5 + at_stop * at_stop / (rate * 2.0);
        return (length, (k * (work * rate * 2.0).sqrt() - at_stop) / rate);
    }
    let compression = -v / first_rate;
    let whole = compression * (k + 1.0);
    if whole <= length {
        return (whole, 0.0);
    }
    // The sliding stops while the contact expands: the remainder of k² C goes into the last stretch.
    let left = (v * v * k * k / first_rate - at_stop * at_stop / first_rate) * 0.5;
    let out = (at_stop * at_stop + left * rate * 2.0).sqrt();
    (length, (out - at_stop) / rate)
}

/// \[P\] Table 1, with ż_S2 of the smooth impact corrected: a rod that falls at v0 without rotation, rough or
/// smooth   (7)
///
/// `body` is a thin uniform rod; any friction counts as rough. A rod that turns or moves sideways as it
/// strikes is outside \[P\]'s (2).
pub(super) fn table_1(body: &Body, before: &State, contact: Contact, k: f64) -> Struck {
    if before.angular_velocity_rad_s != 0.0 || before.horizontal_velocity_m_s != 0.0 {
        return strike_first_end(body, before, contact, k);
    }
    let (l, v0) = (body.length_m, -before.vertical_velocity_m_s);
    let (a, b) = arms_m(body, before.angle_rad, body.cog_m);
    // a = (l/2) cos φ0, b = (l/2) sin φ0
    let (sin, cos) = (2.0 * b / l, 2.0 * a / l);
    let smooth = contact == Contact::Smooth;
    // rough ω2 = 3 (1 + k) v0 cos φ0 / (2 l), smooth ω2 = 6 (1 + k) v0 cos φ0 / (l (3 cos² φ0 + 1))
    let w = if smooth {
        6.0 * (1.0 + k) * v0 * cos / (l * (3.0 * cos * cos + 1.0))
    } else {
        3.0 * (1.0 + k) * v0 * cos / (2.0 * l)
    };
    // ẋ_S2 = ω2 (l/2) sin φ0 if L does not slide, ż_S2 = k v0 − ω2 (l/2) cos φ0
    let after = State {
        horizontal_velocity_m_s: if smooth { 0.0 } else { w * l / 2.0 * sin },
        vertical_velocity_m_s: k * v0 - w * l / 2.0 * cos,
        angular_velocity_rad_s: w,
        ..*before
    };
    Struck {
        after,
        horizontal_impulse_n_s: body.mass_kg * after.horizontal_velocity_m_s,
        vertical_impulse_n_s: body.mass_kg * (after.vertical_velocity_m_s + v0),
        // μ* = a b / (r² + b²), r² = l²/12   (6)
        friction_to_stick: a * b / (l * l / 12.0 + b * b),
        sticks: !smooth,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{BodyModel, example};
    use proptest::prelude::*;

    fn body(h: f64, c: f64) -> Body {
        Body { model: BodyModel::Body, cog_m: c, ..example::body(1500.0, 4.7, h) }
    }

    fn moving(angle_rad: f64, (x, z, w): (f64, f64, f64)) -> State {
        State {
            height_m: 1.0,
            angle_rad,
            horizontal_velocity_m_s: x,
            vertical_velocity_m_s: z,
            angular_velocity_rad_s: w,
        }
    }

    proptest! {
        #[test]
        fn momentum_balances_and_energy_never_rises(
            angle in 0.0..=std::f64::consts::FRAC_PI_2, k in 0.0..=1.0_f64, mu in 0.0..=2.0_f64,
                h in 0.0..1.2_f64, c in 1.5..3.0_f64,
            x in -15.0..15.0_f64, z in -15.0..15.0_f64, w in -8.0..8.0_f64,
        ) {
            let body = body(h, c);
            let before = moving(angle, (x, z, w));
            prop_assume!(before.corner(&body, c).vertical_velocity_m_s < 0.0);
            let (a, b) = arms_m(&body, angle, c);
            for contact in [Contact::Rough, Contact::Smooth, Contact::Coulomb(mu)] {
                let struck = strike_first_end(&body, &before, contact, k);
                let (after, ix, iz) = (struck.after, struck.horizontal_impulse_n_s,
                    struck.vertical_impulse_n_s);
                // Sums of a few terms of size m v l: 1e-12 of that is a dozen roundings.
                let round_off = 1e-12 * body.mass_kg * 20.0 * body.length_m;
                prop_assert!((body.mass_kg * (after.horizontal_velocity_m_s - x) - ix).abs() < round_off);
                prop_assert!((body.mass_kg * (after.vertical_velocity_m_s - z) - iz).abs() < round_off);
                let spin = body.inertia_kg_m2 * (after.angular_velocity_rad_s - w);
                prop_assert!((spin - (a * iz - b * ix)).abs() < round_off);
                let (e0, e1) = (before.kinetic_energy_j(&body), after.kinetic_energy_j(&body));
                prop_assert!(e1 <= e0 * (1.0 + 1e-12), "{contact}: {e0} {e1}");
                prop_assert!(iz >= 0.0 && after.corner(&body, c).vertical_velocity_m_s >= -1e-11);
                prop_assert!(contact == Contact::Rough || ix.abs() <= coefficient(contact) * iz + round_off);
            }
        }

        #[test]
        fn a_corner_that_does_not_slide_before_rebounds_with_k(
            angle in 0.0..1.57_f64, k in 0.0..1.0_f64, mu in 0.0..2.0_f64, h in 0.0..1.2_f64,
                c in 1.5..3.0_f64,
        ) {
            let body = body(h, c);
            let before = moving(angle, (0.0, -13.3, 0.0));
            for contact in [Contact::Rough, Contact::Smooth, Contact::Coulomb(mu)] {
                let struck = strike_first_end(&body, &before, contact, k);
                let corner = struck.after.corner(&body, c);
                prop_assert!((corner.vertical_velocity_m_s - k * 13.3).abs() < 1e-11);
                prop_assert!(!struck.sticks || corner.horizontal_velocity_m_s.abs() < 1e-11);
                let ratio = struck.horizontal_impulse_n_s / struck.vertical_impulse_n_s;
                prop_assert!(!struck.sticks || (ratio.abs() - struck.friction_to_stick).abs() < 1e-9);
            }
        }

        #[test]
        fn much_friction_is_rough_for_any_motion(
            angle in 0.0..1.57_f64, k in 0.0..1.0_f64, h in 0.0..1.2_f64,
            x in -15.0..15.0_f64, z in -15.0..15.0_f64, w in -8.0..8.0_f64,
        ) {
            let body = body(h, 2.3);
            let before = moving(angle, (x, z, w));
            prop_assume!(before.corner(&body, 2.3).vertical_velocity_m_s < -0.1);
            let struck = strike_first_end(&body, &before, Contact::Rough, k);
            // Where stopping the sliding lifts the corner off, friction proportional to the normal force
            // cannot stop it.
            prop_assume!(struck.vertical_impulse_n_s > 0.1 * body.mass_kg);
            let rough = struck.after;
            let much = strike_first_end(&body, &before, Contact::Coulomb(1e12), k).after;
            // The sliding stops after 1e-12 of what it takes; that moves the work of the rest by 1e-9.
            prop_assert!((rough.vertical_velocity_m_s - much.vertical_velocity_m_s).abs() < 1e-6);
            prop_assert!((rough.angular_velocity_rad_s - much.angular_velocity_rad_s).abs() < 1e-6);
        }
    }

    #[test]
    fn coulomb_friction_joins_smooth_and_rough() {
        let (body, before) = (body(0.0, 2.35), moving(0.26, (0.0, -13.3, 0.0)));
        let with = |contact| strike_first_end(&body, &before, contact, 0.5).after.angular_velocity_rad_s;
        assert!((with(Contact::Coulomb(0.0)) - with(Contact::Smooth)).abs() < 1e-12);
        assert!((with(Contact::Coulomb(2.0)) - with(Contact::Rough)).abs() < 1e-12);
        assert!(with(Contact::Coulomb(0.3)) < with(Contact::Smooth));
        assert!(with(Contact::Coulomb(0.3)) > with(Contact::Rough));
    }
    #[test]
    fn just_after_the_impact_k_is_blind_where_the_literature_says() {
        // The vertical velocity of R just after the impact: k v0 − ω2 l cos φ with (7) has no k at cos² φ =
        // 2/3 rough, 1/3 smooth.
        let rod = crate::predict::thin_rod(1000.0, 4.75);
        for (contact, cos2) in [(Contact::Rough, 2.0_f64 / 3.0), (Contact::Smooth, 1.0 / 3.0)] {
            let before = moving(cos2.sqrt().acos(), (0.0, -13.3, 0.0));
            let [slow, fast] = [0.2, 0.8].map(|k| {
                strike_first_end(&rod, &before, contact, k)
                    .after
                    .corner(&rod, -4.75 / 2.0)
                    .vertical_velocity_m_s
            });
            assert!((slow - fast).abs() < 1e-10, "{contact}: {slow} {fast}");
        }
    }
}
