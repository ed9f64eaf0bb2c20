//! A document between two lines of which a command writes to the same with other words there.

use super::super::output::replace;
use crate::ingest::bytes_of;
use miette::miette;
use std::path::{Path, PathBuf};

/// What stands before and behind the words that a command writes, the lines that mark the place included.
pub struct MarkedDocument {
    path: PathBuf,
    before: String,
    behind: String,
}

impl MarkedDocument {
    /// The document with the lines `<!-- name: begin -->` and `<!-- name: end -->`.
    pub fn of(path: &Path, name: &str) -> miette::Result<Self> {
        let text = bytes_of(path, 16)
            .and_then(|bytes| String::from_utf8(bytes).map_err(std::io::Error::other))
            .map_err(|source| miette!("{} cannot be read: {source}", path.display()))?;
        let [begin, end] = ["begin", "end"].map(|word| format!("<!-- {name}: {word} -->"));
        let found = text.find(&begin).map(|at| at + begin.len()).zip(text.find(&end));
        let Some((begin, end)) = found.filter(|(begin, end)| begin <= end) else {
            let mend = format!("write the lines {begin} and {end} where the tables are to stand");
            return Err(miette!(help = mend, "{} does not say where the tables go", path.display()));
        };
        Ok(Self { path: path.to_owned(), before: text[..begin].to_owned(), behind: text[end..].to_owned() })
    }

    /// Writes the words to their place.
    pub fn write(&self, words: &str) -> miette::Result<()> {
        Ok(replace(&self.path, format!("{}\n{words}{}", self.before, self.behind).as_bytes())?)
    }

    /// What leads from the document to a folder, for references: relative where the folder lies below the
    /// document's own.
    pub fn way_to(&self, folder: &Path) -> String {
        let below = self.path.parent().and_then(|own| folder.strip_prefix(own).ok()).unwrap_or(folder);
        let words: Vec<String> =
            below.components().map(|part| part.as_os_str().to_string_lossy().replace(' ', "%20")).collect();
        if words.is_empty() { String::new() } else { format!("{}/", words.join("/").replace("//", "/")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_is_between_the_marks() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.md");
        std::fs::write(&path, "a\n<!-- a: begin -->\nold\n<!-- a: end -->\nb\n").expect("a file");
        MarkedDocument::of(&path, "a").expect("marks").write("new\n").expect("written");
        let text = std::fs::read_to_string(&path).expect("a document");
        assert_eq!(text, "a\n<!-- a: begin -->\nnew\n<!-- a: end -->\nb\n");
        std::fs::write(&path, "<!-- a: end --><!-- a: begin -->").expect("a file");
        assert!(MarkedDocument::of(&path, "a").is_err());
    }

    #[test]
    fn pictures_below_the_document_are_named_from_it() {
        let way = |document: &str, folder: &str| {
            let [before, behind] = [String::new(), String::new()];
            MarkedDocument { path: document.into(), before, behind }.way_to(Path::new(folder))
        };
        assert_eq!(way("docs/a.md", "docs/the charts"), "the%20charts/");
        assert_eq!(way("docs/a.md", "docs"), "");
        assert_eq!(way("a.md", "/b"), "/b/");
    }
}
