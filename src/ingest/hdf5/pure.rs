//! An HDF5 file in memory, by a library in Rust alone, to descriptions and numbers: what a page in a browser
//! has in place of the C library. What this one cannot tell it refuses.

mod attributes;
mod places;
mod words;

use super::answer::{
    AttributeValue, Bytes, DEFLATE, Dataset, FRAME_NUMBERS, Filter, Object, Packing, Reply, SHUFFLE, Slab,
    Storage, StoredChunk,
};
use super::tree::{ELSEWHERE, MOST_CHUNKS, Members, Send, Store};
use crate::numerics::to_f32;
use attributes::type_of;
use hdf5_reader::chunk_index::ChunkEntry;
use hdf5_reader::error::Error;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::dataspace::DataspaceType;
use hdf5_reader::messages::filter_pipeline::FilterDescription;
use hdf5_reader::messages::layout::DataLayout;
use hdf5_reader::object_header::ObjectHeader;
use hdf5_reader::{FilterRegistry, Hdf5File, OpenOptions};
use std::io;
use std::rc::Rc;
use std::sync::Arc;
use words::{beyond, words};

/// The library and its version, as Cargo.lock has it.
pub(in crate::ingest) const READER: &str = "hdf5-reader 0.12.1";

/// A file in memory as the library has it open.
pub(super) struct InMemory {
    file: Hdf5File,
    links: places::Links,
    /// The dataset of which a part was read last, and all its values: its next column comes from them.
    held: Option<(String, Rc<Vec<u8>>)>,
}

/// Opens a file, and says how many bytes stand before it.
///
/// # Errors
/// The library does not open it, or might read it wrong.
pub(super) fn opened(bytes: &Arc<[u8]>) -> Result<(InMemory, u64), Vec<Bytes>> {
    let options = OpenOptions::default().with_filter_registry(filters()).with_chunk_cache_bytes(0);
    let file =
        Hdf5File::from_shared_bytes_with_options(bytes.clone(), options).map_err(|error| match error {
            Error::InvalidMagic => vec![b"file signature not found".to_vec()],
            Error::UnexpectedEof { .. } | Error::OffsetOutOfBounds(_) => vec![b"truncated file".to_vec()],
            error => words(error),
        })?;
    let head = file.superblock();
    let (user_block, length) = (head.base_address, bytes.len() as u64);
    if (head.offset_size, head.length_size) != (8, 8) {
        return Err(beyond(&format!(
            "addresses of {} and lengths of {} bytes",
            head.offset_size, head.length_size
        )));
    }
    if head.version >= 3 && head.consistency_flags & 5 != 0 {
        return Err(vec![b"already open for write".to_vec()]);
    }
    // Written from the file's beginning or from behind the user block, as the library's version has it.
    if head.eof_address > length {
        let sizes = format!("truncated file: eof = {length}, stored_eof = {}", head.eof_address);
        return Err(vec![sizes.into_bytes()]);
    }
    let mut store = InMemory { file, links: places::Links::default(), held: None };
    let root = store.file.root_group().map_err(words)?.address();
    store.links.of(&store.file, root).map_err(words)?;
    Ok((store, user_block))
}

/// Those filters that are undone: the library's but SZIP, which was compared with nothing; LZF it lacks.
fn filters() -> FilterRegistry {
    let mut registry = FilterRegistry::new();
    for (number, name) in [(4, "SZIP"), (32_000, "LZF")] {
        registry.register(number, Box::new(move |_, _, _| Err(Error::UnsupportedFilter(name.into()))));
    }
    registry
}

fn filter(filter: &FilterDescription) -> Filter {
    let number = filter.id.into();
    let level = filter.client_data.first().filter(|_| number == DEFLATE);
    Filter { number, level: level.map_or(0, |level| u8::try_from(*level).unwrap_or(9)) }
}

/// Of so many values along each side, in the file: text of varying length takes other room in memory.
fn bytes_of(dataset: &hdf5_reader::Dataset, sizes: &[usize]) -> Result<u64, Vec<Bytes>> {
    let value_bytes = dataset.raw_element_size().map_err(words)? as u64;
    Ok(sizes.iter().fold(value_bytes, |all, &size| all.saturating_mul(size as u64)))
}

impl InMemory {
    fn header(&mut self, path: &str) -> Result<Option<(u64, Arc<ObjectHeader>)>, Error> {
        let Some(address) = self.links.lead(&self.file, path)? else { return Ok(None) };
        Ok(Some((address, self.file.get_or_parse_header(address)?)))
    }

