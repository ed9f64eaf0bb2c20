//! Finds separation, slap-down and the flight between them by iteration, since each depends on the others.

use crate::data::{At, CaskFile, End, Events, FlightFit, Motion, Signal};
use crate::motion::{self, Integrated};
use crate::{events, judge};

/// Rounds in which separation and slap-down are determined on signals free of ringing; the second one moves
/// them by less than a sample.
const ROUNDS: usize = 3;
/// The iteration stops when separation and slap-down move by less than this, s: a fiftieth of the shortest
/// contact.
const CONVERGED_S: f64 = 2e-5;

/// Further rounds if the last one moved the slap-down by more than [`SETTLED_S`]: its flight was fitted over
/// a wrong interval.
const FURTHER_ROUNDS: usize = 3;
const SETTLED_S: f64 = 1e-3;

/// R cannot strike before this share of its height over v0: rod ends descend with less than 2 v0, and angles
/// are known to 40 %.
const EARLIEST_SHARE: f64 = 0.3;

/// R strikes with more than this share of v0 if it slaps down at all.
const LEAST_SLAP_DOWN_SHARE: f64 = 0.08;

/// A pulse that the end of the record cuts has begun at this share of that velocity.
const CUT_SHORT_SHARE: f64 = 0.25;

/// Start of the first flight fit, as a share of the time from contact to slap-down, and its latest value, s.
const CLEARANCE_SHARE: f64 = 0.4;
const LONGEST_CLEARANCE_S: f64 = 0.022;

/// Largest number of modes of the first fits, those of a cask below 400 Hz; and of further fits if they do
/// not explain the flight: a short contact excites more modes.
const FEW_MODES: usize = 3;
const MANY_MODES: usize = 6;

/// End of the first fit, as shares of the time to the slap-down seen first: strong ringing may delay that,
/// and a fit that includes the slap-down explains nothing.
const FIRST_ENDS: [f64; 4] = [1.0, 0.8, 0.65, 0.5];

/// Largest residual of a flight fit, as a share of v0, with which a departure from it shows the slap-down.
const SHOWN_SHARE: f64 = 0.05;

/// Residual RMS below which a flight fit has explained its channel, m/s: 1.5 % of a 9 m fall.
const EXPLAINED_M_S: f64 = 0.2;

/// This limit for a flight too short to rank its fits, as a share of v0. Three modes also fit a part of the
/// contact: of 400 simulated drops, those with the right separation had residuals up to 0.6 %, the others 1.4
/// % and more.
const EXPLAINED_SHORT_SHARE: f64 = 0.0075;

/// Accepted height of R above the target at slap-down, as a share of the length; it includes an angle 1° off.
const HEIGHT_SHARE: f64 = 0.02;

/// Accepted deviation of the rotation from that of the first impact's impulse, as a share; a larger one is
/// not that of the rigid body.
const ROTATION_SHARE: f64 = 0.1;

/// Time beyond a window in which the contact's force after separation is searched, s.
const BEYOND_S: f64 = 0.02;

/// Latest time after separation, as a share of the contact, of a blow on L that is the contact's last stage.
const STAGE_SHARE: f64 = 0.25;
/// Time in which such a blow fades after its peak, s.
const STAGE_FADES_S: f64 = 1e-3;

/// Largest standard uncertainty of the slap-down with which touches of L are followed to it, s: half of the
/// interval before it that is omitted.
const STRUCK_U_S: f64 = 5e-4;

/// The search starts this long before first contact, s: half the width of the moving mean that finds a
/// slap-down.
const BEFORE_S: f64 = 0.05;

/// Result of the search.
pub struct FoundFlight {
    /// Separation.
    pub separation: At,
    /// Possible delay of the sensor that shows it, s.
    pub seat_s: f64,
    /// Time at which its signal has become calm, s.
    calm_s: f64,
    /// Slap-down, if there is one.
    pub slap_down: Option<At>,
    /// The flight between them, if it could be fitted.
    pub flight: Option<FlightFit>,
    /// Interval of that fit.
    window: Option<motion::Window>,
}

