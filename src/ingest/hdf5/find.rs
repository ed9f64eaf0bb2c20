//! A source as a cask file names it to the dataset, and the column, row or field of it, that it means.

use super::answer::{Dataset, Field, Filter, Number, Object, Storage, decoded};
use super::dataset::{Column, Place};
use super::fault::{self, Fault};
use super::room::{File, Found};
use std::rc::Rc;

/// No filter that is built in packs tighter (deflate: 1032 : 1), so that a dataset that claims more was damaged or never written.
const TIGHTEST_PACKING: u64 = 1100;

/// Why a source names no column.
pub(super) enum Missing {
    Nowhere,
    Because(Fault),
}

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

/// The channel that `source` names: `/group/dataset`, `/group/dataset[2]` of a two-dimensional one, `/group/dataset.field` of records.
pub(super) fn find(file: &Rc<File>, source: &str) -> Result<Column, Missing> {
    let mut other = None;
    for (path, field, index) in places(source) {
        if let Some(dataset) = Found::at(file, &path) {
            let found = match &field {
                Some(field) => field_of(dataset, path, field, index),
                None => column(dataset, path, index),
            };
            return found.map_err(Missing::Because);
        }
        let object = file.object(&path);
        if field.is_none() || !matches!(*object, Object::Group { .. }) {
            other = other.or_else(|| no_dataset(&object, &path));
        }
    }
    Err(other.map_or(Missing::Nowhere, Missing::Because))
}

/// What stands at a path instead of a dataset; `None` where nothing does.
pub(super) fn no_dataset(object: &Object, path: &str) -> Option<Fault> {
    let fault = |problem: String, mend: &str| Some(Fault { problem, mend: mend.to_owned() });
    match object {
        Object::Nothing | Object::Dataset(_) => None,
        Object::Group { .. } => fault(
            format!("{path} is a group, not a dataset"),
            "name one of the datasets in it; `dropcheck inspect` lists them",
        ),
        Object::NamedType => fault(format!("{path} is a type, not a dataset"), NUMBERS),
        Object::NotFollowed(what) => fault(format!("{path}: {what}"), OWN_DATA),
        Object::Broken(words) => Some(fault::of_words(words).at(path)),
    }
}

/// The sources that a dataset holds, at most `most`; a fault where it holds none.
pub(super) fn sources(dataset: &Dataset, path: &str, most: usize) -> Result<Vec<String>, Fault> {
    refuse_unread(dataset, path)?;
    let several = |name: String, count: usize| match count {
        1 => vec![name],
        count if count <= most => (0..count).map(|i| format!("{name}[{i}]")).collect(),
        _ => Vec::new(),
    };
    let (count, _, _) = channels(&shape_of(dataset, path)?, path)?;
    if dataset.fields.is_empty() {
        number_of(dataset, path)?;
        return Ok(several(path.to_owned(), count));
    }
    let named = |field: &Field| several(format!("{path}.{}", decoded(&field.name)), field.count);
    let mut sources: Vec<String> = dataset.fields.iter().flat_map(named).collect();
    sources.truncate(most);
    Ok(sources)
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
        _ => Err(Fault {
            problem: format!("{name} has {} dimensions", shape.len()),
            mend: "only one and two dimensions are read; save the channel as a dataset of its own".into(),
        }),
    }
}

fn column(dataset: Found, name: String, index: Option<usize>) -> Result<Column, Fault> {
    let wrong = |problem: String, mend: &str| Fault { problem, mend: mend.to_owned() };
    refuse_unread(&dataset, &name)?;
    if let Some(first) = dataset.fields.first() {
        return Err(Fault {
            problem: format!("{name} holds records, with the fields {}", field_names(&dataset.fields)),
            mend: format!("name one field: \"{name}.{}\"", decoded(&first.name)),
        });
    }
    let number = number_of(&dataset, &name)?;
    let shape = shape_of(&dataset, &name)?;
    let (columns, length, place) = channels(&shape, &name)?;
    let index = match index {
        None | Some(0) if matches!(place, Place::Whole) => (shape.len() > 1).then_some(0),
        Some(_) if shape.len() == 1 => {
            return Err(wrong(format!("{name} has one dimension"), "leave out the [ ] behind its name"));
        }
        Some(index) if index < columns => Some(index),
        Some(index) => {
            let what = if matches!(place, Place::Row) { "rows, one a channel" } else { "columns" };
            let mend = "columns, or rows where those are the channels, count from 0";
            return Err(wrong(format!("{name} has {columns} {what}, there is no [{index}]"), mend));
        }
        None => {
            let what = if matches!(place, Place::Row) { "row" } else { "column" };
            return Err(wrong(
                format!("{name} has {} rows and {} columns", shape[0], shape[1]),
                &format!("name one {what}: \"{name}[0]\" to \"{name}[{}]\"", columns.saturating_sub(1)),
            ));
        }
    };
    Ok(Column { dataset, index, columns, name, length, number, place })
}

