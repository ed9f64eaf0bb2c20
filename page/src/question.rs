//! What the page asks, and what the program says to it.

use crate::cask_text;
use dropcheck::data::{Analysis, CaskFile, Listing, Program, Recording};
use dropcheck::ingest::{self, IngestError, Limits, RecordingFile};
use dropcheck::{report, stages};
use miette::{IntoDiagnostic, Report, miette};
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

/// What the cask file is called that was not opened from a disk.
const CASK_NAME: &str = "cask.toml";

/// What reading may take of the 4 GiB that a page can have; the recording and the analysis need as much.
const MEMORY_BYTES: u64 = 2 << 30;

/// What is asked, and of what.
#[derive(Deserialize)]
struct Header {
    op: String,
    /// What the recording is called.
    #[serde(default)]
    name: String,
    /// The text of the cask file.
    #[serde(default)]
    cask: String,
    /// What it is called.
    cask_name: Option<String>,
    /// When it is asked, as RFC 3339 writes it: the module has no clock.
    analysed: Option<String>,
    /// A key: `cask.length_m`, `channel.0.position_m`.
    #[serde(default)]
    path: String,
    /// What the key is to be, as TOML; none takes it out.
    value: Option<String>,
}

/// A question, with the bytes of the recording.
pub struct Question {
    header: Header,
    recording: Arc<[u8]>,
}

/// What is answered.
pub struct Answer {
    /// Whether it is one, with what the page reads itself.
    pub header: Value,
    /// What the page shows or saves.
    pub bodies: Vec<Vec<u8>>,
}

impl From<Vec<u8>> for Answer {
    fn from(body: Vec<u8>) -> Self {
        Self { header: json!({ "ok": true }), bodies: vec![body] }
    }
}

impl Question {
    /// The question in a block.
    ///
    /// # Errors
    /// The block is none.
    pub fn of(block: &[u8]) -> Result<Self, Report> {
        let cut = || miette!("the question is cut off");
        let (length, rest) = block.split_first_chunk().ok_or_else(cut)?;
        let length = usize::try_from(u32::from_le_bytes(*length)).into_diagnostic()?;
        let (header, recording) = rest.split_at_checked(length).ok_or_else(cut)?;
        Ok(Self { header: serde_json::from_slice(header).into_diagnostic()?, recording: recording.into() })
    }

    /// What the program says to it.
    ///
    /// # Errors
    /// As the command.
    pub fn answered(self) -> Result<Answer, Report> {
        let Header { op, cask, path, value, .. } = &self.header;
        let body = match op.as_str() {
            "inspect" => report::pretty_json(&self.listing()?)?,
            "look" => self.look()?,
            "init" => report::cask_file_template(&self.listing()?)?.into_bytes(),
            "keys" => cask_text::keys().to_string().into_bytes(),
            "values" => cask_text::values(cask)?.to_string().into_bytes(),
            "edit" => cask_text::edited(cask, path, value.as_deref())?.into_bytes(),
            "check" => self.cask_file().map(|_| Vec::new())?,
            "read" => self.read(&self.cask_file()?).map(|_| Vec::new())?,
            "setup" => report::setup_picture(&self.cask_file()?).into_bytes(),
            "predict" => {
                let file = self.cask_file()?;
                report::study_json(&dropcheck::study(&file, &dropcheck::predict::usual_request(&file)))?
            }
            "analyze" => report::pretty_json(&self.analysis()?.result)?,
            "report" => return self.report(),
            other => return Err(miette!("there is no question {other:?}")),
        };
        Ok(body.into())
    }

    fn recording(&self) -> RecordingFile<'_> {
        RecordingFile::in_memory(Path::new(&self.header.name), &self.recording)
    }

    fn cask_name(&self) -> &str {
        self.header.cask_name.as_deref().unwrap_or(CASK_NAME)
    }

    fn cask_file(&self) -> Result<CaskFile, Report> {
        Ok(ingest::cask_file::of_text(Path::new(self.cask_name()), &self.header.cask)?)
    }

    fn listing(&self) -> Result<Listing, Report> {
        Ok(ingest::list_within(self.recording(), Limits::of_memory(MEMORY_BYTES), &|_| ())?)
    }

    /// The page with every source as a curve.
    fn look(&self) -> Result<Vec<u8>, Report> {
        let listing = self.listing()?;
        let drawn = report::drawn_sources(&listing);
        let mut page = report::FirstLook::new(&listing, &drawn);
        let add = |number, looked| page.add(number, looked);
        stages::look_at_each(self.recording(), &drawn, Limits::of_memory(MEMORY_BYTES), &|_| (), add);
        let mut files = page.files(&ingest::sha256(self.recording())?)?;
        Ok(files.swap_remove(0).1)
    }

    /// The recording by the cask file: what an analysis would ask for is refused here.
    fn read(&self, file: &CaskFile) -> Result<Recording, Report> {
        let other_files = [
            ("`rest` out of [recording]", "rest", file.rest.is_some()),
            ("[simulation] out", "calculation", file.simulation.is_some()),
        ];
        if let Some((key, what, _)) = other_files.into_iter().find(|(.., is_named)| *is_named) {
            return Err(miette!(
                help = format!("take {key} here, or analyse by the dropcheck command"),
                "{}: the {what} lies in a file of its own, which a page cannot open",
                self.cask_name()
            ));
        }
        Ok(stages::read_within(self.recording(), file, Limits::of_memory(MEMORY_BYTES), &|_| ())?)
    }

    fn analysis(&self) -> Result<Analysis, Report> {
        let file = self.cask_file()?;
        let recording = self.read(&file)?;
        let mut analysis = dropcheck::analyze(&recording, &file);
        analysis.result.program = Some(Program::current());
        analysis.result.analysed.clone_from(&self.header.analysed);
        Ok(analysis)
    }

    /// Every file of the report.
    fn report(&self) -> Result<Answer, Report> {
        let (names, bodies): (Vec<String>, _) = report::files(&self.analysis()?)?.into_iter().unzip();
        Ok(Answer { header: json!({ "ok": true, "names": names }), bodies })
    }
}

/// A refusal, with the place in the cask file that it speaks of.
pub fn refused(refusal: &Report) -> Answer {
    let wrong_line = match refusal.downcast_ref() {
        Some(IngestError::Line(line)) => Some(line),
        _ => None,
    };
    let error = json!({
        "text": report::message(refusal),
        "problem": refusal.to_string(),
        "mend": refusal.help().map(|help| help.to_string()),
        "line": wrong_line.map(|wrong| wrong.line),
        "key": wrong_line.and_then(|wrong| cask_text::key_at(wrong.text.inner(), wrong.line)),
    });
    Answer { header: json!({ "error": error }), bodies: Vec::new() }
}
