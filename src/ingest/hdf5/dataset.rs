//! A dataset path to the numbers of one column.

use super::attributes;
use super::fault::{self, Fault};
use super::packed::{self, Stored};
use crate::data::Samples;
use hdf5_metno::types::{FloatSize, IntSize, TypeDescriptor};
use hdf5_metno::{Dataset, Datatype, File, H5Type, Hyperslab, Selection, SliceOrIndex};

/// No filter that is built in packs tighter (deflate: 1032 : 1), so that a dataset that claims more was damaged or never written.
const TIGHTEST_PACKING: u64 = 1100;

/// Values read at a time where whole rows are read for one column: 2 MB of f64.
const BLOCK_VALUES: usize = 1 << 18;

/// One column of numbers in a file.
pub(super) struct Column {
    pub dataset: Dataset,
    /// Which column of a two-dimensional dataset.
    pub index: Option<usize>,
    /// Number of columns; 1 for one dimension.
    pub columns: usize,
    name: String,
    length: usize,
    kind: Kind,
}

/// How a column is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Int(IntSize),
    Unsigned(IntSize),
    Single,
    Double,
}

/// Why a source names no column.
pub(super) enum Missing {
    Nowhere,
    Because(Fault),
}

/// The column that `source` names: `/group/dataset`, or `/group/dataset[2]` of a two-dimensional one.
pub(super) fn find(file: &File, source: &str) -> Result<Column, Missing> {
    let path = format!("/{}", source.trim().trim_start_matches('/'));
    if let Ok(dataset) = file.dataset(&path) {
        return column(dataset, path, None).map_err(Missing::Because);
    }
    if let Some((bare, index)) = path.strip_suffix(']').and_then(|path| path.rsplit_once('['))
        && let Ok(index) = index.trim().parse()
        && let Ok(dataset) = file.dataset(bare)
    {
        return column(dataset, bare.to_owned(), Some(index)).map_err(Missing::Because);
    }
    if file.group(&path).is_ok() {
        return Err(Missing::Because(Fault {
            problem: format!("{path} is a group, not a dataset"),
            mend: "name one of the datasets in it; `dropcheck inspect` lists them".into(),
        }));
    }
    Err(Missing::Nowhere)
}

fn column(dataset: Dataset, name: String, index: Option<usize>) -> Result<Column, Fault> {
    let wrong = |problem: String, mend: &str| Fault { problem, mend: mend.to_owned() };
    // A file that was sent may name any other on this machine.
    let external = dataset.create_plist().map(|list| list.external()).unwrap_or_default();
    if let Some(other) = external.iter().find(|file| file.name.contains(['/', '\\'])) {
        return Err(wrong(
            format!("the data of {name} are in another file, {}, which lies elsewhere", other.name),
            "ask for a recording that holds its own data: `h5repack IN OUT` makes one",
        ));
    }
    let (kind, shape) = readable(&dataset, &name)?;
    let (length, columns, index) = match (shape.as_slice(), index) {
        (&[length], None | Some(0)) => (length, 1, None),
        (&[_], Some(_)) => {
            return Err(wrong(format!("{name} has one dimension"), "leave out the [ ] behind its name"));
        }
        (&[rows, columns], Some(index)) if index < columns => (rows, columns, Some(index)),
        (&[_, columns], Some(index)) => {
            return Err(wrong(
                format!("{name} has {columns} columns, there is no [{index}]"),
                "columns count from 0",
            ));
        }
        (&[rows, 1], None) => (rows, 1, Some(0)),
        (&[rows, columns], None) => {
            return Err(wrong(
                format!("{name} has {rows} rows and {columns} columns"),
                &format!("name one column: \"{name}[0]\" to \"{name}[{}]\"", columns.saturating_sub(1)),
            ));
        }
        _ => {
            return Err(wrong(
                format!("{name} has {} dimensions", shape.len()),
                "only one and two dimensions are read; save the channel as a dataset of its own",
            ));
        }
    };
    Ok(Column { dataset, index, columns, name, length, kind })
}

/// How a dataset's numbers are read, and its shape; a fault where it holds none.
pub(super) fn shape_of(dataset: &Dataset, name: &str) -> Result<Vec<usize>, Fault> {
    readable(dataset, name).map(|(_, shape)| shape)
}

