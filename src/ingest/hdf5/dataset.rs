//! A column, row or field of a dataset to its numbers.

use super::attributes;
use super::fault::{self, Fault};
use super::packed::{self, Stored};
use super::record::Field;
use crate::data::{Issue, Samples};
use crate::ingest::time_reading::{Carrier, Reading, Scale};
use hdf5_metno::types::{FloatSize, IntSize, TypeDescriptor};
use hdf5_metno::{Dataset, Datatype, H5Type, Hyperslab, Selection, SliceOrIndex};

/// Values read at a time where whole rows are read for one column: 2 MB of f64.
const BLOCK_VALUES: usize = 1 << 18;

/// One channel's numbers in a file: a dataset, a column or row of one, or a field of its records.
pub(super) struct Column {
    pub dataset: Dataset,
    /// Which of several channels in one dataset.
    pub index: Option<usize>,
    /// Number of channels in the dataset, or in the field of its records.
    pub columns: usize,
    /// The dataset's path.
    pub name: String,
    /// Number of samples.
    pub length: usize,
    pub kind: Kind,
    pub place: Place,
}

/// How a column is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Int(IntSize),
    Unsigned(IntSize),
    Single,
    Double,
}

/// Where the numbers of a channel lie in its dataset.
pub(super) enum Place {
    /// They are all of it.
    Whole,
    /// In a column.
    Column,
    /// In a row.
    Row,
    /// In a field of its records.
    Field(Field),
}

/// How the numbers of a dataset are read; `None` where it holds none.
pub(super) fn kind(dtype: &Datatype) -> Option<Kind> {
    match dtype.to_descriptor() {
        Ok(descriptor) => Kind::of(&descriptor),
        // Half precision and odd widths have no name in Rust; the library converts them.
        Err(_) if dtype.size() <= 2 && dtype.conv_to::<f32>().is_some() => Some(Kind::Single),
        Err(_) => dtype.conv_to::<f64>().map(|_| Kind::Double),
    }
}

impl Kind {
    /// How numbers of this type are read; `None` where they are none.
    pub(super) fn of(descriptor: &TypeDescriptor) -> Option<Self> {
        match descriptor {
            TypeDescriptor::Integer(size) => Some(Self::Int(*size)),
            TypeDescriptor::Unsigned(size) => Some(Self::Unsigned(*size)),
            TypeDescriptor::Float(FloatSize::U4) => Some(Self::Single),
            TypeDescriptor::Float(_) => Some(Self::Double),
            _ => None,
        }
    }
}

/// A type for people: `int16`, big-endian where it is.
pub(super) fn type_name(dtype: &Datatype) -> String {
    let name = match dtype.to_descriptor() {
        Ok(TypeDescriptor::Compound(compound)) => {
            let fields: Vec<&str> = compound.fields.iter().map(|field| field.name.as_str()).collect();
            return format!("records ({})", fields.join(", "));
        }
        Ok(
            TypeDescriptor::FixedAscii(_)
            | TypeDescriptor::FixedUnicode(_)
            | TypeDescriptor::VarLenAscii
            | TypeDescriptor::VarLenUnicode,
        ) => return "text".into(),
        Ok(TypeDescriptor::VarLenArray(_) | TypeDescriptor::FixedArray(..)) => return "lists".into(),
        Ok(TypeDescriptor::Enum(_) | TypeDescriptor::Boolean) => return "named values".into(),
        Ok(TypeDescriptor::Reference(_)) => return "references".into(),
        Ok(number) => number.to_string(),
        // IEEE 754 binary16 is the only one that loggers write and Rust has no type for.
        Err(_) if dtype.conv_to::<f64>().is_some() && dtype.size() == 2 => "float16".into(),
        Err(_) if dtype.conv_to::<f64>().is_some() => format!("{}-byte number", dtype.size()),
        Err(_) => return "another type".into(),
    };
    match dtype.byte_order() {
        hdf5_metno::datatype::ByteOrder::BigEndian if dtype.size() > 1 => format!("{name} big-endian"),
        _ => name,
    }
}

impl Column {
    /// What to write as `source`.
    pub(super) fn source(&self) -> String {
        let name = match &self.place {
            Place::Field(field) => format!("{}.{}", self.name, field.name),
            _ => self.name.clone(),
        };
        self.index.map_or(name.clone(), |index| format!("{name}[{index}]"))
    }

