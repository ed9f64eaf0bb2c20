//! Words to those that a medium has room for: a terminal, a page, a part of another document.

/// Where a document is read.
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

/// Words, and shorter ones for where a line has no room for them: a terminal, and a table in Markdown.
#[derive(Clone, Default, PartialEq)]
pub(crate) struct Words {
    full: String,
    short: Option<String>,
}

impl Words {
    /// `full` on a page, `short` elsewhere.
    pub(crate) fn or(full: impl Into<String>, short: impl Into<String>) -> Self {
        Self { full: full.into(), short: Some(short.into()) }
    }

    /// Those of the medium.
    pub(crate) fn on(&self, medium: Medium) -> &str {
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
