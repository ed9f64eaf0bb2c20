//! The plain structs of the laboratory; they hold no algorithm.

mod campaign;
mod scene;
mod synthetic;
mod trial;

pub use campaign::{
    Campaign, CampaignRequest, CampaignRow, Damage, RungSaid, SceneFacts, SceneNumber, Scored, Stated,
};
pub use scene::{
    BendingMode, Chain, CrushableEnd, LooseMass, MotionStep, Scene, SceneChannel, SceneExtras,
    SimulatedMotion, Truth, slowed,
};
pub use synthetic::{SceneFile, SyntheticChannel, SyntheticRecording, WantedImpact};
pub use trial::{
    Trial, TrialDrop, TrialFate, TrialLimit, TrialMachine, TrialMap, TrialPoint, TrialRequest, TrialSize,
};
