//! The bytes of a dataset, plain or in deflated chunks, to one column or field of it, on all cores: the
//! library works on one thread at a time.

use super::answer::{Dataset, Packing, RecordField, Slab, Storage, StoredChunk};
use super::column::{DatasetColumn, Place};
use super::fault::{AGAIN, REPACK};
use crate::data::Samples;
use crate::ingest::number_type::{NumberType, for_number_types};
use crate::ingest::{Limits, RecordingFile, recording_file::OpenFile, refusal::Refusal, unpack};
use rayon::prelude::*;
use std::io::{Read, Seek, SeekFrom};

/// Bytes read at a time of a dataset that lies in one piece: they stay in the cache until they are turned.
const PIECE_BYTES: usize = 1 << 18;

/// A number as HDF5 stores it, to the sample that it is held as.
trait Stored {
    /// f32 for f32 and short integers, f64 for all others.
    type Sample: Copy + Default + Send + Sync;
    /// From its bytes, least first, given one by one.
    fn sample(byte: impl Fn(usize) -> u8) -> Self::Sample;
}

macro_rules! stored {
    ($($name:ident = $number:ty as $sample:ident in $samples:ident),*) => {
        $(impl Stored for $number {
            type Sample = $sample;
            #[allow(clippy::cast_lossless, clippy::cast_precision_loss, reason = "counts beyond 2^53 lose \
                what no sensor resolves")]
            fn sample(byte: impl Fn(usize) -> u8) -> $sample {
                Self::from_le_bytes(std::array::from_fn(byte)) as $sample
            }
        })*

        /// The numbers of a column, or of a field of records; `None` where the library must read them: other
        /// filters, types or byte orders, chunks that were never written, damage. For records the library
        /// would need a type made for them, which only its unsafe part can have.
        fn numbers(column: &DatasetColumn) -> Option<Samples> {
            match column.number {
                $(NumberType::$name => values::<$number>(column).map(Samples::$samples)),*
            }
        }
    };
}
for_number_types!(stored);

impl DatasetColumn {
    /// Its numbers as stored: f32 and short integers as f32, the rest as f64.
    ///
    /// # Errors
    /// They cannot be unpacked.
    pub(super) fn samples(&self) -> Result<Samples, Refusal> {
        if let Some(numbers) = numbers(self) {
            return Ok(numbers);
        }
        let slab = match &self.place {
            Place::Field(_) => {
                let stored = self.dataset.described();
                let problem = format!(
                    "cannot be unpacked from {stored}: damaged, or by other filters than deflate and shuffle"
                );
                let mend = format!("{AGAIN}, or {REPACK}");
                return Err(Refusal::of(&self.source, problem, mend));
            }
            Place::Whole => Slab::Whole,
            Place::Row => Slab::Row(self.index),
            Place::Column => Slab::Column(self.index),
        };
        let read = self.file.values(&self.path, slab, self.length, self.number.is_wide())?;
        let problem = |(from, upto)| {
            format!("lacks its samples {from} to {upto}: the damaged index leads to no chunk of them")
        };
        let lost = self.lost_rows(&read).map(|rows| Refusal::of(&self.source, problem(rows), AGAIN));
        lost.map_or(Ok(read), Err)
    }

    /// The first and last number of a chunk that the library does not find, and takes for zeros that were
    /// never written, though the index lists it with other numbers, or lists one in its stead elsewhere.
    fn lost_rows(&self, read: &Samples) -> Option<(usize, usize)> {
        let Storage::Chunked { shape, chunks: Some(listed) } = &self.dataset.storage else { return None };
        let value_bytes = usize::try_from(self.dataset.value_bytes).ok()?;
        let (rows, packing, index) = (0, Packing::Plain, self.index);
        let layout = ChunkLayout { rows, columns: 1, value_bytes, packing, field: None, index };
        let (layout, chunks) = layout.in_chunks(&self.dataset, shape, listed)?;
        if matches!(self.place, Place::Row) || self.dataset.shape.as_ref()?.first() != Some(&self.length) {
            return None;
        }
        let is_moved = chunks.iter().any(|chunk| chunk.row >= self.length)
            || chunks.windows(2).any(|two| two[0].row == two[1].row);
        let source = RecordingFile { path: &self.file.path, in_memory: self.file.in_memory.as_ref() };
        let (mut file, mut packed, mut bytes) = (source.opened().ok()?, Vec::new(), Vec::new());
        let mut is_lost = |row: usize, upto: usize| {
            let is_blank = (row..upto).all(|i| read.get(i).to_bits() == 0);
            let chunk = chunks.iter().find(|chunk| chunk.row == row);
            is_blank
                && chunk.map_or(is_moved, |chunk| {
                    let unpacked = layout.unpack(&mut file, chunk, &mut packed, &mut bytes);
                    unpacked.is_some() && layout.columns == 1 && bytes.iter().any(|byte| *byte != 0)
                })
        };
        let upto = |row: usize| row.saturating_add(layout.rows).min(self.length);
        let mut stretches = (0..self.length).step_by(layout.rows.max(1));
        stretches.find(|&row| is_lost(row, upto(row))).map(|row| (row + 1, upto(row)))
    }
}

