//! A column, row or field of a dataset to its numbers.

use super::answer::{Field, Number, Slab, Storage};
use super::attributes;
use super::fault::Fault;
use super::packed::{self, Stored};
use super::room::Found;
use crate::data::{Issue, Samples};
use crate::ingest::time_reading::{Carrier, Reading, Scale};

/// One channel's numbers in a file: a dataset, a column or row of one, or a field of its records.
#[derive(Clone)]
pub(super) struct Column {
    pub dataset: Found,
    /// Which of several channels in one dataset.
    pub index: Option<usize>,
    /// Number of channels in the dataset, or in the field of its records.
    pub columns: usize,
    /// The dataset's path.
    pub name: String,
    /// Number of samples.
    pub length: usize,
    pub number: Number,
    pub place: Place,
}

/// Where the numbers of a channel lie in its dataset.
#[derive(Clone)]
pub(super) enum Place {
    /// They are all of it.
    Whole,
    /// In a column.
    Column,
    /// In a row.
    Row,
    /// In a field of its records, of this name.
    Field(Field, String),
}

impl Column {
    /// What to write as `source`.
    pub(super) fn source(&self) -> String {
        let name = match &self.place {
            Place::Field(_, field) => format!("{}.{field}", self.name),
            _ => self.name.clone(),
        };
        self.index.map_or(name.clone(), |index| format!("{name}[{index}]"))
    }

    /// What it is, for people.
    pub(super) fn kind_name(&self) -> &'static str {
        match self.place {
            Place::Field(..) => "field",
            Place::Row => "row",
            Place::Column => "column",
            Place::Whole if self.index.is_some() => "column",
            Place::Whole => "dataset",
        }
    }

    /// The last part of its name, which may tell its unit.
    pub(super) fn bare_name(&self) -> &str {
        match &self.place {
            Place::Field(_, field) => field,
            _ => self.name.rsplit_once('/').map_or(&self.name, |(_, name)| name),
        }
    }

    /// The dataset whose records it is a field of.
    pub(super) fn records(&self) -> Option<&str> {
        matches!(self.place, Place::Field(..)).then_some(self.name.as_str())
    }

    /// The group it lies in, without a trailing slash.
    pub(super) fn group(&self) -> &str {
        self.name.rsplit_once('/').map_or("", |(group, _)| group)
    }

    pub(super) fn len(&self) -> usize {
        self.length
    }

    /// Memory of its numbers when they are read, of the widest kind.
    pub(super) fn held_bytes(&self) -> u64 {
        8 * self.length as u64
    }

    /// Memory of the largest block that the library must unpack, or that is read at once, to have them.
    pub(super) fn part_bytes(&self) -> u64 {
        let Storage::Chunked { shape: chunk, .. } = &self.dataset.storage else { return 0 };
        let values = chunk.iter().fold(1_u64, |product, &n| product.saturating_mul(n as u64));
        match &self.place {
            Place::Field(..) => values.saturating_mul(self.dataset.value_bytes),
            Place::Column => {
                let rows = chunk.first().copied().unwrap_or(1) as u64;
                8_u64.saturating_mul(values.max(rows.saturating_mul(self.columns as u64)))
            }
            Place::Whole | Place::Row => 8_u64.saturating_mul(values),
        }
    }

    /// Its numbers as stored: f32 and short integers as f32, the rest as f64.
    pub(super) fn samples(&self) -> Result<Samples, Fault> {
        Ok(match self.number {
            Number::F32 => Samples::F32(self.read()?),
            Number::I8 => Samples::F32(self.read::<i8>()?.into_iter().map(f32::from).collect()),
            Number::I16 => Samples::F32(self.read::<i16>()?.into_iter().map(f32::from).collect()),
            Number::U8 => Samples::F32(self.read::<u8>()?.into_iter().map(f32::from).collect()),
            Number::U16 => Samples::F32(self.read::<u16>()?.into_iter().map(f32::from).collect()),
            _ => Samples::F64(self.wide()?),
        })
    }

    #[allow(clippy::cast_precision_loss, reason = "counts beyond 2^53 lose what no sensor resolves")]
    fn wide(&self) -> Result<Vec<f64>, Fault> {
        Ok(match self.number {
            Number::I64 => self.read::<i64>()?.into_iter().map(|x| x as f64).collect(),
            Number::U64 => self.read::<u64>()?.into_iter().map(|x| x as f64).collect(),
            Number::U32 => self.read::<u32>()?.into_iter().map(f64::from).collect(),
            Number::I32 => self.read::<i32>()?.into_iter().map(f64::from).collect(),
            _ => self.read::<f64>()?,
        })
    }

    /// Its numbers as times, s, and a question where their unit is a guess: its own attributes `unit`, `scale` and `offset` are followed.
    pub(super) fn times_s(&self, declared_rate_hz: Option<f64>) -> Result<(Vec<f64>, Option<Issue>), Fault> {
        let mut times_s = match self.samples()? {
            Samples::F32(times) => times.into_iter().map(f64::from).collect(),
            Samples::F64(times) => times,
        };
        let (counted, scale, offset) = attributes::time_scale(self)?;
        #[allow(clippy::float_cmp, reason = "exactly the values that stand for nothing to do")]
        let mut apply = |scale: f64, offset: f64| {
            if scale != 1.0 || offset != 0.0 {
                for t in &mut times_s {
                    *t = t.mul_add(scale, offset);
                }
            }
        };
        if let Scale::Known(unit_s) = counted {
            apply(unit_s * scale, unit_s * offset);
            return Ok((times_s, None));
        }
        apply(scale, offset);
        if let Scale::Twofold(..) = counted
            && declared_rate_hz.is_none()
        {
            return Err(Fault {
                problem: format!("the times of {} are in another unit by its name than by its unit", self.source()),
                mend: "correct the one that is wrong in a copy, or write sample_rate_hz in each [[channel]], which tells them apart"
                    .into(),
            });
        }
        let reading = Reading::of(counted, &times_s, declared_rate_hz);
        let source = self.source();
        let carrier = if self.records().is_some() { Carrier::Field } else { Carrier::Dataset };
        if let Some(doubt) = reading.doubt.as_ref().filter(|doubt| doubt.is_grave()) {
            let problem = doubt.problem(&source, carrier);
            return Err(Fault { problem, mend: doubt.mend(carrier) });
        }
        reading.apply(&mut times_s);
        let issue = reading.issue(&source, carrier);
        Ok((times_s, issue))
    }

    fn read<T: Stored>(&self) -> Result<Vec<T>, Fault> {
        let index = self.index.unwrap_or(0);
        let slab = match &self.place {
            Place::Field(field, _) => return self.read_field(field),
            Place::Whole => Slab::Whole,
            Place::Row => Slab::Row(index),
            Place::Column => Slab::Column(index),
        };
        let is_down = self.dataset.shape.as_ref().and_then(|shape| shape.first()) == Some(&self.length);
        let packed = if is_down { packed::column(&self.dataset, index) } else { None };
        packed.map_or_else(|| self.dataset.file.values(&self.name, slab, self.length), Ok)
    }

    fn read_field<T: Stored>(&self, field: &Field) -> Result<Vec<T>, Fault> {
        packed::field(&self.dataset, field).ok_or_else(|| Fault {
            problem: format!(
                "{}: its records are damaged, or packed in a way that is not read",
                self.source()
            ),
            mend: "copy the file from the logger again, or repack it with gzip: `h5repack -f GZIP=1 IN OUT`"
                .into(),
        })
    }
}
