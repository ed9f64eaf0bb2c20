//! What is wrong with a file, a channel or a dataset, and how to mend it: the one form of it in all readers.

/// What is wrong, and how to mend it; the reader adds which file and channel.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}{problem}")]
pub struct Refusal {
    /// What it is about with what parts it from the problem, "/a " or "/a: "; empty where that is said
    /// elsewhere.
    place: String,
    /// What is wrong, with its numbers.
    pub problem: String,
    /// What to write or do.
    pub remedy: String,
}

impl Refusal {
    pub(crate) fn new(problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: String::new(), problem: problem.into(), remedy: remedy.into() }
    }

    /// What `name` is or has: "/a" and "is empty".
    pub(super) fn of(name: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: format!("{name} "), ..Self::new(problem, remedy) }
    }

    /// The same, said of `name`, unless it says itself what it is about.
    pub(super) fn at(self, name: &str) -> Self {
        if self.place.is_empty() { Self { place: format!("{name}: "), ..self } } else { self }
    }

    /// The problem and its remedy for a list, where it stands beside `name`: that is not said again.
    pub(super) fn beside(&self, name: &str) -> String {
        let place = if self.place.trim_end_matches([':', ' ']) == name { "" } else { &self.place };
        format!("{place}{}: {}", self.problem, self.remedy)
    }
}
