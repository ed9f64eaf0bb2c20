//! MCAP files to raw channels and listings: JSON, protobuf and ROS 2 messages, whole files and what is left
//! of others.

mod beside;
mod cdr;
mod chunk;
mod column;
mod complaint;
mod descriptors;
#[cfg(any(test, fuzzing))]
pub(super) mod fuzz_tests;
mod json;
mod list;
mod message_type;
mod numbers;
mod path;
mod plan;
mod planning;
mod protobuf;
mod read;
mod records;
mod ros_type;
mod scanned;
mod summary;
mod topic;
mod topics;
mod walk;
mod wire;

pub(super) use list::list;
pub(super) use read::read;

#[cfg(test)]
pub(super) mod written;
