//! The bytes of a dataset, plain or in deflated chunks, to one column or field of it, on all cores: the library works on one thread at a time.

use super::record::Field;
use hdf5_metno::datatype::ByteOrder;
use hdf5_metno::filters::Filter;
use hdf5_metno::{Dataset, H5Type};
use libdeflater::Decompressor;
use rayon::prelude::*;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

/// Fewer bytes than this are read before the threads have started.
const LEAST_BYTES: usize = 1 << 16;
/// Values read at a time of a dataset that lies in one piece: they stay in the cache until they are turned.
const PIECE_VALUES: usize = 1 << 15;

/// A number as HDF5 stores it, least byte first.
pub(super) trait Stored: H5Type + Copy + Default + Send + Sync {
    /// From its bytes, given one by one.
    fn from_bytes(byte: impl Fn(usize) -> u8) -> Self;
}

macro_rules! stored {
    ($($number:ty),*) => {$(
        impl Stored for $number {
            fn from_bytes(byte: impl Fn(usize) -> u8) -> Self {
                Self::from_le_bytes(std::array::from_fn(byte))
            }
        }
    )*};
}
stored!(f32, f64, i8, i16, i32, i64, u8, u16, u32, u64);

/// A chunk: the row and column of its first value, and where its bytes lie.
struct Place {
    row: usize,
    column: usize,
    at: u64,
    length: usize,
}

/// How the chunks of a dataset are laid out.
struct Layout<'a> {
    rows: usize,
    columns: usize,
    is_deflated: bool,
    is_shuffled: bool,
    /// The field to be taken, where the values are records.
    field: Option<&'a Field>,
}

/// Column `index` of a dataset of one or two dimensions; `None` where the library must read it: other filters, types or byte orders,
/// chunks that were never written, damage.
pub(super) fn column<T: Stored>(dataset: &Dataset, index: usize) -> Option<Vec<T>> {
    let dtype = dataset.dtype().ok()?;
    let is_plain = dtype.to_descriptor().ok()? == T::type_descriptor()
        && (dtype.size() == 1 || dtype.byte_order() == ByteOrder::LittleEndian);
    let length = *dataset.shape().first()?;
    // Addresses count from behind a user block in some versions of the library and from the file's start in others.
    let is_at_start = dataset.file().ok()?.userblock() == 0;
    if !is_plain || !is_at_start || length.saturating_mul(size_of::<T>()) < LEAST_BYTES {
        return None;
    }
    let is_shuffled = match dataset.filters().as_slice() {
        [] if dataset.ndim() == 1 && !dataset.is_chunked() => return contiguous(dataset, length),
        [Filter::Deflate(_)] => false,
        [Filter::Shuffle, Filter::Deflate(_)] => true,
        _ => return None,
    };
    chunked(dataset, index, (true, is_shuffled), None)
}

/// One field of the records of a dataset; `None` where they are packed otherwise, were never written or are damaged.
///
/// The library would need a type made for these records, which only its unsafe part can have.
pub(super) fn field<T: Stored>(dataset: &Dataset, field: &Field) -> Option<Vec<T>> {
    if field.bytes != size_of::<T>() || dataset.file().ok()?.userblock() != 0 {
        return None;
    }
    let filters = match dataset.filters().as_slice() {
        [] if !dataset.is_chunked() => return records(dataset, field),
        [] => (false, false),
        [Filter::Deflate(_)] => (true, false),
        [Filter::Shuffle, Filter::Deflate(_)] => (true, true),
        _ => return None,
    };
    chunked(dataset, 0, filters, Some(field))
}

/// A field of records that lie in one piece.
fn records<T: Stored>(dataset: &Dataset, field: &Field) -> Option<Vec<T>> {
    let (from, length) = (dataset.offset()?, dataset.size());
    let is_elsewhere = !dataset.create_plist().ok()?.external().is_empty();
    let stored = length.checked_mul(field.record_bytes)?;
    if is_elsewhere || dataset.storage_size() != stored as u64 || field.record_bytes == 0 {
        return None;
    }
    // As many whole records as a piece of plain values has bytes, so that wide ones take no more memory.
    let piece = (PIECE_VALUES * size_of::<f64>() / field.record_bytes).max(1);
    let path = dataset.filename();
    let mut values = vec![T::default(); length];
    values
        .par_chunks_mut(piece)
        .enumerate()
        .map_init(
            || (File::open(&path).ok(), Vec::new()),
            |(file, bytes), (i, values)| {
                let file = file.as_mut()?;
                bytes.resize(values.len() * field.record_bytes, 0);
                file.seek(SeekFrom::Start(from + (i * piece * field.record_bytes) as u64)).ok()?;
                file.read_exact(bytes).ok()?;
                for (value, record) in values.iter_mut().zip(bytes.chunks_exact(field.record_bytes)) {
                    *value = T::from_bytes(|i| record[field.byte(i)]);
                }
                Some(())
            },
        )
        .collect::<Option<()>>()?;
    Some(values)
}

