//! An HDF5 file, through the C library, to descriptions and numbers: all that hands a file's bytes to C, in a process of its own.

use super::answer::{
    AttributeValue, Bytes, Dataset, FRAME_NUMBERS, Filter, Object, Packing, Query, Reply, Slab, Storage,
    StoredChunk, receive, send,
};
use super::{names, types};
use hdf5_metno::dataset::Layout;
use hdf5_metno::types::{FixedAscii, FixedUnicode, TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5_metno::{
    Attribute, File, H5Type, Hyperslab, LinkType, Location, LocationType, Selection, SliceOrIndex,
};
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Read, Write};
use std::path::Path;

/// Groups deeper than this are not followed: links may form circles.
const DEEPEST: usize = 32;
/// At most so many objects are walked, for the same reason.
pub(super) const MOST_OBJECTS: usize = 10_000;
/// An attribute with more values than this is none that is read.
const MOST_VALUES: usize = 4096;
/// Larger than any rate, unit or scale.
const MOST_BYTES: usize = 1 << 20;
/// No unit, rate or scale is longer.
const TEXT_BYTES: usize = 256;
/// More chunks than this are the library's to find: a table of them would take as long as it spares.
const MOST_CHUNKS: usize = 1 << 20;

const ELSEWHERE: &str = "a link into another file, which is not followed";
const UNNAMED: &str =
    "its name is not UTF-8, and the HDF5 library is asked by names in UTF-8: rename it in a copy";

/// The names in a group, and whether what bears it is a link into another file.
type Members = BTreeMap<String, bool>;

/// A file as the library has it open.
struct Opened<'a> {
    file: File,
    /// Told how many bytes come next, and how many are held at a time.
    grant: &'a mut dyn FnMut(u64, u64),
    members: HashMap<String, Members>,
}

