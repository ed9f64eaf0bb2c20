//! The bytes of a dataset, plain or in deflated chunks, to one column or field of it, on all cores: the library works on one thread at a time.

use super::answer::{Chunk, Field, Filter, Storage, Stored};
use super::room::Found;
use libdeflater::Decompressor;
use rayon::prelude::*;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

/// Bytes read at a time of a dataset that lies in one piece: they stay in the cache until they are turned.
const PIECE_BYTES: usize = 1 << 18;

/// Column `index` of a dataset of one or two dimensions, or a field of its records; `None` where the library must read it: other filters,
/// types or byte orders, chunks that were never written, damage. For records the library would need a type made for them, which only its
/// unsafe part can have.
pub(super) fn column<T: Stored>(
    dataset: &Found,
    index: usize,
    field: Option<&Field>,
) -> Option<Vec<T::Sample>> {
    let is_plain = dataset.is_plain && dataset.number == Some(T::NUMBER);
    // Addresses count from behind a user block in some versions of the library and from the file's start in others.
    if dataset.file.user_block != 0 || !field.map_or(is_plain, |field| field.number == T::NUMBER) {
        return None;
    }
    match dataset.storage {
        Storage::Contiguous(from) => in_one_piece::<T>(dataset, from?, field),
        _ => chunked::<T>(dataset, index, field),
    }
}

impl Field {
    /// Where byte `i` of its number, counted from the lowest, stands in a record.
    fn byte(&self, i: usize) -> usize {
        self.from + if self.is_big_endian { self.number.bytes() - 1 - i } else { i }
    }
}

/// A dataset of one column that lies in one piece, or a field of its records.
fn in_one_piece<T: Stored>(dataset: &Found, from: u64, field: Option<&Field>) -> Option<Vec<T::Sample>> {
    let shape = dataset.shape.as_ref()?;
    let value_bytes = usize::try_from(dataset.value_bytes).ok().filter(|bytes| *bytes > 0)?;
    let length = shape.iter().try_fold(1_usize, |all, &n| all.checked_mul(n))?;
    let stored = length.checked_mul(value_bytes)? as u64;
    let is_within = from.checked_add(stored).is_some_and(|end| end <= dataset.file.bytes);
    if dataset.stored_bytes != stored || !is_within || shape.iter().filter(|n| **n != 1).count() > 1 {
        return None;
    }
    let piece = (PIECE_BYTES / value_bytes).max(1);
    let path = &dataset.file.path;
    let mut values = vec![T::Sample::default(); length];
    values
        .par_chunks_mut(piece)
        .enumerate()
        .map_init(
            || (File::open(path).ok(), Vec::new()),
            |(file, bytes), (i, values)| {
                let file = file.as_mut()?;
                bytes.resize(values.len() * value_bytes, 0);
                file.seek(SeekFrom::Start(from + (i * piece * value_bytes) as u64)).ok()?;
                file.read_exact(bytes).ok()?;
                match field {
                    None => {
                        for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(size_of::<T>())) {
                            *value = T::sample(|i| bytes[i]);
                        }
                    }
                    Some(field) => {
                        for (value, record) in values.iter_mut().zip(bytes.chunks_exact(value_bytes)) {
                            *value = T::sample(|i| record[field.byte(i)]);
                        }
                    }
                }
                Some(())
            },
        )
        .collect::<Option<()>>()?;
    Some(values)
}

/// How the values of a column lie in the chunks of its dataset.
struct Layout<'a> {
    /// Of a chunk.
    rows: usize,
    /// Of a chunk.
    columns: usize,
    /// Of one value or record.
    value_bytes: usize,
    is_deflated: bool,
    is_shuffled: bool,
    /// The field to be taken, where the values are records.
    field: Option<&'a Field>,
    /// The column to be taken.
    index: usize,
}

