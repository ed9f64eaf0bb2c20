//! dropcheck: what accelerometers on both ends of a dropped cask say about its slap-down, and whether to
//! believe it.
//!
//! A library user calls six names: [`cask_file()`] and [`read`] for what a test left behind, [`analyze`] for
//! everything that can be said of it, [`predict()`] and [`study`] for what the analytical model says, and
//! [`files`] for the report; [`data`] has what passes between them. A program of its own calls [`serve_hdf5`]
//! first in `main`, or names one that does by [`read_hdf5_with`].
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let file = dropcheck::cask_file("anf18.toml".as_ref())?;
//! let recording = dropcheck::read("test.mcap".as_ref(), &file, &|_| ())?;
//! let analysis = dropcheck::analyze(&recording, &file);
//! println!("{:?}: k is {:?}", analysis.result.verdict, analysis.result.k);
//! for (name, bytes) in dropcheck::files(&analysis)? {
//!     std::fs::write(name, bytes)?;
//! }
//! # Ok(())
//! # }
//! ```
//!
//! A recording and a cask file pass through stages in the order that `analysis` alone knows; a stage imports
//! only `data` and `numerics`.

#![cfg_attr(not(feature = "native"), allow(dead_code, unused_imports, reason = "a page asks for less"))]

mod analysis;
#[cfg(feature = "native")]
mod cli;
mod compare;
mod condition;
pub mod data;
mod events;
mod fit;
#[doc(hidden)]
pub mod ingest;
mod judge;
#[cfg(feature = "lab")]
#[doc(hidden)]
pub mod lab;
mod motion;
mod numerics;
#[cfg(feature = "native")]
#[doc(hidden)]
pub mod ordered_parallel;
#[doc(hidden)]
pub mod predict;
#[doc(hidden)]
pub mod report;

pub use analysis::{analyze, read, study};
pub use ingest::{IngestError, cask_file};
#[cfg(feature = "native")]
pub use ingest::{read_hdf5_with, serve_hdf5};
pub use predict::predict;
pub use report::{ReportError, files};

/// The command line, for the program and for another that takes its words; it changes without notice.
#[cfg(feature = "native")]
#[doc(hidden)]
pub mod command {
    #[cfg(feature = "lab")]
    pub use crate::cli::synthetic;
    pub use crate::cli::{analysis, listing, main, message, prediction, write};
}

/// Stages one by one, for benchmarks and tests; they change without notice.
#[doc(hidden)]
pub mod stages {
    pub use crate::analysis::{look_at_each, measure, read_within, sticking};
    pub use crate::condition::{Reach, condition};
    pub use crate::data::keys::{Allowed, INNER_TABLES, Key, KeyTable, TABLES, Takes};
    pub use crate::events::Changes;
    pub use crate::fit::{FitData, run_methods};
    pub use crate::motion::vector_pulses;
    pub use crate::motion::{Integrated, Window, filter, fit_flights, outcome, pulses, reconstruct};
    pub use crate::numerics::filter::LowPass;
    pub use crate::numerics::shock_response::{ShockResponse, shock_response};
    pub use crate::numerics::spectrum::magnitude;
}
