//! Writes a document as a page: one file without network, for the desk and for A4 paper. Every word is
//! escaped here.

use super::document::{
    CellKind, ChapterPart, Fact, Frame, Medium, PartContent, ReportColumn, ReportDocument, ReportTable,
    SentenceRole, TableCell, Tone, Words,
};
use super::pictures::draw::Picture;
use super::text::{Style, capital, sanitize};
use crate::data::Photo;
use base64::prelude::{BASE64_STANDARD as STANDARD, Engine};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest, Sha256};

const STYLE: &str = include_str!("report.css");
/// uPlot 1.6.32 (MIT) with its style, and the script that turns figures into its plots.
const UPLOT_STYLE: &str = include_str!("live/uplot-1.6.32.min.css");
const SCRIPTS: [&str; 2] = [include_str!("live/uplot-1.6.32.min.js"), include_str!("live/live.js")];

/// The page with these pictures.
pub(crate) fn page(document: &ReportDocument, pictures: &[Picture]) -> String {
    let Frame { title, product, heading, about, footer, foot, letterhead, style, data, .. } = &document.page;
    let scripts = scripts(document, pictures);
    let generator = concat!("dropcheck ", env!("CARGO_PKG_VERSION"));
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                // The policy keeps a script that a file smuggled in from running or connecting.
                meta http-equiv="Content-Security-Policy" content=(policy(&scripts));
                meta name="generator" content=(generator);
                title { (sanitize(title)) }
                style { (PreEscaped(STYLE)) (PreEscaped(style)) (PreEscaped(foot_style("left", foot)))
                    @if is_live(pictures) {
                    (PreEscaped(UPLOT_STYLE)) } @if let Some(words) = &letterhead.footer {
                    (PreEscaped(foot_style("center", words))) } }
            }
            body { main {
                header {
                    @if let Some(logo) = &letterhead.logo { (image(logo, "logo")) }
                    @if let Some(words) = &letterhead.header { p { (sanitize(words)) } }
                    div class="product" { (product) " · " (generator) }
                    h1 { (sanitize(heading)) }
                    p class="soft" { (sanitize(about)) }
                }
                @for (i, chapter) in document.chapters.iter().enumerate() {
                    @if let Some(words) = chapter.heading(Medium::Page).map(sanitize) {
                        h2 id=(anchor(&words)) { (words) }
                    }
                    @for passage in chapter.parts_on(Medium::Page) { (self::passage(passage, pictures)) }
                    @if i == 0 { (contents(document)) }
                }
                footer {
                    (footer)
                    @if let Some(words) = &letterhead.footer { p { (sanitize(words)) } }
                }
                @if !data.is_empty() { script type="application/json" id="data" { (PreEscaped(data)) } }
                @for script in &scripts { script { (PreEscaped(script)) } }
            } }
        }
    }
    .into_string()
}

/// List of the chapters, and of the files beside the page; empty on a page without such files.
fn contents(document: &ReportDocument) -> Markup {
    let headings = document.chapters.iter().filter_map(|chapter| chapter.heading(Medium::Page));
    let chapters = headings.map(|words| (format!("#{}", anchor(words)), sanitize(words)));
    let files = document.page.files.iter().map(|name| ((*name).to_owned(), (*name).to_owned()));
    let links =
        |links: Vec<(String, String)>| html! { @for (to, words) in links { a href=(to) { (words) } " " } };
    html! { @if !document.page.files.is_empty() {
        nav aria-label="Contents" {
            p { strong { "Contents " } (links(chapters.collect())) }
            p { strong { "Files beside this page " } (links(files.collect())) }
        }
    } }
}

/// Turns a heading into the name of its anchor.
fn anchor(words: &str) -> String {
    let parts = words.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("-").to_lowercase()
}

