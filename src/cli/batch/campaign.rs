//! Writes the files of a campaign from its lines: page and pictures at once, the two tables line by line.

use super::super::Ending;
use super::super::lines::LineFiles;
use super::super::output::{Folder, replace_in_pieces};
use super::plan::SUMMARY;
use crate::data::{CaskFile, Contact, Drop};
use crate::report::{Batch, BatchRow, CampaignFiles, PredictedCurve};
use crate::{ingest, predict};
use std::path::Path;

/// Steps of the angle in a predicted curve.
const ANGLES: u32 = 100;

/// Writes the files of a campaign; `lines` are all of its lines.
pub fn write(out: &Path, batch: &Batch, lines: &LineFiles, inputs: &[&Path]) -> miette::Result<()> {
    let folder = Folder::prepare(out, &SUMMARY[..3], inputs)?;
    let cask_file = |row: &BatchRow| {
        let line = lines.line(usize::try_from(row.at.number).ok()?.checked_sub(1)?)?;
        ingest::cask_file::of_text(Path::new(""), line["cask_text"].as_str()?).ok()
    };
    let files = CampaignFiles::new(batch, |row, ks, angles_deg| {
        cask_file(row).map_or_else(Vec::new, |cask_file| predict_curves(&cask_file, ks, angles_deg))
    });
    folder.create()?;
    // This file is first, since it marks the folder as a campaign's: a run that is stopped here can continue.
    replace_in_pieces(&out.join(SUMMARY[0]), |put| {
        put(&files.json_head()?)?;
        let mut between = "";
        lines.for_each(|line| {
            put(between.as_bytes())?;
            between = CampaignFiles::JSON_BETWEEN;
            put(&files.json_row(&serde_json::from_slice(line).unwrap_or_default())?)
        })?;
        put(CampaignFiles::JSON_END.as_bytes())
    })?;
    replace_in_pieces(&out.join(SUMMARY[1]), |put| {
        put(&batch.csv_head()?)?;
        lines.for_each(|line| put(&files.csv_row(&serde_json::from_slice(line).unwrap_or_default())?))
    })?;
    Ok(folder.write(&files.page())?)
}

/// Predicts rod and body, rough and smooth, for the lowest and the highest k.
fn predict_curves(cask_file: &CaskFile, ks: [f64; 2], [from, to]: [f64; 2]) -> Vec<PredictedCurve> {
    let mut curves = Vec::new();
    for body in predict::bodies(&cask_file.cask) {
        for contact in [Contact::Rough, Contact::Smooth] {
            for k in ks {
                let at = |i: u32| {
                    let angle_deg = from + (to - from) * f64::from(i) / f64::from(ANGLES);
                    let drop = Drop { angle_rad: angle_deg.to_radians(), ..cask_file.drop };
                    let prediction = predict::predict(&body, &drop, contact, k);
                    (angle_deg, prediction.slap_down_speed_m_s.unwrap_or(f64::NAN))
                };
                let points = (0..=ANGLES).map(at).collect();
                curves.push(PredictedCurve { model: body.model, contact, points });
            }
        }
    }
    curves
}

/// Outcome of a campaign: that of its worst recording.
pub fn ending(batch: &Batch) -> Ending {
    match batch.rows.iter().map(|row| row.exit).max() {
        Some(2..) => Ending::NotDone,
        exit => Ending::from_review(exit == Some(1)),
    }
}
