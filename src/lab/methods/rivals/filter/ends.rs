//! A record to the same with both ends continued in one of several ways.

use crate::numerics::filter::ends::continued;
use crate::numerics::filter::stage::{Sample, constant};

/// Samples by which `OddNine` continues: three times the coefficients of a second-order section, as `scipy.signal.sosfiltfilt` does.
const NINE: usize = 9;

/// How a record is continued beyond its ends.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum EndPadding {
    /// Point reflection in the end sample for the filter's memory: lines go on as lines; the end sample keeps its noise.
    Odd,
    /// Point reflection for 9 samples, whatever the filter's memory.
    OddNine,
    /// Mirrored for the filter's memory: the ends keep the filter's own noise; a slope becomes a kink.
    #[default]
    Even,
    /// Not at all; the states at both ends are those for which forward-back and back-forward agree best (Gustafsson 1996).
    /// A record of fewer samples than four times the order does not tell them.
    Gustafsson,
    /// Not at all; the filter begins at rest at both ends.
    Zero,
}

impl EndPadding {
    /// All of them, the default first.
    pub const ALL: [Self; 5] = [Self::Even, Self::Odd, Self::OddNine, Self::Gustafsson, Self::Zero];

    /// Its name.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Odd => "odd",
            Self::OddNine => "odd, 9 samples",
            Self::Even => "even",
            Self::Gustafsson => "Gustafsson",
            Self::Zero => "none",
        }
    }

    /// The samples with their continuation by up to `memory`, and how much of it stands in front.
    pub(super) fn extended<T: Sample>(self, samples: &[T], memory: usize) -> (Vec<T>, usize) {
        let two = constant::<T>(2.0);
        match self {
            Self::Even => continued(samples, memory, |_, x| x),
            Self::Odd => continued(samples, memory, |end, x| two * end - x),
            Self::OddNine => continued(samples, NINE, |end, x| two * end - x),
            Self::Gustafsson | Self::Zero => (samples.to_vec(), 0),
        }
    }
}
