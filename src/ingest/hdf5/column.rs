//! A column, row or field of a dataset to its numbers.

use super::answer::{Field, Number, Slab, Storage, Stored};
use super::fault::Fault;
use super::packed;
use super::room::Found;
use crate::data::Samples;

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
            Number::F32 => Samples::F32(self.read::<f32, f32>()?),
            Number::I8 => Samples::F32(self.read::<i8, f32>()?),
            Number::I16 => Samples::F32(self.read::<i16, f32>()?),
            Number::U8 => Samples::F32(self.read::<u8, f32>()?),
            Number::U16 => Samples::F32(self.read::<u16, f32>()?),
            Number::I32 => Samples::F64(self.read::<i32, f64>()?),
            Number::I64 => Samples::F64(self.read::<i64, f64>()?),
            Number::U32 => Samples::F64(self.read::<u32, f64>()?),
            Number::U64 => Samples::F64(self.read::<u64, f64>()?),
            Number::F64 => Samples::F64(self.read::<f64, f64>()?),
        })
    }

    fn read<T: Stored<Sample = S>, S: Stored<Sample = S>>(&self) -> Result<Vec<S>, Fault> {
        let index = self.index.unwrap_or(0);
        let slab = match &self.place {
            Place::Field(field, _) => {
                return packed::column::<T>(&self.dataset, 0, Some(field)).ok_or_else(|| self.not_unpacked());
            }
            Place::Whole => Slab::Whole,
            Place::Row => Slab::Row(index),
            Place::Column => Slab::Column(index),
        };
        let is_down = self.dataset.shape.as_ref().and_then(|shape| shape.first()) == Some(&self.length);
        let packed = if is_down { packed::column::<T>(&self.dataset, index, None) } else { None };
        packed.map_or_else(|| self.dataset.file.values(&self.name, slab, self.length), Ok)
    }

    /// Of records only this program can read fields, and only as it unpacks them itself.
    fn not_unpacked(&self) -> Fault {
        let stored = self.dataset.described();
        Fault::of(
            &self.source(),
            format!(
                "cannot be unpacked from {stored}: damaged, or by other filters than deflate, or shuffle and then deflate"
            ),
            "copy the file from the logger again, or repack it with gzip: `h5repack -f SHUF -f GZIP=1 IN OUT`",
        )
    }
}
