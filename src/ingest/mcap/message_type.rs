//! A channel's record and schema to the type of its messages: which fields they have and how to decode them.

use super::cdr::{self, Cdr};
use super::descriptors;
use super::json::Json;
use super::path::FieldPath;
use super::plan::{Decode, Leaf, Plan};
use super::protobuf::{self, Protobuf};
use super::ros_type;
use crate::ingest::Limits;
use mcap::Schema;
use mcap::records::Channel;
use prost_reflect::MessageDescriptor;
use std::collections::HashMap;
use std::sync::Arc;

/// A schema is larger than this and the file only to do harm: those of sensors take tens of kilobytes, and
/// each byte of one that is no schema takes five hundred as it is taken apart.
const ALWAYS_READ_BYTES: u64 = 256 << 10;

/// What is known of a channel's messages.
#[derive(Debug, Clone)]
pub(super) enum MessageType {
    /// Each message tells its own fields.
    Json,
    /// From the descriptor set.
    Protobuf(MessageDescriptor),
    /// From the `ros2msg` text.
    Cdr(Arc<[ros_type::RosField]>),
}

/// The message types of a file: each schema is taken apart once, all of them within a limit.
#[derive(Debug, Default)]
pub(super) struct MessageTypes {
    known: HashMap<(u16, String), Result<MessageType, String>>,
    left_bytes: u64,
    largest_bytes: u64,
}

impl MessageTypes {
    /// For a file of `file_bytes`.
    pub(super) fn new(limits: Limits, file_bytes: u64) -> Self {
        let left_bytes = limits.schemas_bytes(file_bytes);
        let largest_bytes = file_bytes.saturating_add(ALWAYS_READ_BYTES);
        Self { known: HashMap::new(), left_bytes, largest_bytes }
    }

    /// The type of a channel's messages.
    ///
    /// # Errors
    /// Why its messages cannot be read.
    pub(super) fn of(&mut self, channel: &Channel, schema: Option<&Schema>) -> Result<MessageType, String> {
        /// What is kept of a type besides its text takes a few hundred bytes.
        const LEAST_BYTES: u64 = 256;
        /// A field of `ros2msg` is paid for by itself: two lines of text double the number of fields.
        const FIELD_BYTES: u64 = size_of::<ros_type::RosField>() as u64;
        let key = (channel.schema_id, channel.message_encoding.clone());
        if let Some(known) = self.known.get(&key) {
            return known.clone();
        }
        let text_bytes = schema.map_or(0, |schema| schema.data.len() as u64);
        if LEAST_BYTES + text_bytes > self.left_bytes.min(self.largest_bytes) {
            return Err(format!(
                "its schema of {text_bytes} bytes is more than is read of the schemas of such a file; allow \
                 more with --max-memory"
            ));
        }
        let mut left = ros_type::MOST_FIELDS;
        let found = MessageType::new(&channel.message_encoding, schema, &mut left);
        let fields_bytes = (ros_type::MOST_FIELDS - left) as u64 * FIELD_BYTES;
        self.left_bytes = self.left_bytes.saturating_sub(LEAST_BYTES + text_bytes + fields_bytes);
        self.known.insert(key, found.clone());
        found
    }
}

impl MessageType {
    /// The type of a channel's messages.
    /// As [`MessageTypes::of`] says; the fields of a `ros2msg` are taken from what is `left`.
    fn new(encoding: &str, schema: Option<&Schema>, left: &mut usize) -> Result<Self, String> {
        match (encoding, schema) {
            ("json", _) => Ok(Self::Json),
            ("protobuf", Some(schema)) if schema.encoding == "protobuf" => {
                descriptors::message_type(&schema.name, &schema.data).map(Self::Protobuf)
            }
            ("cdr", Some(schema)) if schema.encoding == "ros2msg" => {
                ros_type::parse(&schema.name, &String::from_utf8_lossy(&schema.data), left)
                    .map(|fields| Self::Cdr(fields.into()))
            }
            (encoding, schema) => {
                let schema =
                    schema.map_or("no schema".into(), |schema| format!("a schema in {:?}", schema.encoding));
                Err(format!(
                    "its messages are encoded as {encoding:?} with {schema}; those that can be read are \
                     json, protobuf with its schema, and cdr with ros2msg"
                ))
            }
        }
    }

    /// The numeric fields, where the schema tells them.
    pub(super) fn leaves(&self) -> Option<Vec<Leaf>> {
        match self {
            Self::Json => None,
            Self::Protobuf(message) => Some(protobuf::leaves(message)),
            Self::Cdr(fields) => Some(cdr::leaves(fields)),
        }
    }

    /// Whether a message may have the field at `path`, as far as its schema rules out others.
    pub(super) fn has(&self, path: &FieldPath) -> bool {
        match self {
            Self::Cdr(fields) => ros_type::has(fields, &path.0),
            Self::Json | Self::Protobuf(_) => true,
        }
    }

    /// The unit that the type of the messages, or of one within them, fixes for a field.
    pub(super) fn implied_unit(&self, schema_name: &str, field: &str) -> Option<&'static str> {
        let own = unit_of_type(schema_name, field);
        let Self::Cdr(fields) = self else { return own };
        // A message may hold another with its own meaning: `imu` of the type sensor_msgs/Imu.
        let (outer, rest) = field.split_once('.')?;
        let inner = fields.iter().find(|field| field.name == outer);
        own.or_else(|| unit_of_type(inner?.type_name.as_deref()?, rest))
    }

    /// A decoder for the fields of `plan`.
    pub(super) fn decoder(&self, plan: &Plan) -> Box<dyn Decode> {
        match self {
            Self::Json => Box::new(Json(plan.root.clone())),
            Self::Protobuf(message) => Box::new(Protobuf::new(&plan.root, message)),
            Self::Cdr(fields) => Box::new(Cdr::new(plan, fields)),
        }
    }
}

/// The unit that the message type of a field's own message fixes for it: ROS messages are in SI units (REP
/// 103).
fn unit_of_type(type_name: &str, field: &str) -> Option<&'static str> {
    let (package, name) = (type_name.split('/').next()?, type_name.rsplit('/').next()?);
    let is_accel = package == "geometry_msgs" && name.starts_with("Accel");
    let is_imu = package == "sensor_msgs" && name == "Imu";
    let has = |step: &str| field.split('.').any(|part| part == step);
    if (is_imu && has("linear_acceleration")) || (is_accel && has("linear")) {
        Some("m/s^2")
    } else if is_imu && has("angular_velocity") {
        Some("rad/s")
    } else if is_accel && has("angular") {
        Some("rad/s^2")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rep_103_gives_imu_and_accel_their_units() {
        for (schema, field, unit) in [
            ("sensor_msgs/msg/Imu", "linear_acceleration.z", Some("m/s^2")),
            ("sensor_msgs/Imu", "linear_acceleration.z", Some("m/s^2")),
            ("sensor_msgs/msg/Imu", "angular_velocity.z", Some("rad/s")),
            ("geometry_msgs/msg/AccelStamped", "accel.linear.x", Some("m/s^2")),
            ("sensor_msgs/msg/Imu", "orientation.w", None),
            ("my_msgs/msg/Imu", "linear_acceleration.z", None),
        ] {
            assert_eq!(unit_of_type(schema, field), unit, "{schema} {field}");
        }
    }
}