    /// What it is, for people.
    pub(super) fn kind_name(&self) -> &'static str {
        match self.place {
            Place::Field(_) => "field",
            Place::Row => "row",
            Place::Column => "column",
            Place::Whole if self.index.is_some() => "column",
            Place::Whole => "dataset",
        }
    }

    /// The last part of its name, which may tell its unit.
    pub(super) fn bare_name(&self) -> &str {
        match &self.place {
            Place::Field(field) => &field.name,
            _ => self.name.rsplit_once('/').map_or(&self.name, |(_, name)| name),
        }
    }

    /// The dataset whose records it is a field of.
    pub(super) fn records(&self) -> Option<&str> {
        matches!(self.place, Place::Field(_)).then_some(self.name.as_str())
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
        let chunk = self.dataset.chunk().unwrap_or_default();
        let values = chunk.iter().fold(1_u64, |product, &n| product.saturating_mul(n as u64));
        match &self.place {
            Place::Field(field) => values.saturating_mul(field.record_bytes as u64),
            Place::Column => {
                let rows = chunk.first().copied().unwrap_or(1) as u64;
                8 * values.max(rows.saturating_mul(self.columns as u64))
            }
            Place::Whole | Place::Row => 8 * values,
        }
    }

    /// Its numbers as stored: f32 and short integers as f32, the rest as f64.
    pub(super) fn samples(&self) -> Result<Samples, Fault> {
        Ok(match self.kind {
            Kind::Single => Samples::F32(self.read()?),
            Kind::Double => Samples::F64(self.read()?),
            Kind::Int(IntSize::U1) => Samples::F32(self.read::<i8>()?.into_iter().map(f32::from).collect()),
            Kind::Int(IntSize::U2) => Samples::F32(self.read::<i16>()?.into_iter().map(f32::from).collect()),
            Kind::Unsigned(IntSize::U1) => {
                Samples::F32(self.read::<u8>()?.into_iter().map(f32::from).collect())
            }
            Kind::Unsigned(IntSize::U2) => {
                Samples::F32(self.read::<u16>()?.into_iter().map(f32::from).collect())
            }
            Kind::Int(_) | Kind::Unsigned(_) => Samples::F64(self.wide()?),
        })
    }

    #[allow(clippy::cast_precision_loss, reason = "counts beyond 2^53 lose what no sensor resolves")]
    fn wide(&self) -> Result<Vec<f64>, Fault> {
        Ok(match self.kind {
            Kind::Int(IntSize::U8) => self.read::<i64>()?.into_iter().map(|x| x as f64).collect(),
            Kind::Unsigned(IntSize::U8) => self.read::<u64>()?.into_iter().map(|x| x as f64).collect(),
            Kind::Unsigned(_) => self.read::<u32>()?.into_iter().map(f64::from).collect(),
            Kind::Int(_) => self.read::<i32>()?.into_iter().map(f64::from).collect(),
            Kind::Single | Kind::Double => self.read::<f64>()?,
        })
    }

    /// The first and the last of its numbers as stored, without reading those between; `None` for a field of records.
    pub(super) fn ends(&self) -> Option<(f64, f64)> {
        let last = self.length.checked_sub(1)?;
        let at = |sample: usize| {
            let sample = SliceOrIndex::from(sample..sample + 1);
            let slab = match (&self.place, self.index, self.dataset.ndim()) {
                (Place::Field(_), ..) => return None,
                (Place::Row, index, _) => vec![SliceOrIndex::from(index?), sample],
                (Place::Column, index, _) => vec![sample, SliceOrIndex::from(index?)],
                (Place::Whole, _, 1) => vec![sample],
                (Place::Whole, ..) if self.dataset.shape()[0] == 1 => vec![SliceOrIndex::from(0), sample],
                (Place::Whole, ..) => vec![sample, SliceOrIndex::from(0)],
            };
            let slab = Selection::from(Hyperslab::from(slab));
            self.dataset.read_slice_1d::<f64, Selection>(slab).ok()?.first().copied()
        };
        Some((at(0)?, at(last)?))
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
        let is_down = self.dataset.shape().first() == Some(&self.length);
        if is_down
            && !matches!(self.place, Place::Field(_))
            && let Some(values) = packed::column(&self.dataset, self.index.unwrap_or(0))
        {
            return Ok(values);
        }
        let slice = |slab: Vec<SliceOrIndex>| {
            let slab = Selection::from(Hyperslab::from(slab));
            self.dataset.read_slice_1d::<T, Selection>(slab).map(|array| array.into_raw_vec_and_offset().0)
        };
        let index = self.index.unwrap_or(0);
        let read = match &self.place {
            Place::Field(field) => return self.read_field(field),
            Place::Whole => self.dataset.read_raw::<T>(),
            Place::Row => slice(vec![SliceOrIndex::from(index), SliceOrIndex::from(..)]),
            Place::Column if self.dataset.is_chunked() => self.read_rows(index),
            Place::Column => slice(vec![SliceOrIndex::from(..), SliceOrIndex::from(index)]),
        };
        read.map_err(|error| fault::of_dataset(&self.source(), &error))
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

    /// One column of a chunked dataset, taken from whole rows: picking it in the library costs four times as much.
    fn read_rows<T: H5Type>(&self, index: usize) -> hdf5_metno::Result<Vec<T>> {
        let chunk_rows = self.dataset.chunk().and_then(|chunk| chunk.first().copied()).unwrap_or(1).max(1);
        // Whole chunks, so that none is unpacked twice, up to about BLOCK_VALUES at a time.
        let chunks = (BLOCK_VALUES / self.columns / chunk_rows).max(1);
        let block_rows = chunks.saturating_mul(chunk_rows).min(self.length);
        let mut values = Vec::with_capacity(self.length);
        let mut from = 0;
        while from < self.length {
            let to = from.saturating_add(block_rows).min(self.length);
            let rows = Hyperslab::from(vec![SliceOrIndex::from(from..to), SliceOrIndex::from(..)]);
            let block = self.dataset.read_slice_2d::<T, Selection>(Selection::from(rows))?;
            values.extend(block.into_raw_vec_and_offset().0.into_iter().skip(index).step_by(self.columns));
            from = to;
        }
        Ok(values)
    }
}
