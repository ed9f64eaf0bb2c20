//! Lines of JSON, one a recording or scene, and the shards of a campaign that hold them.

mod file;
mod output;
mod shards;

pub use file::{LineFiles, LineRecord};
pub use output::LineOutput;
pub use shards::{holds_some, merged, no_shard, part, schema};
