//! A source as a cask file names it to the dataset, and the column, row or field of it, that it means.

use super::answer::{Dataset, Field, Filter, Number, Object, Storage, decoded};
use super::column::{Column, Place};
use super::fault::{self, Fault};
use super::room::{File, Found};
use crate::ingest::error;
use std::rc::Rc;

/// No filter that is built in packs tighter (deflate: 1032 : 1), so that a dataset that claims more was damaged or never written.
const TIGHTEST_PACKING: u64 = 1100;

/// The places where what `source` names may stand, likeliest first, each with what of the name lies within it: names of datasets and
/// fields may hold points and brackets themselves.
pub(super) fn places(source: &str) -> Vec<(String, Option<String>, Option<usize>)> {
    let path = format!("/{}", source.trim().trim_start_matches('/'));
    let indexed = path.strip_suffix(']').and_then(|path| path.rsplit_once('['));
    let indexed = indexed.and_then(|(bare, index)| Some((bare.to_owned(), index.trim().parse().ok()?)));
    let mut places = vec![(path.clone(), None, None)];
    let (bare, index) = indexed.map_or((path, None), |(bare, index)| (bare, Some(index)));
    if index.is_some() {
        places.push((bare.clone(), None, index));
    }
    let fields = bare.rmatch_indices('.');
    places.extend(fields.map(|(at, _)| (bare[..at].to_owned(), Some(bare[at + 1..].to_owned()), index)));
    places
}

/// The channel that `source` names: `/group/dataset`, `/group/dataset[2]` of a two-dimensional one, `/group/dataset.field` of records;
/// `None` where nothing stands there.
///
/// # Errors
/// What stands there is no channel of numbers.
pub(super) fn find(file: &Rc<File>, source: &str) -> Result<Option<Column>, Fault> {
    let mut other = Ok(None);
    for (path, field, index) in places(source) {
        if let Some(dataset) = Found::at(file, &path) {
            return match &field {
                Some(field) => field_of(dataset, path, field, index),
                None => column(dataset, path, index),
            }
            .map(Some);
        }
        let object = file.object(&path);
        if other.is_ok() && (field.is_none() || !matches!(*object, Object::Group { .. })) {
            other = no_dataset(&object, &path).map_or(Ok(None), Err);
        }
    }
    other
}

/// The channel that `source` names.
///
/// # Errors
/// There is none; where nothing stands there, with the sources that are most like it.
pub(super) fn locate(file: &Rc<File>, source: &str) -> Result<Column, Fault> {
    find(file, source)?.ok_or_else(|| {
        let all: Vec<String> = file
            .walk()
            .iter()
            .filter_map(|(path, object)| match &**object {
                Object::Dataset(dataset) => sources(dataset, path).ok(),
                _ => None,
            })
            .flatten()
            .collect();
        let remedy = error::near_names(&file.path, source, "dataset", &all);
        Fault::new(format!("there is no dataset {source}"), remedy)
    })
}

/// What stands at a path instead of a dataset; `None` where nothing does.
pub(super) fn no_dataset(object: &Object, path: &str) -> Option<Fault> {
    match object {
        Object::Nothing | Object::Dataset(_) => None,
        Object::Group { .. } => Some(Fault::of(
            path,
            "is a group, not a dataset",
            "name one of the datasets in it; `dropcheck inspect` lists them",
        )),
        Object::NamedType => Some(Fault::of(path, "is a type, not a dataset", NUMBERS)),
        Object::NotFollowed(what) => Some(Fault::new(what, OWN_DATA).at(path)),
        Object::Broken(words) => Some(fault::of_words(words).at(path)),
    }
}

/// A dataset with more columns than this is no table of channels.
const MOST_COLUMNS: usize = 256;

