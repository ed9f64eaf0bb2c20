//! An HDF5 file, through the C library, to descriptions and numbers: all that hands a file's bytes to C, in a
//! process of its own.

use super::answer::{
    AttributeValue, Bytes, Dataset, FRAME_NUMBERS, Filter, Object, Packing, Query, Reply, Slab, Storage,
    StoredChunk, receive, send,
};
use super::{names, types};
use hdf5_metno::dataset::Layout;
use hdf5_metno::types::{FixedAscii, FixedUnicode, TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5_metno::{
    Container, File, H5Type, Hyperslab, IndexType, IterationOrder, LinkType, Location, LocationToken,
    LocationType, Selection, SliceOrIndex,
};
use std::collections::{BTreeMap, HashMap};
use std::io::{self, Read, Write};
use std::path::Path;

/// Groups deeper than this are not followed.
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

/// What numbers stand for that are none.
const MATLAB_OTHER: &[u8] = b"text or cells of MATLAB";

/// No group has more datasets of one value that say something of samples.
const MOST_ONES: usize = 64;

const ELSEWHERE: &str = "a link into another file, which is not followed";
const UNNAMED: &str =
    "its name is not UTF-8, and the HDF5 library is asked by names in UTF-8: rename it in a copy";

const SOFT: &str = "a soft link, which is followed only where the system keeps the library from other files: \
                    name what it leads to";

/// The names in a group, and what bears each.
type Members = BTreeMap<String, LinkType>;

/// A file as the library has it open.
struct Opened<'a> {
    file: File,
    /// Told how many bytes come next, and how many are held at a time.
    grant: &'a mut dyn FnMut(u64, u64),
    members: HashMap<String, Members>,
    /// Whether the system keeps this process from every other file.
    is_walled: bool,
    /// The groups that were walked through: links may form circles.
    walked: Vec<LocationToken>,
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
    let mut opened = Opened { file, grant, members: HashMap::new(), is_walled, walked: Vec::new() };
    while let Ok((request, _)) = receive(from) {
        match request {
            Query::Look(path) => {
                let object = opened.object_with_values(&path);
                send(to, &Reply::Found(path, object))?;
            }
            Query::Walk => {
                opened.walked.clear();
                opened.walk("", 0, &mut 0, to)?;
            }
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
    /// Each group once, by the first name that is no soft link: those lead to what is walked through anyway.
    fn walk(&mut self, group: &str, depth: usize, count: &mut usize, to: &mut impl Write) -> io::Result<()> {
        let place = if group.is_empty() { self.file.loc_info() } else { self.file.loc_info_by_name(group) };
        self.walked.extend(place.map(|place| place.token));
        for (name, link) in self.members(group).clone() {
            let (path, is_hard) = (format!("{group}/{name}"), link == LinkType::Hard);
            let place = is_hard.then(|| self.file.loc_info_by_name(&path));
            if place.is_some_and(|place| place.is_ok_and(|place| self.walked.contains(&place.token))) {
                continue;
            }
            if *count >= MOST_OBJECTS {
                break;
            }
            *count += 1;
            let object = self.object_with_values(&path);
            let is_group = matches!(object, Object::Group { .. });
            send(to, &Reply::Found(path.clone(), object))?;
            if is_hard && is_group && depth < DEEPEST {
                self.walk(&path, depth + 1, count, to)?;
            }
        }
        Ok(())
    }

    /// What stands at an absolute path, by way of links within the file alone.
    fn object(&mut self, path: &str) -> Object {
        let mut group = String::new();
        for name in path.split('/').filter(|name| !name.is_empty()) {
            match self.members(&group).get(name).copied() {
                None => return Object::Nothing,
                Some(LinkType::External) => return Object::NotFollowed(ELSEWHERE.into()),
                Some(LinkType::Soft) if !self.is_walled => return Object::NotFollowed(SOFT.into()),
                Some(_) => group = format!("{group}/{name}"),
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

    /// What stands at a path, a group with the datasets of one value in it: attributes of it, as MATLAB
    /// writes all numbers. Their own stand behind their name: `Fs_unit`.
    fn object_with_values(&mut self, path: &str) -> Object {
        let mut object = self.object(path);
        let group = path.trim_end_matches('/');
        // What MATLAB's cells hold is named by chance.
        if let Object::Group { attributes, .. } = &mut object
            && !group.ends_with("/#refs#")
        {
            let names = self.members(group).keys().filter(|name| names::is_read(name)).take(MOST_ONES);
            for name in names.cloned().collect::<Vec<String>>() {
                let path = format!("{group}/{name}");
                if let Object::Dataset(told) = self.object(&path)
                    && told.type_name != MATLAB_OTHER
                    && told.shape.is_some_and(|shape| shape.iter().all(|n| *n == 1))
                    && let Some(held) = self.file.dataset(&path).ok().and_then(|dataset| value(&dataset))
                {
                    let inner =
                        told.attributes.into_iter().map(|(inner, held)| (format!("{name}_{inner}"), held));
                    attributes.extend(inner.chain([(name.clone(), held)]));
                }
            }
        }
        object
    }

    fn times_in(&mut self, group: &str) -> Vec<String> {
        self.members(group)
            .keys()
            .filter(|name| names::is_time(name) || names::is_sensor(name))
            .cloned()
            .collect()
    }

    /// The members of a group, named by its path without a slash at its end.
    fn members(&mut self, group: &str) -> &Members {
        let Self { file, members, .. } = self;
        members.entry(group.to_owned()).or_insert_with(|| {
            let links = file
                .group(if group.is_empty() { "/" } else { group })
                .and_then(|group| group.links(IndexType::Name, IterationOrder::Native));
            let links = links.unwrap_or_default().into_iter();
            links.map(|(name, link)| (name, link.link_type)).collect()
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
    let is_class = |(name, _): &&(String, AttributeValue)| name == names::MATLAB_CLASS;
    if let Some((_, AttributeValue::Texts(class))) = told.attributes.iter().find(is_class)
        && let b"char" | b"cell" = &class.concat()[..]
    {
        (told.type_name, told.number) = (MATLAB_OTHER.to_vec(), None);
    }
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

/// One value in place of several that are the same, so that nobody goes through them for every column.
fn joined<T: PartialEq>(mut values: Vec<T>) -> Vec<T> {
    if values.windows(2).all(|two| two[0] == two[1]) {
        values.truncate(1);
    }
    values
}
