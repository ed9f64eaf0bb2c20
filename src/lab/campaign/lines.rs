//! A row to a line of JSON that says of which campaign it is, and such a line back to its row.

use crate::data::Program;
use crate::lab::data::{CampaignRequest, CampaignRow};
use serde::Serialize;

/// What the first key of every line names.
pub const SCHEMA: &str = "dropcheck.scenes/1";

/// Of which campaign a line is, and where in it.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ScenePlace<'a> {
    schema: &'static str,
    version: &'static str,
    commit: Option<&'static str>,
    of: &'a CampaignRequest,
    /// Scenes of the whole.
    count: usize,
    /// Which of them, from 0.
    number: usize,
    /// Which part holds it, of how many.
    shard: [usize; 2],
}

impl<'a> ScenePlace<'a> {
    /// The first of the `count` scenes of a campaign, done in so many parts, by this program.
    pub fn first(of: &'a CampaignRequest, count: usize, parts: usize) -> Self {
        let Program { version, commit, .. } = Program::this();
        Self { schema: SCHEMA, version, commit, of, count, number: 0, shard: [0, parts] }
    }

    /// Scene `number` of the same campaign.
    pub fn at(self, number: usize) -> Self {
        let parts = self.shard[1];
        Self { number, shard: [number % parts.max(1), parts], ..self }
    }
}

#[derive(Serialize)]
struct PlacedRow<'a> {
    campaign: &'a ScenePlace<'a>,
    #[serde(flatten)]
    row: &'a CampaignRow,
}

/// The line, with its end.
///
/// # Errors
/// Where the writer fails.
pub fn line(campaign: &ScenePlace, row: &CampaignRow) -> serde_json::Result<String> {
    Ok(serde_json::to_string(&PlacedRow { campaign, row })? + "\n")
}

/// What a line says; `None` where it is no whole one.
pub fn read(line: &[u8]) -> Option<CampaignRow> {
    serde_json::from_slice(line.strip_suffix(b"\n")?).ok()
}
