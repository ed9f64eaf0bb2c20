//! A column, row or field of a dataset with what of it a channel is.

use super::answer::{AttributeValue::Texts, Dataset, RecordField, Storage, decoded};
use super::names::{self, AttributeRole::Columns};
use super::room::File;
use crate::ingest::number_type::NumberType;
use std::rc::Rc;

/// One channel's numbers in a file: a dataset, a column or row of one, or a field of its records.
#[derive(Clone)]
pub(super) struct DatasetColumn {
    pub file: Rc<File>,
    pub dataset: Rc<Dataset>,
    /// The dataset's path.
    pub path: String,
    /// What to write as `source`: `/daq/acc[2]`, `/daq/table.a1`.
    pub source: String,
    /// Which of several channels in the dataset, or in a field of its records.
    pub index: usize,
    /// How many of them there are.
    pub columns: usize,
    /// Number of samples.
    pub length: usize,
    pub number: NumberType,
    pub place: Place,
}

/// Where the numbers of a channel lie in its dataset.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// They are all of it.
    Whole,
    /// In a column.
    Column,
    /// In a row.
    Row,
    /// In a field of its records.
    Field(RecordField),
}

impl DatasetColumn {
    /// What it is, for people.
    pub(super) fn kind_name(&self) -> &'static str {
        match self.place {
            Place::Field(_) => "field",
            Place::Row => "row",
            Place::Column => "column",
            Place::Whole if self.dataset.shape.as_ref().is_some_and(|shape| shape.len() > 1) => "column",
            Place::Whole => "dataset",
        }
    }

    /// The names of the columns of its dataset, where an attribute lists them.
    pub(super) fn names(&self) -> Vec<String> {
        let listed = self.dataset.attributes.iter().find_map(|(name, held)| match held {
            Texts(texts) if names::role(name, 0) == Some(Columns) => Some(texts),
            _ => None,
        });
        let texts =
            listed.filter(|texts| self.columns > 1 && texts.len() == self.columns).into_iter().flatten();
        texts.map(|text| decoded(text).trim_end_matches('\0').trim().to_owned()).collect()
    }

    /// The last part of its name, which may tell its unit.
    pub(super) fn bare_name(&self) -> String {
        if let Place::Field(field) = &self.place {
            return decoded(&field.name);
        }
        let of_dataset = self.path.rsplit('/').next().unwrap_or_default();
        self.names().into_iter().nth(self.index).unwrap_or_else(|| of_dataset.to_owned())
    }

    /// Whether it is a field of records.
    pub(super) fn is_field(&self) -> bool {
        matches!(self.place, Place::Field(_))
    }

    /// The group it lies in, without a trailing slash.
    pub(super) fn group(&self) -> &str {
        self.path.rsplit_once('/').map_or("", |(group, _)| group)
    }

    /// Memory of its numbers when they are read, of the widest kind.
    pub(super) fn held_bytes(&self) -> u64 {
        8 * self.length as u64
    }

    /// How many values are unpacked to have them.
    pub(super) fn values(&self) -> u64 {
        let rows = (self.length as u64).saturating_mul(self.columns as u64);
        rows.max(self.dataset.unpacked_bytes() / self.dataset.value_bytes.max(1))
    }

    /// Memory of the largest block that the library must unpack, or that is read at once, to have them.
    pub(super) fn part_bytes(&self) -> u64 {
        let Storage::Chunked { shape: chunk, .. } = &self.dataset.storage else { return 0 };
        let values = chunk.iter().fold(1_u64, |product, &n| product.saturating_mul(n as u64));
        match &self.place {
            Place::Field(_) => values.saturating_mul(self.dataset.value_bytes),
            Place::Column => {
                let rows = chunk.first().copied().unwrap_or(1) as u64;
                8_u64.saturating_mul(values.max(rows.saturating_mul(self.columns as u64)))
            }
            Place::Whole | Place::Row => 8_u64.saturating_mul(values),
        }
    }
}
