//! Signals and first contact to separation, slap-down and the flight between them: an iteration, since each
//! needs the others.

use crate::data::{At, CaskFile, End, Events, FlightFit, Motion, Signal};
use crate::motion::{self, Integrated};
use crate::{events, judge};

/// Separation and slap-down are found again on signals free of ringing this often; the second round moves
/// them by less than a sample.
const ROUNDS: usize = 3;
/// The iteration stops when separation and slap-down both move by less than this, s: a fiftieth of the
/// shortest contact.
const STILL_S: f64 = 2e-5;

/// Further rounds where the last one moved the slap-down by more than [`SETTLED_S`]: its flight was fitted
/// over the wrong stretch.
const FURTHER_ROUNDS: usize = 3;
const SETTLED_S: f64 = 1e-3;

/// R cannot strike before this share of its height over v0: rod ends come down with less than 2 v0, angles
/// are known to 40 %.
const EARLIEST_SLAP_DOWN: f64 = 0.3;

/// R strikes with more than this share of v0 where it slaps down at all.
const LEAST_SLAP_DOWN: f64 = 0.08;

/// A pulse that the record ends in has begun with this share of that.
const CUT_SHORT: f64 = 0.25;

/// The first flight fit starts after this share of the time from contact to slap-down, and at the latest
/// after so many s.
const FIRST_CLEARANCE: f64 = 0.4;
const LONGEST_CLEARANCE_S: f64 = 0.022;

/// Most modes of the first fits: those of a cask below 400 Hz; and where they do not explain the flight: a
/// short contact excites more of them.
const FEW_MODES: usize = 3;
const MANY_MODES: usize = 6;

/// Shares of the time to the slap-down first seen at which the first fit ends: strong ringing may make that
/// one late, and a fit that reaches into it explains nothing.
const FIRST_ENDS: [f64; 4] = [1.0, 0.8, 0.65, 0.5];

/// A flight fit that leaves no more than this share of v0 shows the slap-down as what departs from it.
const SHOWN: f64 = 0.05;

/// A flight fit that leaves less than this RMS has explained its channel, m/s: 1.5 % of a 9 m fall.
const EXPLAINED_M_S: f64 = 0.2;

/// The same of a flight too short to tell fits apart, as a share of v0. Three modes bend around a part of the
/// contact too: of 400 simulated drops those with the right separation left 0.6 % at most, the others 1.4 %
/// and more.
const EXPLAINED_SHORT: f64 = 0.0075;

/// R at slap-down this share of the length off the target is where it should be, an angle 1° off included.
const NEAR: f64 = 0.02;

/// A rotation this share off what the impulse of the first impact gives the cask is not the rigid body's.
const TURNED: f64 = 0.1;

/// The contact's force after separation is sought this long beyond a window, s.
const BEYOND_S: f64 = 0.02;

/// A blow on L this soon after separation, as a share of the contact, is the contact's last stage …
const STAGE: f64 = 0.25;
/// … and over so long after its peak, s.
const STAGE_FADES_S: f64 = 1e-3;

/// Touches of L are followed to a slap-down that is known to this, s: to half of what is left out before it.
const STRUCK_U_S: f64 = 5e-4;

/// The search starts this long before first contact, s: half the width of the moving mean by which a
/// slap-down is found.
const BEFORE_S: f64 = 0.05;

/// Where the search ended.
pub struct FoundFlight {
    /// Separation.
    pub separation: At,
    /// How late the sensor that shows it may answer, s.
    pub seat_s: f64,
    /// Where its signal has become calm, s.
    calm_s: f64,
    /// Slap-down, where there is one.
    pub slap_down: Option<At>,
    /// The flight between them, where it could be fitted.
    pub flight: Option<FlightFit>,
    /// What that was fitted over.
    window: Option<motion::Window>,
}

