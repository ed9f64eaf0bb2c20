//! The bytes of a dataset, plain or in deflated chunks, to one column or field of it, on all cores: the library works on one thread at a time.

use super::answer::{Chunk, Field, Filter, Number, Storage};
use super::room::Found;
use libdeflater::Decompressor;
use rayon::prelude::*;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

/// Values read at a time of a dataset that lies in one piece: they stay in the cache until they are turned.
const PIECE_VALUES: usize = 1 << 15;

/// A number as HDF5 stores it, least byte first.
pub(super) trait Stored: Copy + Default + Send + Sync {
    /// What it is called in an answer.
    const NUMBER: Number;
    /// From its bytes, given one by one.
    fn from_bytes(byte: impl Fn(usize) -> u8) -> Self;
}

macro_rules! stored {
    ($($number:ty = $name:ident),*) => {$(
        impl Stored for $number {
            const NUMBER: Number = Number::$name;
            fn from_bytes(byte: impl Fn(usize) -> u8) -> Self {
                Self::from_le_bytes(std::array::from_fn(byte))
            }
        }
    )*};
}
stored!(
    f32 = F32,
    f64 = F64,
    i8 = I8,
    i16 = I16,
    i32 = I32,
    i64 = I64,
    u8 = U8,
    u16 = U16,
    u32 = U32,
    u64 = U64
);

/// How the chunks of a dataset are laid out.
struct Layout<'a> {
    rows: usize,
    columns: usize,
    /// Of one value or record.
    value_bytes: usize,
    is_deflated: bool,
    is_shuffled: bool,
    /// The field to be taken, where the values are records.
    field: Option<&'a Field>,
}

/// Column `index` of a dataset of one or two dimensions; `None` where the library must read it: other filters, types or byte orders,
/// chunks that were never written, damage.
pub(super) fn column<T: Stored>(dataset: &Found, index: usize) -> Option<Vec<T>> {
    let length = *dataset.shape.as_ref()?.first()?;
    if !dataset.is_plain || dataset.number != Some(T::NUMBER) || !is_at_start(dataset) {
        return None;
    }
    match dataset.storage {
        Storage::Contiguous(from) if dataset.shape.as_ref()?.len() == 1 => contiguous(dataset, from?, length),
        _ => chunked(dataset, index, None),
    }
}

/// One field of the records of a dataset; `None` where they are packed otherwise, were never written or are damaged.
///
/// The library would need a type made for these records, which only its unsafe part can have.
pub(super) fn field<T: Stored>(dataset: &Found, field: &Field) -> Option<Vec<T>> {
    if field.number != T::NUMBER || !is_at_start(dataset) {
        return None;
    }
    match dataset.storage {
        Storage::Contiguous(from) => records(dataset, from?, field),
        _ => chunked(dataset, 0, Some(field)),
    }
}

/// Addresses count from behind a user block in some versions of the library and from the file's start in others.
fn is_at_start(dataset: &Found) -> bool {
    dataset.file.user_block == 0
}

