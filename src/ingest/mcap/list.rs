//! An MCAP file to its listing: every numeric field of every topic, read once and kept nowhere.

use super::column::{CLOCK_IS_SET_NS, TimeOrigin, message_time, seconds_from};
use super::json;
use super::message_type::{MessageType, implied_unit};
use super::path::{FieldPath, source_text};
use super::plan::{Decode, Leaf, Plan, Slots, Value};
use super::running::{MOST_SEGMENTS, Running, Segment};
use super::scan::scan;
use super::scanned::{ChannelInfo, Scanned, Sink};
use crate::data::{Issue, IssueCode, ListedChannel, Listing, RecordingFormat, Severity};
use crate::ingest::error::{self, IngestError};
use crate::ingest::{Limits, Progress};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// Lists what the file at `path` holds.
///
/// # Errors
/// Only where the file cannot be read at all.
pub(in crate::ingest) fn list(
    path: &Path,
    limits: Limits,
    progress: Progress,
) -> Result<Listing, IngestError> {
    let bytes = std::fs::metadata(path).map_err(|source| error::io(path, source))?.len();
    let mut walk = ListWalk::new(limits);
    let scanned = scan(path, limits, &mut walk, progress)?;
    let ListWalk { topics, slots, .. } = &mut walk;
    for topic in topics {
        topic.release(slots);
    }
    let mut issues = scanned.issues();
    issues.extend(walk.topics.iter().filter_map(Topic::issue));
    Ok(Listing {
        schema: "dropcheck.inspect/1",
        recording: path.display().to_string(),
        bytes,
        format: RecordingFormat::Mcap,
        counts: scanned.counts.named(),
        facts: facts(&scanned, walk.zero_ns()),
        channels: walk.finish(),
        issues,
    })
}

fn facts(scanned: &Scanned, zero_ns: Option<i64>) -> BTreeMap<String, String> {
    let is_set = |ns: &i64| *ns >= CLOCK_IS_SET_NS;
    let start = zero_ns.filter(is_set).and_then(|ns| jiff::Timestamp::from_nanosecond(ns.into()).ok());
    let compressions: Vec<&str> = scanned
        .compressions
        .iter()
        .map(|name| if name.is_empty() { "none" } else { name.as_str() })
        .collect();
    [
        ("profile", scanned.profile.clone()),
        ("library", scanned.library.clone()),
        ("compression", compressions.join(", ")),
        ("start", start.map(|start| start.to_string()).unwrap_or_default()),
    ]
    .into_iter()
    .filter(|(_, value)| !value.is_empty())
    .map(|(name, value)| (name.to_owned(), value))
    .collect()
}

/// What is seen of one topic.
struct Topic {
    name: String,
    encoding: String,
    schema_name: String,
    message_type: Result<MessageType, String>,
    plan: Plan,
    decoder: Option<Box<dyn Decode>>,
    fields: Vec<Field>,
    messages: u64,
    malformed: u64,
    first_problem: Option<String>,
    /// Messages and malformed ones when the chunk began that was the last to hold a message of it.
    mark: (u64, u64),
    marked_chunk: u64,
    /// Blocks that are remembered, or were in a rejected chunk.
    blocks: u64,
    /// Whether its stamps count from their own start, so that zero is a time; unknown before the second message.
    is_own_clock: Option<bool>,
    /// The first message and its log time, where its stamp is zero, until the second tells what that means.
    held: Option<(i64, Vec<u8>)>,
}

/// What is seen of one field.
struct Field {
    leaf: Leaf,
    running: Running,
    segments: Vec<Segment>,
    unit: Option<String>,
    mark: (Running, usize),
}

pub(super) struct ListWalk {
    topics: Vec<Topic>,
    by_id: HashMap<u16, usize>,
    /// By name and encoding.
    by_name: HashMap<(String, String), usize>,
    slots: Slots,
    /// The longest JSON message that is taken apart.
    longest_json_bytes: u64,
    /// Chunks begun.
    chunk: u64,
    /// Topics with a message in this chunk.
    touched: Vec<usize>,
    held_bytes: u64,
}

impl Sink for ListWalk {
    type Part = ();

    fn channel(&mut self, id: u16, info: &ChannelInfo) {
        let schema_name = info.schema.map_or("", |schema| schema.name.as_str());
        let encoding = match info.schema {
            Some(schema) if !schema.name.is_empty() => format!("{} ({})", info.message_encoding, schema.name),
            _ => info.message_encoding.to_owned(),
        };
        let same = (info.topic.to_owned(), encoding.clone());
        let index = self.by_name.get(&same).copied().unwrap_or_else(|| {
            let mut topic = Topic {
                name: info.topic.to_owned(),
                encoding: encoding.clone(),
                schema_name: schema_name.to_owned(),
                message_type: MessageType::new(info),
                plan: Plan::default(),
                decoder: None,
                fields: Vec::new(),
                messages: 0,
                malformed: 0,
                first_problem: None,
                mark: (0, 0),
                marked_chunk: 0,
                blocks: 0,
                is_own_clock: None,
                held: None,
            };
            if let Some(leaves) = topic.message_type.as_ref().ok().and_then(MessageType::leaves) {
                topic.prepare(leaves);
            }
            self.held_bytes += topic.held_bytes();
            self.topics.push(topic);
            self.by_name.insert(same, self.topics.len() - 1);
            self.topics.len() - 1
        });
        self.by_id.insert(id, index);
    }