/// Answers what is asked about the file at `path` until nobody asks any more.
///
/// # Errors
/// Nobody listens.
pub(super) fn answer(
    path: &Path,
    from: &mut impl Read,
    to: &mut impl Write,
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
    send(to, &Reply::Opened { user_block: file.userblock(), library: hdf5_metno::library_version() })?;
    to.flush()?;
    let mut opened = Opened { file, grant, members: HashMap::new() };
    while let Ok((request, _)) = receive(from) {
        match request {
            Query::Look(path) => {
                let object = opened.object(&path);
                send(to, &Reply::Found(path, object))?;
            }
            Query::Walk => opened.walk("", 0, &mut 0, to)?,
            Query::Read { path, is_wide, slab } => opened.read(&path, is_wide, slab, to)?,
        }
        send(to, &Reply::Done)?;
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

impl Opened<'_> {
    fn walk(&mut self, group: &str, depth: usize, count: &mut usize, to: &mut impl Write) -> io::Result<()> {
        let names: Vec<String> = self.members(group).keys().cloned().collect();
        for name in names {
            if *count >= MOST_OBJECTS {
                break;
            }
            *count += 1;
            let path = format!("{group}/{name}");
            let object = self.object(&path);
            let is_group = matches!(object, Object::Group { .. });
            send(to, &Reply::Found(path.clone(), object))?;
            if is_group && depth < DEEPEST {
                self.walk(&path, depth + 1, count, to)?;
            }
        }
        Ok(())
    }

    /// What stands at an absolute path, by way of links within the file alone.
    fn object(&mut self, path: &str) -> Object {
        let mut group = String::new();
        for name in path.split('/').filter(|name| !name.is_empty()) {
            match self.members(&group).get(name) {
                None => return Object::Nothing,
                Some(true) => return Object::NotFollowed(ELSEWHERE.into()),
                Some(false) => group = format!("{group}/{name}"),
            }
        }
        self.opened(path).unwrap_or_else(|error| {
            // The wrapper hands names over with what is no UTF-8 replaced, and nothing is found under those.
            let is_replaced = path.contains(char::REPLACEMENT_CHARACTER);
            if is_replaced { Object::NotFollowed(UNNAMED.into()) } else { Object::Broken(words(&error)) }
        })
    }

    fn opened(&mut self, path: &str) -> hdf5_metno::Result<Object> {
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
                let times = self.times_in(path.trim_end_matches('/'));
                Ok(Object::Group { attributes: attributes_of(&group), times })
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

    fn times_in(&mut self, group: &str) -> Vec<String> {
        self.members(group).keys().filter(|name| names::is_time(name)).cloned().collect()
    }

    /// The members of a group, named by its path without a slash at its end.
    fn members(&mut self, group: &str) -> &Members {
        let Self { file, members, .. } = self;
        members.entry(group.to_owned()).or_insert_with(|| {
            let listed = file.group(if group.is_empty() { "/" } else { group }).and_then(|group| {
                group.iter_visit_default(Members::new(), |_, name, link, members| {
                    members.insert(name.to_owned(), link.link_type == LinkType::External);
                    true
                })
            });
            listed.unwrap_or_default()
        })
    }

    /// Sends the numbers of a dataset, or why they cannot be read.
    fn read(&mut self, path: &str, is_wide: bool, slab: Slab, to: &mut impl Write) -> io::Result<()> {
        let sent = if is_wide {
            self.send_numbers(path, slab, |numbers| send(to, &Reply::Wide(numbers)))
        } else {
            self.send_numbers(path, slab, |numbers| send(to, &Reply::Narrow(numbers)))
        };
        sent.or_else(|error| send(to, &Reply::Refused(words(&error))))
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
        let beside = if is_picked { width } else { *chunk.get(1 - along).unwrap_or(&1) };
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

/// A dataset without its numbers. Where they lie outside the file that is all that is asked of it: the library would open the others.
fn described(dataset: &hdf5_metno::Dataset) -> hdf5_metno::Result<Dataset> {
    let made = dataset.create_plist()?;
    let dtype = dataset.dtype()?;
    let (number, fields) = (types::number(&dtype), types::fields(&dtype));
    let mut told = Dataset {
        type_name: types::name(&dtype),
        value_bytes: dtype.size() as u64,
        number,
        is_plain: types::is_plain(&dtype),
        is_records: matches!(dtype.to_descriptor(), Ok(TypeDescriptor::Compound(_))),
        fields,
        shape: None,
        storage: Storage::Virtual,
        filters: Vec::new(),
        stored_bytes: 0,
        attributes: Vec::new(),
    };
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
    use hdf5_metno::filters::Filter as Known;
    match filter {
        Known::Shuffle => Filter::Shuffle,
        Known::Deflate(level) => Filter::Deflate(*level),
        Known::Fletcher32 => Filter::Fletcher32,
        Known::LZF => Filter::Lzf,
        Known::SZip(..) => Filter::Other("SZIP".into()),
        Known::NBit => Filter::Other("N-bit".into()),
        Known::ScaleOffset(_) => Filter::Other("scale-offset".into()),
        Known::User(id, _) => Filter::Other(format!("number {id}")),
    }
}

/// Where the chunks lie that this program unpacks itself; `None` where only the library can.
fn chunks(dataset: &hdf5_metno::Dataset, filters: &[Filter]) -> Option<Vec<StoredChunk>> {
    if Packing::of(filters).is_none() || dataset.ndim() > 2 || dataset.num_chunks()? > MOST_CHUNKS {
        return None;
    }
    let (mut chunks, mut is_whole) = (Vec::new(), true);
    let visited = dataset.chunks_visit(|chunk| {
        let place = |i: usize| chunk.offset.get(i).map_or(Some(0), |&n| usize::try_from(n).ok());
        match (place(0), place(1), usize::try_from(chunk.size)) {
            (Some(row), Some(column), Ok(bytes)) if chunk.filter_mask == 0 && chunks.len() < MOST_CHUNKS => {
                chunks.push(StoredChunk { row, column, at: chunk.addr, bytes });
            }
            _ => is_whole = false,
        }
        0
    });
    (visited.is_ok() && is_whole).then_some(chunks)
}

/// Those attributes of a place that may say something of samples.
fn attributes_of(place: &Location) -> Vec<(String, AttributeValue)> {
    // The wrapper makes text of names of any bytes; they are bytes again before anybody looks at them.
    let names = place.attr_names().unwrap_or_default().into_iter().map(String::into_bytes);
    let names = names.filter_map(|name| String::from_utf8(name).ok()).filter(|name| names::is_read(name));
    let held = names.filter_map(|name| {
        let value = value(&place.attr(&name).ok()?)?;
        Some((name, value))
    });
    held.collect()
}

/// What an attribute holds; `None` where that is too much.
fn value(attribute: &Attribute) -> Option<AttributeValue> {
    let dtype = attribute.dtype().ok()?;
    if attribute.size() > MOST_VALUES || dtype.size().saturating_mul(attribute.size()) > MOST_BYTES {
        return None;
    }
    let texts = match dtype.to_descriptor() {
        Ok(TypeDescriptor::VarLenUnicode) => texts::<VarLenUnicode>(attribute, VarLenUnicode::as_bytes),
        Ok(TypeDescriptor::VarLenAscii) => texts::<VarLenAscii>(attribute, VarLenAscii::as_bytes),
        Ok(TypeDescriptor::FixedAscii(_)) => texts(attribute, FixedAscii::<TEXT_BYTES>::as_bytes),
        Ok(TypeDescriptor::FixedUnicode(_)) => texts(attribute, FixedUnicode::<TEXT_BYTES>::as_bytes),
        _ => attribute.read_raw::<f64>().ok().map(AttributeValue::Numbers),
    };
    Some(texts.unwrap_or(AttributeValue::Other))
}

/// Texts as the bytes that they are: the wrapper's own way to `str` does not look whether they are UTF-8.
fn texts<T: H5Type>(attribute: &Attribute, bytes: fn(&T) -> &[u8]) -> Option<AttributeValue> {
    let texts = attribute.read_raw::<T>().ok()?;
    let cut = |text: &T| bytes(text).iter().take(TEXT_BYTES).copied().collect();
    Some(AttributeValue::Texts(texts.iter().map(cut).collect()))
}