/// A field of the records of a dataset.
fn field_of(dataset: Found, name: String, wanted: &str, index: Option<usize>) -> Result<Column, Fault> {
    refuse_unread(&dataset, &name)?;
    let fields = &dataset.fields;
    let Some(field) = fields.iter().find(|field| decoded(&field.name) == wanted) else {
        let Some(first) = fields.first() else {
            return Err(number_of(&dataset, &name).err().unwrap_or_else(|| Fault {
                problem: format!("{name} holds no records with a field {wanted}, but numbers"),
                mend: format!("name it without a field: \"{name}\""),
            }));
        };
        return Err(Fault {
            problem: format!("the records of {name} have no field {wanted} of numbers"),
            mend: format!("name one of {}: \"{name}.{}\"", field_names(fields), decoded(&first.name)),
        });
    };
    let place = match index {
        None if field.count > 1 => {
            return Err(Fault {
                problem: format!("{name}.{wanted} holds {} numbers a record", field.count),
                mend: format!("name one: \"{name}.{wanted}[0]\" to \"{name}.{wanted}[{}]\"", field.count - 1),
            });
        }
        Some(index) if index >= field.count => {
            return Err(Fault {
                problem: format!(
                    "{name}.{wanted} holds {} numbers a record, there is no [{index}]",
                    field.count
                ),
                mend: "they count from 0".into(),
            });
        }
        index => field.element(index.unwrap_or(0)),
    };
    let (count, length, _) = channels(&shape_of(&dataset, &name)?, &name)?;
    if count > 1 {
        return Err(Fault {
            problem: format!("{name} holds records in rows and columns"),
            mend: "save them as a table of one dimension, one record a sample".into(),
        });
    }
    let (columns, number) = (field.count, field.number);
    let place = Place::Field(place, wanted.to_owned());
    Ok(Column { dataset, index, columns, name, length, number, place })
}

impl Field {
    /// One number of the list, as a field of its own.
    fn element(&self, index: usize) -> Self {
        Self { count: 1, from: self.from + index * self.number.bytes(), ..self.clone() }
    }
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
    let (what, mend) = match (&dataset.storage, filter) {
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
    Err(Fault { problem: format!("{name}: {what}"), mend: mend.into() })
}

const OWN_DATA: &str = "ask for a recording that holds its own data: `h5repack IN OUT` makes one";
const NUMBERS: &str = "name a dataset of numbers; `dropcheck inspect` lists them";

/// How the numbers of a dataset are read; a fault where it holds none.
fn number_of(dataset: &Dataset, name: &str) -> Result<Number, Fault> {
    dataset.number.ok_or_else(|| {
        let what = decoded(&dataset.type_name);
        if dataset.is_records {
            Fault {
                problem: format!("{name} holds {what}: none of numbers, or beside others of varying length or other byte order"),
                mend: "save each field of numbers as a dataset of its own".into(),
            }
        } else {
            Fault { problem: format!("{name} holds no numbers but {what}"), mend: NUMBERS.into() }
        }
    })
}

/// The shape of a dataset; a fault where it is empty, or where the file cannot hold it.
fn shape_of(dataset: &Dataset, name: &str) -> Result<Vec<usize>, Fault> {
    let wrong = |what: &str| Fault { problem: format!("{name} {what}"), mend: NUMBERS.into() };
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
        return Err(Fault {
            problem: format!("{name} claims {rows} rows, of which the file holds {stored} bytes"),
            mend: "it was never written, or the file is damaged: copy it from the logger again".into(),
        });
    }
    Ok(shape)
}
