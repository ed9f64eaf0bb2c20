//! An HDF5 file in memory, by a library in Rust alone, to descriptions and numbers: what a page in a browser
//! has in place of the C library. What this one cannot tell it refuses.

mod attributes;
mod filters;
mod places;

use super::answer::{
    AttributeValue, Bytes, Dataset, FRAME_NUMBERS, Filter, NumberType, Object, Packing, Reply, Slab, Storage,
    StoredChunk, receive, send,
};
use super::fault::BEYOND;
use super::tree::{ELSEWHERE, MOST_CHUNKS, Members, Store, Tree};
use super::types::{Kind, Order, Type, of_message};
use hdf5_reader::chunk_index::ChunkEntry;
use hdf5_reader::error::Error;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::dataspace::DataspaceType;
use hdf5_reader::messages::layout::DataLayout;
use hdf5_reader::object_header::ObjectHeader;
use hdf5_reader::{Hdf5File, OpenOptions};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::rc::Rc;
use std::sync::Arc;

/// The library and its version, as Cargo.lock has it.
pub(super) const READER: &str = "hdf5-reader 0.12.1";

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
    let options = OpenOptions::default().with_filter_registry(filters::registry()).with_chunk_cache_bytes(0);
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

/// Words for what the library does not read, or might read wrong.
fn beyond(what: &str) -> Vec<Bytes> {
    vec![format!("{BEYOND}{what}").into_bytes()]
}