    fn message(&mut self, id: u16, log_time_ns: i64, data: &[u8]) {
        let Some(&index) = self.by_id.get(&id) else { return };
        let Some(topic) = self.topics.get_mut(index) else { return };
        if topic.marked_chunk != self.chunk {
            topic.set_mark(self.chunk);
            self.touched.push(index);
        }
        let before = topic.held_bytes();
        topic.message(log_time_ns, data, &mut self.slots, self.longest_json_bytes);
        self.held_bytes = (self.held_bytes + topic.held_bytes()).saturating_sub(before);
    }

    fn chunk_begins(&mut self) {
        // A topic is marked with its first message: there may be many topics, and many chunks of a message each.
        self.chunk += 1;
        self.touched.clear();
    }

    fn held_bytes(&self) -> u64 {
        self.held_bytes
    }

    fn chunk_rejected(&mut self) {
        for index in std::mem::take(&mut self.touched) {
            let Some(topic) = self.topics.get_mut(index) else { continue };
            (topic.messages, topic.malformed) = topic.mark;
            if topic.messages == 0 {
                (topic.is_own_clock, topic.held) = (None, None);
            }
            for field in &mut topic.fields {
                field.running = field.mark.0;
                field.segments.truncate(field.mark.1);
            }
        }
    }
}

impl Topic {
    /// Memory that grows with the file.
    fn held_bytes(&self) -> u64 {
        let message = self.held.as_ref().map_or(0, |(_, data)| data.len());
        (message + self.fields.len() * size_of::<Field>()) as u64 + self.blocks * size_of::<Segment>() as u64
    }

    fn set_mark(&mut self, chunk: u64) {
        self.marked_chunk = chunk;
        self.mark = (self.messages, self.malformed);
        for field in &mut self.fields {
            field.mark = (field.running, field.segments.len());
        }
    }

    fn prepare(&mut self, leaves: Vec<Leaf>) {
        let signals: Vec<(Leaf, FieldPath)> = leaves
            .into_iter()
            .filter(|leaf| !leaf.is_about_others())
            .filter_map(|leaf| FieldPath::parse(&leaf.path).map(|path| (leaf, path)))
            .collect();
        let paths: Vec<FieldPath> = signals.iter().map(|(_, path)| path.clone()).collect();
        self.plan = Plan::new(&paths);
        self.decoder = self.message_type.as_ref().ok().map(|message_type| message_type.decoder(&self.plan));
        self.fields = signals
            .into_iter()
            .map(|(leaf, _)| Field {
                unit: implied_unit(&self.schema_name, &leaf.path).map(str::to_owned),
                leaf,
                running: Running::default(),
                segments: Vec::new(),
                mark: (Running::default(), 0),
            })
            .collect();
    }

    fn message(&mut self, log_time_ns: i64, data: &[u8], slots: &mut Slots, longest_json_bytes: u64) {
        self.messages += 1;
        if self.decoder.is_none() && matches!(self.message_type, Ok(MessageType::Json)) {
            if data.len() as u64 > longest_json_bytes {
                self.message_type = Err(format!(
                    "its fields were not looked for: a message takes {} MiB; allow more with --max-memory",
                    data.len() >> 20
                ));
                return;
            }
            let leaves = json::leaves(data);
            if !leaves.is_empty() {
                self.prepare(leaves);
            }
        }
        self.decode(log_time_ns, data, slots);
    }

    fn decode(&mut self, log_time_ns: i64, data: &[u8], slots: &mut Slots) {
        let Some(decoder) = &self.decoder else { return };
        slots.clear(self.plan.wants.len());
        if let Err(problem) = decoder.decode(data, slots) {
            self.malformed += 1;
            self.first_problem.get_or_insert(problem);
            return;
        }
        if self.is_own_clock.is_none() {
            let stamp = self.plan.targets.first().map(|target| slots.stamp(target)).unwrap_or_default();
            if stamp == Value::Stamp(0) && self.held.is_none() {
                self.held = Some((log_time_ns, data.to_vec()));
                return;
            }
            let counts_from_start =
                matches!(stamp, Value::Stamp(ns) if ns != 0 && ns.abs() < CLOCK_IS_SET_NS);
            self.is_own_clock = Some(counts_from_start && self.held.is_some());
            if self.held.is_some() {
                self.release(slots);
                return self.decode(log_time_ns, data, slots);
            }
        }
        self.see(log_time_ns, slots);
    }

