//! A study of the drop angle: sweeps, curves, critical angles and Monte Carlo.

use super::cask::Contact;
use super::cask_file::CaskFile;
use super::ladder::Ladder;
use super::plan::MeasuringPlan;
use super::prediction::{Body, BodyModel, Prediction};
use serde::Serialize;

/// Variable of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SweepVariable {
    /// Inclination at first contact, degrees.
    Angle,
    /// Coefficient of restitution.
    K,
    /// Coulomb coefficient.
    Friction,
    /// Length of the cask, m; the centre of gravity keeps its share of it, the inertia scales with l² + h².
    Length,
    /// Height of the drop, m.
    DropHeight,
}

/// The values that a sweep takes, in the unit of its variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// Variable.
    pub variable: SweepVariable,
    /// Values, ascending.
    pub values: Vec<f64>,
}

/// A prediction and where it was made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictionRow {
    /// Inclination at first contact, degrees.
    pub angle_deg: f64,
    /// Length of the cask, m.
    pub length_m: f64,
    /// Height of the drop, m.
    pub drop_height_m: f64,
    /// True if the cask turns over before R strikes, [`Prediction::turns_over`].
    pub turns_over: bool,
    /// Prediction of the model.
    #[serde(flatten)]
    pub prediction: Prediction,
}

/// Request of a study besides its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRequest {
    /// Contact laws, one or several.
    pub contacts: Vec<Contact>,
    /// Coefficients of restitution, one or several.
    pub ks: Vec<f64>,
    /// Inclination of results at a single angle, degrees.
    pub angle_deg: f64,
    /// Sweeps; the rows are their product.
    pub sweeps: Vec<Sweep>,
    /// Inclinations of the curves and critical angles, degrees, ascending.
    pub angles_deg: Vec<f64>,
    /// Width of the critical bands, percent of the largest value.
    pub band_percent: f64,
    /// Uncertain inputs of the Monte Carlo draws.
    pub uncertain: Uncertain,
}

/// Inputs that are not known before a test. Half-widths hold 95 % of a normal distribution, ranges are
/// uniform.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Uncertain {
    /// Range of k.
    pub k: (f64, f64),
    /// Range of the Coulomb coefficient; `None`: the contact law is known.
    pub friction: Option<(f64, f64)>,
    /// Range of the length of the first contact, s; 0 is an impulse.
    pub contact_s: (f64, f64),
    /// Half-width of the angle, degrees.
    pub angle_deg: f64,
    /// Half-width of the impact velocity, share of it.
    pub impact_velocity: f64,
    /// Half-width of the rotation at first contact, degrees per second.
    pub angular_velocity_deg_s: f64,
    /// Half-width of the sideways velocity at first contact, m/s.
    pub horizontal_velocity_m_s: f64,
    /// Half-width of the length, share of it.
    pub length: f64,
    /// Half-width of the section, share of it.
    pub height: f64,
    /// Half-width of the centre of gravity, share of the length.
    pub cog: f64,
    /// Half-width of the inertia, share of it.
    pub inertia: f64,
    /// Draws.
    pub draws: u32,
    /// Seed: the same seed gives the same draws on every machine.
    pub seed: u64,
}

/// The slap-down over the angle for one body, contact law and k; NaN where R never strikes.
#[derive(Debug, Clone, PartialEq)]
pub struct AngleCurve {
    /// Rod or body.
    pub model: BodyModel,
    /// Section in the plane of the drop, m.
    pub height_m: f64,
    /// The contact law.
    pub contact: Contact,
    /// Coefficient of restitution.
    pub k: f64,
    /// Inclinations, degrees, ascending.
    pub angle_deg: Vec<f64>,
    /// Magnitude of R's velocity, m/s.
    pub speed_m_s: Vec<f64>,
    /// Vertical component, negative down, m/s.
    pub vertical_velocity_m_s: Vec<f64>,
    /// Horizontal component, m/s.
    pub horizontal_velocity_m_s: Vec<f64>,
    /// Kinetic energy before slap-down over that before the first impact.
    pub energy_ratio: Vec<f64>,
    /// Speed for k = 0 by the closed form of \[P\] Table 2, m/s; NaN for k > 0.
    pub closed_form_speed_m_s: Vec<f64>,
    /// True if the cask turns over before R strikes, [`Prediction::turns_over`].
    pub turns_over: Vec<bool>,
}

/// Position of a body at a time after first contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Time since first contact, s.
    pub time_s: f64,
    /// S along the target from where L touched, m, positive towards R.
    pub along_m: f64,
    /// S above the target, m.
    pub height_m: f64,
    /// Inclination of the axis above the horizontal, rad.
    pub angle_rad: f64,
}

/// Positions of a body from first contact to the slap-down (\[P\] Figs. 2 and 3).
#[derive(Debug, Clone, PartialEq)]
pub struct BodyPath {
    /// Body that moves.
    pub body: Body,
    /// The contact law.
    pub contact: Contact,
    /// Coefficient of restitution.
    pub k: f64,
    /// The first as L touches, the last as R does.
    pub poses: Vec<Pose>,
}

