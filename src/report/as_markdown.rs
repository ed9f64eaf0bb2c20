//! Writes a document as Markdown, with its pictures in files beside it.

use super::document::{CellKind, ChapterPart, Medium, PartContent, ReportDocument, ReportTable, TableCell};
use super::text::sanitize;

/// The Markdown.
pub(crate) fn markdown(document: &ReportDocument) -> String {
    let mut blocks = Vec::new();
    for chapter in &document.chapters {
        let heading = chapter.heading(Medium::Markdown).map(cell_text).unwrap_or_default();
        blocks.extend((!heading.is_empty()).then(|| format!("### {heading}\n")));
        let shown = chapter.parts_on(Medium::Markdown).into_iter();
        blocks.extend(shown.filter_map(|part| passage(part, &heading)));
    }
    blocks.join("\n")
}

fn passage(passage: &ChapterPart, heading: &str) -> Option<String> {
    match &passage.content {
        PartContent::Sentence(_, words) => {
            Some(format!("{}\n", sanitize(words.text_on(Medium::Markdown)).replace('<', "&lt;")))
        }
        PartContent::Picture(name, _) => Some(format!("![{heading}]({name}.svg)\n")),
        PartContent::ReportTable(table) => Some(self::table(table)),
        // Other parts exist only for pages and terminals.
        _ => None,
    }
}

fn table(table: &ReportTable) -> String {
    let columns = table.columns_on(Medium::Markdown);
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let heads = columns.iter().map(|column| cell_text(column.head.text_on(Medium::Markdown)));
    let rule = columns.iter().map(|_| "---".to_owned());
    let rows = (0..table.chosen.len())
        .map(|i| row(columns.iter().map(|column| cell(column.kind, &column.cells[i])).collect()));
    [row(heads.collect()), row(rule.collect())].into_iter().chain(rows).collect()
}

fn cell(kind: CellKind, cell: &TableCell) -> String {
    let text = cell_text(cell.words.text_on(Medium::Markdown));
    match kind {
        CellKind::Code => format!("`{text}`"),
        _ if !cell.mark.is_empty() => format!("{text} ({})", cell.mark),
        _ => text,
    }
}

/// Text that cannot leave its cell or begin markup.
fn cell_text(text: &str) -> String {
    sanitize(text).replace('|', "\\|").replace('<', "&lt;").replace('`', " ")
}
