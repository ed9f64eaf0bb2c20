//! What a message says of the samples in it to the samples as it means them.

use super::plan::{Beside, Says, Slots, Target, Value};
use crate::data::Samples;
use crate::ingest::clock::Refusal;
use crate::ingest::shown::short;
use std::borrow::Cow;

/// What a message says of the samples of one field.
#[derive(Debug, Default)]
pub(super) struct SaidBeside<'a> {
    /// A number that is their time, and its field.
    pub(super) tick: Option<(f64, &'a Beside)>,
    pub(super) sensor: Option<(Cow<'a, str>, &'a Beside)>,
    scale: Option<f64>,
    offset: Option<(f64, &'a Beside)>,
    conversion: Option<(f64, &'a Beside)>,
    count: Option<f64>,
    turns: Option<f64>,
}

impl Slots {
    /// What the message says of the samples of `target`, the nearest of each.
    pub(super) fn beside<'a>(&'a self, target: &'a Target) -> SaidBeside<'a> {
        let mut said = SaidBeside::default();
        for beside in &target.beside {
            let number = match self.values.get(beside.slot) {
                Some(Value::Number { value, .. }) => *value,
                Some(Value::Text(words)) if beside.says == Says::Sensor => {
                    said.sensor.get_or_insert((Cow::Borrowed(words), beside));
                    continue;
                }
                _ => continue,
            };
            match beside.says {
                Says::Time(_) => _ = said.tick.get_or_insert((number, beside)),
                Says::Scale => _ = said.scale.get_or_insert(number),
                Says::Offset => _ = said.offset.get_or_insert((number, beside)),
                Says::Conversion => _ = said.conversion.get_or_insert((number, beside)),
                Says::Count => _ = said.count.get_or_insert(number),
                Says::Turns => _ = said.turns.get_or_insert(number),
                Says::Sensor => _ = said.sensor.get_or_insert((number.to_string().into(), beside)),
                Says::Rate(_) | Says::Unit => {}
            }
        }
        said
    }
}

impl SaidBeside<'_> {
    /// The samples as the message means them: the valid ones, value = raw · scale + offset.
    ///
    /// # Errors
    /// It says what is not done here.
    pub(super) fn applied(&self, mut value: Value) -> Result<Value, Refusal> {
        if let (Some(turns), Value::Array(_)) = (self.turns.filter(|turns| *turns > 1.0), &value) {
            return Err(Refusal::new(
                format!("by its layout each message holds {} signals by turns in one array", short(turns)),
                "name one number of the array, as in `data[0]`, where a message holds one sample of each; else have the recorder write an \
                 array for each signal",
            ));
        }
        // A factor of one changes nothing, nor does an offset of zero.
        let is_apart = |(number, _): &(f64, &Beside)| (*number - 1.0).abs() > f64::EPSILON;
        let conversion = self.conversion.filter(is_apart);
        let offset = self.offset.filter(|(number, _)| *number != 0.0);
        if let (None, Some((number, beside))) = (self.scale, conversion.or(offset)) {
            return Err(Refusal::new(
                format!(
                    "its messages state {} = {} beside the samples, and nothing says whether these are converted by it already",
                    beside.field,
                    short(number)
                ),
                "have the recorder write `scale` and `offset` beside them: value = raw · scale + offset; scale = 1 where they are converted",
            ));
        }
        if let (Some(count), Value::Array(samples)) = (self.count, &mut value) {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "saturates; a larger one changes nothing"
            )]
            samples.truncate(count as usize);
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