impl Field {
    /// Where byte `i` of its number, counted from the lowest, stands in a record.
    fn byte(&self, i: usize) -> usize {
        self.from + if self.is_big_endian { self.bytes - 1 - i } else { i }
    }
}

/// A column of a dataset in chunks, deflated and shuffled or not, or a field of the records in it.
fn chunked<T: Stored>(
    dataset: &Dataset,
    index: usize,
    (is_deflated, is_shuffled): (bool, bool),
    field: Option<&Field>,
) -> Option<Vec<T>> {
    let (shape, chunk) = (dataset.shape(), dataset.chunk()?);
    let length = *shape.first()?;
    let columns = chunk.get(1).copied().unwrap_or(1);
    let layout = Layout { rows: *chunk.first()?, columns, is_deflated, is_shuffled, field };
    if shape.len() != chunk.len() || shape.len() > 2 || layout.rows == 0 {
        return None;
    }
    let places = places(dataset, index, &layout)?;
    // A chunk for every stretch of rows, or the rest is what the library fills in.
    if places.len() != length.div_ceil(layout.rows) {
        return None;
    }
    let path = dataset.filename();
    let mut values = vec![T::default(); length];
    values
        .par_chunks_mut(layout.rows)
        .zip(&places)
        .enumerate()
        .map_init(
            || (File::open(&path).ok(), Vec::new(), Vec::new()),
            |(file, packed, bytes), (i, (values, place))| {
                let is_next = place.row == i * layout.rows;
                is_next.then(|| unpack(file.as_mut()?, place, &layout, (packed, bytes), (index, values)))?
            },
        )
        .collect::<Option<()>>()?;
    Some(values)
}

/// A dataset of one dimension that lies in one piece.
fn contiguous<T: Stored>(dataset: &Dataset, length: usize) -> Option<Vec<T>> {
    let from = dataset.offset()?;
    let is_elsewhere = !dataset.create_plist().ok()?.external().is_empty();
    if is_elsewhere || dataset.storage_size() != (length * size_of::<T>()) as u64 {
        return None;
    }
    let path = dataset.filename();
    let mut values = vec![T::default(); length];
    let pieces = values.par_chunks_mut(PIECE_VALUES).enumerate();
    pieces
        .map_init(
            || (File::open(&path).ok(), vec![0; PIECE_VALUES * size_of::<T>()]),
            |(file, bytes), (i, values)| {
                let (file, bytes) = (file.as_mut()?, &mut bytes[..size_of_val(values)]);
                file.seek(SeekFrom::Start(from + (i * PIECE_VALUES * size_of::<T>()) as u64)).ok()?;
                file.read_exact(bytes).ok()?;
                for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(size_of::<T>())) {
                    *value = T::from_bytes(|i| bytes[i]);
                }
                Some(())
            },
        )
        .collect::<Option<()>>()?;
    Some(values)
}

/// The chunks that hold the column, by row.
fn places(dataset: &Dataset, index: usize, layout: &Layout) -> Option<Vec<Place>> {
    let mut places = Vec::new();
    let mut is_whole = true;
    dataset
        .chunks_visit(|chunk| {
            let [row, column] =
                [0, 1].map(|i| chunk.offset.get(i).map_or(Some(0), |&n| usize::try_from(n).ok()));
            match (row, column, usize::try_from(chunk.size)) {
                (Some(row), Some(column), Ok(length)) if chunk.filter_mask == 0 => {
                    if index.checked_sub(column).is_some_and(|first| first < layout.columns) {
                        places.push(Place { row, column, at: chunk.addr, length });
                    }
                }
                _ => is_whole = false,
            }
            0
        })
        .ok()?;
    places.sort_by_key(|place| place.row);
    is_whole.then_some(places)
}