/// Inputs and limits of the search.
struct Search<'a> {
    integrated: &'a Integrated<'a>,
    file: &'a CaskFile,
    record_end_s: f64,
    earliest_s: f64,
    least_m_s: f64,
    /// True if R must strike the target; else a flight that is explained is enough.
    to_target: bool,
}

/// Effort of the search for a flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchEffort {
    /// Tries one start after the other, until one explains the flight.
    EveryStart,
    /// Tries the first start only: for many trials, of which the right one succeeds with it.
    FirstStart,
}

/// Signals of both ends, free of ringing as far as it is known.
type Ends = (motion::RingingRemoved, motion::RingingRemoved);

/// Start of the search's first round.
#[derive(Clone, Copy)]
struct SearchStart {
    /// End of its fit, as a share of the time to the slap-down seen first.
    share: f64,
    /// End of the impulse, s: the fit begins no sooner.
    impulse_end_s: Option<f64>,
    /// Largest number of modes of this fit and the next ones.
    most_modes: usize,
}

/// State that one round of the search passes to the next.
struct SearchState {
    separation: At,
    slap_down: Option<At>,
    /// Start of the next fit, clear of the contact, s.
    free_s: f64,
    /// End of the flight, s.
    end_s: f64,
    /// Largest number of modes of its fit.
    most_modes: usize,
    /// The last fit of the flight, and its interval.
    last_fit: Option<(FlightFit, motion::Window)>,
    /// The other fits over that interval, the best first.
    others: Vec<FlightFit>,
}

/// Finds separation, slap-down and flight: from several starts the first one that explains the flight and
/// brings R to the target, else the best. `None` without transverse channels on both ends.
pub fn find(file: &CaskFile, integrated: &Integrated, effort: SearchEffort) -> Option<FoundFlight> {
    let starts = if effort == SearchEffort::FirstStart { 1 } else { FIRST_ENDS.len() };
    let mut found = search(file, integrated, true, starts)?;
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
            // Its effect is known.
            flight.plateaus.iter_mut().for_each(|p| p.late_mismatch_m_s = None);
        }
    }
    Some(found)
}

/// Finds separation and flight without a condition on what follows the flight.
pub fn find_without_target(file: &CaskFile, integrated: &Integrated) -> Option<FoundFlight> {
    search(file, integrated, false, 1)
}

fn search(file: &CaskFile, integrated: &Integrated, to_target: bool, starts: usize) -> Option<FoundFlight> {
    let &Integrated { ref signals, contact_s, .. } = integrated;
    let drop = &file.drop;
    let descent_m = file.cask.length_m * drop.angle_rad.sin().max(0.0);
    let search = Search {
        integrated,
        file,
        record_end_s: record_end_s(signals),
        earliest_s: contact_s + EARLIEST_SHARE * descent_m / drop.impact_velocity_m_s,
        least_m_s: LEAST_SLAP_DOWN_SHARE * drop.impact_velocity_m_s,
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
    // If the velocities are cut off, no start leads to a flight that explains them.
    let before_s = struck.map_or(search.record_end_s, |s| s.time_s);
    let is_hopeless = signals.iter().any(|s| judge::is_cut_off(s, contact_s, before_s));
    // A contact in stages may last beyond the clearance: the first start is then the end of its impulse.
    let impulse_end_s = events::impulse_end(ends.0.signal(), contact_s, before_s)
        .filter(|impulse_end_s| !is_hopeless && *impulse_end_s > clearance_end_s(contact_s, before_s));
    let shares = FIRST_ENDS.into_iter().take(if is_hopeless { 1 } else { starts });
    let with_impulse = impulse_end_s.map(|impulse_end_s| (FIRST_ENDS[0], Some(impulse_end_s)));
    for (share, impulse_end_s) in with_impulse.into_iter().chain(shares.map(|share| (share, None))) {
        let most_modes = if best.is_none() { FEW_MODES } else { MANY_MODES };
        let start = SearchStart { share, impulse_end_s, most_modes };
        let attempt = search.attempt(&mut ends, struck, start);
        let cost = search.cost(&attempt);
        let is_settled = cost < 1.0 || attempt.flight.as_ref().is_some_and(is_clearly_explained);
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, attempt));
        }
        if is_settled {
            break;
        }
    }
    best.map(|(_, found)| search.refit_after_last_stage(found))
}

