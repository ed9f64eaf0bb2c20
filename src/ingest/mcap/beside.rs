//! What a message says of the samples in it to the samples as it means them.

use super::plan::{Beside, Field, Says, Slots, StatedRate, Value};
use crate::data::Samples;
use crate::ingest::refusal::Refusal;
use crate::ingest::shown::short;
use crate::numerics::as_count;
use std::borrow::Cow;

/// What a message says of the samples of one field.
#[derive(Debug, Default)]
pub(super) struct SaidBeside<'a> {
    /// Their time, understood or not.
    pub(super) stamp: Option<&'a Value>,
    /// A number that is their time, and its field.
    pub(super) tick: Option<(f64, &'a Beside)>,
    pub(super) sensor: Option<(Cow<'a, str>, &'a Beside)>,
    pub(super) unit: Option<&'a str>,
    /// The nearest first, whatever their values.
    pub(super) rates: Vec<StatedRate>,
    scale: Option<f64>,
    offset: Option<(f64, &'a Beside)>,
    conversion: Option<(f64, &'a Beside)>,
    count: Option<f64>,
    turns: Option<f64>,
}

impl Slots {
    /// What the message says of the samples of `field`, the nearest of each.
    pub(super) fn beside<'a>(&'a self, field: &'a Field) -> SaidBeside<'a> {
        let mut said = SaidBeside::default();
        for beside in &field.beside {
            match (beside.says, self.values.get(beside.slot)) {
                (Says::Stamp, Some(stamp @ (Value::Stamp(_) | Value::BadStamp))) => {
                    said.stamp.get_or_insert(stamp);
                }
                (Says::Unit, Some(Value::Text(words))) if !words.trim().is_empty() => {
                    said.unit.get_or_insert(words);
                }
                (Says::Sensor, Some(Value::Text(words))) => {
                    said.sensor.get_or_insert((Cow::Borrowed(words), beside));
                }
                (_, Some(Value::Number { value, .. })) => said.number(*value, beside, self),
                _ => {}
            }
        }
        said
    }
}

impl<'a> SaidBeside<'a> {
    /// Takes a number.
    fn number(&mut self, number: f64, beside: &'a Beside, slots: &Slots) {
        match beside.says {
            Says::Time(_) => _ = self.tick.get_or_insert((number, beside)),
            Says::Scale => _ = self.scale.get_or_insert(number),
            Says::Offset => _ = self.offset.get_or_insert((number, beside)),
            Says::Conversion => _ = self.conversion.get_or_insert((number, beside)),
            Says::Count => _ = self.count.get_or_insert(number),
            Says::Turns => _ = self.turns.get_or_insert(number),
            Says::Sensor => _ = self.sensor.get_or_insert((number.to_string().into(), beside)),
            Says::Rate { meaning, level, unit } => {
                let name = beside.field.as_str().into();
                let unit = match unit.and_then(|slot| slots.values.get(slot)) {
                    Some(Value::Text(unit)) => Some(unit.clone()),
                    _ => None,
                };
                self.rates.push(StatedRate { name, meaning, level, value: number, unit });
            }
            Says::Stamp | Says::Unit => {}
        }
    }

    /// The samples as the message means them: the valid ones, value = raw · scale + offset.
    ///
    /// # Errors
    /// It says what is not done here.
    pub(super) fn applied(&self, mut value: Value) -> Result<Value, Refusal> {
        if let (Some(turns), Value::Array(_)) = (self.turns.filter(|turns| *turns > 1.0), &value) {
            return Err(Refusal::new(
                format!("by its layout each message holds {} signals by turns in one array", short(turns)),
                "name one number of the array, as in `data[0]`, where a message holds one sample of each; \
                 else have the recorder write an array for each signal",
            ));
        }
        // A factor of one changes nothing, nor does an offset of zero.
        let is_apart = |(number, _): &(f64, &Beside)| (*number - 1.0).abs() > f64::EPSILON;
        let conversion = self.conversion.filter(is_apart);
        let offset = self.offset.filter(|(number, _)| *number != 0.0);
        if let (None, Some((number, beside))) = (self.scale, conversion.or(offset)) {
            return Err(Refusal::new(
                format!(
                    "its messages state {} = {} beside the samples, and nothing says whether these are \
                     converted by it already",
                    beside.field,
                    short(number)
                ),
                "have the recorder write `scale` and `offset` beside them: value = raw · scale + offset; \
                 scale = 1 where they are converted",
            ));
        }
        if let (Some(count), Value::Array(samples)) = (self.count, &mut value) {
            samples.truncate(as_count(count));
        }
        if let Some(scale) = self.scale {
            let offset = offset.map_or(0.0, |(number, _)| number);
            match &mut value {
                Value::Number { value, is_narrow } => (*value, *is_narrow) = (*value * scale + offset, false),
                Value::Array(samples) => {
                    let wide = std::mem::replace(samples, Samples::F64(Vec::new())).into_f64();
                    *samples = Samples::F64(wide.into_iter().map(|raw| raw * scale + offset).collect());
                }
                _ => {}
            }
        }
        Ok(value)
    }
}

#[cfg(test)]
#[path = "beside_tests.rs"]
mod tests;
