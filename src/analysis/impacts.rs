//! The motion over both contacts to what test reports tabulate of them, each number with its interval.

use super::second::SecondImpact;
use super::settle;
use crate::data::{
    Axis, BENDING_WAVE_M_S, CaskFile, ChannelPeak, DropFinding, DropResult, End, Estimate, Events, Finding,
    ForceOverCrush, ImpactTable, Motion, RigidBodyDeceleration, Signal,
};
use crate::fit::{COVERAGE, Inputs, RungTaken};
use crate::motion::{self, ContactCourse, ForceCourse, Integrated, largest};

/// Numbers of one contact, in this order.
const COUNT: usize = 15;
const DURATION: usize = 0;
const GAINED: usize = 1;
const IMPULSE_X: usize = 2;
const IMPULSE_Z: usize = 3;
const RESTITUTION: usize = 4;
const FRICTION: usize = 5;
const BEFORE: usize = 6;
const AFTER: usize = 7;
const ABSORBED: usize = 8;
const CRUSH: usize = 9;
const FORCE: usize = 10;
const AT_COG: usize = 11;
const AT_END: usize = 12;
const TURNED: usize = 13;
const RATIO: usize = 14;

/// Numbers that follow the course of the force, not only what it gives in all.
const OF_COURSE: [usize; 4] = [CRUSH, FORCE, AT_COG, AT_END];
/// Standard uncertainty of these: so much of what other courses make of them, and of themselves for ringing as large as the velocity gained. With
/// it the intervals of 200 simulated drops hold what docs/uncertainty.md says.
const OTHER_COURSES: [(ForceCourse, f64); 2] =
    [(ForceCourse::Translation, 0.25), (ForceCourse::HalfSine, 0.35)];
const RINGING_SHARE: f64 = 0.07;

/// A rotation that is off the impulse of one contact at R by so many standard uncertainties is that of two, or of none.
const MISSED_U: f64 = 3.5;
/// No end is thrown back faster than it came, nor drawn in.
const RESTITUTION_RANGE: std::ops::RangeInclusive<f64> = -0.1..=1.1;
/// Points of the curve of force over crush.
const CURVE_POINTS: usize = 40;

/// What one contact says of itself.
struct Course {
    motion: Motion,
    contact: ContactCourse,
}

/// What is tabulated of the motion.
pub(super) struct Tabulated {
    /// First, second where it is told; times and channels not yet.
    tables: [Option<ImpactTable>; 2],
    /// When R leaves, s.
    left_s: Option<f64>,
}

impl Tabulated {
    /// Without what follows the course of the force: with the channels of one end alone, nothing tells how the cask bends while the contact
    /// lasts. Of the fixture ANF-18 without its A2 the crush would be off by 1.5 half-widths.
    pub fn without_course(mut self) -> Self {
        for table in self.tables.iter_mut().flatten() {
            let deceleration = &mut table.rigid_body_deceleration;
            (table.crush, table.force_peak, deceleration.at_cog, deceleration.at_struck_end) =
                (None, None, None, None);
            deceleration.others.clear();
            table.force_over_crush = ForceOverCrush::default();
        }
        self
    }

    /// The finding where the motion tells the first impact alone, though there is another.
    pub fn untold(&self, recorded: &[Signal], events: &Events) -> Option<Finding> {
        let struck_s = events.slap_down_s().filter(|_| self.tables[1].is_none())?;
        Some(DropFinding::SecondUntold { recorded_s: settle::record_end_s(recorded) - struck_s }.into())
    }
}

/// Both impacts, with what each channel reads of them; the motion's part where it may be stated, beside the quantities stated already.
pub(super) fn of_result(
    file: &CaskFile,
    recorded: &[Signal],
    result: &DropResult,
    measured: Option<&Tabulated>,
) -> [ImpactTable; 2] {
    let (first, second) = (&result.first_impact, &result.slap_down);
    let told = |i: usize| measured.and_then(|m| m.tables[i].clone());
    let stretches_s = stretches_s(&result.events, measured.and_then(|m| m.left_s), file.cask.length_m);
    let with = |table: Option<ImpactTable>, end: End, start: Option<Estimate>, stretch: Option<[f64; 2]>| {
        let table = table.unwrap_or_else(|| ImpactTable::unknown(end));
        let channels = stretch.map_or_else(Vec::new, |s| channel_peaks(file, recorded, s, &table));
        ImpactTable { start, channels, ..table }
    };
    let [of_first, of_second] = stretches_s;
    let table = with(told(0), End::First, first.time, of_first);
    [
        ImpactTable { restitution: result.k, duration: first.duration, ..table },
        with(told(1), End::Second, second.time, of_second),
    ]
}

