//! Two passes of a Butterworth low-pass in every form and with every continuation of the ends.

mod ends;
mod fourier;
mod gustafsson;
mod low_pass;
mod stage;

pub use ends::EndPadding;
pub use low_pass::{FilterForm, LowPass};
