//! An HDF5 file, through the C library, to descriptions and numbers: all that hands a file's bytes to C, in a
//! process of its own.

use super::answer::{
    AttributeValue, Bytes, Dataset, FRAME_NUMBERS, Filter, Object, Packing, Reply, Slab, Storage,
    StoredChunk, receive, send,
};
use super::tree::{
    ELSEWHERE, LinkKind, MOST_BYTES, MOST_CHUNKS, MOST_VALUES, Members, Send, Store, TEXT_BYTES, Tree, joined,
};
use super::{names, types};
use hdf5_metno::dataset::Layout;
use hdf5_metno::types::{FixedAscii, FixedUnicode, TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5_metno::{
    Container, File, H5Type, Hyperslab, IndexType, IterationOrder, LinkType, Location, LocationToken,
    LocationType, Selection, SliceOrIndex,
};
use std::io::{self, Read, Write};
use std::path::Path;

/// A file as the library has it open.
struct LibraryFile<'a> {
    file: File,
    /// Told how many bytes come next, and how many are held at a time.
    grant: &'a mut dyn FnMut(u64, u64),
}

/// Answers what is asked about the file at `path` until nobody asks any more.
///
/// # Errors
/// Nobody listens.
pub(super) fn answer(
    path: &Path,
    from: &mut impl Read,
    to: &mut impl Write,
    is_walled: bool,
    grant: &mut dyn FnMut(u64, u64),
) -> io::Result<()> {
    hdf5_metno::silence_errors(true);
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) => {
            send(to, &Reply::Refused(words(&error)))?;
            return to.flush();
        }
    };
    let (user_block, library) = (file.userblock(), hdf5_metno::library_version());
    send(to, &Reply::Opened { user_block, library, is_walled })?;
    to.flush()?;
    let mut tree = Tree::of(LibraryFile { file, grant }, is_walled);
    while let Ok((request, _)) = receive(from) {
        tree.answer(request, &mut |reply| send(to, &reply))?;
        to.flush()?;
    }
    Ok(())
}

/// The library's words why something failed, outermost first.
fn words(error: &hdf5_metno::Error) -> Vec<Bytes> {
    match error {
        hdf5_metno::Error::Internal(text) => vec![text.clone().into_bytes()],
        hdf5_metno::Error::HDF5(stack) => match stack.clone().expand() {
            Ok(frames) => frames.iter().map(|frame| frame.desc().as_bytes().to_vec()).collect(),
            Err(_) => Vec::new(),
        },
    }
}

impl Store for LibraryFile<'_> {
    type Token = LocationToken;

    fn token(&mut self, path: &str) -> Option<LocationToken> {
        let place = if path == "/" { self.file.loc_info() } else { self.file.loc_info_by_name(path) };
        place.ok().map(|place| place.token)
    }

    fn members(&mut self, group: &str) -> Members {
        let links =
            self.file.group(group).and_then(|group| group.links(IndexType::Name, IterationOrder::Native));
        let kind = |link: LinkType| match link {
            LinkType::Hard => LinkKind::Hard,
            LinkType::Soft => LinkKind::Soft,
            LinkType::External => LinkKind::External,
        };
        links.unwrap_or_default().into_iter().map(|(name, link)| (name, kind(link.link_type))).collect()
    }

    fn object(&mut self, path: &str) -> Result<Object, Vec<Bytes>> {
        self.opened(path).map_err(|error| words(&error))
    }

    fn value(&mut self, path: &str) -> Option<AttributeValue> {
        self.file.dataset(path).ok().and_then(|dataset| value(&dataset))
    }

    fn read(&mut self, path: &str, is_wide: bool, slab: Slab, send: Send) -> io::Result<()> {
        let sent = if is_wide {
            self.send_numbers(path, slab, |numbers| send(Reply::Wide(numbers)))
        } else {
            self.send_numbers(path, slab, |numbers| send(Reply::Narrow(numbers)))
        };
        sent.or_else(|error| send(Reply::Refused(words(&error))))
    }
}

