//! What the stages found, gathered on the way, to one [`Analysis`].

use crate::data::{
    Analysis, Axis, CaskFile, ChannelSummary, Comparison, Curves, DropResult, Estimate, Events, FirstImpact,
    FlightFit, Input, Issue, IssueCode, ModelChoice, Quantities, ReconstructionChoice, Recording, RestLevel,
    Setting, Setup, Severity, Signal, SlapDown,
};
use crate::numerics::reduce::peak;
use crate::{fit, judge, motion, predict};

/// What a recorder's anti-alias filter delays by, in samples: 1.0 to 1.7 for one of fourth order at 0.4 to 0.25 of the rate, 2.0 for one of
/// eighth order at 0.4 (Butterworth, at low frequency).
const CHAIN_DELAY_SAMPLES: f64 = 2.0;

/// The analysis while it is made.
pub(crate) struct Draft<'a> {
    recording: &'a Recording,
    pub cask_file: &'a CaskFile,
    pub issues: Vec<Issue>,
    pub events: Events,
    pub u_events_s: [f64; 3],
    pub curves: Curves,
    pub flight: Option<FlightFit>,
    channels: Vec<ChannelSummary>,
    settings: Vec<Setting>,
    pub rests: Vec<RestLevel>,
    quantities: Option<Quantities>,
    reconstruction: Option<ReconstructionChoice>,
    model: Option<ModelChoice>,
    comparison: Option<Comparison>,
}

impl<'a> Draft<'a> {
    pub fn new(recording: &'a Recording, cask_file: &'a CaskFile) -> Self {
        Self {
            recording,
            cask_file,
            issues: recording.issues.clone(),
            events: Events::default(),
            u_events_s: [0.0; 3],
            curves: Curves::default(),
            flight: None,
            channels: recording.channels.iter().map(summary).collect(),
            settings: Vec::new(),
            rests: Vec::new(),
            quantities: None,
            reconstruction: None,
            model: None,
            comparison: None,
        }
    }

    /// The result where no impact was found.
    pub fn without_impact(mut self) -> Analysis {
        let is_doubt = |i: &&Issue| i.code == IssueCode::TimeJitter && i.severity == Severity::Warning;
        let doubt = self.issues.iter().find(is_doubt).map_or_else(String::new, |issue| {
            let of = issue.channel.as_ref().map_or_else(String::new, |channel| format!(" of {channel}"));
            format!(
                "; the rate{of} is in doubt (time_jitter), and a rate too high makes every velocity too small by as much: clear that up first"
            )
        });
        self.issues.push(Issue::new(
            IssueCode::NoImpact,
            Severity::Error,
            format!(
                "no impact was found: no transverse channel changes its velocity by {:.1} m/s within 25 ms; check source, unit and that the recording covers the drop{doubt}",
                self.cask_file.drop.least_impact_m_s()
            ),
        ));
        self.finish()
    }

    /// Takes over the times of the events with their standard uncertainties.
    pub fn take_times(&mut self, contact: (f64, f64), left: (f64, f64), struck: Option<(f64, f64)>) {
        self.events.separation_s = Some(left.0);
        self.events.slap_down_s = struck.map(|s| s.0);
        self.u_events_s = [contact.1, left.1, struck.map_or(0.0, |s| s.1)];
    }

    /// Says that the second end shows no slap-down in the time that was recorded after the first one left.
    pub fn no_slap_down(&mut self, after_s: f64) {
        let (code, why) = if after_s < 0.3 {
            (IssueCode::EndsEarly, "the recording ends before it")
        } else {
            (IssueCode::NoSlapDown, "the second end shows no impact")
        };
        self.issues.push(Issue::new(
            code,
            Severity::Error,
            format!("no slap-down within {:.0} ms after the first end left the target: {why}", 1e3 * after_s),
        ));
    }

    /// Says that no flight could be had.
    pub fn flight_is_too_short(&mut self) {
        self.issues.push(Issue::new(
            IssueCode::FlightFit,
            Severity::Error,
            "the free flight between the impacts is too short to be told from them and from ringing",
        ));
    }

    /// Takes over what was measured and how it compares.
    pub fn measured(
        &mut self,
        quantities: Quantities,
        reconstruction: ReconstructionChoice,
        compared: Option<(ModelChoice, Option<Comparison>)>,
    ) {
        self.quantities = Some(quantities);
        self.reconstruction = Some(reconstruction);
        if let Some((model, comparison)) = compared {
            self.model = Some(model);
            self.comparison = comparison;
        }
    }

    /// The signals as the curves' low-pass leaves them.
    pub fn smooth(&self, signals: &[Signal]) -> Vec<Signal> {
        motion::filtered(signals, &self.events, self.cutoff().0)
    }