/// Slap-down speed over impact velocity.
pub(super) fn amplification(result: &DropResult) -> Option<Estimate> {
    let (speed, impact) = result.slap_down.speed.zip(result.first_impact.impact_velocity)?;
    let value = speed.value / impact.value;
    let share = (speed.u95 / speed.value).hypot(impact.u95 / impact.value);
    Some(Estimate::new(value, value * share, "1"))
}

/// The low-pass of the peaks: as stated, or the same for every drop of this mass.
fn low_pass(file: &CaskFile) -> (String, f64) {
    let (cutoff_hz, _) = motion::cutoff_hz(file.filter, file.cask.mass_kg, None);
    (motion::filter_name(file.filter), cutoff_hz)
}

/// Both contacts as a function of the inputs.
struct BothImpacts<'a> {
    file: &'a CaskFile,
    integrated: &'a Integrated<'a>,
    second: Option<&'a SecondImpact>,
    cutoff_hz: f64,
}

/// Both impacts, as far as the motion tells them.
pub(super) fn tabulated(
    file: &CaskFile,
    integrated: &Integrated,
    taken: &RungTaken,
    second: Option<&SecondImpact>,
) -> Option<Tabulated> {
    let both = BothImpacts { file, integrated, second, cutoff_hz: low_pass(file).1 };
    let known = both.known(taken)?;
    let (first, after) = both.courses(&taken.taken, &both.unmoved(), ForceCourse::Rotation)?;
    let of_second = known.get(COUNT + 1..).filter(|numbers| is_one_contact(numbers));
    Some(Tabulated {
        left_s: second.map(|s| s.left.time_s),
        tables: [
            Some(both.table(End::First, &first, &known[..=COUNT])),
            after.zip(of_second).map(|(course, numbers)| both.table(End::Second, &course, numbers)),
        ],
    })
}

impl BothImpacts<'_> {
    /// The second impact's own inputs as they are.
    fn unmoved(&self) -> Vec<f64> {
        vec![0.0; self.second.map_or(0, SecondImpact::further)]
    }

    /// Θ/m, m².
    fn inertia_m2(&self, inputs: &Inputs) -> f64 {
        let cask = &self.file.cask;
        inputs.inertia_m2.unwrap_or(cask.inertia_kg_m2 / cask.mass_kg)
    }

    /// The first contact and the second.
    fn courses(&self, inputs: &Inputs, by_u: &[f64], by: ForceCourse) -> Option<(Course, Option<Course>)> {
        let inertia_m2 = self.inertia_m2(inputs);
        let (motion, states) =
            motion::with_states(self.integrated, &inputs.flight, &inputs.events, &inputs.setup)?;
        let contact = ContactCourse::of((&motion, &states), &inputs.setup, inertia_m2, by)?;
        let mut after = None;
        if let Some(second) = self.second {
            let (motion, contact) = second.course((inputs, &motion), by_u, (inertia_m2, by))?;
            after = Some(Course { motion, contact });
        }
        Some((Course { motion, contact }, after))
    }

    /// The numbers of the first contact, then those of the second.
    fn numbers(&self, inputs: &Inputs, by_u: &[f64], by: ForceCourse) -> Option<Vec<f64>> {
        let inertia_m2 = self.inertia_m2(inputs);
        let (first, second) = self.courses(inputs, by_u, by)?;
        let [before_m2_s2, _] = first.contact.kinetic_m2_s2(inertia_m2);
        let of = |course: &Course| {
            let mut numbers = read_off(course, inertia_m2, inputs.setup.gravity_m_s2, self.cutoff_hz);
            numbers[RATIO] = numbers[BEFORE] / before_m2_s2;
            numbers.push(numbers[ABSORBED] / before_m2_s2);
            numbers
        };
        Some([of(&first), second.as_ref().map(of).unwrap_or_default()].concat())
    }

    /// These with their standard uncertainties: what else could have told the course of the force says how well that is known.
    fn known(&self, taken: &RungTaken) -> Option<Vec<(f64, f64)>> {
        let unmoved = self.unmoved();
        let of = |inputs: &Inputs, by_u: &[f64]| self.numbers(inputs, by_u, ForceCourse::Rotation);
        let mut known = taken.spread(unmoved.len(), &of)?;
        let flights = [Some(&taken.taken.flight), self.second.map(|second| &second.flight)];
        for (flight, own) in flights.into_iter().flatten().zip(known.chunks_mut(COUNT + 1)) {
            let rings_m_s: f64 = flight.modes.iter().map(|m| m.amplitude_m_s).sum();
            let share = RINGING_SHARE * rings_m_s / own[GAINED].0;
            for i in OF_COURSE {
                own[i].1 = own[i].1.hypot(share * own[i].0);
            }
        }
        for (by, share) in OTHER_COURSES {
            let others = self.numbers(&taken.taken, &unmoved, by)?;
            for (i, (value, u)) in known.iter_mut().enumerate() {
                if OF_COURSE.contains(&(i % (COUNT + 1))) {
                    *u = u.hypot(share * (others[i] - *value));
                }
            }
        }
        Some(known)
    }

    fn table(&self, end: End, course: &Course, numbers: &[(f64, f64)]) -> ImpactTable {
        let mass_kg = self.file.cask.mass_kg;
        let of = |i: usize, factor: f64, unit| {
            let (value, u) = numbers[i];
            Some(Estimate::new(factor * value, COVERAGE * factor.abs() * u, unit))
        };
        // The mirror turns round what runs along the target.
        let along = if end == End::First { 1.0 } else { -1.0 };
        ImpactTable {
            duration: of(DURATION, 1.0, "s"),
            velocity_change: of(GAINED, 1.0, "m/s"),
            impulse_x: of(IMPULSE_X, along * mass_kg, "N s"),
            impulse_z: of(IMPULSE_Z, mass_kg, "N s"),
            restitution: of(RESTITUTION, 1.0, "1"),
            friction: of(FRICTION, along, "1"),
            energy_before: of(BEFORE, mass_kg, "J"),
            energy_absorbed: of(ABSORBED, mass_kg, "J"),
            energy_after: of(AFTER, mass_kg, "J"),
            energy_ratio: of(RATIO, 1.0, "1"),
            absorbed_ratio: of(COUNT, 1.0, "1"),
            crush: of(CRUSH, 1.0, "m"),
            force_peak: of(FORCE, mass_kg, "N"),
            rigid_body_deceleration: decelerations(self.file, course, [AT_COG, AT_END].map(|i| numbers[i])),
            force_over_crush: force_over_crush(&course.contact, mass_kg, self.cutoff_hz),
            ..ImpactTable::unknown(end)
        }
    }
}

