//! A source as a cask file names it to the dataset, and the column, row or field of it, that it means.

use super::answer::{Dataset, Object, RecordField, Storage, decoded};
use super::column::{DatasetColumn, Place};
use super::fault::{self, REPACK};
use super::room::File;
use crate::ingest::error;
use crate::ingest::number_type::NumberType;
use crate::ingest::refusal::Refusal;
use std::rc::Rc;

/// No filter that is built in packs tighter (deflate: 1032 : 1), so that a dataset that claims more was
/// damaged or never written.
const TIGHTEST_PACKING: u64 = 1100;

/// The paths at which the dataset of a source may stand, likeliest first, and where the source means one of
/// its fields: `/a.b[2]` may be a dataset of this name, column 2 of `/a.b`, or number 2 in field `b` of the
/// records `/a`.
fn places(source: &str) -> impl Iterator<Item = &str> {
    let is_number = |index: &&str| index.bytes().all(|digit| digit.is_ascii_digit());
    let indexed = source.strip_suffix(']').and_then(|source| source.rsplit_once('['));
    let bare = indexed.filter(|(_, index)| is_number(index)).map_or(source, |(bare, _)| bare);
    let fields = bare.rmatch_indices('.').map(move |(at, _)| &bare[..at]);
    Some(source).into_iter().chain((bare.len() < source.len()).then_some(bare)).chain(fields)
}

/// The channel that `source` names: `/group/dataset`, `/group/dataset[2]` of a two-dimensional one,
/// `/group/dataset.field` of records; `None` where nothing stands there.
///
/// # Errors
/// What stands there is no channel of numbers.
pub(super) fn find(file: &Rc<File>, source: &str) -> Result<Option<DatasetColumn>, Refusal> {
    let source = format!("/{}", source.trim().trim_start_matches('/'));
    let mut other = Ok(None);
    for path in places(&source) {
        let object = file.object(path);
        if let Object::Dataset(dataset) = &*object {
            return named(&source, channels(file, dataset, path, MOST_NAMED)?).map(Some);
        }
        let is_field = source[path.len()..].starts_with('.');
        if other.is_ok() && !(is_field && matches!(*object, Object::Group { .. })) {
            other = no_dataset(&object, path).map_or(Ok(None), Err);
        }
    }
    other
}

/// Of the channels of a dataset the one that `source` names; one that is alone may be counted or not.
fn named(source: &str, mut channels: Vec<DatasetColumn>) -> Result<DatasetColumn, Refusal> {
    /// More names no longer fit a message.
    const HANDFUL: usize = 12;
    let is_meant = |column: &DatasetColumn| {
        column.source == source
            || column.columns == 1 && source.strip_suffix("[0]") == Some(column.source.as_str())
    };
    if let Some(at) = channels.iter().position(is_meant) {
        return Ok(channels.swap_remove(at));
    }
    let names: Vec<&str> = channels.iter().take(HANDFUL).map(|column| column.source.as_str()).collect();
    let more = if channels.len() > HANDFUL { " …" } else { "" };
    let (path, stored) = (&channels[0].path, channels[0].dataset.described());
    let problem = format!("{source:?} is none of the {} channel(s) in {path} ({stored})", channels.len());
    Err(Refusal::new(problem, format!("name one: {}{more}", names.join(", "))))
}

/// The channel that `source` names.
///
/// # Errors
/// There is none; where nothing stands there, with the sources that are most like it.
pub(super) fn locate(file: &Rc<File>, source: &str) -> Result<DatasetColumn, Refusal> {
    find(file, source)?.ok_or_else(|| {
        let objects = file.walk();
        let of_dataset = |(path, object): &(String, Rc<Object>)| match &**object {
            Object::Dataset(dataset) => channels(file, dataset, path, MOST_LISTED).ok(),
            _ => None,
        };
        let all: Vec<String> =
            objects.iter().filter_map(of_dataset).flatten().map(|column| column.source).collect();
        let remedy = error::near_names(&file.path, source, "dataset", &all);
        Refusal::new(format!("there is no dataset {source}"), remedy)
    })
}

/// What stands at a path instead of a dataset; `None` where nothing does.
pub(super) fn no_dataset(object: &Object, path: &str) -> Option<Refusal> {
    match object {
        Object::Nothing | Object::Dataset(_) => None,
        Object::Group { .. } => Some(Refusal::of(
            path,
            "is a group, not a dataset",
            "name one of the datasets in it; `dropcheck inspect` lists them",
        )),
        Object::NamedType => Some(Refusal::of(path, "is a type, not a dataset", NUMBERS)),
        Object::NotFollowed(what) => Some(Refusal::new(what, NO_LINKS).at(path)),
        Object::Broken(words) => Some(fault::of_words(words).at(path)),
    }
}

/// More rows than this are samples, not channels: no recorder of these tests has so many, and so few samples
/// are no record of a drop.
const MOST_ROWS: usize = 64;
/// Rows are channels where they are so many times longer than there are of them: a record has more samples
/// than channels.
const LONGER: usize = 8;
/// Channels of one dataset that are looked through for a source.
const MOST_NAMED: usize = 4096;
/// Channels of one dataset that are listed: one with more columns is an image rather than a table.
pub(super) const MOST_LISTED: usize = 256;