impl LibraryFile<'_> {
    fn opened(&self, path: &str) -> hdf5_metno::Result<Object> {
        let kind = if path == "/" { LocationType::Group } else { self.file.loc_type_by_name(path)? };
        let own = self.file.filename();
        // A link within the file may lead to one that leaves it.
        let is_elsewhere = |place: &Location| place.filename().as_bytes() != own.as_bytes();
        match kind {
            LocationType::Group => {
                let group = self.file.group(path)?;
                if is_elsewhere(&group) {
                    return Ok(Object::NotFollowed(ELSEWHERE.into()));
                }
                Ok(Object::Group { attributes: attributes_of(&group), times: Vec::new() })
            }
            LocationType::Dataset => {
                let dataset = self.file.dataset(path)?;
                if is_elsewhere(&dataset) {
                    return Ok(Object::NotFollowed(ELSEWHERE.into()));
                }
                described(&dataset).map(Object::Dataset)
            }
            _ => Ok(Object::NamedType),
        }
    }

    fn send_numbers<T: H5Type + Copy>(
        &mut self,
        path: &str,
        slab: Slab,
        mut send: impl FnMut(Vec<T>) -> io::Result<()>,
    ) -> hdf5_metno::Result<()> {
        let dataset = self.file.dataset(path)?;
        let shape = dataset.shape();
        let chunk = dataset.chunk().unwrap_or_else(|| vec![1; shape.len()]);
        let (along, across) = match slab {
            Slab::Whole => (usize::from(shape.len() == 2 && shape[0] == 1), 0),
            Slab::Row(row) => (1, row),
            Slab::Column(column) => (0, column),
        };
        // Picking a column of chunks in the library costs four times as much as taking whole rows of them.
        let is_picked = along == 0 && shape.len() == 2 && dataset.is_chunked();
        let width = if is_picked { shape[1] } else { 1 };
        // Whole chunks, so that none is unpacked twice.
        let chunks = (FRAME_NUMBERS / width / chunk[along]).max(1);
        let step = chunks.saturating_mul(chunk[along]);
        let bytes = |values: usize| values.saturating_mul(size_of::<T>()) as u64;
        let in_chunk = chunk.iter().fold(1_usize, |all, &n| all.saturating_mul(n));
        let beside = width.max(*chunk.get(1 - along).unwrap_or(&1));
        let unpacked = bytes(shape[along].saturating_mul(beside));
        (self.grant)(unpacked, bytes(in_chunk).saturating_add(bytes(step.saturating_mul(width))));
        for from in (0..shape[along]).step_by(step) {
            let upto = from.saturating_add(step).min(shape[along]);
            let mut slab = vec![SliceOrIndex::from(across); shape.len()];
            slab[along] = SliceOrIndex::from(from..upto);
            let values: Vec<T> = if is_picked {
                slab[1] = SliceOrIndex::from(..);
                let rows = dataset.read_slice_2d::<T, Selection>(Hyperslab::from(slab).into())?;
                rows.into_raw_vec_and_offset().0.into_iter().skip(across).step_by(width).collect()
            } else {
                let line = dataset.read_slice_1d::<T, Selection>(Hyperslab::from(slab).into())?;
                line.into_raw_vec_and_offset().0
            };
            let mut parts = values.chunks(FRAME_NUMBERS);
            parts.try_for_each(|part| send(part.to_vec())).map_err(|deaf| deaf.to_string())?;
        }
        Ok(())
    }
}

