//! Tabulates the numbers of both impacts for test reports, each with its interval.

use super::flight_search;
use super::second_impact::{Course, SecondImpact};
use crate::data::{
    Axis, BENDING_WAVE_M_S, CaskFile, ChannelPeak, ChannelPulse, CheckKind, DropFinding, DropResult, End,
    Estimate, Events, FilteredPeak, Finding, FlightFit, ForceOverCrush, ImpactNumbers, ImpactTable, MISSED_U,
    Mode, PulseLength, Quantities, RigidBodyDeceleration, STANDARD_GRAVITY_M_S2, Signal, transverse,
};
use crate::fit::{COVERAGE, Inputs, SelectedMethod};
use crate::motion::{self, ContactCourse, FirstTouch, ForceCourse, Integrated, largest};
use std::f64::consts::TAU;

/// Standard uncertainty of the numbers that depend on the course of the force: these shares of their changes
/// with other courses, and of themselves for ringing as large as the velocity gained. The intervals of 200
/// simulated drops then hold what docs/uncertainty.md states.
const U_OTHER_COURSES: [(ForceCourse, f64); 2] =
    [(ForceCourse::Translation, 0.25), (ForceCourse::HalfSine, 0.35)];
const U_RINGING_SHARE: f64 = 0.07;
/// Standard uncertainty of the crush from the corner that bends with the cask, as a share of its swing after
/// the contact, and its limit as a share of the crush: the crush of both ends is then held in nine of ten
/// simulated drops of elastic bodies, and without it in four of five.
const U_BENDING_SHARE: f64 = 0.7;
const MOST_U_BENDING: f64 = 0.1;
/// Standard uncertainty of the second crush from the bending of the cask under the force that stops R, as a
/// share of the deceleration of R over the square of the first angular frequency: the crush of 94 drawn
/// elastic bodies exceeds the true one by 0.2 to 0.6 of it in the mean.
const U_BENT_SHARE: f64 = 0.4;

/// Possible range of the restitution: no end rebounds faster than it struck, nor is drawn in.
const RESTITUTION_RANGE: std::ops::RangeInclusive<f64> = -0.1..=1.1;
/// The same range for a corner that stands still as recorded: with the inputs that the fit takes it may still
/// sink with 4 % of its energy.
const STANDSTILL_RANGE: std::ops::RangeInclusive<f64> = -0.2..=1.1;
/// Number of points of the curve of force over crush.
const CURVE_POINTS: usize = 40;

/// Tables of both impacts, as far as the motion determines them.
pub(super) struct ImpactTables {
    /// First impact, and second if it is determined; times and channels are added later.
    pub tables: [Option<ImpactTable>; 2],
    /// Time at which R leaves, s.
    left_s: Option<f64>,
    /// First touch of the first contact, if that may be two touches.
    touch: Option<FirstTouch>,
}

impl ImpactTables {
    /// Removes the numbers that depend on the course of the force: with the channels of one end alone,
    /// nothing shows how the cask bends while the contact lasts. In the fixture ANF-18 without its A2 the
    /// crush would be off by 1.5 half-widths.
    pub fn without_course(mut self) -> Self {
        for table in self.tables.iter_mut().flatten() {
            let deceleration = &mut table.rigid_body_deceleration;
            (deceleration.at_cog, deceleration.at_struck_end) = (None, None);
            deceleration.at_cog_unfiltered = None;
            for number in table.numbers.course_numbers() {
                *number = None;
            }
            deceleration.others.clear();
            table.force_over_crush = ForceOverCrush::default();
        }
        self
    }

    /// Reports a force of the first contact that falls between two maxima as if L touched twice.
    pub fn judge_two_maxima(&self) -> Option<Finding> {
        let FirstTouch { dip, k, .. } = *self.touch.as_ref()?;
        Some(DropFinding::TwoMaxima { dip, k }.into())
    }

    /// Widens the intervals of the numbers that the contact's end defines, to include the end of its first
    /// touch.
    pub fn widen_end(&self, quantities: &mut Quantities) {
        let Some(FirstTouch { earlier_s, k_moves, .. }) = self.touch else { return };
        let Quantities { duration, flight_time, k, .. } = quantities;
        for time in [Some(duration), flight_time.as_mut()].into_iter().flatten() {
            time.u95 = time.u95.hypot(earlier_s);
        }
        k.u95 = k.u95.hypot(k_moves);
    }

