//! The plain structs that pass between stages; they hold no algorithm.

mod analysis;
mod at;
mod cask;
mod cask_file;
mod channel;
mod check;
mod curves;
mod estimate;
#[cfg(test)]
pub(crate) mod example;
mod finding;
mod flight;
mod held;
mod impacts;
mod key;
pub(crate) mod keys;
mod ladder;
mod listing;
mod look;
mod motion;
mod onset;
mod other;
mod plan;
pub(crate) mod planar;
mod prediction;
mod prototype;
mod quantities;
mod reconstruction;
mod recording;
pub(crate) mod shown;
mod signal;
mod study;
mod test_record;
mod tolerances;
mod unit;

pub use analysis::{
    Analysis, ChannelSummary, Comparison, DropResult, Events, Input, ModelCandidate, ModelChoice, Program,
    Setting, Verdict,
};
pub use at::At;
pub use cask::{
    Axis, BENDING_WAVE_M_S, Cask, ChannelSpec, Contact, Coupling, Drop, End, FilterChoice, GRAZE_SHARE,
    MOST_CHANNELS, RowsOf, SAMPLE_RATES_HZ, SLOWEST_BENDING_HZ, Source, Unit, block_inertia_kg_m2,
};
pub use cask_file::CaskFile;
pub(crate) use channel::is_number;
pub use channel::{Channel, Extreme, RestReading, Samples, Span};
pub use check::{AtRest, BlowAnswer, Check, CheckedChannel};
pub use curves::{ChannelCurve, Curves, LazyCurves, MotionCurve};
pub use estimate::Estimate;
pub(crate) use finding::two_units;
pub use finding::{
    AttributeFinding, CODES, ChannelFinding, ClockFinding, Cure, DropFinding, During, FileEnd, Finding,
    FindingKind, HowApart, IssueCode, Jitter, McapFinding, RatesApart, RestCause, RestFinding, RotationCause,
    Severity, Slip, TableFinding, TimesApart, TimesFinding, shortened,
};
pub use flight::{FlightFit, FlightModelScore, Mode, Plateau, Strike};
pub use held::HeldSamples;
pub use impacts::{ChannelPeak, ForceOverCrush, ImpactNumbers, ImpactTable, RigidBodyDeceleration};
pub use keys::LONGEST_CONTACT_S;
pub use ladder::{LADDER_TOLERANCE_PERCENT, Ladder, LadderStep, Rung};
pub use listing::{ListedChannel, Listing};
pub use look::ChannelLook;
pub use motion::{AssumedFriction, AxialClosure, CONTACT_STEPS, Motion, MotionState, Setup, StoodIn};
pub use onset::Onset;
pub use other::{
    MeasuredRotation, OtherChannels, OtherCurve, OtherSpec, OtherSummary, RateSpec, RotationRate,
    SpectralLine,
};
pub use plan::{ChannelNeeds, ExpectedIntervals, ExpectedPeak, MeasuringPlan, RecordingNeeds};
pub use prediction::{Body, BodyModel, FlightRegime, Prediction};
pub use prototype::Prototype;
pub use quantities::{Contribution, FirstImpact, Quantities, QuantityRow, SlapDown, Untested, UntestedMoves};
pub use reconstruction::{
    Adjustment, Closure, ClosureKind, MET_U, MISSED_U, ReconstructionCandidate, ReconstructionChoice,
    ReconstructionRung, RestLevel, U_RELEASE_S,
};
pub use recording::{Recording, RecordingFormat, RestFile};
pub use signal::{CoarseEvent, MOST_LOST_M_S, Signal};
pub use study::{
    AngleCurve, BodyPath, Criterion, CriticalAngle, MonteCarlo, Pose, PredictionRow, QuantileCurves, Study,
    StudyRequest, Sweep, SweepVariable, Uncertain,
};
pub use test_record::{
    Letterhead, Limit, LimitState, Observed, ObservedBeside, Photo, SensorRecord, TestRecord,
};
pub use tolerances::{Corrections, TOLERANCES, Tolerance, Tolerances};
pub use unit::{STANDARD_GRAVITY_M_S2, acceleration_unit_m_s2, is_rate_of_turn, rate_unit_rad_s};
