//! Writes curves as `curves.mcap`: JSON messages with schemas, one per sample, for Foxglove.

use super::ReportError;
use super::grid::{CurveSeries, channel_series, motion_series, named_events};
use super::text::sanitize;
use crate::data::Analysis;
use crate::numerics::{nanoseconds, to_f32};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::io::Cursor;

/// Level of zstd: at the library's default, 3, the file of the fixtures' ANF-18 at 1e5 samples is 2 % larger.
const ZSTD_LEVEL: u32 = 1;

/// The file as bytes; `log_time` is absolute if the recording's start is known, else from 0.
///
/// # Errors
///
/// [`ReportError::Mcap`] if the writer fails.
pub(super) fn bytes(analysis: &Analysis) -> Result<Vec<u8>, ReportError> {
    let options = WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .compression_level(ZSTD_LEVEL)
        // Separate threads would each take part of a message at a time, and wait for one another.
        .compression_threads(0)
        .library(concat!("dropcheck ", env!("CARGO_PKG_VERSION")));
    let mut file = CurvesFile {
        writer: options.create(Cursor::new(Vec::new()))?,
        start_ns: analysis.start_unix_ns.unwrap_or(0),
        buffer: String::new(),
    };
    let mut topics = Vec::new();
    for curve in &analysis.curves.channels {
        let topic = topic(&curve.channel, &topics);
        file.curve("dropcheck.ChannelCurve", &topic, &curve.time_s, &channel_series(curve), "")?;
        topics.push(topic);
    }
    for curve in &analysis.curves.others {
        let topic = topic(&curve.channel, &topics);
        let series = [CurveSeries { name: "value", values: &curve.values, factor: 1.0 }];
        file.curve("dropcheck.OtherChannel", &topic, &curve.time_s, &series, &curve.unit)?;
        topics.push(topic);
    }
    if let Some(motion) = &analysis.curves.motion {
        file.curve("dropcheck.Motion", "/dropcheck/motion", &motion.time_s, &motion_series(motion), "")?;
    }
    file.events(analysis)?;
    file.writer.finish()?;
    Ok(file.writer.into_inner().into_inner())
}

/// A free topic `/dropcheck/NAME`; characters that are invalid in a message path become `_`.
fn topic(name: &str, taken: &[String]) -> String {
    let name: String = sanitize(name)
        .chars()
        .map(|c| if c.is_alphanumeric() || c == '_' || c == '-' { c } else { '_' })
        .collect();
    let mut topic = format!("/dropcheck/{name}");
    while topic == "/dropcheck/motion" || topic == "/dropcheck/events" || taken.contains(&topic) {
        topic.push('_');
    }
    topic
}

/// The file under way.
struct CurvesFile {
    writer: Writer<Cursor<Vec<u8>>>,
    start_ns: i64,
    buffer: String,
}

impl CurvesFile {
    /// Declares a channel of JSON messages with a time stamp and these fields; an existing schema is used
    /// again. The channel's metadata has a unit that the field names do not state.
    fn channel(&mut self, name: &str, topic: &str, fields: &[&str], unit: &str) -> Result<u16, ReportError> {
        let mut properties = serde_json::json!({"timestamp": {
            "type": "object", "title": "time",
            "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}
        }});
        for field in fields {
            let kind = if *field == "name" { "string" } else { "number" };
            properties[*field] = serde_json::json!({"type": kind});
        }
        let schema = serde_json::json!({"title": name, "type": "object", "properties": properties});
        let schema = self.writer.add_schema(name, "jsonschema", &serde_json::to_vec(&schema)?)?;
        let unit = (!unit.is_empty()).then(|| ("unit".to_owned(), unit.to_owned()));
        Ok(self.writer.add_channel(schema, topic, "json", &unit.into_iter().collect::<BTreeMap<_, _>>())?)
    }

