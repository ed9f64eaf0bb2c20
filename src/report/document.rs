//! What a person is to read to a document of chapters: tables, facts and sentences, each once for every
//! medium.

use super::rounding::MISSING;
pub(crate) use super::table::{
    CellKind, Medium, ReportColumn, ReportTable, TableCell, TableRows, TableShape, Words,
};
use super::text::Style;
use crate::data::{Letterhead, Photo};

/// What is read from its first line to its last.
#[derive(Default)]
pub(crate) struct ReportDocument {
    /// What a page says besides its chapters.
    pub(crate) page: Frame,
    /// In the order of reading.
    pub(crate) chapters: Vec<Chapter>,
}

/// What stands around the chapters of a page.
#[derive(Default)]
pub(crate) struct Frame {
    /// Words of the browser's tab.
    pub(crate) title: String,
    /// What kind of report it is.
    pub(crate) product: &'static str,
    /// The heading of the whole.
    pub(crate) heading: String,
    /// What it is made from.
    pub(crate) about: String,
    /// Sentences at the foot.
    pub(crate) footer: &'static str,
    /// What a site puts around it.
    pub(crate) letterhead: Letterhead,
    /// What stands at the foot of each printed page beside its number.
    pub(crate) foot: String,
    /// The files beside a page that has a list of its chapters and of them; none on one that has no list.
    pub(crate) files: &'static [&'static str],
    /// Style besides that of all pages.
    pub(crate) style: &'static str,
    /// What runs in the page, and the JSON that it reads; nothing where they are empty.
    pub(crate) script: &'static str,
    pub(crate) data: String,
}

/// What stands below a heading; none where its words are empty.
pub(crate) struct Chapter {
    heading: Words,
    /// Where alone it is shown.
    only: Option<Medium>,
    passages: Vec<ChapterPart>,
}

impl Chapter {
    /// Nothing yet below this heading.
    pub(crate) fn new(heading: impl Into<Words>) -> Self {
        Self { heading: heading.into(), only: None, passages: Vec::new() }
    }

    /// On this medium alone.
    pub(crate) fn only(self, medium: Medium) -> Self {
        Self { only: Some(medium), ..self }
    }

    /// And then this.
    pub(crate) fn with(mut self, passage: impl Into<ChapterPart>) -> Self {
        self.passages.push(passage.into());
        self
    }

    /// And then these, if any.
    pub(crate) fn with_all(mut self, passages: impl IntoIterator<Item = ChapterPart>) -> Self {
        self.passages.extend(passages);
        self
    }

    /// The heading, unless nothing would stand below it.
    pub(crate) fn heading(&self, medium: Medium) -> Option<&str> {
        let words = self.heading.on(medium);
        (!words.is_empty() && !self.shown(medium).is_empty()).then_some(words)
    }

    /// What of it this medium shows; nothing where it shows none of it.
    pub(crate) fn shown(&self, medium: Medium) -> Vec<&ChapterPart> {
        let all = if self.only.is_none_or(|only| only == medium) { &self.passages[..] } else { &[] };
        all.iter().filter(|passage| passage.is_shown(medium)).collect()
    }
}

/// One thing below a heading.
pub(crate) struct ChapterPart {
    /// Where alone it is shown.
    pub(crate) only: Option<Medium>,
    pub(crate) content: PartContent,
}

/// What a passage may be.
pub(crate) enum PartContent {
    /// Words in the given role.
    Sentence(SentenceRole, Words),
    /// A word in its colour, and what it means.
    Banner(Tone, String),
    /// The numbers that a reader looks for first: name, value, what to know of it.
    Figures(Vec<[String; 3]>),
    /// A caption, and names with what they stand for.
    Facts(String, Vec<Fact>),
    ReportTable(ReportTable),
    /// The picture of this name; its room on paper as a class of the style.
    Picture(String, &'static str),
    /// Photographs of the test.
    Photographs(Vec<Photo>),
    /// Sentences one below the other.
    List(Vec<String>),
    /// Two columns where there is room.
    Beside([Vec<ChapterPart>; 2]),
}

/// What a sentence is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum SentenceRole {
    /// It names the whole.
    Title,
    /// It stands with the title.
    Line,
    /// It leads to what follows.
    Lead,
    Text,
    /// It explains what stands above it.
    Note,
}