    /// Takes the message that was held back.
    fn release(&mut self, slots: &mut Slots) {
        if let Some((log_time_ns, data)) = self.held.take() {
            self.is_own_clock.get_or_insert(false);
            self.decode(log_time_ns, &data, slots);
        }
    }

    /// Takes what one message gave.
    fn see(&mut self, log_time_ns: i64, slots: &mut Slots) {
        for (target, field) in self.plan.targets.iter().zip(&mut self.fields) {
            let stamp = slots.stamp(target);
            let (time_ns, _) = match (&stamp, self.is_own_clock) {
                (Value::Stamp(0), Some(true)) => (0, TimeOrigin::Stamp),
                _ => message_time(&stamp, log_time_ns),
            };
            if let Some(unit) = slots.unit(target).filter(|unit| field.unit.as_deref() != Some(*unit)) {
                field.unit = Some(unit.to_owned());
            }
            let rate_hz = slots.rate_hz(target);
            match slots.samples(target) {
                Value::Number { value, .. } => field.running.number(time_ns, value),
                Value::Array(samples) if !samples.is_empty() => {
                    field.running.block(time_ns, &samples);
                    if field.segments.len() < MOST_SEGMENTS {
                        self.blocks += 1;
                        field.segments.push(Segment {
                            start_ns: time_ns,
                            count: samples.len() as u64,
                            rate_hz,
                        });
                    }
                }
                _ => {}
            }
        }
    }

    fn issue(&self) -> Option<Issue> {
        let problem = self.first_problem.as_ref().filter(|_| self.malformed > 0)?;
        Some(Issue::new(
            IssueCode::Damaged,
            Severity::Warning,
            format!(
                "{} of {} messages of {} do not decode; the first: {problem}",
                self.malformed, self.messages, self.name
            ),
        ))
    }

    fn listed(&self, zero_ns: Option<i64>) -> Vec<ListedChannel> {
        if self.fields.is_empty() {
            let unreadable = match &self.message_type {
                Err(reason) => Some(reason.clone()),
                Ok(_) if self.messages == 0 => None,
                Ok(_) => Some("its messages hold no numbers".to_owned()),
            };
            return vec![ListedChannel {
                source: self.name.clone(),
                kind: "topic".into(),
                samples: None,
                messages: Some(self.messages),
                sample_rate_hz: None,
                unit: None,
                start_s: None,
                duration_s: None,
                gaps: None,
                range: None,
                encoding: self.encoding.clone(),
                unreadable,
            }];
        }
        self.fields.iter().map(|field| field.listed(self, zero_ns)).collect()
    }
}

impl Field {
    fn listed(&self, topic: &Topic, zero_ns: Option<i64>) -> ListedChannel {
        let timing = self.running.timing(&self.segments);
        let start_s =
            self.running.first_ns().zip(zero_ns).map(|(first_ns, zero_ns)| seconds_from(first_ns, zero_ns));
        ListedChannel {
            source: source_text(&topic.name, &self.leaf.path),
            kind: if self.leaf.is_array { "array" } else { "number" }.into(),
            samples: Some(self.running.samples),
            messages: Some(topic.messages),
            sample_rate_hz: timing.sample_rate_hz,
            unit: self.unit.clone(),
            start_s,
            duration_s: timing.duration_s,
            gaps: timing.gaps,
            range: self.running.range(),
            encoding: topic.encoding.clone(),
            unreadable: None,
        }
    }
}

impl ListWalk {
    pub(super) fn new(limits: Limits) -> Self {
        /// A tree of JSON values takes up to so many times its text: two letters become 32 bytes.
        const TREE_BYTES: u64 = 32;
        Self {
            topics: Vec::new(),
            by_id: HashMap::new(),
            by_name: HashMap::new(),
            slots: Slots::default(),
            longest_json_bytes: limits.part_bytes() / TREE_BYTES,
            chunk: 0,
            touched: Vec::new(),
            held_bytes: 0,
        }
    }

    /// The earliest sample of all, ns since 1970.
    fn zero_ns(&self) -> Option<i64> {
        self.topics.iter().flat_map(|topic| &topic.fields).filter_map(|field| field.running.first_ns()).min()
    }

    /// Every source, times counted from the earliest sample of all.
    fn finish(&self) -> Vec<ListedChannel> {
        let zero_ns = self.zero_ns();
        self.topics.iter().flat_map(|topic| topic.listed(zero_ns)).collect()
    }
}

#[cfg(test)]
#[path = "list_tests.rs"]
mod tests;
