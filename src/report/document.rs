//! Document for a reader: chapters of tables, facts and sentences, each written once for every medium.

use super::rounding::MISSING;
pub(crate) use super::table::{
    CellKind, Medium, ReportColumn, ReportTable, TableCell, TableRows, TableShape, Words,
};
use super::text::Style;
use crate::data::{Letterhead, Photo};

/// A document in the order of reading.
#[derive(Default)]
pub(crate) struct ReportDocument {
    /// Parts of a page around the chapters.
    pub(crate) page: Frame,
    /// Chapters, in the order of reading.
    pub(crate) chapters: Vec<Chapter>,
}

/// Parts of a page around its chapters.
#[derive(Default)]
pub(crate) struct Frame {
    /// Title of the browser's tab.
    pub(crate) title: String,
    /// Kind of report.
    pub(crate) product: &'static str,
    /// Heading of the document.
    pub(crate) heading: String,
    /// Files that the report describes.
    pub(crate) about: String,
    /// Sentences at the foot.
    pub(crate) footer: &'static str,
    /// Letterhead of the site.
    pub(crate) letterhead: Letterhead,
    /// Text at the foot of each printed page beside its number.
    pub(crate) foot: String,
    /// Files beside a page that has a list of its chapters and of them; empty on a page without a list.
    pub(crate) files: &'static [&'static str],
    /// Style in addition to that of all pages.
    pub(crate) style: &'static str,
    /// Script of the page, and the JSON that it reads; both may be empty.
    pub(crate) script: &'static str,
    pub(crate) data: String,
}

/// Parts below a heading; the heading may be empty.
pub(crate) struct Chapter {
    heading: Words,
    /// The only medium that shows the chapter.
    only_on: Option<Medium>,
    passages: Vec<ChapterPart>,
}

impl Chapter {
    /// An empty chapter with this heading.
    pub(crate) fn new(heading: impl Into<Words>) -> Self {
        Self { heading: heading.into(), only_on: None, passages: Vec::new() }
    }

    /// Restricts the chapter to one medium.
    pub(crate) fn only_on(self, medium: Medium) -> Self {
        Self { only_on: Some(medium), ..self }
    }

    /// Appends a part.
    pub(crate) fn then(mut self, passage: impl Into<ChapterPart>) -> Self {
        self.passages.push(passage.into());
        self
    }

    /// Appends these parts, if any.
    pub(crate) fn with_all(mut self, passages: impl IntoIterator<Item = ChapterPart>) -> Self {
        self.passages.extend(passages);
        self
    }

    /// The heading, unless nothing would follow it.
    pub(crate) fn heading(&self, medium: Medium) -> Option<&str> {
        let words = self.heading.text_on(medium);
        (!words.is_empty() && !self.parts_on(medium).is_empty()).then_some(words)
    }

    /// Parts that this medium shows; none if it does not show the chapter.
    pub(crate) fn parts_on(&self, medium: Medium) -> Vec<&ChapterPart> {
        let all = if self.only_on.is_none_or(|only| only == medium) { &self.passages[..] } else { &[] };
        all.iter().filter(|passage| passage.is_shown(medium)).collect()
    }
}

/// One part below a heading.
pub(crate) struct ChapterPart {
    /// The only medium that shows the part.
    pub(crate) only: Option<Medium>,
    pub(crate) content: PartContent,
}

/// Kinds of parts.
pub(crate) enum PartContent {
    /// Words in the given role.
    Sentence(SentenceRole, Words),
    /// A word in its colour, and its meaning.
    Banner(Tone, String),
    /// The headline numbers: name, value, remark.
    Figures(Vec<[String; 3]>),
    /// A caption, and names with their values.
    Facts(String, Vec<Fact>),
    ReportTable(ReportTable),
    /// The picture with this name; its room on paper as a class of the style.
    Picture(String, &'static str),
    /// Photographs of the test.
    Photographs(Vec<Photo>),
    /// Sentences as a list.
    List(Vec<String>),
    /// Two columns where there is room.
    Beside([Vec<ChapterPart>; 2]),
}

/// Purpose of a sentence.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum SentenceRole {
    /// Title of the document.
    Title,
    /// Line below the title.
    Line,
    /// Introduction to the following parts.
    Lead,
    Text,
    /// Explanation of the part above.
    Note,
}

/// A word in a colour.
pub(crate) struct Tone(pub(crate) Style, pub(crate) String);

impl ChapterPart {
    fn sentence(role: SentenceRole, words: impl Into<Words>) -> Self {
        PartContent::Sentence(role, words.into()).into()
    }

    /// Makes the title of the document.
    pub(crate) fn title(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Title, words)
    }

    /// Makes a line below the title.
    pub(crate) fn line(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Line, words)
    }

    /// Makes an introduction to the parts after it.
    pub(crate) fn lead(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Lead, words)
    }

    /// Plain words.
    pub(crate) fn text(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Text, words)
    }

    /// Makes an explanation of the part before it.
    pub(crate) fn note(words: impl Into<Words>) -> Self {
        Self::sentence(SentenceRole::Note, words)
    }

    /// Makes a list of names with their values.
    pub(crate) fn facts(caption: impl Into<String>, facts: Vec<Fact>) -> Self {
        PartContent::Facts(caption.into(), facts).into()
    }

    /// The picture of this name.
    pub(crate) fn picture(name: &str, room: &'static str) -> Self {
        PartContent::Picture(name.to_owned(), room).into()
    }

    /// Restricts the part to one medium.
    pub(crate) fn only_on(self, medium: Medium) -> Self {
        Self { only: Some(medium), ..self }
    }

    /// True if this medium shows the part: a table needs rows.
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

/// A name with its value.
pub(crate) struct Fact {
    pub(crate) name: String,
    /// True if nobody stated the value.
    pub(crate) is_default: bool,
    pub(crate) kind: CellKind,
    pub(crate) value: String,
    /// Unit of the value, or a short remark.
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

    /// Adds the unit, or a short remark.
    pub(crate) fn note(self, note: impl Into<String>) -> Self {
        self.tone(Style::Dim, note)
    }

    /// The words on its value, where it has one.
    pub(crate) fn shown_note(&self) -> &str {
        if self.value == MISSING { "" } else { &self.note.1 }
    }

    /// Adds a remark in a colour.
    pub(crate) fn tone(self, style: Style, note: impl Into<String>) -> Self {
        Self { note: Tone(style, note.into()), ..self }
    }
}
