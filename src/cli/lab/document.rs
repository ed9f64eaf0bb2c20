//! A document and two lines in it to what stands before the one and behind the other.

use crate::ingest::bytes_of;
use std::path::Path;

/// The lines between which a command writes.
pub struct Marks {
    pub begin: &'static str,
    pub end: &'static str,
}

impl Marks {
    /// What stands before and after the place in a document, the lines that mark it included.
    pub fn parts(&self, path: &Path) -> miette::Result<(String, String)> {
        let text = bytes_of(path, 16)
            .and_then(|bytes| String::from_utf8(bytes).map_err(std::io::Error::other))
            .map_err(|source| miette::miette!("{} cannot be read: {source}", path.display()))?;
        let found = text.find(self.begin).map(|at| at + self.begin.len()).zip(text.find(self.end));
        match found.filter(|(begin, end)| begin <= end) {
            Some((begin, end)) => Ok((text[..begin].to_owned(), text[end..].to_owned())),
            None => Err(miette::miette!(
                help =
                    format!("write the lines {} and {} where the tables are to stand", self.begin, self.end),
                "{} does not say where the tables go",
                path.display()
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_is_between_the_marks() {
        let marks = Marks { begin: "<!-- a: begin -->", end: "<!-- a: end -->" };
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.md");
        std::fs::write(&path, "a\n<!-- a: begin -->\nold\n<!-- a: end -->\nb\n").expect("a file");
        let (before, after) = marks.parts(&path).expect("marks");
        assert_eq!((before.as_str(), after.as_str()), ("a\n<!-- a: begin -->", "<!-- a: end -->\nb\n"));
        std::fs::write(&path, "<!-- a: end --><!-- a: begin -->").expect("a file");
        assert!(marks.parts(&path).is_err());
    }
}