/// One chunk's share of the column.
fn unpack<T: Stored>(
    file: &mut File,
    place: &Place,
    layout: &Layout,
    (packed, bytes): (&mut Vec<u8>, &mut Vec<u8>),
    (index, values): (usize, &mut [T]),
) -> Option<()> {
    let count = layout.rows.checked_mul(layout.columns)?;
    let size = layout.field.map_or(size_of::<T>(), |field| field.record_bytes);
    // Deflate stores what it cannot pack with five bytes for each 16 KiB: a longer chunk is damage.
    if place.length > count.checked_mul(size)?.checked_mul(2)?.checked_add(1024)? {
        return None;
    }
    file.seek(SeekFrom::Start(place.at)).ok()?;
    bytes.resize(count.checked_mul(size)?, 0);
    if layout.is_deflated {
        packed.clear();
        file.take(place.length as u64).read_to_end(packed).ok()?;
        if Decompressor::new().zlib_decompress(packed, bytes).ok()? != bytes.len() {
            return None;
        }
    } else if place.length == bytes.len() {
        file.read_exact(bytes).ok()?;
    } else {
        return None;
    }
    let first = index - place.column;
    if let Some(field) = layout.field {
        for (row, value) in values.iter_mut().enumerate() {
            let at = row * layout.columns + first;
            *value = T::from_bytes(|i| {
                let byte = field.byte(i);
                if layout.is_shuffled { bytes[byte * count + at] } else { bytes[at * size + byte] }
            });
        }
        return Some(());
    }
    for (row, value) in values.iter_mut().enumerate() {
        let at = row * layout.columns + first;
        *value =
            T::from_bytes(|i| if layout.is_shuffled { bytes[i * count + at] } else { bytes[at * size + i] });
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// 20 000 rows of numbers that pack and are all different, in one column or three.
    fn numbers(columns: usize) -> Vec<i32> {
        (0..20_000 * i32::try_from(columns).unwrap()).map(|i| i * 7919 % 100_003 - 50_000).collect()
    }

    fn file(path: &Path, columns: usize, chunk_rows: usize, shuffle: bool) -> Dataset {
        let file = hdf5_metno::File::create(path).unwrap();
        let builder = file.new_dataset::<i32>();
        let builder = if shuffle { builder.shuffle() } else { builder }.deflate(4);
        if columns == 1 {
            let dataset = builder.chunk(chunk_rows).shape(20_000).create("a").unwrap();
            dataset.write_raw(&numbers(1)).unwrap();
        } else {
            let dataset = builder.chunk((chunk_rows, 2)).shape((20_000, columns)).create("a").unwrap();
            dataset.write_raw(&numbers(columns)).unwrap();
        }
        file.close().unwrap();
        hdf5_metno::File::open(path).unwrap().dataset("a").unwrap()
    }

    #[test]
    fn a_column_is_what_the_library_reads() {
        let folder = tempfile::tempdir().unwrap();
        for (columns, chunk_rows, shuffle) in
            [(1, 999, false), (1, 20_000, true), (3, 777, true), (3, 1, false)]
        {
            let path = folder.path().join(format!("{columns}-{chunk_rows}.h5"));
            let dataset = file(&path, columns, chunk_rows, shuffle);
            let whole = dataset.read_raw::<i32>().unwrap();
            for index in 0..columns {
                let expected: Vec<i32> = whole.iter().copied().skip(index).step_by(columns).collect();
                assert_eq!(column::<i32>(&dataset, index), Some(expected), "{columns} {chunk_rows} {index}");
            }
            // Another type than the stored one is the library's to convert.
            assert_eq!(column::<i64>(&dataset, 0), None);
        }
    }

    #[test]
    fn a_dataset_in_one_piece_is_what_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let written = hdf5_metno::File::create(folder.path().join("plain.h5")).unwrap();
        let values: Vec<f32> =
            (0..100_003).map(|i: i32| 0.25 * f32::from(i16::try_from(i % 30_000).unwrap())).collect();
        written.new_dataset_builder().with_data(&values).create("a").unwrap();
        written.flush().unwrap();
        let dataset = written.dataset("a").unwrap();
        assert_eq!(contiguous::<f32>(&dataset, values.len()), Some(values.clone()));
        assert_eq!(column::<f32>(&dataset, 0), Some(values));
        assert_eq!(column::<f64>(&dataset, 0), None);
    }

    #[test]
    fn what_is_damaged_or_not_there_is_left_to_the_library() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.h5");
        let layout = Layout { rows: 999, columns: 1, is_deflated: true, is_shuffled: true, field: None };
        let place = places(&file(&path, 1, 999, true), 0, &layout);
        let place = place.unwrap().pop().unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = usize::try_from(place.at).unwrap() + place.length / 2;
        bytes[middle] ^= 0x10;
        std::fs::write(&path, bytes).unwrap();
        let dataset = hdf5_metno::File::open(&path).unwrap().dataset("a").unwrap();
        assert_eq!(column::<i32>(&dataset, 0), None);
        let path = folder.path().join("partly.h5");
        let written = hdf5_metno::File::create(&path).unwrap();
        let dataset = written.new_dataset::<i32>().deflate(1).chunk(5000).shape(20_000).create("a").unwrap();
        dataset.write_slice(&numbers(1)[..5000], 5000..10_000).unwrap();
        assert_eq!(column::<i32>(&dataset, 0), None);
    }
}