/// What the search goes by.
struct Search<'a> {
    integrated: &'a Integrated<'a>,
    file: &'a CaskFile,
    record_end_s: f64,
    earliest_s: f64,
    least_m_s: f64,
    /// Whether R has to strike, and on the target; else a flight that is explained will do.
    to_target: bool,
}

/// How long a flight is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchEffort {
    /// From one beginning after the other, until one explains it.
    EveryStart,
    /// From the first beginning alone: one of many trials, which the right one passes so.
    FirstStart,
}

/// The signals of both ends, free of ringing as far as it is known.
type Ends = (motion::RingingRemoved, motion::RingingRemoved);

/// What the first round of the search goes by.
#[derive(Clone, Copy)]
struct Beginning {
    /// Of the time to the slap-down first seen, where its fit ends.
    share: f64,
    /// When the impulse has been given, s: its fit begins no sooner.
    given_s: Option<f64>,
    /// Most modes of its fits, and of those after it.
    most_modes: usize,
}

/// What one round of the search hands to the next.
struct Attempt {
    separation: At,
    slap_down: Option<At>,
    /// Where the next fit begins, clear of the contact, s.
    free_s: f64,
    /// Where the flight ends, s.
    end_s: f64,
    /// Most modes of its fit.
    most_modes: usize,
    /// The last fit of the flight, and what it was fitted over.
    fitted: Option<(FlightFit, motion::Window)>,
    /// The other fits over that, the best first.
    others: Vec<FlightFit>,
}

/// Finds separation, slap-down and flight; of several beginnings the first that explains the flight and
/// brings R to the target, else the best. `None` without transverse channels on both ends.
pub fn find(file: &CaskFile, integrated: &Integrated, effort: SearchEffort) -> Option<FoundFlight> {
    let beginnings = if effort == SearchEffort::FirstStart { 1 } else { FIRST_ENDS.len() };
    let mut found = searched(file, integrated, true, beginnings)?;
    if let (Some(flight), Some(window)) = (&mut found.flight, &found.window) {
        motion::compare_late(flight, integrated, window, file.cask.cog_m);
        let early_s = (found.separation.time_s, found.calm_s);
        motion::compare_early(flight, integrated, window, file.cask.cog_m, early_s);
        flight.strike = motion::find_shock(flight, integrated, window, file.cask.cog_m);
        let is_off =
            flight.plateaus.iter().any(|p| p.late_mismatch_m_s.is_some_and(|off_m_s| off_m_s != 0.0));
        let landing = || motion::landing(flight, integrated, window, &file.cask);
        flight.landing = found.slap_down.filter(|at| is_off && at.u_s < STRUCK_U_S).and_then(|_| landing());
        if flight.landing.is_some() {
            // What it changes is known.
            flight.plateaus.iter_mut().for_each(|p| p.late_mismatch_m_s = None);
        }
    }
    Some(found)
}

/// The same where nothing is asked of what comes after the flight.
pub fn find_open(file: &CaskFile, integrated: &Integrated) -> Option<FoundFlight> {
    searched(file, integrated, false, 1)
}