/// Residual of a flight in an end's signal in the calmest of its quarters but the first, m/s²: fast modes
/// ring at the beginning, and the end may contain the onset of the slap-down.
fn calm_m_s2(second: &motion::RingingRemoved, flight: &FlightFit) -> f64 {
    let quarter_s = (flight.to_s - flight.from_s) / 4.0;
    let quarters_s = [1.0, 2.0, 3.0].map(|n| flight.from_s + n * quarter_s);
    let largest_m_s2 = |from_s: f64| second.largest_m_s2(&(from_s..from_s + quarter_s));
    quarters_s.into_iter().map(largest_m_s2).fold(f64::INFINITY, f64::min)
}

/// Start of the first fit, which ends at `end_s`, unless something shows a longer contact, s.
fn clearance_end_s(contact_s: f64, end_s: f64) -> f64 {
    contact_s + (CLEARANCE_SHARE * (end_s - contact_s)).min(LONGEST_CLEARANCE_S)
}

/// Rotation of the cask from first contact to separation, rad.
pub fn rotation_in_contact_rad(file: &CaskFile, signals: &[Signal], contact_s: f64) -> Option<f64> {
    let integrated = Integrated::new(signals, contact_s);
    let motion = find(file, &integrated, SearchEffort::EveryStart)?.reconstruct(file, &integrated)?;
    Some(file.drop.angle_rad - motion.separation.angle_rad)
}

/// End of the shortest record, s.
pub fn record_end_s(signals: &[Signal]) -> f64 {
    signals.iter().map(Signal::end_s).fold(f64::INFINITY, f64::min)
}