/// Quantity that is largest at a critical angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Slap-down speed, m/s.
    Speed,
    /// Vertical component of the speed, m/s, positive down.
    VerticalSpeed,
    /// Kinetic energy that remains for the second impact, over that before the first.
    EnergyRatio,
}

impl Criterion {
    /// All criteria.
    pub const ALL: [Self; 3] = [Self::Speed, Self::VerticalSpeed, Self::EnergyRatio];
}

/// Angle at which a criterion is largest for one body, contact law and k among [single
/// slap-downs](Prediction::is_single_slap_down); NaN if there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CriticalAngle {
    /// Rod or body.
    pub model: BodyModel,
    /// The contact law.
    pub contact: Contact,
    /// Coefficient of restitution.
    pub k: f64,
    /// Criterion that is largest.
    pub criterion: Criterion,
    /// Angle, degrees.
    pub angle_deg: f64,
    /// Largest value, in the criterion's unit.
    pub largest: f64,
    /// Angles at which the criterion is within the chosen percentage of the largest value, degrees; more than
    /// one band if the curve has several humps.
    pub bands_deg: Vec<(f64, f64)>,
    /// Angle, degrees, and value of a larger result among the angles at which L strikes again before R.
    pub further_impacts: Option<(f64, f64)>,
}

/// Quantiles over the draws, one entry an angle; NaN where fewer than half of the draws have a
/// [single slap-down](Prediction::is_single_slap_down).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuantileCurves {
    /// Criterion.
    pub criterion: Criterion,
    /// 2.5 %.
    pub q025: Vec<f64>,
    /// 25 %.
    pub q25: Vec<f64>,
    /// 50 %.
    pub q50: Vec<f64>,
    /// 75 %.
    pub q75: Vec<f64>,
    /// 97.5 %.
    pub q975: Vec<f64>,
    /// Share of the draws whose value at this nominal angle lies within the band of that draw's own largest.
    pub in_band: Vec<f64>,
    /// 2.5, 25, 50, 75 and 97.5 % quantile of the critical angle over the draws, degrees.
    pub critical_angle_deg: [f64; 5],
    /// Quantiles of the largest value.
    pub largest: [f64; 5],
    /// Number of draws whose critical angle is nearest to each of the angles.
    pub critical_counts: Vec<u32>,
    /// Angles at which at least 95 % of the draws lie within their band, degrees.
    pub robust_bands_deg: Vec<(f64, f64)>,
}

/// Critical angles that follow from the uncertain inputs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MonteCarlo {
    /// Rod or body: the richest that the cask file describes.
    pub model: BodyModel,
    /// The contact law where it is known.
    pub contact: Contact,
    /// Uncertain inputs of the draws.
    pub uncertain: Uncertain,
    /// Width of the bands, percent of the largest value.
    pub band_percent: f64,
    /// Nominal inclinations, degrees.
    pub angle_deg: Vec<f64>,
    /// Share of the draws without a single slap-down at each angle.
    pub no_slap_down: Vec<f64>,
    /// Quantiles of each criterion.
    pub quantiles: Vec<QuantileCurves>,
}

/// Recommended drop angle and expected slap-down speed by the richest body that the cask file describes, over
/// all draws and requested cases.
///
/// Only a [single slap-down](Prediction::is_single_slap_down) counts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    /// The widest of the robust bands of the speed, without angles that may be flat, degrees.
    pub band_deg: Option<(f64, f64)>,
    /// The largest slap-down speed, m/s: no draw, case or row exceeds it. NaN if there is none.
    pub largest_m_s: f64,
    /// Angle of that speed, degrees.
    pub at_deg: f64,
    /// The angle of the request, degrees.
    pub own_deg: f64,
    /// Median of the draws there, m/s; NaN where fewer than half of them slap down.
    pub own_m_s: f64,
    /// Their 2.5 and 97.5 % quantile, m/s.
    pub own_range_m_s: (f64, f64),
    /// Share of the draws that slap down there.
    pub own_share: f64,
    /// Uncertain inputs of the draws.
    pub drawn: Uncertain,
}

/// Everything that a study found.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The cask.
    pub cask_file: CaskFile,
    /// Request of the study.
    pub request: StudyRequest,
    /// The predictions asked for.
    pub rows: Vec<PredictionRow>,
    /// Paths of the richest body at the angle of the request, for two contact laws and k each, if it makes
    /// one flight or L is held.
    pub paths: Vec<BodyPath>,
    /// All models for every contact law and k, at the angle of the request.
    pub ladders: Vec<Ladder>,
    /// Results over the angle: every body, contact law and k of the request.
    pub curves: Vec<AngleCurve>,
    /// Results over the angle, smooth and k = 1: the cask's length with a section of 0, 10, 500 and 600 mm
    /// and its own (\[P\] Fig. 9).
    pub sections: Vec<AngleCurve>,
    /// Critical angle of every curve and criterion.
    pub critical: Vec<CriticalAngle>,
    /// Distribution that follows from the uncertain inputs.
    pub monte_carlo: MonteCarlo,
    /// Recommended drop angle.
    pub advice: Advice,
    /// Plan for measuring the drop at the requested angle; `None` for the prediction alone.
    pub plan: Option<MeasuringPlan>,
}