/// Whether what turned the cask was one contact at R that a passive end can give.
fn is_one_contact(numbers: &[(f64, f64)]) -> bool {
    numbers.len() > COUNT
        && numbers[TURNED].0.abs() <= MISSED_U * numbers[TURNED].1
        && RESTITUTION_RANGE.contains(&numbers[RESTITUTION].0)
        && numbers[DURATION].0 > 0.0
}

/// The numbers of one contact, all over the mass where it belongs to them.
fn read_off(course: &Course, inertia_m2: f64, gravity_m_s2: f64, cutoff_hz: f64) -> Vec<f64> {
    let Course { motion, contact } = course;
    let [along_m_s, up_m_s] = contact.impulse_m_s;
    let [before, after] = contact.kinetic_m2_s2(inertia_m2);
    let [begin, end] = &contact.ends;
    let courses = [&contact.up_m_s2[..], &contact.at_cog_m_s2, &contact.at_end_m_s2];
    let [force, at_cog, at_end] = contact.low_passed(courses, cutoff_hz).map(|course| largest(&course));
    let mut numbers = vec![0.0; COUNT];
    numbers[DURATION] = end.time_s - begin.time_s;
    numbers[GAINED] = motion.rebound_m_s - contact.struck_m_s;
    numbers[IMPULSE_X] = along_m_s;
    numbers[IMPULSE_Z] = up_m_s;
    numbers[RESTITUTION] = -motion.rebound_m_s / contact.struck_m_s;
    numbers[FRICTION] = along_m_s / up_m_s;
    numbers[BEFORE] = before;
    numbers[AFTER] = after;
    numbers[ABSORBED] = before - after + gravity_m_s2 * (begin.height_m - end.height_m);
    numbers[CRUSH] = largest(&contact.crush_m);
    numbers[FORCE] = force;
    numbers[AT_COG] = at_cog;
    numbers[AT_END] = at_end;
    numbers[TURNED] = contact.turned_beyond_m2_s;
    numbers
}

/// The decelerations through the low-pass of this cask, each with its u, and beside them through the usual others, known as well.
fn decelerations(file: &CaskFile, course: &Course, taken: [(f64, f64); 2]) -> RigidBodyDeceleration {
    let contact = &course.contact;
    let through = |(filter, cutoff_hz): (String, f64)| {
        let low_passed = contact.low_passed([&contact.at_cog_m_s2, &contact.at_end_m_s2], cutoff_hz);
        let of = |i: usize| {
            let (value, (taken, u)) = (largest(&low_passed[i]), taken[i]);
            Some(Estimate::new(value, COVERAGE * u * value / taken, "m/s^2"))
        };
        RigidBodyDeceleration { filter, cutoff_hz, at_cog: of(0), at_struck_end: of(1), others: Vec::new() }
    };
    let others = motion::usual_filters(file.cask.mass_kg).into_iter().map(through).collect();
    RigidBodyDeceleration { others, ..through(low_pass(file)) }
}

