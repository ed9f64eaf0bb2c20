//! What grows until the analysis fails: of the recorder, of what is stated, of the drop itself.

mod drop;
mod recorder;
mod statements;

use super::scene::STANDARD_GRAVITY_M_S2;
use super::sweep::Stress;
use crate::data::{BendingMode, Contact};

pub(super) use drop::DROPS;
pub(super) use recorder::RECORDER;
pub(super) use statements::STATEMENTS;

/// A stress on a logarithmic axis whose map is of the speed alone.
const COMMON: Stress =
    Stress { name: "", title: "", axis: "", is_log: true, values: &[], tells_k: false, apply: |_, _, _| {} };