fn values<T: Stored>(column: &DatasetColumn) -> Option<Vec<T::Sample>> {
    let DatasetColumn { file, dataset, place, .. } = column;
    let (index, field) = match place {
        Place::Field(field) => (0, Some(field)),
        Place::Whole | Place::Column if dataset.is_plain => (column.index, None),
        _ => return None,
    };
    let value_bytes = usize::try_from(dataset.value_bytes).ok().filter(|bytes| *bytes > 0)?;
    let layout = ChunkLayout { rows: 0, columns: 1, value_bytes, packing: Packing::Plain, field, index };
    let (layout, chunks) = match &dataset.storage {
        // Addresses count from behind a user block in some versions of the library and from the file's start
        // in others.
        _ if file.opened.user_block != 0 => return None,
        Storage::Contiguous(from) => layout.in_one_piece(column, (*from)?)?,
        Storage::Chunked { shape, chunks } => layout.in_chunks(dataset, shape, chunks.as_ref()?)?,
        _ => return None,
    };
    let source = RecordingFile { path: &file.path, in_memory: file.in_memory.as_ref() };
    let mut values = vec![T::Sample::default(); column.length];
    // A chunk for every stretch of rows, or the rest is what the library fills in.
    if chunks.len() != column.length.div_ceil(layout.rows) {
        return None;
    }
    values
        .par_chunks_mut(layout.rows)
        .zip(&chunks)
        .enumerate()
        .with_min_len(layout.least_in_turn(chunks.len(), file.limits))
        .map_init(
            || (source.opened().ok(), Vec::new(), Vec::new()),
            |(file, packed, bytes), (i, (values, chunk))| {
                let is_next = chunk.row == i * layout.rows;
                is_next.then(|| layout.unpack(file.as_mut()?, chunk, packed, bytes))??;
                layout.take::<T>(bytes, chunk, values)
            },
        )
        .collect::<Option<()>>()?;
    Some(values)
}

/// How the values of a column lie in the chunks of its dataset.
struct ChunkLayout<'a> {
    /// Of a chunk.
    rows: usize,
    /// Of a chunk.
    columns: usize,
    /// Of one value or record.
    value_bytes: usize,
    packing: Packing,
    /// The field to be taken, where the values are records.
    field: Option<&'a RecordField>,
    /// The column to be taken.
    index: usize,
}

impl RecordField {
    /// Where byte `i` of its number, counted from the lowest, stands in a record.
    fn byte(&self, i: usize) -> usize {
        self.from + if self.is_big_endian { self.number.bytes() - 1 - i } else { i }
    }
}