/// A word in a colour.
pub(crate) struct Tone(pub(crate) Style, pub(crate) String);

impl ChapterPart {
    fn sentence(role: SentenceRole, words: impl Into<Words>) -> Self {
        PartContent::Sentence(role, words.into()).into()
    }

    /// What names the whole.
    pub(crate) fn title(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Title, words)
    }

    /// What stands with the title.
    pub(crate) fn line(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Line, words)
    }

    /// What leads to the passages after it.
    pub(crate) fn lead(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Lead, words)
    }

    /// Plain words.
    pub(crate) fn text(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Text, words)
    }

    /// What explains the passage before it.
    pub(crate) fn note(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Note, words)
    }

    /// Names with what they stand for.
    pub(crate) fn facts(caption: impl Into<String>, facts: Vec<Fact>) -> Self {
        PartContent::Facts(caption.into(), facts).into()
    }

    /// The picture of this name.
    pub(crate) fn picture(name: &str, room: &'static str) -> Self {
        PartContent::Picture(name.to_owned(), room).into()
    }

    /// On this medium alone.
    pub(crate) fn only(self, medium: Medium) -> Self {
        Self { only: Some(medium), ..self }
    }

    /// Whether this medium shows it: no table without rows.
    pub(crate) fn is_shown(&self, medium: Medium) -> bool {
        let is_drawn = matches!(
            self.content,
            PartContent::Figures(_)
                | PartContent::Picture(..)
                | PartContent::Photographs(_)
                | PartContent::List(_)
        );
        let is_empty = match &self.content {
            PartContent::ReportTable(table) => table.rows(medium).0 == 0,
            PartContent::Photographs(all) => all.is_empty(),
            _ => false,
        };
        let is_meant = self.only.is_none_or(|only| only == medium);
        is_meant && !is_empty && !(is_drawn && medium == Medium::Terminal)
    }
}

impl From<PartContent> for ChapterPart {
    fn from(content: PartContent) -> Self {
        Self { only: None, content }
    }
}

impl<R> From<TableRows<'_, R>> for ChapterPart {
    fn from(rows: TableRows<'_, R>) -> Self {
        ReportTable::from(rows).into()
    }
}

impl From<ReportTable> for ChapterPart {
    fn from(table: ReportTable) -> Self {
        PartContent::ReportTable(table).into()
    }
}

/// A name and what it stands for.
pub(crate) struct Fact {
    pub(crate) name: String,
    /// Whether nobody stated it.
    pub(crate) is_default: bool,
    pub(crate) kind: CellKind,
    pub(crate) value: String,
    /// Its unit, or a few words on it.
    pub(crate) note: Tone,
}

impl Fact {
    /// A number.
    pub(crate) fn number(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            is_default: false,
            kind: CellKind::Number,
            value: value.into(),
            note: Tone(Style::Dim, String::new()),
        }
    }

    /// Words.
    pub(crate) fn words(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { kind: CellKind::Text, ..Self::number(name, value) }
    }

    /// Words as a machine writes them.
    pub(crate) fn code(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { kind: CellKind::Code, ..Self::number(name, value) }
    }

    /// With its unit, or a few words on it.
    pub(crate) fn note(self, note: impl Into<String>) -> Self {
        self.toned(Style::Dim, note)
    }

    /// The words on its value, where it has one.
    pub(crate) fn shown_note(&self) -> &str {
        if self.value == MISSING { "" } else { &self.note.1 }
    }

    /// With words in a colour.
    pub(crate) fn toned(self, style: Style, note: impl Into<String>) -> Self {
        Self { note: Tone(style, note.into()), ..self }
    }
}