    /// Reports a second impact whose whole effect the motion does not determine.
    pub fn judge_undetermined(&self, recorded: &[Signal], events: &Events) -> Option<Finding> {
        let second = self.tables[1].as_ref();
        let is_whole = second.is_some_and(|table| table.numbers.restitution.is_some());
        let struck_s = events.slap_down_s().filter(|_| !is_whole)?;
        let is_open = second.is_some();
        let recorded_s = flight_search::record_end_s(recorded) - struck_s;
        Some(DropFinding::SecondUndetermined { recorded_s, is_open }.into())
    }
}

/// Completes the tables of both impacts with the pulse of each channel; numbers of the motion are included if
/// they may be stated.
pub(super) fn complete_tables(
    file: &CaskFile,
    recorded: &[Signal],
    result: &DropResult,
    measured: Option<&ImpactTables>,
) -> [ImpactTable; 2] {
    let (first, second) = (&result.first_impact, &result.slap_down);
    let table = |i: usize| measured.and_then(|m| m.tables[i].clone());
    let stretches_s = stretches_s(&result.events, measured.and_then(|m| m.left_s), file.cask.length_m);
    let fill = |table: Option<ImpactTable>, end: End, start: Option<Estimate>, stretch: Option<[f64; 2]>| {
        let table = table.unwrap_or_else(|| ImpactTable::empty(end));
        let channels = stretch.map_or_else(Vec::new, |s| channel_peaks(file, recorded, s, &table));
        ImpactTable { start, channels, ..table }
    };
    let [first_stretch, second_stretch] = stretches_s;
    let first_table = fill(table(0), End::First, first.time, first_stretch);
    [
        ImpactTable {
            numbers: ImpactNumbers { restitution: result.k, duration: first.duration, ..first_table.numbers },
            ..first_table
        },
        fill(table(1), End::Second, second.time, second_stretch),
    ]
}

/// Ratio of slap-down speed to impact velocity.
pub(super) fn amplification(result: &DropResult) -> Option<Estimate> {
    let (speed, impact) = result.slap_down.speed.zip(result.first_impact.impact_velocity)?;
    let value = speed.value / impact.value;
    let share = (speed.u95 / speed.value).hypot(impact.u95 / impact.value);
    Some(Estimate::new(value, value * share, "1"))
}

/// Returns the low-pass of the peaks: as stated, or the same for every drop of this mass.
fn low_pass(file: &CaskFile) -> (String, f64) {
    let (cutoff_hz, _) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
    (motion::filter_name(file.filter), cutoff_hz)
}

/// Both contacts as functions of the inputs.
struct BothImpacts<'a> {
    file: &'a CaskFile,
    integrated: &'a Integrated<'a>,
    second: Option<&'a SecondImpact<'a>>,
    cutoff_hz: f64,
}

/// Tabulates both impacts, as far as the motion determines them.
pub(super) fn tabulate(
    file: &CaskFile,
    integrated: &Integrated,
    method: &SelectedMethod,
    second: Option<&SecondImpact>,
    u_late_s: [f64; 2],
) -> Option<ImpactTables> {
    let impacts = BothImpacts { file, integrated, second, cutoff_hz: low_pass(file).1 };
    let mut known = impacts.with_uncertainties(method)?;
    let (first, after) = impacts.courses(&method.taken, ForceCourse::Rotation)?;
    for ((own, course), u_s) in known.iter_mut().zip([Some(&first), after.as_ref()]).zip(u_late_s) {
        let struck_m_s = course.map_or(0.0, |course| course.contact.struck_m_s);
        own.crush.1 = own.crush.1.hypot(struck_m_s * u_s);
        own.duration.1 = own.duration.1.hypot(u_s);
    }
    // The rotation came from one contact at R that a passive end can produce.
    let mut turning = method.choice.closures.iter().filter(|c| c.kind == CheckKind::SecondTurning);
    let is_one = turning.all(|closure| closure.miss_in_u.abs() <= MISSED_U);
    let is_open = second.is_some_and(|second| second.is_open);
    let range = if is_open { STANDSTILL_RANGE } else { RESTITUTION_RANGE };
    let is_passive = |n: &&ImpactNumbers<(f64, f64)>| range.contains(&n.restitution.0) && n.duration.0 > 0.0;
    let second_numbers = known.get(1).filter(|_| is_one).filter(is_passive);
    let second_table = after.zip(second_numbers).map(|(course, numbers)| {
        let mut table = impacts.table(End::Second, &course, numbers);
        if is_open {
            // No flight tells what the contact gives in all.
            table.numbers = ImpactNumbers {
                duration: None,
                velocity_change: None,
                impulse_x: None,
                impulse_z: None,
                restitution: None,
                friction: None,
                energy_after: None,
                ..table.numbers
            };
        }
        table
    });
    Some(ImpactTables {
        left_s: second.map(|s| s.left.time_s),
        touch: first.contact.first_touch(method.quantities.k.value, impacts.cutoff_hz, integrated),
        tables: [Some(impacts.table(End::First, &first, known.first()?)), second_table],
    })
}