/// A column of a dataset in chunks, deflated and shuffled or not, or a field of the records in it.
fn chunked<T: Stored>(dataset: &Found, index: usize, field: Option<&Field>) -> Option<Vec<T::Sample>> {
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
    let layout = Layout { rows, columns, value_bytes, is_deflated, is_shuffled, field, index };
    let holds = |chunk: &&Chunk| index.checked_sub(chunk.column).is_some_and(|first| first < columns);
    let mut places: Vec<&Chunk> = chunks.as_ref()?.iter().filter(holds).collect();
    places.sort_by_key(|place| place.row);
    // A chunk for every stretch of rows, or the rest is what the library fills in.
    if chunk.len() > 2 || places.len() != length.div_ceil(rows) {
        return None;
    }
    let path = &dataset.file.path;
    let mut values = vec![T::Sample::default(); length];
    values
        .par_chunks_mut(rows)
        .zip(&places)
        .enumerate()
        .map_init(
            || (File::open(path).ok(), Vec::new(), Vec::new()),
            |(file, packed, bytes), (i, (values, place))| {
                let is_next = place.row == i * rows;
                is_next.then(|| layout.unpack(file.as_mut()?, place, packed, bytes))??;
                layout.take::<T>(bytes, place, values);
                Some(())
            },
        )
        .collect::<Option<()>>()?;
    Some(values)
}

impl Layout<'_> {
    /// The bytes of a chunk as they were before they were deflated.
    fn unpack(
        &self,
        file: &mut File,
        place: &Chunk,
        packed: &mut Vec<u8>,
        bytes: &mut Vec<u8>,
    ) -> Option<()> {
        let whole = self.rows.checked_mul(self.columns)?.checked_mul(self.value_bytes)?;
        // Deflate stores what it cannot pack with five bytes for each 16 KiB: a longer chunk is damage.
        if place.bytes > whole.checked_mul(2)?.checked_add(1024)? {
            return None;
        }
        file.seek(SeekFrom::Start(place.at)).ok()?;
        bytes.resize(whole, 0);
        if !self.is_deflated {
            return (place.bytes == whole).then(|| file.read_exact(bytes).ok())?;
        }
        packed.clear();
        file.take(place.bytes as u64).read_to_end(packed).ok()?;
        (Decompressor::new().zlib_decompress(packed, bytes).ok()? == whole).then_some(())
    }

    /// The chunk's share of the column out of its bytes.
    fn take<T: Stored>(&self, bytes: &[u8], place: &Chunk, values: &mut [T::Sample]) {
        // Two loops over the rows each: where nothing in a loop is asked anew, it takes half the time.
        match self.field {
            Some(field) => self.take_by::<T>(bytes, place, values, |i| field.byte(i)),
            None => self.take_by::<T>(bytes, place, values, |i| i),
        }
    }

    fn take_by<T: Stored>(
        &self,
        bytes: &[u8],
        place: &Chunk,
        values: &mut [T::Sample],
        byte: impl Fn(usize) -> usize,
    ) {
        let (count, size) = (self.rows * self.columns, self.value_bytes);
        for (row, value) in values.iter_mut().enumerate() {
            let at = row * self.columns + self.index - place.column;
            let stored = |i| if self.is_shuffled { byte(i) * count + at } else { at * size + byte(i) };
            *value = T::sample(|i| bytes[stored(i)]);
        }
    }
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
        let file = room::File::open(path, Limits::default()).unwrap();
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
                let expected: Vec<f64> =
                    numbers(columns).into_iter().skip(index).step_by(columns).map(f64::from).collect();
                let slab = if columns == 1 { Slab::Whole } else { Slab::Column(index) };
                assert_eq!(dataset.file.values::<f64>("/a", slab, 20_000), Ok(expected.clone()));
                assert_eq!(
                    column::<i32>(&dataset, index, None),
                    Some(expected),
                    "{columns} {chunk_rows} {index}"
                );
            }
            // Another type than the stored one is the library's to convert.
            assert_eq!(column::<i64>(&dataset, 0, None), None);
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
        assert_eq!(column::<f32>(&dataset, 0, None), Some(values));
        assert_eq!(column::<f64>(&dataset, 0, None), None);
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
        assert_eq!(column::<i32>(&opened(&path), 0, None), None);
        let path = folder.path().join("partly.h5");
        let written = hdf5_metno::File::create(&path).unwrap();
        let dataset = written.new_dataset::<i32>().deflate(1).chunk(5000).shape(20_000).create("a").unwrap();
        dataset.write_slice(&numbers(1)[..5000], 5000..10_000).unwrap();
        drop(dataset);
        written.close().unwrap();
        assert_eq!(column::<i32>(&opened(&path), 0, None), None);
    }
}
