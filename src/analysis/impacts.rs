//! The motion over both contacts to what test reports tabulate of them, each number with its interval.

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

/// Standard uncertainty of the numbers that follow the course of the force: so much of what other courses
/// make of them, and of themselves for ringing as large as the velocity gained. With it the intervals of 200
/// simulated drops hold what docs/uncertainty.md says.
const OTHER_COURSES: [(ForceCourse, f64); 2] =
    [(ForceCourse::Translation, 0.25), (ForceCourse::HalfSine, 0.35)];
const RINGING_SHARE: f64 = 0.07;
/// Standard uncertainty of the crush from the corner that bends with the cask, as a share of how far it
/// swings behind the contact, and at most as a share of itself: so the crush of both ends is held in nine of
/// ten simulated drops of elastic bodies, and without it in four of five.
const BENDS_SHARE: f64 = 0.7;
const MOST_BENDS: f64 = 0.1;
/// The force that stops R bends the cask while it lasts, by about the deceleration of R over the square of
/// its first angular frequency: standard uncertainty of the second crush as a share of this. The rotation's
/// course exceeds the crush of 94 drawn elastic bodies by 0.2 to 0.6 of it in the mean.
const STANDS_BENT: f64 = 0.4;

/// No end is thrown back faster than it came, nor drawn in.
const RESTITUTION_RANGE: std::ops::RangeInclusive<f64> = -0.1..=1.1;
/// A corner that stands still as recorded sinks at most so fast with the inputs that the fit takes: 4 % of its
/// energy is left.
const STANDING_RANGE: std::ops::RangeInclusive<f64> = -0.2..=1.1;
/// Points of the curve of force over crush.
const CURVE_POINTS: usize = 40;

/// What is tabulated of the motion.
pub(super) struct Tabulated {
    /// First, second where it is told; times and channels not yet.
    tables: [Option<ImpactTable>; 2],
    /// When R leaves, s.
    left_s: Option<f64>,
    /// What the first contact begins with, where it may be two touches.
    touch: Option<FirstTouch>,
}

impl Tabulated {
    /// Without what follows the course of the force: with the channels of one end alone, nothing tells how
    /// the cask bends while the contact lasts. Of the fixture ANF-18 without its A2 the crush would be off by
    /// 1.5 half-widths.
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

    /// True if the second impact is stated, in all or up to its greatest crush.
    pub fn has_second(&self) -> bool {
        self.tables[1].is_some()
    }

    /// The finding where the force of the first contact falls between two maxima as if L touched twice.
    pub fn two_maxima(&self) -> Option<Finding> {
        let FirstTouch { dip, k, .. } = *self.touch.as_ref()?;
        Some(DropFinding::TwoMaxima { dip, k }.into())
    }

    /// Lets the intervals of what the contact's end defines reach back to the end of its first touch.
    pub fn doubt_end(&self, quantities: &mut Quantities) {
        let Some(FirstTouch { earlier_s, k_moves, .. }) = self.touch else { return };
        let Quantities { duration, flight_time, k, .. } = quantities;
        for time in [Some(duration), flight_time.as_mut()].into_iter().flatten() {
            time.u95 = time.u95.hypot(earlier_s);
        }
        k.u95 = k.u95.hypot(k_moves);
    }

    /// The finding where the motion does not determine what the second impact gives in all, though there is
    /// one.
    pub fn untold(&self, recorded: &[Signal], events: &Events) -> Option<Finding> {
        let second = self.tables[1].as_ref();
        let is_whole = second.is_some_and(|table| table.numbers.restitution.is_some());
        let struck_s = events.slap_down_s().filter(|_| !is_whole)?;
        let is_open = second.is_some();
        let recorded_s = flight_search::record_end_s(recorded) - struck_s;
        Some(DropFinding::SecondUndetermined { recorded_s, is_open }.into())
    }
}

/// Both impacts, with what each channel reads of them; the motion's part where it may be stated, beside the
/// quantities stated already.
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
        let table = table.unwrap_or_else(|| ImpactTable::empty(end));
        let channels = stretch.map_or_else(Vec::new, |s| channel_peaks(file, recorded, s, &table));
        ImpactTable { start, channels, ..table }
    };
    let [of_first, of_second] = stretches_s;
    let table = with(told(0), End::First, first.time, of_first);
    [
        ImpactTable {
            numbers: ImpactNumbers { restitution: result.k, duration: first.duration, ..table.numbers },
            ..table
        },
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
    let (cutoff_hz, _) = motion::cutoff_hz(file.filter, file.cask.mass_kg);
    (motion::filter_name(file.filter), cutoff_hz)
}

/// Both contacts as a function of the inputs.
struct BothImpacts<'a> {
    file: &'a CaskFile,
    integrated: &'a Integrated<'a>,
    second: Option<&'a SecondImpact<'a>>,
    cutoff_hz: f64,
}