/// A field of records that lie in one piece.
fn records<T: Stored>(dataset: &Found, from: u64, field: &Field) -> Option<Vec<T>> {
    let record_bytes = usize::try_from(dataset.value_bytes).ok()?;
    let length = dataset.shape.as_ref()?.iter().try_fold(1_usize, |all, &n| all.checked_mul(n))?;
    let stored = length.checked_mul(record_bytes)?;
    if dataset.stored_bytes != stored as u64 || !is_within(dataset, from, stored) || record_bytes == 0 {
        return None;
    }
    // As many whole records as a piece of plain values has bytes, so that wide ones take no more memory.
    let piece = (PIECE_VALUES * size_of::<f64>() / record_bytes).max(1);
    let path = &dataset.file.path;
    let mut values = vec![T::default(); length];
    values
        .par_chunks_mut(piece)
        .enumerate()
        .map_init(
            || (File::open(path).ok(), Vec::new()),
            |(file, bytes), (i, values)| {
                let file = file.as_mut()?;
                bytes.resize(values.len() * record_bytes, 0);
                file.seek(SeekFrom::Start(from + (i * piece * record_bytes) as u64)).ok()?;
                file.read_exact(bytes).ok()?;
                for (value, record) in values.iter_mut().zip(bytes.chunks_exact(record_bytes)) {
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
        self.from + if self.is_big_endian { self.number.bytes() - 1 - i } else { i }
    }
}

/// A column of a dataset in chunks, deflated and shuffled or not, or a field of the records in it.
fn chunked<T: Stored>(dataset: &Found, index: usize, field: Option<&Field>) -> Option<Vec<T>> {
    let Storage::Chunked { shape: chunk, chunks } = &dataset.storage else { return None };
    let (is_deflated, is_shuffled) = match dataset.filters.as_slice() {
        [] => (false, false),
        [Filter::Deflate(_)] => (true, false),
        [Filter::Shuffle, Filter::Deflate(_)] => (true, true),
        _ => return None,
    };
    let length = *dataset.shape.as_ref()?.first()?;
    let (rows, columns) = (*chunk.first()?, chunk.get(1).copied().unwrap_or(1));
    let value_bytes = usize::try_from(dataset.value_bytes).ok()?;
    let layout = Layout { rows, columns, value_bytes, is_deflated, is_shuffled, field };
    let holds = |chunk: &&Chunk| index.checked_sub(chunk.column).is_some_and(|first| first < columns);
    let mut places: Vec<&Chunk> = chunks.as_ref()?.iter().filter(holds).collect();
    places.sort_by_key(|place| place.row);
    // A chunk for every stretch of rows, or the rest is what the library fills in.
    if chunk.len() > 2 || places.len() != length.div_ceil(rows) {
        return None;
    }
    let path = &dataset.file.path;
    let mut values = vec![T::default(); length];
    values
        .par_chunks_mut(layout.rows)
        .zip(&places)
        .enumerate()
        .map_init(
            || (File::open(path).ok(), Vec::new(), Vec::new()),
            |(file, packed, bytes), (i, (values, place))| {
                let is_next = place.row == i * layout.rows;
                is_next.then(|| unpack(file.as_mut()?, place, &layout, (packed, bytes), (index, values)))?
            },
        )
        .collect::<Option<()>>()?;
    Some(values)
}

/// A dataset of one dimension that lies in one piece.
fn contiguous<T: Stored>(dataset: &Found, from: u64, length: usize) -> Option<Vec<T>> {
    let stored = length.checked_mul(size_of::<T>())?;
    if dataset.stored_bytes != stored as u64 || !is_within(dataset, from, stored) {
        return None;
    }
    let path = &dataset.file.path;
    let mut values = vec![T::default(); length];
    let pieces = values.par_chunks_mut(PIECE_VALUES).enumerate();
    pieces
        .map_init(
            || (File::open(path).ok(), vec![0; PIECE_VALUES * size_of::<T>()]),
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

fn is_within(dataset: &Found, from: u64, bytes: usize) -> bool {
    from.checked_add(bytes as u64).is_some_and(|end| end <= dataset.file.bytes)
}

/// One chunk's share of the column.
fn unpack<T: Stored>(
    file: &mut File,
    place: &Chunk,
    layout: &Layout,
    (packed, bytes): (&mut Vec<u8>, &mut Vec<u8>),
    (index, values): (usize, &mut [T]),
) -> Option<()> {
    let count = layout.rows.checked_mul(layout.columns)?;
    let size = layout.value_bytes;
    // Deflate stores what it cannot pack with five bytes for each 16 KiB: a longer chunk is damage.
    if place.bytes > count.checked_mul(size)?.checked_mul(2)?.checked_add(1024)? {
        return None;
    }
    file.seek(SeekFrom::Start(place.at)).ok()?;
    bytes.resize(count.checked_mul(size)?, 0);
    if layout.is_deflated {
        packed.clear();
        file.take(place.bytes as u64).read_to_end(packed).ok()?;
        if Decompressor::new().zlib_decompress(packed, bytes).ok()? != bytes.len() {
            return None;
        }
    } else if place.bytes == bytes.len() {
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
    use crate::ingest::Limits;
    use crate::ingest::hdf5::answer::Slab;
    use crate::ingest::hdf5::room;
    use std::path::Path;

    /// 20 000 rows of numbers that pack and are all different, in one column or three.
    fn numbers(columns: usize) -> Vec<i32> {
        (0..20_000 * i32::try_from(columns).unwrap()).map(|i| i * 7919 % 100_003 - 50_000).collect()
    }

    fn opened(path: &Path) -> Found {
        let file = room::File::open(path, Limits::default(), Vec::new()).unwrap();
        Found::at(&file, "/a").unwrap()
    }

    fn file(path: &Path, columns: usize, chunk_rows: usize, shuffle: bool) -> Found {
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
        opened(path)
    }

    #[test]
    fn a_column_is_what_the_library_reads() {
        let folder = tempfile::tempdir().unwrap();
        for (columns, chunk_rows, shuffle) in
            [(1, 999, false), (1, 20_000, true), (3, 777, true), (3, 1, false)]
        {
            let path = folder.path().join(format!("{columns}-{chunk_rows}.h5"));
            let dataset = file(&path, columns, chunk_rows, shuffle);
            for index in 0..columns {
                let expected: Vec<i32> = numbers(columns).into_iter().skip(index).step_by(columns).collect();
                let slab = if columns == 1 { Slab::Whole } else { Slab::Column(index) };
                assert_eq!(dataset.file.values::<i32>("/a", slab, 20_000), Ok(expected.clone()));
                assert_eq!(column::<i32>(&dataset, index), Some(expected), "{columns} {chunk_rows} {index}");
            }
            // Another type than the stored one is the library's to convert.
            assert_eq!(column::<i64>(&dataset, 0), None);
        }
    }

    #[test]
    fn a_dataset_in_one_piece_is_what_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plain.h5");
        let written = hdf5_metno::File::create(&path).unwrap();
        let values: Vec<f32> =
            (0..100_003).map(|i: i32| 0.25 * f32::from(i16::try_from(i % 30_000).unwrap())).collect();
        written.new_dataset_builder().with_data(&values).create("a").unwrap();
        written.close().unwrap();
        let dataset = opened(&path);
        assert_eq!(column::<f32>(&dataset, 0), Some(values));
        assert_eq!(column::<f64>(&dataset, 0), None);
    }

    #[test]
    fn what_is_damaged_or_not_there_is_left_to_the_library() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.h5");
        let dataset = file(&path, 1, 999, true);
        let Storage::Chunked { chunks: Some(chunks), .. } = &dataset.storage else { panic!("no chunks") };
        let place = chunks.last().unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        bytes[usize::try_from(place.at).unwrap() + place.bytes / 2] ^= 0x10;
        drop(dataset);
        let path = folder.path().join("changed.h5");
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(column::<i32>(&opened(&path), 0), None);
        let path = folder.path().join("partly.h5");
        let written = hdf5_metno::File::create(&path).unwrap();
        let dataset = written.new_dataset::<i32>().deflate(1).chunk(5000).shape(20_000).create("a").unwrap();
        dataset.write_slice(&numbers(1)[..5000], 5000..10_000).unwrap();
        drop(dataset);
        written.close().unwrap();
        assert_eq!(column::<i32>(&opened(&path), 0), None);
    }
}