    fn events(&mut self, analysis: &Analysis) -> Result<(), ReportError> {
        let id = self.channel("dropcheck.Event", "/dropcheck/events", &["name", "time_s"], "")?;
        for (name, time_s) in named_events(&analysis.result.events) {
            if let Some(time_s) = time_s.filter(|t| t.is_finite()) {
                self.begin(time_s);
                // Writing to a string does not fail.
                let _ = write!(self.buffer, r#","name":"{name}","time_s":{time_s}}}"#);
                self.send(id, 0, time_s)?;
            }
        }
        Ok(())
    }

    fn curve(
        &mut self,
        schema: &str,
        topic: &str,
        time_s: &[f64],
        series: &[CurveSeries],
        unit: &str,
    ) -> Result<(), ReportError> {
        let fields: Vec<&str> = series.iter().map(|one| one.name).collect();
        let id = self.channel(schema, topic, &fields, unit)?;
        let mut digits = zmij::Buffer::new();
        for (i, &time_s) in time_s.iter().enumerate() {
            self.begin(time_s);
            for CurveSeries { name, values, factor } in series {
                // A missing value is omitted: JSON has no number for it.
                if let Some(value) = values.get(i).filter(|v| v.is_finite()) {
                    for part in [",\"", name, "\":", digits.format(to_f32(value * factor))] {
                        self.buffer.push_str(part);
                    }
                }
            }
            self.buffer.push('}');
            self.send(id, u32::try_from(i).unwrap_or(u32::MAX), time_s)?;
        }
        Ok(())
    }

    fn begin(&mut self, time_s: f64) {
        let stamp_ns = self.stamp_ns(time_s);
        self.buffer.clear();
        let (sec, nsec) = (stamp_ns / 1_000_000_000, stamp_ns % 1_000_000_000);
        let _ = write!(self.buffer, r#"{{"timestamp":{{"sec":{sec},"nsec":{nsec}}}"#);
    }

    fn send(&mut self, channel_id: u16, sequence: u32, time_s: f64) -> Result<(), ReportError> {
        let stamp_ns = self.stamp_ns(time_s);
        let header = MessageHeader { channel_id, sequence, log_time: stamp_ns, publish_time: stamp_ns };
        self.writer.write_to_known_channel(&header, self.buffer.as_bytes())?;
        Ok(())
    }

    /// Time of a sample, ns; times before 1970, or before 0 in a recording without a start, become 0.
    fn stamp_ns(&self, time_s: f64) -> u64 {
        u64::try_from(self.start_ns.saturating_add(nanoseconds(time_s))).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;
    use serde_json::Value;

    #[test]
    fn messages_return_with_absolute_times() {
        let analysis = sample::analysis();
        let bytes = bytes(&analysis).unwrap();
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for message in mcap::MessageStream::new(&bytes).unwrap() {
            let message = message.unwrap();
            let json: Value = serde_json::from_slice(&message.data).unwrap();
            assert_eq!(json["timestamp"]["sec"], 1_700_000_000);
            assert!(message.log_time >= 1_700_000_000_000_000_000);
            if message.channel.topic == "/dropcheck/A1" && message.sequence == 700 {
                let truth = analysis.curves.channels[0].velocity_m_s[700];
                // Single precision, printed so that it reads back to the same bits.
                let read = to_f32(json["velocity_m_s"].as_f64().unwrap());
                assert_eq!(read.to_bits(), to_f32(truth).to_bits());
            }
            *counts.entry(message.channel.topic.clone()).or_default() += 1;
        }
        assert_eq!(counts["/dropcheck/A1"], 2000);
        assert_eq!(counts["/dropcheck/A2"], 2000);
        assert_eq!(counts["/dropcheck/motion"], 1400);
        assert_eq!(counts["/dropcheck/events"], 3);
    }

    #[test]
    fn topics_never_collide() {
        let taken = vec!["/dropcheck/A_1".to_owned()];
        assert_eq!(topic("A 1", &taken), "/dropcheck/A_1_");
        assert_eq!(topic("motion", &[]), "/dropcheck/motion_");
    }

    #[test]
    fn what_is_not_a_number_is_left_out() {
        let mut analysis = sample::analysis();
        analysis.curves.channels[0].raw_m_s2[0] = f64::NAN;
        let bytes = bytes(&analysis).unwrap();
        let first = mcap::MessageStream::new(&bytes).unwrap().next().unwrap().unwrap();
        let json: Value = serde_json::from_slice(&first.data).unwrap();
        assert!(json.get("raw_g").is_none());
        assert!(json.get("filtered_g").is_some());
    }
}