fn readable(dataset: &Dataset, name: &str) -> Result<(Kind, Vec<usize>), Fault> {
    const NUMBERS: &str = "name a dataset of numbers; `dropcheck inspect` lists them";
    let wrong = |what: String| Fault { problem: format!("{name} {what}"), mend: NUMBERS.into() };
    let dtype = dataset.dtype().map_err(|error| fault::of_dataset(name, &error))?;
    let kind = kind(&dtype).ok_or_else(|| wrong(format!("holds no numbers but {}", type_name(&dtype))))?;
    let space = dataset.space().map_err(|error| fault::of_dataset(name, &error))?;
    if space.is_null() {
        return Err(wrong("is empty".into()));
    }
    let shape = space.shape();
    if shape.is_empty() {
        return Err(wrong("is a single value".into()));
    }
    if shape.contains(&0) {
        return Err(wrong("is empty".into()));
    }
    let claimed = shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    let rows = shape.first().copied().unwrap_or(0);
    let bytes = claimed.and_then(|count| count.checked_mul(dtype.size())).and_then(|b| u64::try_from(b).ok());
    let stored = dataset.storage_size();
    let is_plausible = bytes.is_some_and(|bytes| bytes <= stored.saturating_mul(TIGHTEST_PACKING));
    if !is_plausible {
        return Err(Fault {
            problem: format!("{name} claims {rows} rows, of which the file holds {stored} bytes"),
            mend: "it was never written, or the file is damaged: copy it from the logger again".into(),
        });
    }
    Ok((kind, shape))
}

fn kind(dtype: &Datatype) -> Option<Kind> {
    match dtype.to_descriptor() {
        Ok(TypeDescriptor::Integer(size)) => Some(Kind::Int(size)),
        Ok(TypeDescriptor::Unsigned(size)) => Some(Kind::Unsigned(size)),
        Ok(TypeDescriptor::Float(FloatSize::U4)) => Some(Kind::Single),
        Ok(TypeDescriptor::Float(_)) => Some(Kind::Double),
        Ok(_) => None,
        // Half precision and odd widths have no name in Rust; the library converts them.
        Err(_) if dtype.size() <= 2 && dtype.conv_to::<f32>().is_some() => Some(Kind::Single),
        Err(_) => dtype.conv_to::<f64>().map(|_| Kind::Double),
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
        match self.index {
            Some(index) => format!("{}[{index}]", self.name),
            None => self.name.clone(),
        }
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
        let rows = if self.index.is_some() { chunk.first().copied().unwrap_or(1) as u64 } else { 1 };
        8 * values.max(rows.saturating_mul(self.columns as u64))
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

    /// Its numbers as times, s: its own attributes `unit`, `scale` and `offset` are followed.
    pub(super) fn times_s(&self) -> Result<Vec<f64>, Fault> {
        let mut times_s = match self.samples()? {
            Samples::F32(times) => times.into_iter().map(f64::from).collect(),
            Samples::F64(times) => times,
        };
        let (scale, offset) = attributes::time_scale(self)?;
        #[allow(clippy::float_cmp, reason = "exactly the values that stand for nothing to do")]
        if scale != 1.0 || offset != 0.0 {
            for t in &mut times_s {
                *t = t.mul_add(scale, offset);
            }
        }
        Ok(times_s)
    }

    fn read<T: Stored>(&self) -> Result<Vec<T>, Fault> {
        if let Some(values) = packed::column(&self.dataset, self.index.unwrap_or(0)) {
            return Ok(values);
        }
        let read = match self.index {
            None => self.dataset.read_raw::<T>(),
            Some(_) if self.columns == 1 => self.dataset.read_raw::<T>(),
            Some(index) if self.dataset.is_chunked() => self.read_rows(index),
            Some(index) => {
                let slab = Hyperslab::from(vec![SliceOrIndex::from(..), SliceOrIndex::from(index)]);
                self.dataset
                    .read_slice_1d::<T, Selection>(Selection::from(slab))
                    .map(|array| array.into_raw_vec_and_offset().0)
            }
        };
        read.map_err(|error| fault::of_dataset(&self.source(), &error))
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