/// Words at a place below each printed page; characters that could end the words are written as numbers.
fn foot_style(place: &str, words: &str) -> String {
    let plain =
        |c: char| if c.is_alphanumeric() || c == ' ' { c.into() } else { format!("\\{:x} ", u32::from(c)) };
    let words: String = sanitize(words).chars().map(plain).collect();
    format!("@page {{ @bottom-{place} {{ content: \"{words}\" }} }}")
}

fn passage(passage: &ChapterPart, pictures: &[Picture]) -> Markup {
    match &passage.content {
        PartContent::Sentence(role, words) => sentence(*role, words),
        PartContent::Banner(Tone(style, word), sentence) => html! {
            div class=(format!("banner {}",
                banner_class(*style))) role="status" { strong { (word) } span { (prose(sentence)) } }
        },
        PartContent::Figures(figures) => html! {
            dl class="figures" { @for [name, value, detail] in figures {
                div { dt { (name) } dd { (value) @if !detail.is_empty() { small { (sanitize(detail)) } } } }
            } }
        },
        PartContent::Facts(caption, facts) => self::facts(caption, facts),
        PartContent::ReportTable(table) => self::table(table),
        PartContent::Picture(name, room) => html! {
            @for picture in pictures.iter().filter(|picture| picture.name == *name) {
                figure id=(name) aria-label=(sanitize(&picture.alt)) class=[class(room)] {
                    (PreEscaped(&picture.svg))
                    @if !picture.live.is_empty() {
                        script type="application/json" { (PreEscaped(&picture.live)) }
                    }
                    figcaption { strong { (sanitize(&picture.title)) ". " } (sanitize(&picture.caption)) }
                }
            }
        },
        PartContent::Photographs(photos) => html! {
            @for photo in photos {
                figure class="photo" { (image(photo, "")) figcaption { (sanitize(&photo.name)) } }
            }
        },
        PartContent::List(sentences) => {
            html! { ul class="limits" { @for sentence in sentences { li { (sentence) } } } }
        }
        PartContent::Beside(columns) => html! {
            div class="pair" { @for column in columns { div {
                @for passage in column.iter().filter(|p| p.is_shown(Medium::Page)) {
                (self::passage(passage, pictures))
            } } } }
        },
    }
}

/// Embeds a picture in the page; as an image, an SVG runs and fetches nothing.
fn image(Photo { name, media_type, bytes }: &Photo, class: &str) -> Markup {
    let data = format!("data:{media_type};base64,{}", STANDARD.encode(bytes));
    html! { @if !bytes.is_empty() { img class=[self::class(class)] alt=(sanitize(name)) src=(data); } }
}

/// True if a picture can be zoomed.
fn is_live(pictures: &[Picture]) -> bool {
    pictures.iter().any(|picture| !picture.live.is_empty())
}

/// Scripts of the page.
fn scripts(document: &ReportDocument, pictures: &[Picture]) -> Vec<&'static str> {
    let live = if is_live(pictures) { &SCRIPTS[..] } else { &[] };
    let own = Some(document.page.script).filter(|script| !script.is_empty());
    live.iter().copied().chain(own).collect()
}

/// Content security policy: nothing from other sites, and no script but these.
fn policy(scripts: &[&str]) -> String {
    let hash = |script: &&str| format!(" 'sha256-{}'", STANDARD.encode(Sha256::digest(script)));
    let hashes: String = scripts.iter().map(hash).collect();
    let own = if hashes.is_empty() { String::new() } else { format!("; script-src{hashes}") };
    format!("default-src 'none'; style-src 'unsafe-inline'; img-src data:{own}")
}

/// The colours of a banner.
fn banner_class(style: Style) -> &'static str {
    match style {
        Style::Green => "pass",
        Style::Red => "fail",
        _ => "review",
    }
}

/// A class where there is one.
fn class(name: &str) -> Option<&str> {
    (!name.is_empty()).then_some(name)
}