/// The channels that a dataset holds: itself, its columns or rows, or the first numbers in the fields of its
/// records; one at least, and `most` at most.
///
/// # Errors
/// It holds no numbers in one or two dimensions, none that are read, or more columns than that.
pub(super) fn channels(
    file: &Rc<File>,
    dataset: &Dataset,
    path: &str,
    most: usize,
) -> Result<Vec<DatasetColumn>, Refusal> {
    refuse_unread(dataset, path)?;
    let shape = shape_of(dataset, path)?;
    // Records in rows and columns are none of channels.
    let widest = if dataset.fields.is_empty() { most } else { 1 };
    let (place, columns, length) = match *shape {
        [length] | [length, 1] | [1, length] => (Place::Whole, 1, length),
        [rows, length] if rows <= widest.min(MOST_ROWS) && length >= LONGER * rows => {
            (Place::Row, rows, length)
        }
        [length, columns] if columns <= widest => (Place::Column, columns, length),
        [rows, columns] => {
            let problem = format!("has {rows} rows and {columns} columns, too many for channels");
            return Err(Refusal::of(path, problem, "save each channel as a dataset of its own"));
        }
        _ => {
            let mend = "only one and two dimensions are read; save the channel as a dataset of its own";
            return Err(Refusal::of(path, format!("has {} dimensions", shape.len()), mend));
        }
    };
    let dataset = Rc::new(dataset.clone());
    let several = |name: &str, count: usize, column: &dyn Fn(usize) -> (NumberType, Place)| {
        let of_index = |index: usize| {
            let (number, place) = column(index);
            let source = if count > 1 { format!("{name}[{index}]") } else { name.to_owned() };
            let (file, dataset, path) = (Rc::clone(file), Rc::clone(&dataset), path.to_owned());
            DatasetColumn { file, dataset, path, source, index, columns: count, length, number, place }
        };
        (0..count.min(most)).map(of_index).collect::<Vec<DatasetColumn>>()
    };
    if dataset.fields.is_empty() {
        let number = number_of(&dataset, path)?;
        return Ok(several(path, columns, &|_| (number, place.clone())));
    }
    let of_field = |field: &RecordField| {
        // One number of a list, as a field of its own.
        let single = |index: usize| {
            let from = field.from + index * field.number.bytes();
            (field.number, Place::Field(RecordField { count: 1, from, ..field.clone() }))
        };
        several(&format!("{path}.{}", decoded(&field.name)), field.count, &single)
    };
    Ok(dataset.fields.iter().flat_map(of_field).take(most).collect())
}

/// What is not in the recording, or packed by what is not read. A file that was sent may name any other on
/// this machine, and any filter.
fn refuse_unread(dataset: &Dataset, name: &str) -> Result<(), Refusal> {
    let filter = dataset.filters.iter().find(|filter| !filter.is_read());
    let (what, remedy) = match (&dataset.storage, filter) {
        (Storage::External, _) => ("the data are in another file".to_owned(), OWN_DATA),
        (Storage::Virtual, _) => ("it is put together from other datasets".to_owned(), OWN_DATA),
        (_, Some(filter)) => (format!("its data are packed by the filter {filter}"), REPACK),
        _ => return Ok(()),
    };
    Err(Refusal::new(format!("{what}, which is not read"), remedy).at(name))
}

/// Commands that make a file which is read of one that is not.
pub(super) const COMMANDS: [&str; 3] = [REPACK, OWN_DATA, NO_LINKS];
const OWN_DATA: &str = "ask for a recording that holds its own data: `h5repack -f GZIP=1 IN OUT` makes one";
const NO_LINKS: &str = "ask for a recording that holds its own data: `h5repack --merge IN OUT` makes one";
const NUMBERS: &str = "name a dataset of numbers; `dropcheck inspect` lists them";

/// How the numbers of a dataset are read; a fault where it holds none.
fn number_of(dataset: &Dataset, name: &str) -> Result<NumberType, Refusal> {
    dataset.number.ok_or_else(|| {
        let what = decoded(&dataset.type_name);
        if dataset.is_records {
            Refusal::of(
                name,
                format!(
                    "holds {what}: none of numbers, or beside others of varying length or other byte order"
                ),
                "save each field of numbers as a dataset of its own",
            )
        } else {
            Refusal::of(name, format!("holds no numbers but {what}"), NUMBERS)
        }
    })
}

/// The shape of a dataset; a fault where it is empty, or where the file cannot hold it.
fn shape_of<'a>(dataset: &'a Dataset, name: &str) -> Result<&'a [usize], Refusal> {
    let wrong = |what: &str| Err(Refusal::of(name, what, NUMBERS));
    let shape = match dataset.shape.as_deref() {
        Some([]) => return wrong("is a single value"),
        Some(shape) if !shape.contains(&0) => shape,
        _ => return wrong("is empty"),
    };
    let claimed = shape.iter().try_fold(dataset.value_bytes, |bytes, &n| bytes.checked_mul(n as u64));
    let stored = dataset.stored_bytes;
    if claimed.is_none_or(|bytes| bytes > stored.saturating_mul(TIGHTEST_PACKING)) {
        return Err(Refusal::of(
            name,
            format!("claims {} rows, of which the file holds {stored} bytes", shape[0]),
            "it was never written, or the file is damaged: copy it from the logger again",
        ));
    }
    Ok(shape)
}
