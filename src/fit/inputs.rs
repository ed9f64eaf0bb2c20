//! The uncertain inputs of the reconstruction and by how much each may be off.

use super::Measured;
use crate::data::{AxialClosure, Axis, Events, FlightFit, Setup};

/// One set of inputs.
#[derive(Debug, Clone)]
pub(super) struct Inputs {
    pub flight: FlightFit,
    pub events: Events,
    pub setup: Setup,
}

impl Inputs {
    pub fn new(measured: &Measured) -> Self {
        Self { flight: measured.flight.clone(), events: *measured.events, setup: *measured.setup }
    }
}

/// One input and its standard uncertainty.
pub(super) struct Variation {
    pub name: String,
    pub size: String,
    /// What part of the change counts; 1 but for the contact law.
    pub share: f64,
    change: Change,
}

enum Change {
    Step { channel: usize, add_m_s: f64 },
    Scale { channel: usize, share: f64 },
    Position { by_m: f64, lever_m: f64, channel: usize },
    Angle { by_rad: f64 },
    ImpactVelocity { share: f64 },
    Event { which: usize, by_s: f64 },
    Law(AxialClosure),
}

impl Variation {
    /// The inputs with this one moved by `sign` standard uncertainties.
    pub fn moved(&self, inputs: &Inputs, sign: f64) -> Inputs {
        let mut moved = inputs.clone();
        let step = |flight: &mut FlightFit, channel: usize, add: f64| {
            if let Some(p) = flight.plateaus.get_mut(channel) {
                p.velocity_step_m_s += add;
            }
        };
        match self.change {
            Change::Step { channel, add_m_s } => step(&mut moved.flight, channel, sign * add_m_s),
            Change::Scale { channel, share } => {
                let value = inputs.flight.plateaus.get(channel).map_or(0.0, |p| p.velocity_step_m_s);
                step(&mut moved.flight, channel, sign * share * value);
            }
            Change::Position { by_m, lever_m, channel } => {
                // A sensor nearer to the middle by δ reads f + Ω̇ δ: its step changes by Ω δ.
                let values: Vec<f64> = inputs.flight.plateaus.iter().map(|p| p.velocity_step_m_s).collect();
                let range = values.iter().fold(0.0_f64, |m, v| m.max((v - values[channel]).abs()));
                step(&mut moved.flight, channel, sign * by_m * range / lever_m);
            }
            Change::Angle { by_rad } => moved.setup.angle_rad += sign * by_rad,
            Change::ImpactVelocity { share } => moved.setup.impact_velocity_m_s *= 1.0 + sign * share,
            Change::Event { which, by_s } => {
                let events = &mut moved.events;
                let slot = match which {
                    0 => &mut events.first_contact_s,
                    1 => &mut events.separation_s,
                    _ => &mut events.slap_down_s,
                };
                if let Some(t) = slot {
                    *t += sign * by_s;
                }
            }
            Change::Law(law) => moved.setup.axial = law,
        }
        moved
    }
}

/// Every input that is uncertain, with its size.
pub(super) fn variations(measured: &Measured) -> Vec<Variation> {
    let mut all = Vec::new();
    // Half of a 95 % half-width is a standard uncertainty.
    let known = &measured.tolerances;
    let (calibration, position_m) = (known.calibration / 2.0, known.position_m / 2.0);
    let (angle_rad, velocity) = (known.angle_rad / 2.0, known.impact_velocity / 2.0);
    let law_share = known.friction / 2.0;
    let mut add = |name: String, size: String, share: f64, change: Change| {
        all.push(Variation { name, size, share, change });
    };
    let contact_s = measured.events.first_contact_s.unwrap_or(0.0);
    let pulse_s = measured.events.separation_s.map_or(0.0, |t| t - contact_s);
    for (channel, (signal, plateau)) in measured.signals.iter().zip(&measured.flight.plateaus).enumerate() {
        if signal.axis == Axis::Axial && measured.setup.axial != AxialClosure::Measured {
            continue;
        }
        // What the fit leaves open; where a zero shift set in during the contact; what the offset may be off since.
        let shift_m_s = plateau.zero_shift_m_s2.abs() * pulse_s / 12.0_f64.sqrt();
        let drift_m_s = if measured.flight.drift {
            0.0
        } else {
            signal.u_offset_m_s2 * (pulse_s + (measured.flight.to_s - measured.flight.from_s) / 2.0)
        };
        let clipped_m_s = signal.lost_to_clipping_m_s(contact_s, measured.flight.to_s);
        let u = plateau.u_m_s.hypot(shift_m_s).hypot(drift_m_s).hypot(clipped_m_s);
        add(
            format!("velocity step of {}", signal.name),
            format!("{u:.3} m/s"),
            1.0,
            Change::Step { channel, add_m_s: u },
        );
        add(
            format!("calibration of {}", signal.name),
            format!("{:.1} %", 100.0 * calibration),
            1.0,
            Change::Scale { channel, share: calibration },
        );
        if signal.axis == Axis::Transverse {
            add(
                format!("position of {}", signal.name),
                format!("{:.0} mm", 1e3 * position_m),
                1.0,
                Change::Position { by_m: position_m, lever_m: measured.setup.length_m, channel },
            );
        }
    }
    add(
        "drop angle".into(),
        format!("{:.2}°", angle_rad.to_degrees()),
        1.0,
        Change::Angle { by_rad: angle_rad },
    );
    add(
        "impact velocity".into(),
        format!("{:.2} %", 100.0 * velocity),
        1.0,
        Change::ImpactVelocity { share: velocity },
    );
    for (which, name) in
        ["time of first contact", "time of separation", "time of slap-down"].into_iter().enumerate()
    {
        let by_s = measured.u_events_s[which];
        add(name.into(), format!("{:.3} ms", 1e3 * by_s), 1.0, Change::Event { which, by_s });
    }
    if let Some(law) = measured.other_law {
        add(
            "contact law".into(),
            format!("{:.0} % of rough to smooth", 100.0 * law_share),
            law_share,
            Change::Law(law),
        );
    }
    all
}