    fn described(&mut self, path: &str) -> Result<Object, Vec<Bytes>> {
        let Some((address, header)) = self.header(path).map_err(words)? else {
            return Ok(Object::NotFollowed(ELSEWHERE.into()));
        };
        let has = |is_one: fn(&HdfMessage) -> bool| header.messages.iter().any(is_one);
        if has(|message| matches!(message, HdfMessage::DataLayout(_))) {
            return self.dataset(path, &header).map(Object::Dataset);
        }
        if has(|m| matches!(m, HdfMessage::SymbolTable(_) | HdfMessage::Link(_) | HdfMessage::LinkInfo(_))) {
            // A group whose members cannot be told is none.
            self.links.of(&self.file, address).map_err(words)?;
            let group = self.file.group(path).map_err(words)?;
            let attributes = attributes::held(&self.file, &group.raw_attributes().map_err(words)?)?;
            return Ok(Object::Group { attributes, times: Vec::new() });
        }
        Ok(Object::NamedType)
    }

    /// A dataset without its numbers.
    fn dataset(&mut self, path: &str, header: &ObjectHeader) -> Result<Dataset, Vec<Bytes>> {
        let dataset = self.file.dataset(path).map_err(words)?;
        let mut told = type_of(&dataset.raw_datatype().map_err(words)?)?.dataset();
        let (mut layout, mut fill) = (None, None);
        for message in &header.messages {
            match message {
                HdfMessage::Dataspace(space) => {
                    let sizes = space.dims.iter().map(|size| usize::try_from(*size).ok());
                    let shape: Option<Vec<usize>> = sizes.collect();
                    let shape =
                        shape.ok_or_else(|| beyond("a dataset of more values than can be counted"))?;
                    told.shape = (space.dataspace_type != DataspaceType::Null).then_some(shape);
                }
                HdfMessage::FilterPipeline(pipeline) => {
                    told.filters = pipeline.filters.iter().map(filter).collect();
                }
                HdfMessage::DataLayout(stated) => layout = Some(&stated.layout),
                HdfMessage::FillValue(value) => fill = value.value.as_ref().or(fill),
                HdfMessage::ExternalFiles(_) => {
                    return Ok(Dataset {
                        storage: Storage::External,
                        filters: Vec::new(),
                        shape: None,
                        ..told
                    });
                }
                _ => {}
            }
        }
        let raw = dataset.raw_attributes().map_err(words)?;
        told.attributes = attributes::held(&self.file, &raw)?;
        // The library fills what was never written with it, which the C library does not.
        let is_filled_otherwise =
            fill.is_none() && raw.iter().any(|attribute| attribute.name() == "_FillValue");
        let layout = layout.ok_or_else(|| beyond("a dataset without a layout"))?;
        self.place(&mut told, layout, &dataset, is_filled_otherwise)?;
        Ok(told)
    }

    /// Notes where the values of a dataset lie.
    fn place(
        &self,
        told: &mut Dataset,
        layout: &DataLayout,
        dataset: &hdf5_reader::Dataset,
        is_filled_otherwise: bool,
    ) -> Result<(), Vec<Bytes>> {
        match layout {
            DataLayout::Compact { data } => {
                (told.storage, told.stored_bytes) = (Storage::Compact, data.len() as u64);
            }
            DataLayout::Contiguous { address: u64::MAX, .. } => told.storage = Storage::Contiguous(None),
            DataLayout::Contiguous { address, .. } => {
                let at = address.saturating_add(self.file.superblock().base_address);
                told.stored_bytes = bytes_of(dataset, told.shape.as_deref().unwrap_or(&[]))?;
                told.storage = Storage::Contiguous(Some(at));
            }
            DataLayout::Chunked { address, dims, chunk_indexing, .. } => {
                let shape = told.shape.as_deref().unwrap_or(&[]);
                let chunk: Vec<usize> =
                    dims.iter().take(shape.len()).map(|&size| (size as usize).max(1)).collect();
                let sides = || shape.iter().zip(&chunk).map(|(&whole, &chunk)| (whole, chunk));
                let is_cut = sides().any(|(whole, chunk)| !whole.is_multiple_of(chunk));
                let is_shuffled = told.filters == [Filter { number: SHUFFLE, level: 0 }];
                if is_shuffled && is_cut && chunk_indexing.is_some() {
                    return Err(beyond("shuffled blocks at an edge, which may be shuffled or not"));
                }
                let index = chunk_indexing.as_ref();
                let mut chunks = places::chunks(&self.file, dataset, *address, index).map_err(words)?;
                let count =
                    sides().fold(1_usize, |all, (whole, chunk)| all.saturating_mul(whole.div_ceil(chunk)));
                if is_filled_otherwise && chunks.len() < count {
                    return Err(beyond("blocks that were never written beside an attribute _FillValue"));
                }
                if told.filters.is_empty() {
                    let bytes = bytes_of(dataset, &chunk)?;
                    for chunk in &mut chunks {
                        chunk.size = bytes;
                    }
                }
                told.stored_bytes = chunks.iter().fold(0, |all: u64, chunk| all.saturating_add(chunk.size));
                let is_told =
                    Packing::of(&told.filters).is_some() && chunk.len() <= 2 && chunks.len() <= MOST_CHUNKS;
                let base = self.file.superblock().base_address;
                let stored = |chunk: &ChunkEntry| {
                    let at = chunk.address.checked_add(base)?;
                    StoredChunk::of(&chunk.offsets, at, chunk.size, chunk.filter_mask)
                };
                let stored = || chunks.iter().map(stored).collect();
                told.storage = Storage::Chunked { shape: chunk, chunks: is_told.then(stored).flatten() };
            }
        }
        Ok(())
    }