    /// What the curves' low-pass would have changed had it been used for the numbers, in words.
    fn filter_effect(&self, smooth: &[Signal], setup: &Setup) -> Option<String> {
        let quantities = self.quantities.as_ref()?;
        let speed = quantities.speed?;
        let (contact_s, left_s) = (self.events.first_contact_s?, self.events.separation_s?);
        let window = motion::Window {
            from_s: left_s + 0.1 * (left_s - contact_s) + 3e-4,
            to_s: self.events.slap_down_s? - 5e-4,
            drift: self.cask_file.corrections.zero_shift,
            angular_velocity_rad_s: quantities.angular_velocity.value,
        };
        let integrated = motion::Integrated::over(smooth, contact_s);
        let flight = motion::fit_flight(&integrated, &window, None, setup.cog_m)?;
        let motion = motion::outcome(&integrated, &flight, &self.events, setup)?;
        let (horizontal_m_s, vertical_m_s) = motion.second_end_m_s?;
        Some(format!(
            "slap-down speed {:+.2} m/s, k {:+.3}",
            horizontal_m_s.hypot(vertical_m_s) - speed.value,
            motion.rebound_m_s / setup.impact_velocity_m_s - quantities.k.value
        ))
    }

    fn cutoff(&self) -> (f64, &'static str) {
        let pulse_s = self.events.separation_s.zip(self.events.first_contact_s).map(|(l, c)| l - c);
        motion::cutoff_hz(self.cask_file.filter, self.cask_file.cask.mass_kg, pulse_s)
    }

    /// Draws the curves and takes each channel's peaks, offset and noise; where there is a motion, by `setup`, what the curves' low-pass
    /// would have made of it.
    pub fn draw(&mut self, signals: &[Signal], smooth: &[Signal], setup: Option<&Setup>) {
        let (cutoff_hz, origin) = self.cutoff();
        let (effect, curves) = rayon::join(
            || setup.and_then(|setup| self.filter_effect(smooth, setup)),
            || motion::channel_curves(signals, smooth, &self.events, &sticking(self.cask_file)),
        );
        self.curves.channels = curves;
        if let Some(effect) = effect {
            self.say(
                "effect of that low-pass, had it been applied before integrating",
                effect,
                "from the data",
            );
        }
        for ((summary, signal), curve) in self.channels.iter_mut().zip(signals).zip(&self.curves.channels) {
            summary.offset_m_s2 = Some(signal.removed_offset_m_s2);
            summary.noise_m_s2 = Some(signal.noise_m_s2);
            summary.peak_raw_m_s2 = Some(peak(&curve.raw_m_s2));
            summary.peak_filtered_m_s2 = Some(peak(&curve.filtered_m_s2));
            summary.clipped.clone_from(&signal.clipped);
        }
        self.say(
            "low-pass of the curves shown",
            format!("−3 dB at {cutoff_hz:.0} Hz, zero phase (two passes, second order)"),
            origin,
        );
        self.say("samples that are integrated", "unfiltered, offset removed", "default");
    }

    fn say(&mut self, name: &str, value: impl Into<String>, origin: &str) {
        self.settings.push(Setting { name: name.into(), value: value.into(), origin: origin.into() });
    }

    fn say_settings(&mut self) {
        let file = self.cask_file;
        let origin = |key: &str| if file.defaults.iter().any(|d| d == key) { "default" } else { "cask file" };
        let (cask, drop) = (&file.cask, &file.drop);
        self.say("mass", format!("{} kg", cask.mass_kg), "cask file");
        self.say("length", format!("{} m", cask.length_m), "cask file");
        self.say("section in the plane of the drop", format!("{} m", cask.height_m), origin("cask.height_m"));
        self.say(
            "centre of gravity from the first end",
            format!("{:.3} m", cask.cog_m),
            origin("cask.cog_m"),
        );
        self.say("inertia", format!("{:.0} kg m²", cask.inertia_kg_m2), origin("cask.inertia_kg_m2"));
        self.say("drop angle", format!("{:.1}°", drop.angle_rad.to_degrees()), "cask file");
        let velocity_origin = if drop.impact_velocity_given { "cask file" } else { "√(2 g h)" };
        self.say("impact velocity", format!("{:.3} m/s", drop.impact_velocity_m_s), velocity_origin);
        self.say("gravity", format!("{} m/s²", drop.gravity_m_s2), origin("drop.gravity_m_s2"));
        self.say("contact law of the first end", file.contact.to_string(), origin("contact.friction"));
        if let (Some(release_s), Some(end_s)) = (self.events.release_s, self.events.fall_end_s) {
            self.say(
                "free fall seen",
                format!(
                    "{:.4} s, {} is {:.4} s",
                    end_s - release_s,
                    if drop.impact_velocity_given { "impact velocity over g" } else { "√(2 h / g)" },
                    drop.impact_velocity_m_s / drop.gravity_m_s2
                ),
                "from the data",
            );
        }
    }

