//! A channel's record and schema to the type of its messages: which fields they have and how to decode them.

use super::cdr::{self, Cdr};
use super::descriptors;
use super::json::Json;
use super::plan::{Decode, Leaf, Plan};
use super::protobuf::{self, Protobuf};
use super::ros_type;
use super::scanned::ChannelInfo;
use prost_reflect::MessageDescriptor;

/// Message encodings that are read.
const READ: &str = "those that can be read are json, protobuf, and cdr with ros2msg";

/// What is known of a channel's messages.
#[derive(Debug)]
pub(super) enum MessageType {
    /// Each message tells its own fields.
    Json,
    /// From the descriptor set.
    Protobuf(MessageDescriptor),
    /// From the `ros2msg` text.
    Cdr(Vec<ros_type::Field>),
}

impl MessageType {
    /// The type of a channel's messages.
    ///
    /// # Errors
    /// Why its messages cannot be read.
    pub(super) fn new(info: &ChannelInfo) -> Result<Self, String> {
        match (info.message_encoding, info.schema) {
            ("json", _) => Ok(Self::Json),
            ("protobuf", Some(schema)) if schema.encoding == "protobuf" => {
                descriptors::message_type(&schema.name, &schema.data).map(Self::Protobuf)
            }
            ("cdr", Some(schema)) if schema.encoding == "ros2msg" => {
                ros_type::parse(&schema.name, &String::from_utf8_lossy(&schema.data)).map(Self::Cdr)
            }
            (encoding @ ("protobuf" | "cdr"), None) => {
                Err(format!("its messages are encoded as {encoding:?} and their schema is missing"))
            }
            (encoding, Some(schema)) => Err(format!(
                "its messages are encoded as {encoding:?} with a schema in {:?}; {READ}",
                schema.encoding
            )),
            (encoding, None) => {
                Err(format!("its messages are encoded as {encoding:?} without a schema; {READ}"))
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

    /// A decoder for the fields of `plan`.
    pub(super) fn decoder(&self, plan: &Plan) -> Box<dyn Decode> {
        match self {
            Self::Json => Box::new(Json::new(plan)),
            Self::Protobuf(message) => Box::new(Protobuf::new(plan, message)),
            Self::Cdr(fields) => Box::new(Cdr::new(plan, fields)),
        }
    }
}

/// The unit that a message type fixes for a field: ROS messages are in SI units (REP 103).
pub(super) fn implied_unit(schema_name: &str, field: &str) -> Option<&'static str> {
    let (package, name) = (schema_name.split('/').next()?, schema_name.rsplit('/').next()?);
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
            assert_eq!(implied_unit(schema, field), unit, "{schema} {field}");
        }
    }
}
