//! Files of a synthetic recording; page, pictures and tables of a trial.

mod synthetic;
mod trial;

pub use synthetic::{SyntheticFormat, synthetic_files, synthetic_names};
pub use trial::{TRIAL_NAMES, trial_files, trial_outcome};