    /// Puts everything together.
    pub fn finish(mut self) -> Analysis {
        self.say_settings();
        let verdict = judge::verdict(&mut self.issues);
        let first_impact = self.first_impact();
        let slap_down = self.slap_down();
        let predictions = self.predictions();
        let input = Input {
            recording: self.recording.path.display().to_string(),
            recording_sha256: self.recording.sha256.clone(),
            format: self.recording.format,
            cask: self.cask_file.path.display().to_string(),
            cask_sha256: self.cask_file.sha256.clone(),
        };
        let result = DropResult {
            schema: "dropcheck.result/1",
            version: env!("CARGO_PKG_VERSION"),
            input,
            first_impact,
            slap_down,
            k: self.quantities.as_ref().map(|q| q.k),
            reconstruction: self.reconstruction,
            model: self.model,
            predictions,
            comparison: self.comparison,
            quality: self.issues,
            verdict,
            events: self.events,
            channels: self.channels,
            flight: self.flight,
            budget: self.quantities.map_or_else(Vec::new, |q| q.budget),
            settings: self.settings,
        };
        Analysis {
            result,
            cask_file: self.cask_file.clone(),
            curves: self.curves,
            start_unix_ns: self.recording.start_unix_ns,
        }
    }

    fn first_impact(&self) -> FirstImpact {
        let time = self.events.first_contact_s.map(|t| self.time(t, self.u_events_s[0]));
        let q = self.quantities.as_ref();
        FirstImpact {
            time,
            impact_velocity: q.map(|q| q.impact_velocity),
            duration: q.map(|q| q.duration),
            rebound_velocity: q.map(|q| q.rebound_velocity),
            angular_velocity: q.map(|q| q.angular_velocity),
        }
    }

    /// The time of an event in the recording: what the recorder's filters delay all channels by is part of its interval, and of no other.
    fn time(&self, time_s: f64, u_s: f64) -> Estimate {
        let rates_hz = self.channels.iter().filter(|c| c.axis == Axis::Transverse).map(|c| c.sample_rate_hz);
        let delay_s = CHAIN_DELAY_SAMPLES / rates_hz.fold(f64::INFINITY, f64::min);
        Estimate::new(time_s, (fit::COVERAGE * u_s).hypot(delay_s), "s")
    }

    fn slap_down(&self) -> SlapDown {
        let time = self.events.slap_down_s.map(|t| self.time(t, self.u_events_s[2]));
        let q = self.quantities.as_ref();
        SlapDown {
            time,
            flight_time: q.and_then(|q| q.flight_time),
            speed: q.and_then(|q| q.speed),
            vertical_velocity: q.and_then(|q| q.vertical_velocity),
            horizontal_velocity: q.and_then(|q| q.horizontal_velocity),
            angle: q.and_then(|q| q.angle),
            second_end_height: q.and_then(|q| q.second_end_height),
        }
    }

    /// Rod and body: the four borderline cases, and the cask file's contact law with the measured k.
    fn predictions(&self) -> Vec<crate::data::Prediction> {
        let drop = &self.cask_file.drop;
        let mut all = Vec::new();
        for body in predict::bodies(&self.cask_file.cask) {
            all.extend(predict::borderline_cases(&body, drop));
            if let Some(k) = self.quantities.as_ref().map(|q| q.k.value.clamp(0.0, 1.0)) {
                all.push(predict::predict(&body, drop, self.cask_file.contact, k));
            }
        }
        all
    }
}

/// Geometry and initial motion of a cask file, L sticking to the target.
pub(crate) fn sticking(cask_file: &CaskFile) -> Setup {
    Setup {
        length_m: cask_file.cask.length_m,
        height_m: cask_file.cask.height_m,
        cog_m: cask_file.cask.cog_m,
        angle_rad: cask_file.drop.angle_rad,
        impact_velocity_m_s: cask_file.drop.impact_velocity_m_s,
        gravity_m_s2: cask_file.drop.gravity_m_s2,
        axial: crate::data::AxialClosure::Sticking,
        second_s: 1.0,
    }
}

fn summary(channel: &crate::data::Channel) -> ChannelSummary {
    ChannelSummary {
        name: channel.name.clone(),
        end: channel.end,
        axis: channel.axis,
        source: channel.source.clone(),
        samples: channel.samples.len(),
        sample_rate_hz: channel.sample_rate_hz,
        unit: format!("{} ({})", channel.unit, channel.unit_origin),
        offset_m_s2: None,
        noise_m_s2: None,
        peak_filtered_m_s2: None,
        peak_raw_m_s2: None,
        clipped: Vec::new(),
    }
}
