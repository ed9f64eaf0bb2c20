//! A measured quantity with its 95 % interval, and a time with its standard uncertainty.

use serde::de::{Deserialize, Deserializer, Error};
use serde::ser::{Serialize, SerializeStruct, Serializer};

/// A measured value with the half-width of its 95 % interval and its unit, as the result states it.
///
/// `value` and `u95` are in `unit`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value, in `unit`.
    pub value: f64,
    /// Half-width of the 95 % interval, in `unit`.
    pub u95: f64,
    /// The unit, as written in the result.
    pub unit: &'static str,
}

impl Estimate {
    /// A value, its 95 % half-width and their unit.
    pub fn new(value: f64, u95: f64, unit: &'static str) -> Self {
        Self { value, u95, unit }
    }

    /// Converts a value of a model of this scale to its prototype; each unit scales by its own law   (46)
    pub fn to_prototype(self, scale: f64) -> Self {
        let power = UNITS.iter().find(|(unit, _)| *unit == self.unit).map_or(0, |(_, power)| *power);
        let factor = scale.powi(power);
        Self { value: self.value * factor, u95: self.u95 * factor, ..self }
    }
}

/// An estimate that is not finite becomes null as a whole: half a quantity is of no use.
impl Serialize for Estimate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !(self.value.is_finite() && self.u95.is_finite()) {
            return serializer.serialize_none();
        }
        let mut parts = serializer.serialize_struct("Estimate", 3)?;
        parts.serialize_field("value", &self.value)?;
        parts.serialize_field("u95", &self.u95)?;
        parts.serialize_field("unit", &self.unit)?;
        parts.end()
    }
}

/// Units of the quantities of a result, each with the power of the model scale that converts it to the
/// prototype.
const UNITS: [(&str, i32); 10] = [
    ("s", -1),
    ("m/s", 0),
    ("rad/s", 1),
    ("deg", 0),
    ("1", 0),
    ("m", -1),
    ("m/s^2", 1),
    ("N", -2),
    ("N s", -3),
    ("J", -3),
];

impl<'de> Deserialize<'de> for Estimate {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        #[derive(serde::Deserialize)]
        struct EstimateParts {
            value: f64,
            u95: f64,
            unit: String,
        }
        let EstimateParts { value, u95, unit } = EstimateParts::deserialize(from)?;
        let known = UNITS.into_iter().map(|(known, _)| known).find(|known| *known == unit);
        Ok(Self::new(value, u95, known.ok_or_else(|| D::Error::custom("no unit of a result"))?))
    }
}

/// A time and its standard uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// Time from the recording's first sample, s.
    pub time_s: f64,
    /// Standard uncertainty, s.
    pub u_s: f64,
}

impl At {
    /// A time that is known.
    pub const fn exact(time_s: f64) -> Self {
        Self { time_s, u_s: 0.0 }
    }
}
