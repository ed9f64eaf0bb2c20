//! What an MCAP listing sees of one topic, message by message, and of its fields.

use super::column::{CLOCK_IS_SET_NS, TimeOrigin, message_time, seconds_from};
use super::json;
use super::message_type::{MessageType, implied_unit};
use super::path::{FieldPath, source_text};
use super::plan::{Decode, Leaf, MOST_LEAVES, Plan, Slots, Value};
use super::running::{MOST_SEGMENTS, Running, Segment};
use super::scanned::ChannelInfo;
use crate::data::{Issue, IssueCode, ListedChannel, Severity};

/// So many topics and fields are listed in all, each counted once more for every kilobyte of its names: a recording of hundreds of
/// sensors has thousands, and each takes 3 kB. An HDF5 file lists as many objects.
const MOST_LISTED: usize = 10_000;

/// What may still be listed, and what was left out.
pub(super) struct Room {
    left: usize,
    /// Topics that are not listed.
    pub(super) topics_out: usize,
    fields_out: usize,
}

impl Default for Room {
    fn default() -> Self {
        Self { left: MOST_LISTED, topics_out: 0, fields_out: 0 }
    }
}

impl Room {
    /// Whether one more with names of so many bytes is listed.
    pub(super) fn takes(&mut self, name_bytes: usize) -> bool {
        let left = self.left.checked_sub(1 + name_bytes / 1024);
        self.left = left.unwrap_or(0);
        left.is_some()
    }

    /// What was left out.
    pub(super) fn issue(&self) -> Option<Issue> {
        let Self { topics_out, fields_out, .. } = self;
        (topics_out + fields_out > 0).then(|| {
            let message = format!(
                "it holds more than is listed, {MOST_LISTED} in all and {MOST_LEAVES} of a topic: {topics_out} more topics and {fields_out} more fields of the listed ones; a source that is not listed is read all the same"
            );
            Issue::new(IssueCode::Unlisted, Severity::Note, message)
        })
    }
}

/// What is seen of one topic.
pub(super) struct Topic {
    name: String,
    encoding: String,
    schema_name: String,
    pub(super) message_type: Result<MessageType, String>,
    plan: Plan,
    decoder: Option<Box<dyn Decode>>,
    fields: Vec<Field>,
    messages: u64,
    malformed: u64,
    first_problem: Option<String>,
    /// Messages and malformed ones when the chunk began that was the last to hold a message of it.
    mark: (u64, u64),
    pub(super) marked_chunk: u64,
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

impl Topic {
    /// A topic of which no message was seen.
    pub(super) fn new(
        info: &ChannelInfo,
        encoding: String,
        message_type: Result<MessageType, String>,
    ) -> Self {
        Self {
            name: info.topic.to_owned(),
            encoding,
            schema_name: info.schema.map_or_else(String::new, |schema| schema.name.clone()),
            message_type,
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
        }
    }

    /// The earliest sample, ns since 1970.
    pub(super) fn first_ns(&self) -> Option<i64> {
        self.fields.iter().filter_map(|field| field.running.first_ns()).min()
    }

    /// Takes back what came since [`Self::set_mark`].
    pub(super) fn roll_back(&mut self) {
        (self.messages, self.malformed) = self.mark;
        if self.messages == 0 {
            (self.is_own_clock, self.held) = (None, None);
        }
        for field in &mut self.fields {
            field.running = field.mark.0;
            field.segments.truncate(field.mark.1);
        }
    }

    /// Memory that grows with the file.
    pub(super) fn held_bytes(&self) -> u64 {
        let message = self.held.as_ref().map_or(0, |(_, data)| data.len());
        (message + self.fields.len() * size_of::<Field>()) as u64 + self.blocks * size_of::<Segment>() as u64
    }

    pub(super) fn set_mark(&mut self, chunk: u64) {
        self.marked_chunk = chunk;
        self.mark = (self.messages, self.malformed);
        for field in &mut self.fields {
            field.mark = (field.running, field.segments.len());
        }
    }

    pub(super) fn prepare(&mut self, leaves: Vec<Leaf>, room: &mut Room) {
        let name_bytes = self.name.len() + self.encoding.len();
        let mut signals: Vec<(Leaf, FieldPath)> = Vec::new();
        for leaf in leaves.into_iter().filter(|leaf| !leaf.is_about_others()) {
            let Some(path) = FieldPath::parse(&leaf.path) else { continue };
            // The topic stands for its first field.
            let is_first = signals.is_empty();
            if is_first || (signals.len() < MOST_LEAVES && room.takes(name_bytes + leaf.path.len())) {
                signals.push((leaf, path));
            } else {
                room.fields_out += 1;
            }
        }
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

    pub(super) fn message(
        &mut self,
        log_time_ns: i64,
        data: &[u8],
        (slots, room): (&mut Slots, &mut Room),
        longest_json_bytes: u64,
    ) {
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
                self.prepare(leaves, room);
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
    pub(super) fn release(&mut self, slots: &mut Slots) {
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

    pub(super) fn issue(&self) -> Option<Issue> {
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

    pub(super) fn listed(&self, zero_ns: Option<i64>) -> Vec<ListedChannel> {
        if self.fields.is_empty() {
            let unreadable = match &self.message_type {
                Err(reason) => Some(reason.clone()),
                Ok(_) if self.messages == 0 => None,
                Ok(_) => Some("its messages hold no numbers".to_owned()),
            };
            return vec![ListedChannel {
                messages: Some(self.messages),
                encoding: self.encoding.clone(),
                unreadable,
                ..ListedChannel::named(&self.name, "topic")
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