/// The sources that a dataset holds.
///
/// # Errors
/// It holds no numbers in one or two dimensions, or in too many columns.
pub(super) fn sources(dataset: &Dataset, path: &str) -> Result<Vec<String>, Fault> {
    refuse_unread(dataset, path)?;
    let several = |name: String, count: usize| match count {
        1 => vec![name],
        count => (0..count.min(MOST_COLUMNS)).map(|i| format!("{name}[{i}]")).collect(),
    };
    let shape = shape_of(dataset, path)?;
    let (count, _, place) = channels(&shape, path)?;
    if dataset.fields.is_empty() {
        number_of(dataset, path)?;
        return if count > MOST_COLUMNS {
            Err(unnamed(path, &shape, &place, count))
        } else {
            Ok(several(path.to_owned(), count))
        };
    }
    let named = |field: &Field| several(format!("{path}.{}", decoded(&field.name)), field.count);
    let mut sources: Vec<String> = dataset.fields.iter().flat_map(named).collect();
    sources.truncate(MOST_COLUMNS);
    Ok(sources)
}

/// That a source names none of the columns or rows of a dataset.
fn unnamed(name: &str, shape: &[usize], place: &Place, count: usize) -> Fault {
    let what = if matches!(place, Place::Row) { "row" } else { "column" };
    let remedy = format!("name one {what}: \"{name}[0]\" to \"{name}[{}]\"", count.saturating_sub(1));
    Fault::of(name, format!("has {} rows and {} columns", shape[0], shape[1]), remedy)
}

/// More rows than this are samples, not channels: no recorder of these tests has so many, and so few samples are no record of a drop.
const MOST_ROWS: usize = 64;
/// Rows are channels where they are so many times longer than there are of them: a record has more samples than channels.
const LONGER: usize = 8;

/// How many channels a dataset of this shape holds, of how many samples, and where.
fn channels(shape: &[usize], name: &str) -> Result<(usize, usize, Place), Fault> {
    match *shape {
        [length] | [length, 1] | [1, length] => Ok((1, length, Place::Whole)),
        [rows, length] if rows <= MOST_ROWS && length >= LONGER * rows => Ok((rows, length, Place::Row)),
        [length, columns] => Ok((columns, length, Place::Column)),
        _ => Err(Fault::of(
            name,
            format!("has {} dimensions", shape.len()),
            "only one and two dimensions are read; save the channel as a dataset of its own",
        )),
    }
}

fn column(dataset: Found, name: String, index: Option<usize>) -> Result<Column, Fault> {
    let wrong = |problem: String, remedy: &str| Fault::of(&name, problem, remedy);
    refuse_unread(&dataset, &name)?;
    if let Some(first) = dataset.fields.first() {
        return Err(wrong(
            format!("holds records, with the fields {}", field_names(&dataset.fields)),
            &format!("name one field: \"{name}.{}\"", decoded(&first.name)),
        ));
    }
    let number = number_of(&dataset, &name)?;
    let shape = shape_of(&dataset, &name)?;
    let (columns, length, place) = channels(&shape, &name)?;
    let index = match index {
        None | Some(0) if matches!(place, Place::Whole) => (shape.len() > 1).then_some(0),
        None => return Err(unnamed(&name, &shape, &place, columns)),
        Some(_) if shape.len() == 1 => {
            return Err(wrong("has one dimension".into(), "leave out the [ ] behind its name"));
        }
        Some(index) if index < columns => Some(index),
        Some(index) => {
            let all = if matches!(place, Place::Row) { "rows, one a channel" } else { "columns" };
            let remedy = "columns, or rows where those are the channels, count from 0";
            return Err(wrong(format!("has {columns} {all}, there is no [{index}]"), remedy));
        }
    };
    Ok(Column { dataset, index, columns, name, length, number, place })
}

