//! Why a recording or a cask file could not be read: which file, where in it, what is wrong, how to mend it.

use super::refusal::Refusal;
use super::shown::os_text;
use crate::data::shorten;
use std::path::Path;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum IngestError {
    /// A line of the cask file is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Line(#[from] Box<super::cask_file::fault::WrongLine>),
    /// The operating system refuses it, a part of it would take more memory than reading may, it is no
    /// recording that is read, lacks what a channel names, or contradicts its format.
    #[error("{path}: {refusal}")]
    #[diagnostic(help("{}", .refusal.remedy))]
    Refused {
        /// The file.
        path: String,
        /// Where in it, what is wrong there, and what to do.
        refusal: Refusal,
    },
}

impl IngestError {
    /// The same, of the file `name` where it is of `file`, which stood for it.
    pub(super) fn in_file(mut self, file: &Path, name: &Path) -> Self {
        match &mut self {
            Self::Refused { path, .. } if *path == file.display().to_string() => {
                *path = name.display().to_string();
            }
            Self::Line(_) | Self::Refused { .. } => {}
        }
        self
    }
}

/// The operating system's refusal, with the file's name.
pub(super) fn io(path: &Path, refusal: &std::io::Error) -> IngestError {
    of_file(path, Refusal::new(os_text(refusal), "check the name, and that you may read it"))
}

/// A refusal of the file itself.
pub(crate) fn of_file(path: &Path, refusal: Refusal) -> IngestError {
    IngestError::Refused { path: path.display().to_string(), refusal }
}

/// A directory stands where a recording should.
pub(super) fn directory(path: &Path) -> IngestError {
    let remedy = "name one recording file; a folder is a recording where it holds an .mme file (ISO-MME); \
                  `dropcheck batch` takes several recordings";
    of_file(path, Refusal::new("this is a directory, not a recording", remedy))
}

/// A refusal of a channel of the cask file.
pub(crate) fn of_channel(path: &Path, channel: &str, refusal: Refusal) -> IngestError {
    of_file(path, Refusal::new(format!("channel {channel:?}: {refusal}"), refusal.remedy))
}

/// How alike two words are, 0 to 1, whatever their case.
pub(super) fn alike(one: &str, other: &str) -> f64 {
    /// Comparing takes the square of it, and no one slips in what is longer.
    const LONGEST: usize = 256;
    let [one, other] = [one, other].map(|word| word[..word.floor_char_boundary(LONGEST)].to_lowercase());
    strsim::jaro_winkler(&one, &other)
}

/// The first words of several.
pub(super) fn handful(words: &[impl AsRef<str>]) -> String {
    /// More no longer fit a terminal's few lines.
    const MOST: usize = 8;
    let first: Vec<&str> = words.iter().take(MOST).map(AsRef::as_ref).collect();
    first.join(", ") + if words.len() > MOST { ", …" } else { "" }
}

/// "did you mean …" with the names in `there` that are nearest to `wanted`, or what there is, cut to a
/// handful.
pub(super) fn near_names(path: &Path, wanted: &str, what: &str, there: &[String]) -> String {
    /// More than this many names no longer fit a terminal's few lines.
    const HANDFUL: usize = 6;
    /// Below this similarity (0 to 1) a name is no misspelling but another word; `strsim`'s own examples of
    /// typing slips lie above 0.8.
    const ALIKE: f64 = 0.75;
    if there.is_empty() {
        return format!("the recording holds no {what}");
    }
    let mut ranked: Vec<(f64, &String)> = there.iter().map(|name| (alike(wanted, name), name)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let named = |name: &String| shorten(name).into_owned();
    let near: Vec<String> =
        ranked.iter().filter(|(score, _)| *score >= ALIKE).take(3).map(|(_, name)| named(name)).collect();
    let hint = if near.is_empty() { String::new() } else { format!("did you mean {}? ", near.join(" or ")) };
    let listed: Vec<String> = there.iter().take(HANDFUL).map(named).collect();
    let more = match there.len().saturating_sub(HANDFUL) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let listed = listed.join(", ");
    format!("{hint}there is: {listed}{more}; `dropcheck inspect {}` lists all", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_one_letter_is_named_first_and_the_list_is_cut() {
        let there: Vec<String> = (0..9).map(|i| format!("/daq/a{i}")).collect();
        let text = near_names(Path::new("r.mcap"), "/dag/a3", "topic", &there);
        assert!(text.starts_with("did you mean /daq/a3"), "{text}");
        assert!(text.contains("and 3 more"), "{text}");
        assert!(text.contains("dropcheck inspect r.mcap"), "{text}");
    }

    #[test]
    fn a_refusal_carries_no_error_number() {
        let refusal = std::fs::File::open("none/at all").unwrap_err();
        assert!(refusal.to_string().contains("os error"), "{refusal}");
        assert!(!os_text(&refusal).is_empty() && !os_text(&refusal).contains("os error"));
    }

    #[test]
    fn nothing_alike_is_not_suggested() {
        let text = near_names(Path::new("r"), "zzz", "column", &["time".into()]);
        assert!(!text.contains("did you mean"), "{text}");
    }
}