impl BothImpacts<'_> {
    /// Follows the first contact and the second.
    fn courses(&self, inputs: &Inputs, by: ForceCourse) -> Option<(Course, Option<Course>)> {
        let (motion, states) =
            motion::with_states(self.integrated, &inputs.flight, &inputs.events, &inputs.setup)?;
        let contact = ContactCourse::from_states(&states, &inputs.setup, by)?;
        let mut after = None;
        if let Some(second) = self.second {
            after = Some(second.course(inputs, &motion, by)?);
        }
        Some((Course { motion, contact }, after))
    }

    /// Numbers of the first contact, then those of the second.
    fn numbers(&self, inputs: &Inputs, by: ForceCourse) -> Option<Vec<ImpactNumbers<f64>>> {
        let cask = &self.file.cask;
        let inertia_m2 = inputs.inertia_m2.unwrap_or(cask.inertia_kg_m2 / cask.mass_kg);
        let (first, second) = self.courses(inputs, by)?;
        let [before_m2_s2, _] = first.contact.kinetic_m2_s2(inertia_m2);
        let numbers = |course: &Course| {
            let read = read_numbers(course, inertia_m2, inputs.setup.gravity_m_s2, self.cutoff_hz);
            ImpactNumbers {
                energy_ratio: read.energy_before / before_m2_s2,
                absorbed_ratio: read.energy_absorbed / before_m2_s2,
                ..read
            }
        };
        let mut all: Vec<_> = [Some(&first), second.as_ref()].into_iter().flatten().map(numbers).collect();
        if let (Some(own), Some(course)) = (all.get_mut(1), &second)
            && self.second.is_some_and(|second| second.is_open)
        {
            own.energy_absorbed = course.contact.work_to_greatest_crush_m2_s2();
            own.absorbed_ratio = own.energy_absorbed / before_m2_s2;
        }
        Some(all)
    }

    /// Numbers with their standard uncertainties, including other possible courses of the force.
    fn with_uncertainties(&self, method: &SelectedMethod) -> Option<Vec<ImpactNumbers<(f64, f64)>>> {
        let flat = |inputs: &Inputs| {
            let numbers = self.numbers(inputs, ForceCourse::Rotation)?;
            Some(numbers.into_iter().flat_map(ImpactNumbers::into_array).collect())
        };
        let spread = method.propagate_numbers(&flat)?;
        let by_name = |contact: &[(f64, f64)]| ImpactNumbers::from_fn(|i| contact[i]);
        let mut known: Vec<_> = spread.chunks_exact(ImpactNumbers::COUNT).map(by_name).collect();
        let left_ringing = |flight: &FlightFit, own: &ImpactNumbers<(f64, f64)>| {
            let share =
                |size: fn(&Mode) -> f64| flight.modes.iter().map(size).sum::<f64>() / own.velocity_change.0;
            (share(|m| m.amplitude_m_s), share(|m| m.amplitude_m_s / (TAU * m.frequency_hz)))
        };
        let first_ringing = left_ringing(&method.taken.flight, known.first()?);
        for (i, own) in known.iter_mut().enumerate() {
            // If no flight follows R's impact, its ringing is assumed to be like that of the first.
            let second = self.second.filter(|second| i == 1 && !second.is_open);
            let (share, bends_s) = second.map_or(first_ringing, |second| left_ringing(&second.flight, own));
            for (value, u) in own.course_numbers() {
                *u = u.hypot(U_RINGING_SHARE * share * *value);
            }
            let bends_m = U_BENDING_SHARE * bends_s * own.velocity_change.0;
            let modes_rad_s = method.taken.flight.modes.iter().map(|m| TAU * m.frequency_hz);
            let bent_m = own.at_struck_end.0 / modes_rad_s.fold(f64::INFINITY, f64::min).powi(2);
            // In a contact shorter than the mode the cask bends at most as far as its corner is crushed.
            let u_bent_m = if i == 1 { U_BENT_SHARE * bent_m.min(own.crush.0) } else { 0.0 };
            own.crush.1 = own.crush.1.hypot(bends_m.min(MOST_U_BENDING * own.crush.0)).hypot(u_bent_m);
        }
        for (by, share) in U_OTHER_COURSES {
            let others = self.numbers(&method.taken, by)?;
            for (own, mut other) in known.iter_mut().zip(others) {
                for ((value, u), other) in own.course_numbers().into_iter().zip(other.course_numbers()) {
                    *u = u.hypot(share * (*other - *value));
                }
            }
        }
        Some(known)
    }

    fn table(&self, end: End, course: &Course, known: &ImpactNumbers<(f64, f64)>) -> ImpactTable {
        let mass_kg = self.file.cask.mass_kg;
        let mut numbers = known.zip(ImpactNumbers::UNITS).map(|((value, u), unit)| {
            let factor = if matches!(unit, "N s" | "J" | "N") { mass_kg } else { 1.0 };
            Some(Estimate::new(factor * value, COVERAGE * factor * u, unit))
        });
        // The mirror reverses components along the target.
        for along in [&mut numbers.impulse_x, &mut numbers.friction].into_iter().flatten() {
            along.value *= if end == End::First { 1.0 } else { -1.0 };
        }
        ImpactTable {
            numbers,
            rigid_body_deceleration: decelerations(self.file, course, [known.at_cog, known.at_struck_end]),
            force_over_crush: force_over_crush(&course.contact, mass_kg, self.cutoff_hz),
            ..ImpactTable::empty(end)
        }
    }
}