impl ChunkLayout<'_> {
    /// With the pieces in which a dataset that lies in one is read.
    fn in_one_piece(self, column: &DatasetColumn, from: u64) -> Option<(Self, Vec<StoredChunk>)> {
        let (bytes, rows) = (self.value_bytes, (PIECE_BYTES / self.value_bytes).max(1));
        let stored = column.length.checked_mul(bytes)? as u64;
        let is_within = from.checked_add(stored).is_some_and(|end| end <= column.file.bytes);
        let piece = |row: usize| StoredChunk {
            row,
            column: 0,
            at: from + (row * bytes) as u64,
            bytes: rows.min(column.length - row) * bytes,
        };
        let pieces = || (0..column.length).step_by(rows).map(piece).collect();
        (is_within && column.dataset.stored_bytes == stored).then(|| (Self { rows, ..self }, pieces()))
    }

    /// With the chunks that hold the column, in order.
    fn in_chunks(
        self,
        dataset: &Dataset,
        shape: &[usize],
        chunks: &[StoredChunk],
    ) -> Option<(Self, Vec<StoredChunk>)> {
        let packing = Packing::of(&dataset.filters)?;
        let (rows, columns) = (*shape.first()?, shape.get(1).copied().unwrap_or(1));
        let holds =
            |chunk: &&StoredChunk| self.index.checked_sub(chunk.column).is_some_and(|first| first < columns);
        let mut chunks: Vec<StoredChunk> = chunks.iter().filter(holds).cloned().collect();
        chunks.sort_by_key(|chunk| chunk.row);
        (shape.len() <= 2).then_some((Self { rows, columns, packing, ..self }, chunks))
    }

    /// How many of `count` chunks one thread at least unpacks in turn: those beside one another take half of
    /// what one may, however many cores there are.
    fn least_in_turn(&self, count: usize, limits: Limits) -> usize {
        let bytes = self.rows.saturating_mul(self.columns).saturating_mul(self.value_bytes) as u64;
        // Half of that, for each is held packed and unpacked.
        let beside = limits.part_bytes() / bytes.saturating_mul(4).max(1);
        let beside = usize::try_from(beside).unwrap_or(usize::MAX).max(1);
        if beside < rayon::current_num_threads() { count.div_ceil(beside) } else { 1 }
    }

    /// The bytes of a chunk as they were before they were deflated.
    fn unpack(
        &self,
        file: &mut OpenFile,
        chunk: &StoredChunk,
        packed: &mut Vec<u8>,
        bytes: &mut Vec<u8>,
    ) -> Option<()> {
        let whole = self.rows.checked_mul(self.columns)?.checked_mul(self.value_bytes)?;
        // Deflate stores what it cannot pack with five bytes for each 16 KiB: a longer chunk is damage.
        if chunk.bytes > whole.checked_mul(2)?.checked_add(1024)? {
            return None;
        }
        file.seek(SeekFrom::Start(chunk.at)).ok()?;
        if self.packing == Packing::Plain {
            bytes.resize(chunk.bytes, 0);
            return file.read_exact(bytes).ok();
        }
        packed.clear();
        file.take(chunk.bytes as u64).read_to_end(packed).ok()?;
        if self.packing == Packing::DeflatedShuffled {
            *packed = unshuffled(packed, self.value_bytes);
        }
        bytes.resize(whole, 0);
        (unpack::inflate(packed, true, bytes)? == whole).then_some(())
    }

    /// The chunk's share of the column out of its bytes; `None` where it is short of it.
    fn take<T: Stored>(&self, bytes: &[u8], chunk: &StoredChunk, values: &mut [T::Sample]) -> Option<()> {
        let (size, first) = (self.value_bytes, self.index - chunk.column);
        if bytes.len() < values.len() * self.columns * size {
            return None;
        }
        let rows = values.iter_mut().zip(bytes.chunks_exact(self.columns * size));
        // A loop for each: where nothing in a loop is asked anew, it takes half the time.
        match (self.packing, self.field) {
            (Packing::ShuffledDeflated, None) => self.take_shuffled::<T>(bytes, first, values, |i| i),
            (Packing::ShuffledDeflated, Some(field)) => {
                self.take_shuffled::<T>(bytes, first, values, |i| field.byte(i));
            }
            (_, None) => rows.for_each(|(value, row)| {
                let stored = &row[first * size..][..size_of::<T>()];
                *value = T::sample(|i| stored[i]);
            }),
            (_, Some(field)) => rows.for_each(|(value, row)| {
                let record = &row[first * size..];
                *value = T::sample(|i| record[field.byte(i)]);
            }),
        }
        Some(())
    }

    fn take_shuffled<T: Stored>(
        &self,
        bytes: &[u8],
        first: usize,
        values: &mut [T::Sample],
        byte: impl Fn(usize) -> usize,
    ) {
        let count = self.rows * self.columns;
        for (row, value) in values.iter_mut().enumerate() {
            let at = row * self.columns + first;
            *value = T::sample(|i| bytes[byte(i) * count + at]);
        }
    }
}

