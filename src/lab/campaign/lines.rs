//! A row to a line of JSON that says of which campaign it is, and such a line back to its row.

use crate::data::Program;
use crate::lab::data::{CampaignRequest, CampaignRow, CampaignShard};
use serde::Serialize;

/// What the first key of every line names.
pub const SCHEMA: &str = "dropcheck.scenes/1";

/// Of which campaign a line is, and where in it.
#[derive(Debug, Clone, Serialize)]
pub struct ScenePlace {
    /// [`SCHEMA`].
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// The commit that it was built of, where the build was told.
    pub commit: Option<String>,
    /// What was asked for.
    pub of: CampaignRequest,
    /// Scenes of the whole.
    pub count: usize,
    /// Which of them, from 0.
    pub number: usize,
    /// Which part holds it, of how many.
    pub shard: [usize; 2],
}

impl ScenePlace {
    /// The first scene of a shard, by this program.
    #[must_use]
    pub fn first(of: &CampaignRequest, shard: CampaignShard) -> Self {
        let program = Program::this();
        Self {
            schema: SCHEMA.to_owned(),
            version: program.version.to_owned(),
            commit: program.commit.map(str::to_owned),
            of: of.clone(),
            count: super::count(of),
            number: shard.index,
            shard: [shard.index, shard.count],
        }
    }

    /// Scene `number` of the same campaign, in the part that holds it.
    #[must_use]
    pub fn at(&self, number: usize) -> Self {
        let parts = self.shard[1];
        Self { number, shard: [number % parts.max(1), parts], ..self.clone() }
    }
}

#[derive(Serialize)]
struct PlacedRow<'a> {
    campaign: &'a ScenePlace,
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
#[must_use]
pub fn read(line: &[u8]) -> Option<CampaignRow> {
    serde_json::from_slice(line.strip_suffix(b"\n")?).ok()
}