impl FoundFlight {
    /// Reconstructs the motion from signals, times and flight with L sticking.
    pub fn reconstruct(&self, file: &CaskFile, integrated: &Integrated) -> Option<Motion> {
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
    /// Iterates from a first estimate of the slap-down; the signals of both ends lack the first bending mode.
    fn attempt(&self, ends: &mut Ends, struck: Option<At>, start: SearchStart) -> FoundFlight {
        ends.0.restore();
        let mut attempt = self.first_state(ends, struck, start);
        for round in 0..ROUNDS + FURTHER_ROUNDS {
            let (window, fits) = self.fit(&attempt);
            let mut fits = fits.into_iter();
            let Some(flight) = fits.next() else { break };
            self.remove_ringing(ends, &attempt, &flight);
            let (left_s, end_s) = (attempt.separation.time_s, attempt.end_s);
            self.find_events(ends, &mut attempt, &flight);
            attempt = SearchState { last_fit: Some((flight, window)), others: fits.collect(), ..attempt };
            let (left_by_s, end_by_s) =
                ((attempt.separation.time_s - left_s).abs(), (attempt.end_s - end_s).abs());
            // A search that has not converged determines the slap-down no better than it still moves.
            if let Some(struck) = attempt.slap_down.as_mut().filter(|_| round > 0 && end_by_s > SETTLED_S) {
                struck.u_s = struck.u_s.hypot(end_by_s);
            }
            let is_converged = round > 0 && end_by_s.max(left_by_s) < CONVERGED_S;
            if is_converged || (round + 1 >= ROUNDS && end_by_s < SETTLED_S) {
                break;
            }
        }
        self.conclude(ends, attempt)
    }

    /// Time at which the signal of R shows it to strike after `from_s`; `calm_m_s2` is its residual ringing.
    fn slap_down(&self, second: &motion::RingingRemoved, from_s: f64, calm_m_s2: Option<f64>) -> Option<At> {
        let between_s = from_s..self.record_end_s;
        events::slap_down(second.signal(), self.file.cask.length_m, between_s, self.least_m_s, calm_m_s2)
    }

    /// Time at which R strikes, or the end of the record if nothing shows that, s.
    fn flight_end_s(&self, struck: Option<At>) -> f64 {
        struck.map_or(self.record_end_s, |s| s.time_s)
    }

    /// Prepares the first round.
    fn first_state(&self, (first, _): &Ends, struck: Option<At>, start: SearchStart) -> SearchState {
        let SearchStart { share, impulse_end_s, most_modes } = start;
        let contact_s = self.integrated.contact_s;
        let end_s = contact_s + share * (self.flight_end_s(struck) - contact_s);
        // Ringing may keep the force up beyond the contact: then the clearance alone sets the first fit.
        let clearance_end_s = clearance_end_s(contact_s, end_s);
        let rough_s = events::first_separation(first.signal(), contact_s, end_s).unwrap_or(clearance_end_s);
        SearchState {
            separation: At { time_s: rough_s, u_s: 0.1 * (rough_s - contact_s) },
            slap_down: struck,
            // The first fit begins well clear of the contact, whose end ringing may have shifted to an
            // earlier time.
            free_s: rough_s.max(clearance_end_s).max(impulse_end_s.unwrap_or(clearance_end_s)),
            end_s,
            most_modes,
            last_fit: None,
            others: Vec::new(),
        }
    }

    /// Fits the flight over the interval clear of both contacts; returns the interval and the fits, the best
    /// first.
    fn fit(&self, attempt: &SearchState) -> (motion::Window, Vec<FlightFit>) {
        let cog_m = self.file.cask.cog_m;
        let before = attempt.last_fit.as_ref().map(|(flight, _)| flight);
        let before_rad_s = self.file.drop.angular_velocity_rad_s;
        let window = motion::Window {
            from_s: attempt.free_s,
            to_s: attempt.end_s - motion::BEFORE_SLAP_DOWN_S,
            drift: self.file.corrections.zero_shift,
            angular_velocity_rad_s: before.map_or(0.0, |flight| self.rotation_rad_s(flight, attempt)),
        };
        // After R strikes, the modes ring from both impacts: no single force drove them.
        let drive = || {
            let left_s = attempt.separation.time_s;
            motion::contact_drive(self.integrated, before, left_s, window.from_s, cog_m, before_rad_s)
        };
        let drive = self.to_target.then(drive).flatten();
        let fits = motion::fit_flights(self.integrated, &window, drive.as_ref(), cog_m, attempt.most_modes);
        (window, fits)
    }

    /// Rotation in a flight that causes a centrifugal pull, rad/s.
    fn rotation_rad_s(&self, flight: &FlightFit, attempt: &SearchState) -> f64 {
        let events_s = [self.integrated.contact_s, attempt.separation.time_s];
        motion::spin_rad_s(&self.integrated.signals, flight, self.file.drop.angular_velocity_rad_s, events_s)
    }

    /// Removes the ringing and the centrifugal pull of the flight from the signals of both ends.
    fn remove_ringing(&self, (first, second): &mut Ends, attempt: &SearchState, flight: &FlightFit) {
        let beyond_s = self.flight_end_s(attempt.slap_down).max(attempt.end_s) + BEYOND_S;
        let turning_rad_s = self.rotation_rad_s(flight, attempt);
        let remove = |end: &mut motion::RingingRemoved| {
            let pull_m_s2 = end.pull_m_s2(&self.integrated.signals, turning_rad_s, self.file.cask.cog_m);
            end.take_off(flight, self.integrated.contact_s..beyond_s, pull_m_s2);
        };
        rayon::join(|| remove(first), || remove(second));
    }

    /// Finds slap-down and separation again on signals free of ringing.
    fn find_events(&self, (first, second): &Ends, attempt: &mut SearchState, flight: &FlightFit) {
        let contact_s = self.integrated.contact_s;
        // The ringing of a well-explained flight hides no slap-down, and a poorly fitted one can imitate a
        // slap-down.
        let most_residual_m_s = EXPLAINED_M_S.max(SHOWN_SHARE * self.file.drop.impact_velocity_m_s);
        let is_shown = flight.plateaus.iter().all(|p| p.residual_m_s < most_residual_m_s);
        if is_shown {
            let calm_m_s2 = calm_m_s2(second, flight);
            let from_s = self.earliest_s.max(attempt.free_s);
            let cut_short = || {
                let least_m_s = CUT_SHORT_SHARE * self.least_m_s;
                events::cut_short(second.signal(), self.file.cask.length_m, from_s, calm_m_s2, least_m_s)
            };
            attempt.slap_down = self.slap_down(second, from_s, Some(calm_m_s2)).or_else(cut_short);
            attempt.end_s = self.flight_end_s(attempt.slap_down);
        }
        attempt.separation =
            events::separation(first.signal(), contact_s, attempt.free_s).unwrap_or(attempt.separation);
        attempt.free_s = motion::clear_of_contact_s(contact_s, attempt.separation.time_s);
    }

    /// Concludes the last round; the separation is refined by the impulse.
    fn conclude(&self, (first, second): &Ends, attempt: SearchState) -> FoundFlight {
        let SearchState { mut separation, mut slap_down, last_fit, others, .. } = attempt;
        let contact_s = self.integrated.contact_s;
        let (flight, window) = last_fit.unzip();
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
        self.choose_fit(FoundFlight { separation, seat_s, calm_s, slap_down, flight, window }, others)
    }

    /// Fits the flight again from after a blow on L so soon after separation that its contact was not over.
    fn refit_after_last_stage(&self, found: FoundFlight) -> FoundFlight {
        let Some(stage_s) = self.last_stage_s(&found) else { return found };
        let FoundFlight { separation, slap_down, flight, window, .. } = &found;
        let attempt = SearchState {
            separation: At { u_s: separation.u_s.hypot(stage_s - separation.time_s), ..*separation },
            slap_down: *slap_down,
            free_s: stage_s + STAGE_FADES_S,
            end_s: self.flight_end_s(*slap_down),
            most_modes: FEW_MODES,
            last_fit: flight.clone().zip(*window),
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

    /// Time of that blow on L, s.
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
        let is_stage = |at_s: &f64| *at_s - left_s < STAGE_SHARE * (left_s - contact_s);
        blows.to_s.filter(|at_s| struck.end == End::First && is_stage(at_s))
    }

    /// Chooses the first fit that no check contradicts, if the flight shows too little of its slowest mode to
    /// rank the fits.
    fn choose_fit(&self, found: FoundFlight, others: Vec<FlightFit>) -> FoundFlight {
        if self.cost(&found) < 1.0 || found.flight.as_ref().is_none_or(FlightFit::can_rank_fits) {
            return found;
        }
        let with = |flight| FoundFlight { flight: Some(flight), ..found };
        others.into_iter().map(with).find(|other| self.cost(other) < 1.0).unwrap_or(found)
    }

    /// Largest of the residual, R's distance from the target and the deviation of the rotation, each over its
    /// limit; below 1 nothing contradicts the flight.
    fn cost(&self, found: &FoundFlight) -> f64 {
        let Some(flight) = &found.flight else { return f64::INFINITY };
        let residual_m_s = flight.plateaus.iter().map(|p| p.slow_residual_m_s).fold(0.0, f64::max);
        let most_residual_m_s = if flight.can_rank_fits() {
            EXPLAINED_M_S
        } else {
            EXPLAINED_M_S.min(EXPLAINED_SHORT_SHARE * self.file.drop.impact_velocity_m_s)
        };
        let is_resolved = |cost: f64| if flight.resolves_modes() { cost } else { cost.max(1.0) };
        if !self.to_target {
            return is_resolved(residual_m_s / most_residual_m_s);
        }
        let motion = found.reconstruct(self.file, self.integrated);
        let cask = &self.file.cask;
        let turning = motion.as_ref().filter(|_| cask.is_body).map_or(0.0, |m| {
            let by_impulse_rad_s = m.angular_impulse_m2_s * cask.mass_kg / cask.inertia_kg_m2;
            (m.separation.angular_velocity_rad_s / by_impulse_rad_s - 1.0).abs()
        });
        let off_m = motion.and_then(|m| m.second_end_height_m).unwrap_or(cask.length_m);
        let height = off_m.abs() / (HEIGHT_SHARE * cask.length_m);
        // Modes that the window cannot separate explain anything.
        is_resolved((residual_m_s / most_residual_m_s).max(height).max(turning / ROTATION_SHARE))
    }
}

fn is_explained(flight: &FlightFit) -> bool {
    flight.plateaus.iter().all(|p| p.slow_residual_m_s < EXPLAINED_M_S)
}

/// True if the flight is explained by modes that it shows for long enough: another start would give the same,
/// and the residual is not that of the flight.
fn is_clearly_explained(flight: &FlightFit) -> bool {
    is_explained(flight) && flight.can_rank_fits() && flight.resolves_modes()
}