fn searched(
    file: &CaskFile,
    integrated: &Integrated,
    to_target: bool,
    beginnings: usize,
) -> Option<FoundFlight> {
    let &Integrated { ref signals, contact_s, .. } = integrated;
    let drop = &file.drop;
    let descent_m = file.cask.length_m * drop.angle_rad.sin().max(0.0);
    let search = Search {
        integrated,
        file,
        record_end_s: record_end_s(signals),
        earliest_s: contact_s + EARLIEST_SLAP_DOWN * descent_m / drop.impact_velocity_m_s,
        least_m_s: LEAST_SLAP_DOWN * drop.impact_velocity_m_s,
        to_target,
    };
    let from_s = contact_s - BEFORE_S;
    let on = |end| {
        events::without_first_mode(signals, end, from_s, file.cask.length_m).map(motion::RingingRemoved::new)
    };
    let (first, second) = rayon::join(|| on(End::First), || on(End::Second));
    let mut ends = (first?, second?);
    let struck = search.slap_down(&ends.1, search.earliest_s, None);
    let mut best: Option<(f64, FoundFlight)> = None;
    // Where the velocities are cut off no beginning leads to a flight that explains them.
    let before_s = struck.map_or(search.record_end_s, |s| s.time_s);
    let is_hopeless = signals.iter().any(|s| judge::is_cut_off(s, contact_s, before_s));
    // A contact in stages may last beyond the clearance: first where its impulse has been given.
    let given_s = events::impulse_end(ends.0.signal(), contact_s, before_s)
        .filter(|given_s| !is_hopeless && *given_s > cleared_s(contact_s, before_s));
    let shares = FIRST_ENDS.into_iter().take(if is_hopeless { 1 } else { beginnings });
    let given = given_s.map(|given_s| (FIRST_ENDS[0], Some(given_s)));
    for (share, given_s) in given.into_iter().chain(shares.map(|share| (share, None))) {
        let most_modes = if best.is_none() { FEW_MODES } else { MANY_MODES };
        let beginning = Beginning { share, given_s, most_modes };
        let attempt = search.attempt(&mut ends, struck, beginning);
        let cost = search.cost(&attempt);
        let is_settled = cost < 1.0 || attempt.flight.as_ref().is_some_and(is_clearly_explained);
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, attempt));
        }
        if is_settled {
            break;
        }
    }
    best.map(|(_, found)| search.beyond_last_stage(found))
}

/// What a flight leaves of an end's signal in the calmest of its quarters but the first, m/s²: fast modes
/// ring at the beginning, and the end may hold the slap-down's foot.
fn calm_m_s2(second: &motion::RingingRemoved, flight: &FlightFit) -> f64 {
    let quarter_s = (flight.to_s - flight.from_s) / 4.0;
    let quarters_s = [1.0, 2.0, 3.0].map(|n| flight.from_s + n * quarter_s);
    let largest_m_s2 = |from_s: f64| second.largest_m_s2(&(from_s..from_s + quarter_s));
    quarters_s.into_iter().map(largest_m_s2).fold(f64::INFINITY, f64::min)
}

/// Where the first fit begins that ends at `end_s`, if nothing tells a longer contact, s.
fn cleared_s(contact_s: f64, end_s: f64) -> f64 {
    contact_s + (FIRST_CLEARANCE * (end_s - contact_s)).min(LONGEST_CLEARANCE_S)
}

/// What the cask turns by from first contact to separation, rad.
pub fn turned_rad(file: &CaskFile, signals: &[Signal], contact_s: f64) -> Option<f64> {
    let integrated = Integrated::new(signals, contact_s);
    let moved = find(file, &integrated, SearchEffort::EveryStart)?.moved(file, &integrated)?;
    Some(file.drop.angle_rad - moved.separation.angle_rad)
}

/// Where the shortest record ends, s.
pub fn record_end_s(signals: &[Signal]) -> f64 {
    signals.iter().map(Signal::end_s).fold(f64::INFINITY, f64::min)
}

impl FoundFlight {
    /// The motion that the signals, the times and the flight give where L sticks.
    pub fn moved(&self, file: &CaskFile, integrated: &Integrated) -> Option<Motion> {
        let times = Events {
            first_contact: Some(At::exact(integrated.contact_s)),
            separation: Some(self.separation),
            slap_down: self.slap_down,
            ..Events::default()
        };
        motion::outcome(integrated, self.flight.as_ref()?, &times, &super::setup::sticking(file))
    }
}

