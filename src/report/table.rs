//! Tables from rows of any type: a head and a function for its cells, column by column.

use super::text::Style;

/// Columns of cells, and their layout.
#[derive(Default)]
pub(crate) struct ReportTable {
    pub(crate) caption: String,
    /// Class in the page's style; "whole" keeps a table on one sheet.
    pub(crate) class: &'static str,
    pub(crate) columns: Vec<ReportColumn>,
    /// True for the row that was selected.
    pub(crate) chosen: Vec<bool>,
    /// Most rows on a terminal and on a page, and the place that shows all.
    pub(crate) most: Option<(usize, usize, &'static str)>,
    pub(crate) shape: TableShape,
}

/// Arrangement of the rows on a terminal.
#[derive(Default, PartialEq)]
pub(crate) enum TableShape {
    /// Cells beside one another, wrapped if they are too wide.
    #[default]
    Columns,
    /// Cells beside one another, closer together if they would not fit otherwise.
    Fitting,
    /// As [`TableShape::Columns`], each row below the name of the group to which it belongs.
    Groups(Vec<String>),
    /// The last cell of a row below the others.
    Items,
    /// As `Items`, with air between the rows.
    ApartItems,
}

/// Kind of content in a column.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum CellKind {
    /// Subject of the row.
    Head,
    Text,
    /// Set to the right.
    Number,
    /// Words that stay on one line.
    Soft,
    /// Words as a machine writes them.
    Code,
    /// A word in its colour.
    Tag,
}

/// One column.
pub(crate) struct ReportColumn {
    pub(crate) head: Words,
    pub(crate) kind: CellKind,
    /// The only medium that shows the column.
    only: Option<Medium>,
    pub(crate) cells: Vec<TableCell>,
}

/// One cell.
#[derive(Default)]
pub(crate) struct TableCell {
    pub(crate) words: Words,
    /// A word set apart from the others, such as "default".
    pub(crate) mark: &'static str,
    pub(crate) style: Option<Style>,
    /// Target of a link on a page; empty for none.
    pub(crate) link: String,
}

impl<T: Into<Words>> From<T> for TableCell {
    fn from(words: T) -> Self {
        Self { words: words.into(), ..Self::default() }
    }
}

impl TableCell {
    /// Words with one that is set off.
    pub(crate) fn with_mark(words: impl Into<Words>, mark: &'static str) -> Self {
        Self { mark, ..words.into().into() }
    }

    /// Words in a colour.
    pub(crate) fn tone(style: Style, words: impl Into<Words>) -> Self {
        Self { style: Some(style), ..words.into().into() }
    }
}

impl ReportTable {
    /// A table for these rows, still without columns.
    pub(crate) fn from_rows<R>(rows: &[R]) -> TableRows<'_, R> {
        TableRows { rows, table: Self { class: "whole", chosen: vec![false; rows.len()], ..Self::default() } }
    }

    /// The columns that a medium shows.
    pub(crate) fn columns_on(&self, medium: Medium) -> Vec<&ReportColumn> {
        self.columns.iter().filter(|column| column.only.is_none_or(|only| only == medium)).collect()
    }

    /// Number of rows that a medium shows, and a sentence on the omitted ones.
    pub(crate) fn rows(&self, medium: Medium) -> (usize, Option<String>) {
        let all = self.chosen.len();
        match self.most {
            Some((terminal, page, others)) => {
                let shown = all.min(if medium == Medium::Terminal { terminal } else { page });
                let sentence = || format!("… and {} more: {others}", all - shown);
                (shown, (shown < all).then(sentence))
            }
            None => (all, None),
        }
    }
}

/// A table while its columns are set.
pub(crate) struct TableRows<'a, R> {
    rows: &'a [R],
    pub(crate) table: ReportTable,
}