/// Both impacts, as far as the motion tells them.
pub(super) fn tabulated(
    file: &CaskFile,
    integrated: &Integrated,
    taken: &SelectedMethod,
    second: Option<&SecondImpact>,
    u_late_s: [f64; 2],
) -> Option<Tabulated> {
    let both = BothImpacts { file, integrated, second, cutoff_hz: low_pass(file).1 };
    let mut known = both.known(taken)?;
    let (first, after) = both.courses(&taken.taken, ForceCourse::Rotation)?;
    for ((own, course), u_s) in known.iter_mut().zip([Some(&first), after.as_ref()]).zip(u_late_s) {
        let struck_m_s = course.map_or(0.0, |course| course.contact.struck_m_s);
        own.crush.1 = own.crush.1.hypot(struck_m_s * u_s);
        own.duration.1 = own.duration.1.hypot(u_s);
    }
    // What turned the cask was one contact at R that a passive end can give.
    let mut turning = taken.choice.closures.iter().filter(|c| c.kind == CheckKind::SecondTurning);
    let is_one = turning.all(|closure| closure.miss_in_u.abs() <= MISSED_U);
    let is_open = second.is_some_and(|second| second.is_open);
    let range = if is_open { STANDING_RANGE } else { RESTITUTION_RANGE };
    let is_passive = |numbers: &&ImpactNumbers<(f64, f64)>| {
        range.contains(&numbers.restitution.0) && numbers.duration.0 > 0.0
    };
    let of_second = known.get(1).filter(|_| is_one).filter(is_passive);
    let of_second = after.zip(of_second).map(|(course, numbers)| {
        let table = both.table(End::Second, &course, numbers);
        if is_open { up_to_crush(table) } else { table }
    });
    Some(Tabulated {
        left_s: second.map(|s| s.left.time_s),
        touch: first.contact.first_touch(taken.quantities.k.value, both.cutoff_hz, integrated),
        tables: [Some(both.table(End::First, &first, known.first()?)), of_second],
    })
}

/// Without what the contact gives in all, where no flight after it tells that.
fn up_to_crush(mut table: ImpactTable) -> ImpactTable {
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
    table
}

impl BothImpacts<'_> {
    /// The first contact and the second.
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

    /// The numbers of the first contact, then those of the second.
    fn numbers(&self, inputs: &Inputs, by: ForceCourse) -> Option<Vec<ImpactNumbers<f64>>> {
        let cask = &self.file.cask;
        let inertia_m2 = inputs.inertia_m2.unwrap_or(cask.inertia_kg_m2 / cask.mass_kg);
        let (first, second) = self.courses(inputs, by)?;
        let [before_m2_s2, _] = first.contact.kinetic_m2_s2(inertia_m2);
        let numbers = |course: &Course| {
            let read = read_off(course, inertia_m2, inputs.setup.gravity_m_s2, self.cutoff_hz);
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

    /// These with their standard uncertainties: what else could have told the course of the force says how
    /// well that is known.
    fn known(&self, taken: &SelectedMethod) -> Option<Vec<ImpactNumbers<(f64, f64)>>> {
        let flat = |inputs: &Inputs| {
            let numbers = self.numbers(inputs, ForceCourse::Rotation)?;
            Some(numbers.into_iter().flat_map(ImpactNumbers::into_array).collect())
        };
        let spread = taken.propagate_numbers(&flat)?;
        let by_name = |contact: &[(f64, f64)]| ImpactNumbers::from_fn(|i| contact[i]);
        let mut known: Vec<_> = spread.chunks_exact(ImpactNumbers::COUNT).map(by_name).collect();
        let left_ringing = |flight: &FlightFit, own: &ImpactNumbers<(f64, f64)>| {
            let share =
                |size: fn(&Mode) -> f64| flight.modes.iter().map(size).sum::<f64>() / own.velocity_change.0;
            (share(|m| m.amplitude_m_s), share(|m| m.amplitude_m_s / (TAU * m.frequency_hz)))
        };
        let by_first = left_ringing(&taken.taken.flight, known.first()?);
        for (i, own) in known.iter_mut().enumerate() {
            // Where no flight follows R's impact, that leaves of its own what the first one does.
            let told = self.second.filter(|second| i == 1 && !second.is_open);
            let (share, bends_s) = told.map_or(by_first, |second| left_ringing(&second.flight, own));
            for (value, u) in own.course_numbers() {
                *u = u.hypot(RINGING_SHARE * share * *value);
            }
            let bends_m = BENDS_SHARE * bends_s * own.velocity_change.0;
            own.crush.1 = own.crush.1.hypot(bends_m.min(MOST_BENDS * own.crush.0));
            let slowest = taken.taken.flight.modes.iter().map(|m| TAU * m.frequency_hz).reduce(f64::min);
            if let Some(slowest_rad_s) = slowest.filter(|_| i == 1) {
                let stands_bent_m = own.at_struck_end.0 / slowest_rad_s.powi(2);
                own.crush.1 = own.crush.1.hypot(STANDS_BENT * stands_bent_m);
            }
        }
        for (by, share) in OTHER_COURSES {
            let others = self.numbers(&taken.taken, by)?;
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
        // The mirror turns round what runs along the target.
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

/// The numbers of one contact, all over the mass where it belongs to them; the ratios need the first contact
/// too, and are 0 here.
fn read_off(course: &Course, inertia_m2: f64, gravity_m_s2: f64, cutoff_hz: f64) -> ImpactNumbers<f64> {
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

/// The decelerations through the low-pass of this cask, each with its u, and beside them through the usual
/// others, known as well.
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

/// What the usual low-passes, and none, make of the first end's first impact; empty where its transverse
/// channel or its first contact is missing.
pub(super) fn filters(file: &CaskFile, recorded: &[Signal], result: &DropResult) -> Vec<FilteredPeak> {
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

/// The pulse of each channel between two times, s, through the low-pass of this cask; `table` has the rest of
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
    // Along the axis: what is read there, else that of S by the force and the friction, else at most the same
    // times tan φ0 and a friction of 1.
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
        // A low-pass leaves of white noise what its share of the band is.
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

/// The stretch of each impact in which its pulses are sought, s: a bending wave takes its time to the other
/// end.
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

/// Beyond this inclination nothing is said of the axial force by a transverse one: cos φ0.
const GRAZING_COS: f64 = 0.1;

/// Where nothing tells when an end leaves, its pulse is sought for so long, s.
const LONGEST_S: f64 = 0.025;