/// A dataset without its numbers. Where they lie outside the file that is all that is asked of it: the
/// library would open the others.
fn described(dataset: &hdf5_metno::Dataset) -> hdf5_metno::Result<Dataset> {
    let made = dataset.create_plist()?;
    let dtype = dataset.dtype()?;
    let mut told = types::of_library::of(&dtype).dataset();
    if made.get_layout()? == Layout::Virtual {
        return Ok(told);
    }
    if !made.get_external()?.is_empty() {
        told.storage = Storage::External;
        return Ok(told);
    }
    let space = dataset.space()?;
    told.shape = (!space.is_null()).then(|| space.shape());
    // What cannot be told of the filters must not count as none.
    told.filters = made.get_filters()?.iter().map(filter).collect();
    told.stored_bytes = dataset.storage_size();
    told.attributes = attributes_of(dataset);
    told.storage = match made.get_chunk()? {
        Some(shape) => Storage::Chunked { shape, chunks: chunks(dataset, &told.filters) },
        None if dataset.layout() == Layout::Compact => Storage::Compact,
        None => Storage::Contiguous(dataset.offset()),
    };
    Ok(told)
}

fn filter(filter: &hdf5_metno::filters::Filter) -> Filter {
    let level = if let hdf5_metno::filters::Filter::Deflate(level) = filter { *level } else { 0 };
    Filter { number: filter.id(), level }
}

/// Where the chunks lie that this program unpacks itself; `None` where only the library can.
fn chunks(dataset: &hdf5_metno::Dataset, filters: &[Filter]) -> Option<Vec<StoredChunk>> {
    if Packing::of(filters).is_none() || dataset.ndim() > 2 || dataset.num_chunks()? > MOST_CHUNKS {
        return None;
    }
    let (mut chunks, mut is_whole) = (Vec::new(), true);
    let visited = dataset.chunks_visit(|chunk| {
        let stored = StoredChunk::of(chunk.offset, chunk.addr, chunk.size, chunk.filter_mask);
        is_whole &= stored.is_some() && chunks.len() < MOST_CHUNKS;
        chunks.extend(stored.filter(|_| is_whole));
        0
    });
    (visited.is_ok() && is_whole).then_some(chunks)
}

/// Those attributes of a place that may say something of samples.
fn attributes_of(place: &Location) -> Vec<(String, AttributeValue)> {
    // The wrapper makes text of names of any bytes; they are bytes again before anybody looks at them.
    let names = place.attr_names().unwrap_or_default().into_iter().map(String::into_bytes);
    let names = names.filter_map(|name| String::from_utf8(name).ok()).collect();
    let held = names::likeliest(names).into_iter().filter_map(|name| {
        let attribute = place.attr(&name).ok()?;
        Some((name, value(&attribute)?))
    });
    held.collect()
}

/// What an attribute holds; `None` where that is too much.
fn value(attribute: &Container) -> Option<AttributeValue> {
    let dtype = attribute.dtype().ok()?;
    if attribute.size() > MOST_VALUES || dtype.size().saturating_mul(attribute.size()) > MOST_BYTES {
        return None;
    }
    let texts = match dtype.to_descriptor() {
        Ok(TypeDescriptor::VarLenUnicode) => texts::<VarLenUnicode>(attribute, VarLenUnicode::as_bytes),
        Ok(TypeDescriptor::VarLenAscii) => texts::<VarLenAscii>(attribute, VarLenAscii::as_bytes),
        Ok(TypeDescriptor::FixedAscii(_)) => texts(attribute, FixedAscii::<TEXT_BYTES>::as_bytes),
        Ok(TypeDescriptor::FixedUnicode(_)) => texts(attribute, FixedUnicode::<TEXT_BYTES>::as_bytes),
        _ => attribute.read_raw().ok().map(|all| AttributeValue::Numbers(joined(all))),
    };
    Some(texts.unwrap_or(AttributeValue::Other))
}

/// Texts as the bytes that they are: the wrapper's own way to `str` does not look whether they are UTF-8.
fn texts<T: H5Type>(attribute: &Container, bytes: fn(&T) -> &[u8]) -> Option<AttributeValue> {
    let texts = attribute.read_raw::<T>().ok()?;
    let cut = |text: &T| bytes(text).iter().take(TEXT_BYTES).copied().collect();
    Some(AttributeValue::Texts(joined(texts.iter().map(cut).collect())))
}