fn sentence(role: SentenceRole, words: &Words) -> Markup {
    let name = match role {
        SentenceRole::Title | SentenceRole::Text => "",
        SentenceRole::Line => "soft",
        SentenceRole::Lead => "lead",
        SentenceRole::Note => "note",
    };
    html! { p class=[class(name)] { (prose(words.text_on(Medium::Page))) } }
}

/// Formats a sentence; text between backticks is a key or a word of the command line.
fn prose(words: &str) -> Markup {
    let words = sanitize(words);
    html! { @for (i, part) in words.split('`').enumerate() { @if i % 2 == 1 { code { (part) } } @else {
    (part) } } }
}

fn facts(caption: &str, facts: &[Fact]) -> Markup {
    let noted = facts.iter().any(|fact| !fact.note.1.is_empty());
    html! {
        table class="whole" {
            @if !caption.is_empty() { caption { (sanitize(caption)) } }
            tbody { @for fact in facts { tr {
                th scope="row" { (capital(&sanitize(&fact.name))) @if fact.is_default {
                    " " (default_mark("default")) } }
                (cell(fact.kind, &fact.value.as_str().into(), None))
                @if noted { td class="soft" { (sanitize(fact.shown_note())) } }
            } } }
        }
    }
}

fn default_mark(word: &str) -> Markup {
    html! { span class="default" { (word) } }
}

fn table(table: &ReportTable) -> Markup {
    let columns = table.columns_on(Medium::Page);
    let (rows, left_out) = table.rows(Medium::Page);
    let number = |column: &ReportColumn| (column.kind == CellKind::Number).then_some("n");
    // A row with more cells than a phone is wide becomes a list there, each cell after its head.
    let is_stacked = columns.len() > 3 && matches!(table.class, "" | "whole");
    let classes = if is_stacked { format!("{} stack", table.class) } else { table.class.to_owned() };
    html! {
        table class=[class(classes.trim())] {
            @if !table.caption.is_empty() { caption { (sanitize(&table.caption)) } }
            thead { tr { @for column in &columns {
                th scope="col" class=[number(column)] { (sanitize(column.head.text_on(Medium::Page))) }
            } } }
            tbody { @for (row, is_chosen) in table.chosen.iter().enumerate().take(rows) {
                tr class=[is_chosen.then_some("chosen")] { @for column in &columns {
                    (cell(column.kind, &column.cells[row],
                        is_stacked.then(|| sanitize(column.head.text_on(Medium::Page))).as_deref())) } }
            } }
        }
        @if let Some(sentence) = left_out { p class="note" { (sentence) } }
    }
}

/// Machine-readable text, which may continue on the next line after a punctuation mark, or after a number of
/// letters without one.
fn code(words: &str) -> Markup {
    const LONGEST: usize = 16;
    let letters: Vec<char> = words.chars().collect();
    let parts = letters.split_inclusive(|c| "._/".contains(*c)).flat_map(|part| part.chunks(LONGEST));
    html! { code { @for part in parts { (part.iter().collect::<String>()) wbr; } } }
}

/// Writes a cell; below `head` if its row is stacked.
fn cell(kind: CellKind, cell: &TableCell, head: Option<&str>) -> Markup {
    let text = sanitize(cell.words.text_on(Medium::Page));
    let shown = html! { @if cell.link.is_empty() { (prose(&text)) } @else { a href=(cell.link) { (text) } } };
    let words = html! { (shown) @if !cell.mark.is_empty() { @if !text.is_empty() {
    " " } (default_mark(cell.mark)) } };
    match kind {
        CellKind::Head => html! { th scope="row" { (words) } },
        CellKind::Text => html! { td data-head=[head] { (words) } },
        CellKind::Number => html! { td class="n" data-head=[head] { (words) } },
        CellKind::Soft => html! { td class="u" data-head=[head] { (words) } },
        CellKind::Code => html! { td data-head=[head] { (code(&text)) } },
        CellKind::Tag => html! { td class=(format!("tag {text}")) data-head=[head] { (words) } },
    }
}
