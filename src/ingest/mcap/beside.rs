//! What a message says of the samples in it to the samples as it means them.

use super::plan::{Beside, Field, Says, Slots, StatedRate, Value};
use crate::data::Samples;
use crate::ingest::refusal::Refusal;
use crate::ingest::shown::show;
use crate::numerics::as_count;
use std::borrow::Cow;

/// What a message says of the samples of one field.
#[derive(Debug, Default)]
pub(super) struct SaidBeside<'a> {
    /// Their time, understood or not.
    pub(super) stamp: Option<&'a Value>,
    pub(super) sensor: Option<(Cow<'a, str>, &'a Beside)>,
    pub(super) unit: Option<&'a str>,
    /// The nearest first, whatever their values.
    pub(super) rates: Vec<StatedRate>,
    /// The time of each of their array, and its field.
    times: Option<(&'a Samples, &'a Beside)>,
    /// What else is said by a number, the nearest first.
    numbers: Vec<(f64, &'a Beside)>,
}

impl Slots {
    /// What the message says of the samples of `field`, the nearest of each.
    pub(super) fn beside<'a>(&'a self, field: &'a Field) -> SaidBeside<'a> {
        let mut said = SaidBeside::default();
        let words = |slot: usize| match self.values.get(slot) {
            Some(Value::Text(words)) => Some(words),
            _ => None,
        };
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
                (Says::Sensor, Some(Value::Number { value, .. })) => {
                    said.sensor.get_or_insert_with(|| (value.to_string().into(), beside));
                }
                (Says::Rate { meaning, level, unit }, Some(&Value::Number { value, .. })) => {
                    let (name, unit) = (beside.field.as_str().into(), unit.and_then(words).cloned());
                    said.rates.push(StatedRate { name, meaning, level, value, unit });
                }
                (Says::Time | Says::Times, Some(Value::Array(all))) => {
                    said.times.get_or_insert((all, beside));
                }
                (Says::Factor, Some(Value::Array(all))) if !all.is_empty() => {
                    let fraction = (0..all.len()).map(|at| all.get(at)).find(|x| x.fract() != 0.0);
                    said.numbers.push((fraction.unwrap_or_else(|| all.get(0)), beside));
                }
                (_, Some(Value::Number { value, .. })) => said.numbers.push((*value, beside)),
                _ => {}
            }
        }
        said
    }
}

impl SaidBeside<'_> {
    /// The number that is their time, and its field.
    pub(super) fn tick(&self) -> Option<(f64, &Beside)> {
        self.nearest(|says| says == Says::Time)
    }

    /// Numbers that may be factors of the samples, each with its field, where no scale is applied.
    pub(super) fn factors(&self) -> impl Iterator<Item = (f64, &Beside)> {
        let is_scaled = self.nearest(|says| says == Says::Scale).is_some();
        self.numbers.iter().filter(move |(_, beside)| beside.says == Says::Factor && !is_scaled).copied()
    }

    /// The times of so many samples in an array, and their field.
    pub(super) fn times(&self, count: usize) -> Option<(&Samples, &Beside)> {
        self.times.filter(|(times, _)| times.len() == count)
    }

    /// Numbers of whose names nothing is known.
    pub(super) fn others(&self) -> impl Iterator<Item = (f64, &Beside)> {
        self.numbers.iter().filter(|(_, beside)| beside.says == Says::Other).copied()
    }

    fn nearest(&self, is_it: impl Fn(Says) -> bool) -> Option<(f64, &Beside)> {
        self.numbers.iter().find(|(_, beside)| is_it(beside.says)).copied()
    }

    /// The samples as the message means them: the valid ones, value = raw · scale + offset; `is_settled`
    /// where the cask file states what is not done here.
    ///
    /// # Errors
    /// It says what is not done here.
    pub(super) fn applied(&self, mut value: Value, is_settled: bool) -> Result<Value, Refusal> {
        let number = |says: Says| self.nearest(|own| own == says);
        let [scale, count, turns] = [Says::Scale, Says::Count, Says::Turns].map(|s| Some(number(s)?.0));
        if let (Some(turns), Value::Array(_)) = (turns.filter(|turns| *turns > 1.0), &value) {
            return Err(Refusal::new(
                format!("by its layout each message holds {} signals by turns in one array", show(turns)),
                "name one number of the array, as in `data[0]`, where a message holds one sample of each; \
                 else have the recorder write an array for each signal",
            ));
        }
        if scale == Some(0.0) && !is_settled {
            return Err(Refusal::new(
                "its messages state scale = 0 beside the samples, as a field that was never set does",
                "have the recorder write the scale, or write scale into this [[channel]] of the cask file",
            ));
        }
        // A factor of one changes nothing, nor does an offset of zero.
        let is_apart = |(number, _): &(f64, &Beside)| (*number - 1.0).abs() > f64::EPSILON;
        let conversion = number(Says::Conversion).filter(is_apart);
        let offset = number(Says::Offset).filter(|(number, _)| *number != 0.0);
        let scale = scale.filter(|scale| *scale != 0.0);
        if let (None, Some((number, beside)), false) = (scale, conversion.or(offset), is_settled) {
            return Err(Refusal::new(
                format!(
                    "its messages state {} = {} beside the samples, and nothing says whether these are \
                     converted by it already",
                    beside.field,
                    show(number)
                ),
                "write scale into this [[channel]] of the cask file, scale = 1 where they are converted; or \
                 have the recorder write `scale` and `offset` beside them: value = raw · scale + offset",
            ));
        }
        if let (Some(count), Value::Array(samples)) = (count, &mut value) {
            samples.truncate(as_count(count));
        }
        if let Some(scale) = scale {
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