/// The library's words why something failed.
fn words(error: Error) -> Vec<Bytes> {
    match error {
        Error::Context { source, .. } => words(*source),
        Error::UnsupportedLayoutClass(3) => beyond("a dataset whose values lie in other datasets"),
        Error::DecompressionError(_) | Error::FilterError(_) => {
            vec![b"filter returned failure".to_vec(), error.to_string().into_bytes()]
        }
        Error::InvalidData(what) if what.contains("UTF-8") => beyond("names that are not in UTF-8"),
        error => match error.to_string().strip_prefix("unsupported ") {
            Some(what) => beyond(what),
            None => vec![error.to_string().into_bytes()],
        },
    }
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
        let mut told = Dataset::of_type(&type_of(&dataset.raw_datatype().map_err(words)?)?);
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
                    told.filters = pipeline.filters.iter().map(filters::named).collect();
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
        let is_filled_otherwise =
            fill.is_none() && raw.iter().any(|attribute| attribute.name() == "_FillValue");
        self.place(&mut told, layout, &dataset, is_filled_otherwise)?;
        Ok(told)
    }

    /// Notes where the values of a dataset lie.
    fn place(
        &self,
        told: &mut Dataset,
        layout: Option<&DataLayout>,
        dataset: &hdf5_reader::Dataset,
        is_filled_otherwise: bool,
    ) -> Result<(), Vec<Bytes>> {
        let shape = told.shape.as_deref().unwrap_or(&[]);
        // In the file: text of varying length takes other room there than in memory.
        let value_bytes = dataset.raw_element_size().map_err(words)? as u64;
        let bytes = |sizes: &[usize]| sizes.iter().fold(value_bytes, |all, &n| all.saturating_mul(n as u64));
        let base = self.file.superblock().base_address;
        match layout {
            Some(DataLayout::Compact { data }) => {
                (told.storage, told.stored_bytes) = (Storage::Compact, data.len() as u64);
            }
            Some(DataLayout::Contiguous { address, .. }) => {
                let at = (*address != u64::MAX).then(|| address.saturating_add(base));
                told.stored_bytes = at.map_or(0, |_| bytes(shape));
                told.storage = Storage::Contiguous(at);
            }
            Some(DataLayout::Chunked { address, dims, chunk_indexing, .. }) => {
                let chunk: Vec<usize> = dims.iter().take(shape.len()).map(|&n| n as usize).collect();
                let chunk_bytes = bytes(&chunk);
                let grid = shape.iter().zip(&chunk).map(|(&whole, &chunk)| whole.div_ceil(chunk.max(1)));
                let count = grid.fold(1_usize, usize::saturating_mul);
                let is_cut =
                    shape.iter().zip(&chunk).any(|(whole, chunk)| !whole.is_multiple_of(*chunk.max(&1)));
                if told.filters == [Filter::Shuffle] && is_cut && chunk_indexing.is_some() {
                    return Err(beyond("shuffled blocks at an edge, which may be shuffled or not"));
                }
                let mut chunks =
                    places::chunks(&self.file, dataset, *address, chunk_indexing.as_ref()).map_err(words)?;
                if told.filters.is_empty() {
                    chunks.iter_mut().for_each(|stored| stored.size = chunk_bytes);
                }
                if is_filled_otherwise && chunks.len() < count {
                    return Err(beyond("blocks that were never written beside an attribute _FillValue"));
                }
                told.stored_bytes = chunks.iter().fold(0, |all: u64, chunk| all.saturating_add(chunk.size));
                let is_told = Packing::of(&told.filters).is_some() && chunk.len() <= 2;
                let chunks = (is_told && chunks.len() <= MOST_CHUNKS)
                    .then(|| {
                        chunks.iter().map(|chunk| stored(chunk, base)).collect::<Option<Vec<StoredChunk>>>()
                    })
                    .flatten();
                told.storage = Storage::Chunked { shape: chunk, chunks };
            }
            None => return Err(beyond("a dataset without a layout")),
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

    fn numbers(&mut self, path: &str, slab: Slab) -> Result<Numbers, Vec<Bytes>> {
        let dataset = self.file.dataset(path).map_err(words)?;
        let message = dataset.raw_datatype().map_err(words)?;
        let dtype = type_of(&message)?;
        let sizes: Option<Vec<usize>> =
            dataset.shape().iter().map(|size| usize::try_from(*size).ok()).collect();
        let (rows, columns) = match sizes.as_deref() {
            Some([rows]) => (*rows, 1),
            Some([rows, columns]) => (*rows, *columns),
            _ => return Err(beyond("a dataset of more than two dimensions")),
        };
        let number = NumberIn::of(&dtype, &message).ok_or_else(|| beyond("values that are no numbers"))?;
        let (from, step, count) = match slab {
            Slab::Whole => (0, 1, rows.saturating_mul(columns)),
            Slab::Row(row) => (row.saturating_mul(columns), 1, columns),
            Slab::Column(column) => (column, columns, rows),
        };
        let values = self.values(path, slab != Slab::Whole)?;
        let [from, step] = [from, step].map(|values| values.saturating_mul(dtype.bytes));
        let last = count.saturating_sub(1).saturating_mul(step).saturating_add(from);
        if last.saturating_add(number.bytes()) > values.len() {
            return Err(vec![b"the dataset has fewer values than it states".to_vec()]);
        }
        Ok(Numbers { values, number, from, step, count })
    }
}

impl Store for InMemory {
    type Token = u64;

    fn token(&mut self, path: &str) -> Option<u64> {
        self.links.lead(&self.file, path).ok().flatten()
    }

    fn members(&mut self, group: &str) -> Members {
        let links = self.token(group).and_then(|address| self.links.of(&self.file, address).ok());
        links.iter().flat_map(|links| links.iter()).map(|(name, link)| (name.clone(), link.kind())).collect()
    }

    fn object(&mut self, path: &str) -> Result<Object, Vec<Bytes>> {
        self.described(path)
    }

    fn value(&mut self, path: &str) -> Option<AttributeValue> {
        let dataset = self.file.dataset(path).ok()?;
        let (message, values) = (dataset.raw_datatype().ok()?, dataset.read_raw_bytes().ok()?);
        attributes::value(&self.file, &message, &values, dataset.num_elements().ok()?).ok()?
    }

    fn read(&mut self, path: &str, is_wide: bool, slab: Slab, to: &mut impl Write) -> io::Result<()> {
        match self.numbers(path, slab) {
            Ok(numbers) => numbers.send(is_wide, to),
            Err(words) => send(to, &Reply::Refused(words)),
        }
    }
}

/// The type that a message states.
fn type_of(message: &[u8]) -> Result<Type, Vec<Bytes>> {
    let dtype = of_message::of(message).ok_or_else(|| beyond("values of an unknown type"))?;
    if matches!(dtype.kind, Kind::OddNumber) && !of_message::is_half(message) {
        return Err(beyond(&format!("numbers of an unusual kind, {} bytes each", dtype.bytes)));
    }
    Ok(dtype)
}

/// A chunk in a file that begins so many bytes behind its first; `None` where filters were left out.
fn stored(chunk: &ChunkEntry, base: u64) -> Option<StoredChunk> {
    let place = |i: usize| chunk.offsets.get(i).map_or(Some(0), |&n| usize::try_from(n).ok());
    let bytes = usize::try_from(chunk.size).ok()?;
    (chunk.filter_mask == 0).then_some(StoredChunk {
        row: place(0)?,
        column: place(1)?,
        at: chunk.address.checked_add(base)?,
        bytes,
    })
}

/// How a number is stored.
#[derive(Clone, Copy)]
struct NumberIn {
    number: NumberType,
    is_big_endian: bool,
    is_half: bool,
}

impl NumberIn {
    /// `None` where the type is none of numbers.
    fn of(dtype: &Type, message: &[u8]) -> Option<Self> {
        let is_big_endian = dtype.order == Order::Highest;
        Some(Self { number: dtype.number()?, is_big_endian, is_half: of_message::is_half(message) })
    }

    fn bytes(self) -> usize {
        if self.is_half { 2 } else { self.number.bytes() }
    }

    /// From its bytes.
    #[allow(clippy::cast_precision_loss, reason = "counts beyond 2^53 lose what no sensor resolves")]
    fn value(self, stored: &[u8]) -> f64 {
        let (mut bytes, length) = ([0; 8], stored.len());
        bytes[..length].copy_from_slice(stored);
        if self.is_big_endian {
            bytes[..length].reverse();
        }
        let (unsigned, beside) = (u64::from_le_bytes(bytes), 64 - 8 * u32::try_from(length).unwrap_or(8));
        let [low, high, ..] = bytes;
        match self.number {
            NumberType::F32 if self.is_half => half(u16::from_le_bytes([low, high])),
            NumberType::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]).into(),
            NumberType::F64 => f64::from_bits(unsigned),
            NumberType::U8 | NumberType::U16 | NumberType::U32 | NumberType::U64 => unsigned as f64,
            _ => ((unsigned << beside).cast_signed() >> beside) as f64,
        }
    }
}