fn force_over_crush(contact: &ContactCourse, mass_kg: f64, cutoff_hz: f64) -> ForceOverCrush {
    let [force_m_s2] = contact.low_passed([&contact.up_m_s2], cutoff_hz);
    let step = (force_m_s2.len() / CURVE_POINTS).max(1);
    ForceOverCrush {
        crush_m: contact.crush_m.iter().copied().step_by(step).collect(),
        force_n: force_m_s2.iter().map(|f| mass_kg * f).step_by(step).collect(),
    }
}

/// The pulse of each channel between two times, s, through the low-pass of this cask; `table` has the rest of that impact.
fn channel_peaks(
    file: &CaskFile,
    recorded: &[Signal],
    between_s: [f64; 2],
    table: &ImpactTable,
) -> Vec<ChannelPeak> {
    let (filter, cutoff_hz) = low_pass(file);
    let pulses = motion::pulses(recorded, between_s, cutoff_hz);
    let largest_m_s2 = |axis: Axis| {
        let of_axis = recorded.iter().zip(&pulses).filter(|(signal, _)| signal.axis == axis);
        of_axis.filter_map(|(_, pulse)| Some((*pulse)?.raw_m_s2.abs())).fold(0.0, f64::max)
    };
    let [transverse_m_s2, read_m_s2] = [Axis::Transverse, Axis::Axial].map(largest_m_s2);
    // Along the axis: what is read there, else that of S by the force and the friction, else at most the same times tan φ0 and a friction of 1.
    let (sin, cos) = file.drop.angle_rad.sin_cos();
    let by_force = table.force_peak.zip(table.friction).map(|(force, friction)| {
        force.value / file.cask.mass_kg * (sin + (friction.value.abs() + friction.u95).min(1.0) * cos)
    });
    let axial_m_s2 = if read_m_s2 > 0.0 {
        read_m_s2
    } else {
        by_force.unwrap_or(transverse_m_s2 * (sin + cos) / cos.max(GRAZING_COS))
    };
    let of = |(signal, pulse): (&Signal, &Option<motion::ChannelPulse>)| {
        let own = file.channels.iter().find(|spec| spec.name == signal.name).and_then(|s| s.calibration);
        let calibration = own.unwrap_or(file.tolerances.calibration);
        let aside_m_s2 = match signal.axis {
            Axis::Transverse => axial_m_s2,
            Axis::Axial => transverse_m_s2,
        };
        let crossed_m_s2 = file.tolerances.cross_axis * aside_m_s2;
        // A low-pass leaves of white noise what its share of the band is.
        let left = (2.0 * cutoff_hz / signal.sample_rate_hz).min(1.0).sqrt();
        let noise = |left: f64| COVERAGE * left * signal.noise_m_s2.hypot(signal.u_offset_m_s2);
        let peak = |value: f64, left: f64| {
            Estimate::new(value, (calibration * value).hypot(crossed_m_s2).hypot(noise(left)), "m/s^2")
        };
        let length = |pulse: motion::ChannelPulse| {
            let motion::PulseLength { length_s, by_level } = pulse.length?;
            let level_m_s2 = (0.1 * crossed_m_s2).hypot(noise(left));
            Some(Estimate::new(length_s, (2.0 * pulse.sample_s).hypot(by_level * level_m_s2), "s"))
        };
        ChannelPeak {
            name: signal.name.clone(),
            filter: filter.clone(),
            cutoff_hz,
            peak_raw: pulse.map(|p| peak(p.raw_m_s2, 1.0)),
            peak_filtered: pulse.map(|p| peak(p.filtered_m_s2, left)),
            is_above_raw: pulse.is_some_and(|p| p.filtered_m_s2.abs() > p.raw_m_s2.abs()),
            time: pulse.map(|p| Estimate::new(p.time_s, p.sample_s, "s")),
            pulse_length: pulse.and_then(length),
        }
    };
    recorded.iter().zip(&pulses).map(of).collect()
}

/// The stretch of each impact in which its pulses are sought, s: a bending wave takes its time to the other end.
fn stretches_s(events: &Events, second_left_s: Option<f64>, length_m: f64) -> [Option<[f64; 2]>; 2] {
    let wave_s = length_m / BENDING_WAVE_M_S;
    let stretch = |from: Option<f64>, to: Option<f64>, most_s: f64| {
        from.map(|from_s| [from_s, to.map_or(from_s + LONGEST_S, |to_s| to_s + wave_s).min(most_s)])
    };
    let struck_s = events.slap_down_s();
    [
        stretch(events.first_contact_s(), events.separation_s(), struck_s.unwrap_or(f64::INFINITY)),
        stretch(struck_s, second_left_s, f64::INFINITY),
    ]
}

/// Beyond this inclination nothing is said of the axial force by a transverse one: cos φ0.
const GRAZING_COS: f64 = 0.1;

/// Where nothing tells when an end leaves, its pulse is sought for so long, s.
const LONGEST_S: f64 = 0.025;
