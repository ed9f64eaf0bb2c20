//! A channel's `source` to a topic and a field path.

use crate::data::Source;
use std::fmt;

/// One step into a message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Step {
    /// A field.
    Name(String),
    /// An element of an array, from 0.
    Index(usize),
}

/// The way to a field, from the message.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct FieldPath(pub(super) Vec<Step>);

impl FieldPath {
    /// From `a.b[2].c`; `None` where it is empty or a bracket holds no number.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let mut steps = Vec::new();
        for part in text.split('.') {
            let (name, brackets) = part.split_at(part.find('[').unwrap_or(part.len()));
            if !name.is_empty() {
                steps.push(Step::Name(name.to_owned()));
            } else if brackets.is_empty() {
                return None;
            }
            let mut rest = brackets;
            while let Some(inner) = rest.strip_prefix('[') {
                let (digits, after) = inner.split_once(']')?;
                steps.push(Step::Index(digits.trim().parse().ok()?));
                rest = after;
            }
            if !rest.is_empty() {
                return None;
            }
        }
        Some(Self(steps))
    }

    /// This path and `name` after it.
    pub(super) fn then(&self, name: &str) -> Self {
        let mut steps = self.0.clone();
        steps.push(Step::Name(name.to_owned()));
        Self(steps)
    }

    /// The name of the field.
    pub(super) fn last_name<'a>(&'a self) -> Option<&'a str> {
        let name = |step: &'a Step| if let Step::Name(name) = step { Some(name.as_str()) } else { None };
        self.0.iter().rev().find_map(name)
    }

    /// The messages that enclose the field, the nearest first.
    pub(super) fn enclosing(&self) -> impl Iterator<Item = Self> + '_ {
        let ends = (0..self.0.len()).rev().filter(|&end| matches!(self.0[end], Step::Name(_)));
        ends.map(|end| Self(self.0[..end].to_vec()))
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (position, step) in self.0.iter().enumerate() {
            match step {
                Step::Name(name) if position == 0 => f.write_str(name)?,
                Step::Name(name) => write!(f, ".{name}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// The field that `source` means if it means `topic`, with or without the leading slash; `None` where it
/// means another.
pub(super) fn field_in(source: &Source, topic: &str) -> Option<FieldPath> {
    match source {
        Source::TopicField { topic: wanted, field, .. } => {
            (bare(wanted) == bare(topic)).then(|| FieldPath::parse(field)).flatten()
        }
        Source::Path(path) => {
            let rest = bare(path).strip_prefix(bare(topic))?;
            if rest.starts_with('[') {
                return FieldPath::parse(rest);
            }
            FieldPath::parse(rest.strip_prefix('.')?)
        }
    }
}

fn bare(topic: &str) -> &str {
    topic.strip_prefix('/').unwrap_or(topic)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(name: &str) -> Step {
        Step::Name(name.into())
    }

    #[test]
    fn paths_read_and_print_the_same() {
        for text in ["samples", "linear_acceleration.z", "data[2]", "a.b[0][3].c", "[4]"] {
            assert_eq!(FieldPath::parse(text).unwrap().to_string(), text);
        }
        for text in ["", "a..b", "a.", "a[x]", "a[1", "a[1]b"] {
            assert_eq!(FieldPath::parse(text), None, "{text}");
        }
    }

    #[test]
    fn a_topic_with_dots_leaves_its_own_field() {
        let source = Source::Path("/a.b.c".into());
        assert_eq!(field_in(&source, "/a").unwrap().0, [name("b"), name("c")]);
        assert_eq!(field_in(&source, "/a.b").unwrap().0, [name("c")]);
        assert_eq!(field_in(&source, "/a.b.c"), None);
        assert_eq!(field_in(&source, "/b"), None);
        let apart = Source::TopicField { topic: "/a.b".into(), field: "c".into(), channel: None };
        assert_eq!(field_in(&apart, "/a"), None);
        assert_eq!(field_in(&apart, "/a.b").unwrap().0, [name("c")]);
    }

    #[test]
    fn enclosing_messages_come_nearest_first_and_arrays_are_none() {
        let path = FieldPath::parse("a.b.c[1]").unwrap();
        let enclosing: Vec<String> = path.enclosing().map(|p| p.to_string()).collect();
        assert_eq!(enclosing, ["a.b", "a", ""]);
    }
}
