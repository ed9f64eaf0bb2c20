//! A source as a cask file names it to the dataset, and the column, row or field of it, that it means.

use super::dataset::{Column, Kind, Place, kind, type_name};
use super::fault::{self, Fault};
use super::record;
use hdf5_metno::types::TypeDescriptor;
use hdf5_metno::{Dataset, Datatype, File};

/// No filter that is built in packs tighter (deflate: 1032 : 1), so that a dataset that claims more was damaged or never written.
const TIGHTEST_PACKING: u64 = 1100;

/// Why a source names no column.
pub(super) enum Missing {
    Nowhere,
    Because(Fault),
}

/// The channel that `source` names: `/group/dataset`, `/group/dataset[2]` of a two-dimensional one, `/group/dataset.field` of records.
pub(super) fn find(file: &File, source: &str) -> Result<Column, Missing> {
    let path = format!("/{}", source.trim().trim_start_matches('/'));
    if let Ok(dataset) = file.dataset(&path) {
        return column(dataset, path, None).map_err(Missing::Because);
    }
    // "[g]" may be a part of the name.
    let indexed = path.strip_suffix(']').and_then(|path| path.rsplit_once('['));
    let indexed = indexed.and_then(|(bare, index)| Some((bare, Some(index.trim().parse().ok()?))));
    let (bare, index) = indexed.unwrap_or((&path, None));
    if index.is_some()
        && let Ok(dataset) = file.dataset(bare)
    {
        return column(dataset, bare.to_owned(), index).map_err(Missing::Because);
    }
    // Names of datasets and fields may hold points themselves.
    for (at, _) in bare.rmatch_indices('.') {
        if let Ok(dataset) = file.dataset(&bare[..at]) {
            let (name, field) = (bare[..at].to_owned(), &bare[at + 1..]);
            return field_of(dataset, name, field, index).map_err(Missing::Because);
        }
    }
    if file.group(&path).is_ok() {
        return Err(Missing::Because(Fault {
            problem: format!("{path} is a group, not a dataset"),
            mend: "name one of the datasets in it; `dropcheck inspect` lists them".into(),
        }));
    }
    Err(Missing::Nowhere)
}

/// The sources that a dataset holds, at most `most`; a fault where it holds none.
pub(super) fn sources(dataset: &Dataset, path: &str, most: usize) -> Result<Vec<String>, Fault> {
    let several = |name: String, count: usize| match count {
        1 => vec![name],
        count if count <= most => (0..count).map(|i| format!("{name}[{i}]")).collect(),
        _ => Vec::new(),
    };
    let dtype = dataset.dtype().map_err(|error| fault::of_dataset(path, &error))?;
    let fields = record::fields(&dtype);
    let (count, _, _) = channels(&shape_of(dataset, &dtype, path)?, path)?;
    if fields.is_empty() {
        kind_of(&dtype, path)?;
        return Ok(several(path.to_owned(), count));
    }
    let mut sources: Vec<String> =
        fields.iter().flat_map(|field| several(format!("{path}.{}", field.name), field.count)).collect();
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

fn column(dataset: Dataset, name: String, index: Option<usize>) -> Result<Column, Fault> {
    let wrong = |problem: String, mend: &str| Fault { problem, mend: mend.to_owned() };
    refuse_foreign(&dataset, &name)?;
    let dtype = dataset.dtype().map_err(|error| fault::of_dataset(&name, &error))?;
    let fields = record::fields(&dtype);
    if !fields.is_empty() {
        return Err(Fault {
            problem: format!("{name} holds records, with the fields {}", record::names(&fields)),
            mend: format!("name one field: \"{name}.{}\"", fields[0].name),
        });
    }
    let kind = kind_of(&dtype, &name)?;
    let shape = shape_of(&dataset, &dtype, &name)?;
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
    Ok(Column { dataset, index, columns, name, length, kind, place })
}

/// A field of the records of a dataset.
fn field_of(dataset: Dataset, name: String, wanted: &str, index: Option<usize>) -> Result<Column, Fault> {
    refuse_foreign(&dataset, &name)?;
    let dtype = dataset.dtype().map_err(|error| fault::of_dataset(&name, &error))?;
    let fields = record::fields(&dtype);
    let Some(field) = fields.iter().find(|field| field.name == wanted) else {
        let Some(first) = fields.first() else {
            return Err(kind_of(&dtype, &name).err().unwrap_or_else(|| Fault {
                problem: format!("{name} holds no records with a field {wanted}, but numbers"),
                mend: format!("name it without a field: \"{name}\""),
            }));
        };
        return Err(Fault {
            problem: format!("the records of {name} have no field {wanted} of numbers"),
            mend: format!("name one of {}: \"{name}.{}\"", record::names(&fields), first.name),
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
    let (count, length, _) = channels(&shape_of(&dataset, &dtype, &name)?, &name)?;
    if count > 1 {
        return Err(Fault {
            problem: format!("{name} holds records in rows and columns"),
            mend: "save them as a table of one dimension, one record a sample".into(),
        });
    }
    let (columns, kind) = (field.count, field.kind);
    Ok(Column { dataset, index, columns, name, length, kind, place: Place::Field(place) })
}

/// A file that was sent may name any other on this machine.
fn refuse_foreign(dataset: &Dataset, name: &str) -> Result<(), Fault> {
    let external = dataset.create_plist().map(|list| list.external()).unwrap_or_default();
    match external.iter().find(|file| file.name.contains(['/', '\\'])) {
        None => Ok(()),
        Some(other) => Err(Fault {
            problem: format!("the data of {name} are in another file, {}, which lies elsewhere", other.name),
            mend: "ask for a recording that holds its own data: `h5repack IN OUT` makes one".into(),
        }),
    }
}

const NUMBERS: &str = "name a dataset of numbers; `dropcheck inspect` lists them";

/// How the numbers of a dataset are read; a fault where it holds none.
fn kind_of(dtype: &Datatype, name: &str) -> Result<Kind, Fault> {
    let is_records = matches!(dtype.to_descriptor(), Ok(TypeDescriptor::Compound(_)));
    kind(dtype).ok_or_else(|| {
        let what = type_name(dtype);
        if is_records {
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
fn shape_of(dataset: &Dataset, dtype: &Datatype, name: &str) -> Result<Vec<usize>, Fault> {
    let wrong = |what: &str| Fault { problem: format!("{name} {what}"), mend: NUMBERS.into() };
    let space = dataset.space().map_err(|error| fault::of_dataset(name, &error))?;
    if space.is_null() {
        return Err(wrong("is empty"));
    }
    let shape = space.shape();
    if shape.is_empty() {
        return Err(wrong("is a single value"));
    }
    if shape.contains(&0) {
        return Err(wrong("is empty"));
    }
    let claimed = shape.iter().try_fold(1_usize, |product, &n| product.checked_mul(n));
    let rows = shape.first().copied().unwrap_or(0);
    let bytes = claimed.and_then(|count| count.checked_mul(dtype.size())).and_then(|b| u64::try_from(b).ok());
    let stored = dataset.storage_size();
    let is_plausible = bytes.is_some_and(|bytes| bytes <= stored.saturating_mul(TIGHTEST_PACKING));
    if !is_plausible {
        return Err(Fault {
            problem: format!("{name} claims {rows} rows, of which the file holds {stored} bytes"),
            mend: "it was never written, or the file is damaged: copy it from the logger again".into(),
        });
    }
    Ok(shape)
}
