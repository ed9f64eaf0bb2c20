//! What says of which sensor each sample is to the samples of one sensor, or to a refusal that names them
//! all.

use super::column::DatasetColumn;
use super::names;
use crate::data::RowsOf;
use crate::ingest::counting::are_ids_by_turns;
use crate::ingest::limits::MOST_SENSORS;
use crate::ingest::refusal::Refusal;

/// The sensors of which a column holds samples.
#[derive(Default)]
pub(super) struct RecordSensors {
    /// What stands for the sensor of each sample.
    each: Vec<f64>,
    /// How a cask file picks each of them.
    pub all: Vec<RowsOf>,
}

impl RecordSensors {
    /// By the ids in a column; `None` where they are no whole numbers, or not of several sensors by turns and
    /// not picked for them.
    pub(super) fn by(ids: &DatasetColumn, are_picked: bool) -> Option<Self> {
        let each = ids.samples().ok()?.into_f64();
        let (mut seen, mut runs): (Vec<f64>, usize) = (Vec::new(), 0);
        for id in each.chunk_by(PartialEq::eq).map(|run| run[0]) {
            runs += 1;
            if !seen.contains(&id) {
                seen.push(id);
            }
            if seen.len() > MOST_SENSORS || id.fract().abs() > 0.0 || id.is_nan() {
                return None;
            }
        }
        seen.sort_by(f64::total_cmp);
        let column = ids.bare_name();
        let all = seen.iter().map(|id| RowsOf { column: column.clone(), is: id.to_string() });
        // Numbers of any other name must return one after another.
        let is_named = names::is_sensor(&column);
        let is_so = if is_named { seen.len() > 1 && runs > seen.len() } else { are_ids_by_turns(&each) };
        (are_picked || is_so).then(|| Self { all: all.collect(), each })
    }

    /// The samples of one of them.
    ///
    /// # Errors
    /// None is picked, or none that is there.
    pub(super) fn rows(&self, picked: Option<&RowsOf>) -> Result<Vec<usize>, Refusal> {
        let is = picked.and_then(|picked| picked.is.trim().parse::<f64>().ok());
        let rows: Vec<usize> = (0..self.each.len()).filter(|row| Some(self.each[*row]) == is).collect();
        if !rows.is_empty() {
            return Ok(rows);
        }
        let (Some(first), ids) = (self.all.first(), self.all.iter().map(|one| one.is.as_str())) else {
            return Err(Refusal::new(
                format!(
                    "what is to pick its samples holds no whole number for each, or more than {MOST_SENSORS} \
                     different ones"
                ),
                "pick them by another field or dataset, or take `where` out",
            ));
        };
        let (count, ids) = (self.all.len(), ids.collect::<Vec<_>>().join(", "));
        let column = &first.column;
        Err(Refusal::new(
            format!(
                "its samples are those of {count} sensors by turns, by {column} = {ids}, and none of these \
                 is picked"
            ),
            format!("write into each [[channel]] of the cask file whose they are, as {first}"),
        ))
    }
}