/// Bytes as they were before they were shuffled as values of so many bytes; what is left behind the last
/// value stays.
fn unshuffled(bytes: &[u8], size: usize) -> Vec<u8> {
    let count = bytes.len() / size;
    let (values, rest) = bytes.split_at(count * size);
    let ordered = (0..count).flat_map(|value| (0..size).map(move |i| values[i * count + value]));
    ordered.chain(rest.iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{find, room};
    use super::*;
    use crate::ingest::hdf5::answer::Slab;
    use std::path::Path;

    /// 20 000 rows of numbers that pack and are all different, in one column or three.
    fn written(columns: usize) -> Vec<i32> {
        (0..20_000 * i32::try_from(columns).unwrap()).map(|i| i * 7919 % 100_003 - 50_000).collect()
    }

    fn opened(path: &Path, source: &str) -> DatasetColumn {
        let file = room::File::open(path, Limits::default()).unwrap();
        find::locate(&file, source).unwrap()
    }

    fn write(path: &Path, columns: usize, chunk_rows: usize, shuffle: bool) {
        let file = hdf5_metno::File::create(path).unwrap();
        let builder = file.new_dataset::<i32>();
        let builder = if shuffle { builder.shuffle() } else { builder }.deflate(4);
        if columns == 1 {
            let dataset = builder.chunk(chunk_rows).shape(20_000).create("a").unwrap();
            dataset.write_raw(&written(1)).unwrap();
        } else {
            let dataset = builder.chunk((chunk_rows, 2)).shape((20_000, columns)).create("a").unwrap();
            dataset.write_raw(&written(columns)).unwrap();
        }
        file.close().unwrap();
    }

    #[test]
    fn a_column_is_what_the_library_reads() {
        let folder = tempfile::tempdir().unwrap();
        for (columns, chunk_rows, shuffle) in
            [(1, 999, false), (1, 20_000, true), (3, 777, true), (3, 1, false)]
        {
            let path = folder.path().join(format!("{columns}-{chunk_rows}.h5"));
            write(&path, columns, chunk_rows, shuffle);
            for index in 0..columns {
                let expected: Vec<f64> =
                    written(columns).into_iter().skip(index).step_by(columns).map(f64::from).collect();
                let expected = Samples::F64(expected);
                let source = if columns == 1 { "/a".to_owned() } else { format!("/a[{index}]") };
                let slab = if columns == 1 { Slab::Whole } else { Slab::Column(index) };
                let column = opened(&path, &source);
                assert_eq!(column.file.values("/a", slab, 20_000, true), Ok(expected.clone()));
                assert_eq!(numbers(&column), Some(expected), "{columns} {chunk_rows} {index}");
            }
        }
    }

    #[test]
    fn a_dataset_in_one_piece_is_what_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plain.h5");
        let file = hdf5_metno::File::create(&path).unwrap();
        let values: Vec<f32> =
            (0..100_003).map(|i: i32| 0.25 * f32::from(i16::try_from(i % 30_000).unwrap())).collect();
        file.new_dataset_builder().with_data(&values).create("a").unwrap();
        file.close().unwrap();
        assert_eq!(numbers(&opened(&path, "/a")), Some(Samples::F32(values)));
    }

    #[test]
    fn what_is_damaged_or_not_there_is_left_to_the_library() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("damaged.h5");
        write(&path, 1, 999, true);
        let column = opened(&path, "/a");
        let Storage::Chunked { chunks: Some(chunks), .. } = &column.dataset.storage else {
            panic!("no chunks")
        };
        let place = chunks.last().unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        bytes[usize::try_from(place.at).unwrap() + place.bytes / 2] ^= 0x10;
        let path = folder.path().join("changed.h5");
        std::fs::write(&path, bytes).unwrap();
        assert_eq!(numbers(&opened(&path, "/a")), None);
        let path = folder.path().join("partly.h5");
        let file = hdf5_metno::File::create(&path).unwrap();
        let dataset = file.new_dataset::<i32>().deflate(1).chunk(5000).shape(20_000).create("a").unwrap();
        dataset.write_slice(&written(1)[..5000], 5000..10_000).unwrap();
        drop(dataset);
        file.close().unwrap();
        assert_eq!(numbers(&opened(&path, "/a")), None);
    }
}