/// Numbers of one contact, divided by the mass if they are proportional to it; the ratios also need the first
/// contact, and are 0 here.
fn read_numbers(course: &Course, inertia_m2: f64, gravity_m_s2: f64, cutoff_hz: f64) -> ImpactNumbers<f64> {
    let Course { motion, contact } = course;
    let [impulse_x, impulse_z] = contact.impulse_m_s;
    let [energy_before, energy_after] = contact.kinetic_m2_s2(inertia_m2);
    let [begin, end] = &contact.ends;
    let courses = [&contact.up_m_s2[..], &contact.at_cog_m_s2, &contact.at_end_m_s2];
    let [force_peak, at_cog, at_struck_end] =
        contact.low_pass(courses, cutoff_hz).map(|course| largest(&course));
    ImpactNumbers {
        duration: end.time_s - begin.time_s,
        velocity_change: motion.rebound_m_s - contact.struck_m_s,
        impulse_x,
        impulse_z,
        restitution: -motion.rebound_m_s / contact.struck_m_s,
        friction: impulse_x / impulse_z,
        energy_before,
        energy_absorbed: energy_before - energy_after + gravity_m_s2 * (begin.height_m - end.height_m),
        energy_after,
        energy_ratio: 0.0,
        absorbed_ratio: 0.0,
        crush: largest(&contact.crush_m),
        force_peak,
        at_cog,
        at_struck_end,
    }
}

/// Decelerations after this cask's low-pass, each with its u, and after the other usual ones, with the same
/// relative uncertainty.
fn decelerations(file: &CaskFile, course: &Course, taken: [(f64, f64); 2]) -> RigidBodyDeceleration {
    let contact = &course.contact;
    let through = |(filter, cutoff_hz): (String, f64)| {
        let low_passed = contact.low_pass([&contact.at_cog_m_s2, &contact.at_end_m_s2], cutoff_hz);
        let deceleration = |i: usize| {
            let (value, (taken, u)) = (largest(&low_passed[i]), taken[i]);
            Some(Estimate::new(value, COVERAGE * u * value / taken, "m/s^2"))
        };
        RigidBodyDeceleration {
            filter,
            cutoff_hz,
            at_cog: deceleration(0),
            at_struck_end: deceleration(1),
            at_cog_unfiltered: Some(largest(&contact.at_cog_m_s2)),
            others: Vec::new(),
        }
    };
    let others = motion::usual_filters(file.cask.mass_kg).into_iter().map(through).collect();
    RigidBodyDeceleration { others, ..through(low_pass(file)) }
}

/// Effect of the usual low-passes, and of none, on the first end's first impact; empty if its transverse
/// channel or its first contact is missing.
pub(super) fn filter_table(file: &CaskFile, recorded: &[Signal], result: &DropResult) -> Vec<FilteredPeak> {
    let [stretch_s, _] = stretches_s(&result.events, None, file.cask.length_m);
    let Some((between_s, struck)) = stretch_s.zip(transverse(recorded, End::First)) else {
        return Vec::new();
    };
    let own = &result.impacts[0].rigid_body_deceleration;
    let in_g = |m_s2: f64| m_s2 / STANDARD_GRAVITY_M_S2;
    let through = |(name, cutoff_hz): (String, f64)| {
        let pulse = motion::pulses(std::slice::from_ref(struck), between_s, cutoff_hz).pop().flatten();
        let through = own.others.iter().find(|other| other.filter == name).and_then(|other| other.at_cog);
        let is_filtered = cutoff_hz.is_finite();
        let at_cog = if is_filtered { through.map(|e| e.value) } else { own.at_cog_unfiltered };
        FilteredPeak {
            cutoff_hz: is_filtered.then_some(cutoff_hz),
            peak_g: pulse.map(|p| in_g(p.filtered)),
            deceleration_g: at_cog.map(in_g),
            duration_s: pulse.and_then(|p| Some(p.length?.length_s)),
            name,
        }
    };
    let unfiltered = [("unfiltered".to_owned(), f64::INFINITY)];
    motion::usual_filters(file.cask.mass_kg).into_iter().chain(unfiltered).map(through).collect()
}

