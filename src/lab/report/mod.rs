//! A synthetic recording to its files, a trial to its page, pictures and tables.

mod synthetic;
mod trial;

pub use synthetic::{SyntheticFormat, synthetic_files, synthetic_names};
pub use trial::{TRIAL_NAMES, trial_files, trial_outcome};