    /// All values of a dataset, as they are stored but for filters.
    fn values(&mut self, path: &str, is_kept: bool) -> Result<Rc<Vec<u8>>, Vec<Bytes>> {
        if let Some((held, values)) = &self.held
            && held == path
        {
            return Ok(values.clone());
        }
        self.held = None;
        let values =
            Rc::new(self.file.dataset(path).and_then(|dataset| dataset.read_raw_bytes()).map_err(words)?);
        if is_kept {
            self.held = Some((path.to_owned(), values.clone()));
        }
        Ok(values)
    }

    /// The numbers of one channel among the values of a dataset.
    fn numbers(&mut self, path: &str, slab: Slab) -> Result<impl Iterator<Item = f64> + use<>, Vec<Bytes>> {
        let dataset = self.file.dataset(path).map_err(words)?;
        let dtype = type_of(&dataset.raw_datatype().map_err(words)?)?;
        let sizes: Option<Vec<usize>> =
            dataset.shape().iter().map(|size| usize::try_from(*size).ok()).collect();
        let (rows, columns) = match sizes.as_deref() {
            Some([rows]) => (*rows, 1),
            Some([rows, columns]) => (*rows, *columns),
            _ => return Err(beyond("a dataset of more than two dimensions")),
        };
        let number = dtype.to_number().ok_or_else(|| beyond("values that are no numbers"))?;
        let (from, step, count) = match slab {
            Slab::Whole => (0, 1, rows.saturating_mul(columns)),
            Slab::Row(row) => (row.saturating_mul(columns), 1, columns),
            Slab::Column(column) => (column, columns, rows),
        };
        let values = self.values(path, slab != Slab::Whole)?;
        let [from, step] = [from, step].map(|values| values.saturating_mul(dtype.bytes));
        let last = count.saturating_sub(1).saturating_mul(step).saturating_add(from);
        if last.saturating_add(dtype.bytes) > values.len() {
            return Err(vec![b"the dataset has fewer values than it states".to_vec()]);
        }
        Ok((0..count).map(move |i| number(&values[from + i * step..])))
    }
}

impl Store for InMemory {
    type Token = u64;

    fn token(&mut self, path: &str) -> Option<u64> {
        self.links.lead(&self.file, path).ok().flatten()
    }

    fn members(&mut self, group: &str) -> Members {
        let links = self.token(group).and_then(|address| self.links.of(&self.file, address).ok());
        links
            .iter()
            .flat_map(|links| links.iter())
            .map(|(name, link)| (name.clone(), places::kind(link)))
            .collect()
    }

    fn object(&mut self, path: &str) -> Result<Object, Vec<Bytes>> {
        self.described(path)
    }

    fn value(&mut self, path: &str) -> Option<AttributeValue> {
        let dataset = self.file.dataset(path).ok()?;
        let (message, values) = (dataset.raw_datatype().ok()?, dataset.read_raw_bytes().ok()?);
        attributes::value(&self.file, &message, &values, dataset.num_elements().ok()?).ok()?
    }

    fn read(&mut self, path: &str, is_wide: bool, slab: Slab, send: Send) -> io::Result<()> {
        let mut numbers = match self.numbers(path, slab) {
            Ok(numbers) => numbers,
            Err(words) => return send(Reply::Refused(words)),
        };
        loop {
            let next: Vec<f64> = numbers.by_ref().take(FRAME_NUMBERS).collect();
            if next.is_empty() {
                return Ok(());
            }
            let narrow = |next: Vec<f64>| Reply::Narrow(next.into_iter().map(to_f32).collect());
            send(if is_wide { Reply::Wide(next) } else { narrow(next) })?;
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