/// IEEE 754 binary16.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    let size = match exponent {
        0 => fraction * 2_f64.powi(-14),
        31 if fraction > 0.0 => f64::NAN,
        31 => f64::INFINITY,
        _ => (1.0 + fraction) * 2_f64.powi(exponent - 15),
    };
    if bits >> 15 == 0 { size } else { -size }
}

/// Numbers of one channel among the values of a dataset, all within them.
struct Numbers {
    values: Rc<Vec<u8>>,
    number: NumberIn,
    /// Of the first, bytes.
    from: usize,
    /// From one to the next, bytes.
    step: usize,
    count: usize,
}

impl Numbers {
    fn send(&self, is_wide: bool, to: &mut impl Write) -> io::Result<()> {
        for first in (0..self.count).step_by(FRAME_NUMBERS) {
            let places = first..self.count.min(first + FRAME_NUMBERS);
            let numbers = places
                .map(|i| self.number.value(&self.values[self.from + i * self.step..][..self.number.bytes()]));
            #[allow(clippy::cast_possible_truncation, reason = "short numbers alone are asked for so")]
            let reply = if is_wide {
                Reply::Wide(numbers.collect())
            } else {
                Reply::Narrow(numbers.map(|number| number as f32).collect())
            };
            send(to, &reply)?;
        }
        Ok(())
    }
}

/// Answers on the spot, in the place of a process, what is asked.
pub(super) struct OnTheSpot {
    tree: Tree<InMemory>,
    asked: Vec<u8>,
    answers: Answers,
}

/// What was answered and not yet heard.
#[derive(Clone, Default)]
pub(super) struct Answers(Rc<RefCell<VecDeque<u8>>>);

impl OnTheSpot {
    /// To be asked, and where the answers come from.
    pub(super) fn of(store: InMemory) -> (Self, Answers) {
        let answers = Answers::default();
        (Self { tree: Tree::of(store, true), asked: Vec::new(), answers: answers.clone() }, answers)
    }
}

impl Write for OnTheSpot {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.asked.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        let (request, _) = receive(&mut &self.asked[..])?;
        self.asked.clear();
        self.tree.answer(request, &mut *self.answers.0.borrow_mut())
    }
}

impl Read for Answers {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.borrow_mut().read(buffer)
    }
}

#[cfg(test)]
pub(super) mod tests;