fn force_over_crush(contact: &ContactCourse, mass_kg: f64, cutoff_hz: f64) -> ForceOverCrush {
    let [force_m_s2] = contact.low_pass([&contact.up_m_s2], cutoff_hz);
    let step = (force_m_s2.len() / CURVE_POINTS).max(1);
    ForceOverCrush {
        crush_m: contact.crush_m.iter().copied().step_by(step).collect(),
        force_n: force_m_s2.iter().map(|f| mass_kg * f).step_by(step).collect(),
    }
}

/// Pulse of each channel between two times, s, after this cask's low-pass; `table` holds the other numbers of
/// that impact.
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
        of_axis.filter_map(|(_, pulse)| Some((*pulse)?.raw.abs())).fold(0.0, f64::max)
    };
    let [transverse_m_s2, read_m_s2] = [Axis::Transverse, Axis::Axial].map(largest_m_s2);
    // The axial acceleration is the measured one, else that of S from force and friction, else at most the
    // transverse one times tan φ0 plus a friction of 1.
    let (sin, cos) = file.drop.angle_rad.sin_cos();
    let by_force = table.numbers.force_peak.zip(table.numbers.friction).map(|(force, friction)| {
        force.value / file.cask.mass_kg * (sin + (friction.value.abs() + friction.u95).min(1.0) * cos)
    });
    let axial_m_s2 = if read_m_s2 > 0.0 {
        read_m_s2
    } else {
        by_force.unwrap_or(transverse_m_s2 * (sin + cos) / cos.max(GRAZING_COS))
    };
    let channel_peak = |(signal, pulse): (&Signal, &Option<ChannelPulse>)| {
        let calibration = file.scale_half_width(&signal.name);
        let aside_m_s2 = match signal.axis {
            Axis::Transverse => axial_m_s2,
            Axis::Axial => transverse_m_s2,
        };
        let crossed_m_s2 = file.tolerances.cross_axis * aside_m_s2;
        // A low-pass passes white noise in proportion to its share of the band.
        let left = (2.0 * cutoff_hz / signal.sample_rate_hz).min(1.0).sqrt();
        let noise = |left: f64| COVERAGE * left * signal.noise_m_s2.hypot(signal.u_offset_m_s2);
        let peak = |value: f64, left: f64| {
            Estimate::new(value, (calibration * value).hypot(crossed_m_s2).hypot(noise(left)), "m/s^2")
        };
        let length = |pulse: ChannelPulse| {
            let PulseLength { length_s, by_level } = pulse.length?;
            let level_m_s2 = (0.1 * crossed_m_s2).hypot(noise(left));
            Some(Estimate::new(length_s, (2.0 * pulse.sample_s).hypot(by_level * level_m_s2), "s"))
        };
        ChannelPeak {
            name: signal.name.clone(),
            filter: filter.clone(),
            cutoff_hz,
            peak_raw: pulse.map(|p| peak(p.raw, 1.0)),
            peak_filtered: pulse.map(|p| peak(p.filtered, left)),
            is_above_raw: pulse.is_some_and(|p| p.filtered.abs() > p.raw.abs()),
            time: pulse.map(|p| Estimate::new(p.time_s, p.sample_s, "s")),
            pulse_length: pulse.and_then(length),
            pulse: *pulse,
        }
    };
    recorded.iter().zip(&pulses).map(channel_peak).collect()
}

/// Interval of each impact in which its pulses are searched, s; it includes the way of a bending wave to the
/// other end.
pub(super) fn stretches_s(
    events: &Events,
    second_left_s: Option<f64>,
    length_m: f64,
) -> [Option<[f64; 2]>; 2] {
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

/// Smallest cos φ0 with which a transverse force determines the axial one.
const GRAZING_COS: f64 = 0.1;

/// Longest search for a pulse if nothing shows when the end leaves, s.
const LONGEST_S: f64 = 0.025;