/// A field of the records of a dataset.
fn field_of(dataset: Found, name: String, wanted: &str, index: Option<usize>) -> Result<Column, Fault> {
    let wrong = |problem: String, remedy: String| Fault::of(&name, problem, remedy);
    refuse_unread(&dataset, &name)?;
    let fields = &dataset.fields;
    let Some(field) = fields.iter().find(|field| decoded(&field.name) == wanted) else {
        if fields.is_empty() {
            number_of(&dataset, &name)?;
            return Err(wrong(
                format!("holds no records with a field {wanted}, but numbers"),
                format!("name it without a field: \"{name}\""),
            ));
        }
        return Err(wrong(
            format!("has no field {wanted} of numbers"),
            format!("name one of {}, such as \"{name}.{}\"", field_names(fields), decoded(&fields[0].name)),
        ));
    };
    let (last, several) = (field.count - 1, format!("holds {} numbers a record", field.count));
    let field = match index {
        None if last > 0 => {
            let remedy = format!("name one: \"{name}.{wanted}[0]\" to \"{name}.{wanted}[{last}]\"");
            return Err(Fault::of(&format!("{name}.{wanted}"), several, remedy));
        }
        Some(index) if index > last => {
            let problem = format!("{several}, there is no [{index}]");
            return Err(Fault::of(&format!("{name}.{wanted}"), problem, "they count from 0"));
        }
        // One number of the list, as a field of its own.
        index => {
            Field { count: 1, from: field.from + index.unwrap_or(0) * field.number.bytes(), ..field.clone() }
        }
    };
    let (count, length, _) = channels(&shape_of(&dataset, &name)?, &name)?;
    if count > 1 {
        return Err(wrong(
            "holds records in rows and columns".into(),
            "save them as a table of one dimension, one record a sample".into(),
        ));
    }
    let (columns, number) = (last + 1, field.number);
    let place = Place::Field(field, wanted.to_owned());
    Ok(Column { dataset, index, columns, name, length, number, place })
}

/// Their names, as many as fit a message.
fn field_names(fields: &[Field]) -> String {
    const HANDFUL: usize = 12;
    let names: Vec<String> = fields.iter().take(HANDFUL).map(|field| decoded(&field.name)).collect();
    let more = if fields.len() > HANDFUL { ", …" } else { "" };
    format!("{}{more}", names.join(", "))
}

/// What is not in the recording, or packed by what is not read. A file that was sent may name any other on this machine, and any filter.
fn refuse_unread(dataset: &Dataset, name: &str) -> Result<(), Fault> {
    let filter = dataset.filters.iter().find_map(|filter| match filter {
        Filter::Other(what) => Some(what),
        _ => None,
    });
    let (what, remedy) = match (&dataset.storage, filter) {
        (Storage::External, _) => ("the data are in another file, which is not read".to_owned(), OWN_DATA),
        (Storage::Virtual, _) => {
            ("it is put together from other datasets, which is not read".into(), OWN_DATA)
        }
        (_, Some(filter)) => (
            format!("its data are packed by the filter {filter}, which is not read"),
            "repack them with gzip: `h5repack -f GZIP=1 IN OUT`",
        ),
        _ => return Ok(()),
    };
    Err(Fault::new(what, remedy).at(name))
}

const OWN_DATA: &str = "ask for a recording that holds its own data: `h5repack IN OUT` makes one";
const NUMBERS: &str = "name a dataset of numbers; `dropcheck inspect` lists them";

/// How the numbers of a dataset are read; a fault where it holds none.
fn number_of(dataset: &Dataset, name: &str) -> Result<Number, Fault> {
    dataset.number.ok_or_else(|| {
        let what = decoded(&dataset.type_name);
        if dataset.is_records {
            Fault::of(
                name,
                format!(
                    "holds {what}: none of numbers, or beside others of varying length or other byte order"
                ),
                "save each field of numbers as a dataset of its own",
            )
        } else {
            Fault::of(name, format!("holds no numbers but {what}"), NUMBERS)
        }
    })
}

/// The shape of a dataset; a fault where it is empty, or where the file cannot hold it.
fn shape_of(dataset: &Dataset, name: &str) -> Result<Vec<usize>, Fault> {
    let wrong = |what: &str| Fault::of(name, what, NUMBERS);
    let Some(shape) = dataset.shape.clone() else { return Err(wrong("is empty")) };
    if shape.is_empty() {
        return Err(wrong("is a single value"));
    }
    if shape.contains(&0) {
        return Err(wrong("is empty"));
    }
    let claimed = shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    let rows = shape.first().copied().unwrap_or(0);
    let bytes = claimed.and_then(|count| (count as u64).checked_mul(dataset.value_bytes));
    let stored = dataset.stored_bytes;
    let is_plausible = bytes.is_some_and(|bytes| bytes <= stored.saturating_mul(TIGHTEST_PACKING));
    if !is_plausible {
        return Err(Fault::of(
            name,
            format!("claims {rows} rows, of which the file holds {stored} bytes"),
            "it was never written, or the file is damaged: copy it from the logger again",
        ));
    }
    Ok(shape)
}