impl Search<'_> {
    /// Rounds from a first guess of the slap-down; the signals of both ends are without the first bending
    /// mode.
    fn attempt(&self, ends: &mut Ends, struck: Option<At>, beginning: Beginning) -> FoundFlight {
        ends.0.restore();
        let mut attempt = self.begin(ends, struck, beginning);
        for round in 0..ROUNDS + FURTHER_ROUNDS {
            let (window, fits) = self.fit(&attempt);
            let mut fits = fits.into_iter();
            let Some(flight) = fits.next() else { break };
            self.take_ringing_off(ends, &attempt, &flight);
            let (left_s, end_s) = (attempt.separation.time_s, attempt.end_s);
            self.seek_anew(ends, &mut attempt, &flight);
            attempt = Attempt { fitted: Some((flight, window)), others: fits.collect(), ..attempt };
            let (left_by_s, end_by_s) =
                ((attempt.separation.time_s - left_s).abs(), (attempt.end_s - end_s).abs());
            // A search that has not come to rest knows its slap-down no better than it still moves.
            if let Some(struck) = attempt.slap_down.as_mut().filter(|_| round > 0 && end_by_s > SETTLED_S) {
                struck.u_s = struck.u_s.hypot(end_by_s);
            }
            let is_still = round > 0 && end_by_s.max(left_by_s) < STILL_S;
            if is_still || (round + 1 >= ROUNDS && end_by_s < SETTLED_S) {
                break;
            }
        }
        self.conclude(ends, attempt)
    }

    /// Where the signal of R shows it to strike after `from_s`; free of ringing but for `calm_m_s2`.
    fn slap_down(&self, second: &motion::RingingRemoved, from_s: f64, calm_m_s2: Option<f64>) -> Option<At> {
        let between_s = from_s..self.record_end_s;
        events::slap_down(second.signal(), self.file.cask.length_m, between_s, self.least_m_s, calm_m_s2)
    }

    /// Where R strikes; where nothing shows that, where the record ends, s.
    fn flight_end_s(&self, struck: Option<At>) -> f64 {
        struck.map_or(self.record_end_s, |s| s.time_s)
    }

    /// What the first round goes by.
    fn begin(&self, (first, _): &Ends, struck: Option<At>, beginning: Beginning) -> Attempt {
        let Beginning { share, given_s, most_modes } = beginning;
        let contact_s = self.integrated.contact_s;
        let end_s = contact_s + share * (self.flight_end_s(struck) - contact_s);
        // Ringing may keep the force up beyond the contact: then the clearance alone is what the first fit
        // goes by.
        let cleared_s = cleared_s(contact_s, end_s);
        let rough_s = events::first_separation(first.signal(), contact_s, end_s).unwrap_or(cleared_s);
        Attempt {
            separation: At { time_s: rough_s, u_s: 0.1 * (rough_s - contact_s) },
            slap_down: struck,
            // The first fit keeps well clear of the contact, which ringing may have seemed to end too soon.
            free_s: rough_s.max(cleared_s).max(given_s.unwrap_or(cleared_s)),
            end_s,
            most_modes,
            fitted: None,
            others: Vec::new(),
        }
    }

    /// The fits of the flight over what is clear of both contacts, the best first, and that window.
    fn fit(&self, attempt: &Attempt) -> (motion::Window, Vec<FlightFit>) {
        let cog_m = self.file.cask.cog_m;
        let before = attempt.fitted.as_ref().map(|(flight, _)| flight);
        let before_rad_s = self.file.drop.angular_velocity_rad_s;
        let window = motion::Window {
            from_s: attempt.free_s,
            to_s: attempt.end_s - motion::BEFORE_SLAP_DOWN_S,
            drift: self.file.corrections.zero_shift,
            angular_velocity_rad_s: before.map_or(0.0, |flight| self.turned_rad_s(flight, attempt)),
        };
        // After R the modes ring on from both impacts: what drove them is not one force.
        let drive = || {
            let left_s = attempt.separation.time_s;
            motion::contact_drive(self.integrated, before, left_s, window.from_s, cog_m, before_rad_s)
        };
        let drive = self.to_target.then(drive).flatten();
        let fits = motion::fit_flights(self.integrated, &window, drive.as_ref(), cog_m, attempt.most_modes);
        (window, fits)
    }

    /// The rotation that pulls outward in a flight, rad/s.
    fn turned_rad_s(&self, flight: &FlightFit, attempt: &Attempt) -> f64 {
        let events_s = [self.integrated.contact_s, attempt.separation.time_s];
        motion::spin_rad_s(&self.integrated.signals, flight, self.file.drop.angular_velocity_rad_s, events_s)
    }

    /// Takes off the signals of both ends what rings and pulls in the flight.
    fn take_ringing_off(&self, (first, second): &mut Ends, attempt: &Attempt, flight: &FlightFit) {
        let beyond_s = self.flight_end_s(attempt.slap_down).max(attempt.end_s) + BEYOND_S;
        let turning_rad_s = self.turned_rad_s(flight, attempt);
        let take_off = |end: &mut motion::RingingRemoved| {
            let pull_m_s2 = end.pull_m_s2(&self.integrated.signals, turning_rad_s, self.file.cask.cog_m);
            end.take_off(flight, self.integrated.contact_s..beyond_s, pull_m_s2);
        };
        rayon::join(|| take_off(first), || take_off(second));
    }

    /// Seeks slap-down and separation on signals free of ringing.
    fn seek_anew(&self, (first, second): &Ends, attempt: &mut Attempt, flight: &FlightFit) {
        let contact_s = self.integrated.contact_s;
        // A well-explained flight hides no slap-down in its ringing, and a poorly fitted one can imitate a
        // slap-down.
        let most_left_m_s = EXPLAINED_M_S.max(SHOWN * self.file.drop.impact_velocity_m_s);
        let is_shown = flight.plateaus.iter().all(|p| p.residual_m_s < most_left_m_s);
        if is_shown {
            let calm_m_s2 = calm_m_s2(second, flight);
            let from_s = self.earliest_s.max(attempt.free_s);
            let cut_short = || {
                let least_m_s = CUT_SHORT * self.least_m_s;
                events::cut_short(second.signal(), self.file.cask.length_m, from_s, calm_m_s2, least_m_s)
            };
            attempt.slap_down = self.slap_down(second, from_s, Some(calm_m_s2)).or_else(cut_short);
            attempt.end_s = self.flight_end_s(attempt.slap_down);
        }
        attempt.separation =
            events::separation(first.signal(), contact_s, attempt.free_s).unwrap_or(attempt.separation);
        attempt.free_s = motion::clear_of_contact_s(contact_s, attempt.separation.time_s);
    }

    /// What the last round ended with, the separation by the impulse.
    fn conclude(&self, (first, second): &Ends, attempt: Attempt) -> FoundFlight {
        let Attempt { mut separation, mut slap_down, fitted, others, .. } = attempt;
        let contact_s = self.integrated.contact_s;
        let (flight, window) = fitted.unzip();
        let calm_s = separation.time_s;
        if let (Some(flight), Some(struck)) = (&flight, slap_down) {
            let calm_m_s2 = calm_m_s2(second, flight);
            let from_s = self.earliest_s.max(flight.from_s);
            let length_m = self.file.cask.length_m;
            slap_down = Some(events::departure(second.signal(), length_m, struck, from_s, calm_m_s2));
        }
        if let Some(window) = &window {
            separation =
                events::refine_end(first.signal(), contact_s, separation, &(window.from_s..window.to_s));
        }
        let seat_s = events::seat_delay_s(first.signal(), contact_s, separation.time_s);
        self.best_of(FoundFlight { separation, seat_s, calm_s, slap_down, flight, window }, others)
    }

    /// The flight from behind a blow that L has so soon after it left the target that its contact was not
    /// over.
    fn beyond_last_stage(&self, found: FoundFlight) -> FoundFlight {
        let Some(stage_s) = self.last_stage_s(&found) else { return found };
        let FoundFlight { separation, slap_down, flight, window, .. } = &found;
        let attempt = Attempt {
            separation: At { u_s: separation.u_s.hypot(stage_s - separation.time_s), ..*separation },
            slap_down: *slap_down,
            free_s: stage_s + STAGE_FADES_S,
            end_s: self.flight_end_s(*slap_down),
            most_modes: FEW_MODES,
            fitted: flight.clone().zip(*window),
            others: Vec::new(),
        };
        let (window, fits) = self.fit(&attempt);
        match fits.into_iter().next().filter(is_explained) {
            Some(flight) => {
                let separation = attempt.separation;
                FoundFlight { separation, flight: Some(flight), window: Some(window), ..found }
            }
            None => found,
        }
    }

    /// When L has that blow, s.
    fn last_stage_s(&self, found: &FoundFlight) -> Option<f64> {
        let &Integrated { ref signals, contact_s, .. } = self.integrated;
        let times = Events {
            first_contact: Some(At { time_s: contact_s, u_s: 0.0 }),
            slap_down: found.slap_down,
            ..Events::default()
        };
        let blows = judge::judge_blows(signals, found.flight.as_ref()?, &times, &[], &self.file.cask)?;
        let struck = signals.iter().find(|s| blows.channel.as_ref() == Some(&s.name))?;
        let left_s = found.separation.time_s;
        let is_stage = |at_s: &f64| *at_s - left_s < STAGE * (left_s - contact_s);
        blows.to_s.filter(|at_s| struck.end == End::First && is_stage(at_s))
    }

    /// Where a flight shows too little of its slowest mode to tell the fits apart, the first of them that the
    /// closures do not speak against.
    fn best_of(&self, found: FoundFlight, others: Vec<FlightFit>) -> FoundFlight {
        if self.cost(&found) < 1.0 || found.flight.as_ref().is_none_or(FlightFit::can_rank_fits) {
            return found;
        }
        let with = |flight| FoundFlight { flight: Some(flight), ..found };
        others.into_iter().map(with).find(|other| self.cost(other) < 1.0).unwrap_or(found)
    }

    /// What is left unexplained, R's distance from the target and the rotation beside the impulse, each over
    /// what is allowed; below 1 nothing speaks against it.
    fn cost(&self, found: &FoundFlight) -> f64 {
        let Some(flight) = &found.flight else { return f64::INFINITY };
        let left_m_s = flight.plateaus.iter().map(|p| p.slow_residual_m_s).fold(0.0, f64::max);
        let most_left_m_s = if flight.can_rank_fits() {
            EXPLAINED_M_S
        } else {
            EXPLAINED_M_S.min(EXPLAINED_SHORT * self.file.drop.impact_velocity_m_s)
        };
        let is_resolved = |cost: f64| if flight.resolves_modes() { cost } else { cost.max(1.0) };
        if !self.to_target {
            return is_resolved(left_m_s / most_left_m_s);
        }
        let moved = found.moved(self.file, self.integrated);
        let cask = &self.file.cask;
        let turning = moved.as_ref().filter(|_| cask.is_body).map_or(0.0, |m| {
            let by_impulse_rad_s = m.angular_impulse_m2_s * cask.mass_kg / cask.inertia_kg_m2;
            (m.separation.angular_velocity_rad_s / by_impulse_rad_s - 1.0).abs()
        });
        let off_m = moved.and_then(|m| m.second_end_height_m).unwrap_or(cask.length_m);
        let cost = (left_m_s / most_left_m_s).max(off_m.abs() / (NEAR * cask.length_m)).max(turning / TURNED);
        // Modes that the window does not tell apart explain anything.
        is_resolved(cost)
    }
}

fn is_explained(flight: &FlightFit) -> bool {
    flight.plateaus.iter().all(|p| p.slow_residual_m_s < EXPLAINED_M_S)
}

/// Whether the flight is explained by modes that it shows for long enough: another beginning would end there
/// too, and what it misses is not the flight's.
fn is_clearly_explained(flight: &FlightFit) -> bool {
    is_explained(flight) && flight.can_rank_fits() && flight.resolves_modes()
}