impl<'a, R> TableRows<'a, R> {
    fn column<C: Into<TableCell>>(
        mut self,
        kind: CellKind,
        head: impl Into<Words>,
        cell: impl Fn(&'a R) -> C,
    ) -> Self {
        let cells = self.rows.iter().map(|row| cell(row).into()).collect();
        self.table.columns.push(ReportColumn { head: head.into(), kind, only: None, cells });
        self
    }

    /// Adds the column with the subject of the row.
    pub(crate) fn head<C: Into<TableCell>>(self, head: impl Into<Words>, cell: impl Fn(&'a R) -> C) -> Self {
        self.column(CellKind::Head, head, cell)
    }

    /// Words.
    pub(crate) fn text<C: Into<TableCell>>(self, head: impl Into<Words>, cell: impl Fn(&'a R) -> C) -> Self {
        self.column(CellKind::Text, head, cell)
    }

    /// Numbers, set to the right.
    pub(crate) fn number<C: Into<TableCell>>(
        self,
        head: impl Into<Words>,
        cell: impl Fn(&'a R) -> C,
    ) -> Self {
        self.column(CellKind::Number, head, cell)
    }

    /// Adds a column of words that stay on one line.
    pub(crate) fn line<C: Into<TableCell>>(self, head: impl Into<Words>, cell: impl Fn(&'a R) -> C) -> Self {
        self.column(CellKind::Soft, head, cell)
    }

    /// Words as a machine writes them.
    pub(crate) fn code<C: Into<TableCell>>(self, head: impl Into<Words>, cell: impl Fn(&'a R) -> C) -> Self {
        self.column(CellKind::Code, head, cell)
    }

    /// A word in its colour.
    pub(crate) fn tag<C: Into<TableCell>>(self, head: impl Into<Words>, cell: impl Fn(&'a R) -> C) -> Self {
        self.column(CellKind::Tag, head, cell)
    }

    /// The column set last on this medium alone.
    pub(crate) fn only_on(mut self, medium: impl Into<Option<Medium>>) -> Self {
        if let Some(column) = self.table.columns.last_mut() {
            column.only = medium.into();
        }
        self
    }

    /// Shows the last column only if there is something to show.
    pub(crate) fn show_if(mut self, any: bool) -> Self {
        if !any {
            self.table.columns.pop();
        }
        self
    }

    /// Sets the caption.
    pub(crate) fn caption(mut self, caption: impl Into<String>) -> Self {
        self.table.caption = caption.into();
        self
    }

    /// Sets the class in the page's style.
    pub(crate) fn class(mut self, class: &'static str) -> Self {
        self.table.class = class;
        self
    }

    /// Marks the selected rows.
    pub(crate) fn mark_chosen(mut self, chosen: impl Fn(&'a R) -> bool) -> Self {
        self.table.chosen = self.rows.iter().map(chosen).collect();
        self
    }

    /// Sets the most rows on a terminal and on a page, and the place that shows all.
    pub(crate) fn limit_rows(mut self, terminal: usize, page: usize, others: &'static str) -> Self {
        self.table.most = Some((terminal, page, others));
        self
    }

    /// Sets the arrangement of the rows on a terminal.
    pub(crate) fn shape(mut self, shape: TableShape) -> Self {
        self.table.shape = shape;
        self
    }
}

impl<R> From<TableRows<'_, R>> for ReportTable {
    fn from(rows: TableRows<'_, R>) -> Self {
        rows.table
    }
}

/// Medium on which a document is read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Medium {
    /// 80 columns, with colours.
    Terminal,
    /// HTML, for the desk and for A4 paper.
    Page,
    /// A part of another document.
    #[cfg(feature = "lab")]
    Markdown,
}

/// Words, and shorter ones for lines without room for them: a terminal, and a table in Markdown.
#[derive(Clone, Default, PartialEq)]
pub(crate) struct Words {
    full: String,
    short: Option<String>,
}

impl Words {
    /// `full` on a page, `short` elsewhere.
    pub(crate) fn with_short(full: impl Into<String>, short: impl Into<String>) -> Self {
        Self { full: full.into(), short: Some(short.into()) }
    }

    /// The text for a medium.
    pub(crate) fn text_on(&self, medium: Medium) -> &str {
        match &self.short {
            Some(short) if medium != Medium::Page => short,
            _ => &self.full,
        }
    }
}

impl From<String> for Words {
    fn from(full: String) -> Self {
        Self { full, short: None }
    }
}

impl From<&str> for Words {
    fn from(full: &str) -> Self {
        full.to_owned().into()
    }
}
