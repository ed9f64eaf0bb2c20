//! A line of a table to its cells.

/// What stands between cells: one byte, or, where that is a blank, any run of blanks and tabs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Delimiter(pub u8);

impl Delimiter {
    /// Whether any run of blanks is one delimiter.
    pub(super) fn is_run(self) -> bool {
        self.0 == b' '
    }

    /// Whether `byte` stands between cells.
    pub(super) fn is(self, byte: u8) -> bool {
        byte == self.0 || (self.is_run() && byte == b'\t')
    }

    /// Where the first cell of the line at `at` begins.
    pub(super) fn first(self, text: &[u8], at: usize) -> usize {
        if self.is_run() { skip(text, at, |byte| self.is(byte)) } else { at }
    }

    /// Where the cell at `at` ends: its delimiter, line break, or the text's end. In quotes, `"a;b""c"`, a
    /// delimiter is text.
    pub(super) fn end(self, text: &[u8], at: usize) -> usize {
        let mut at = skip(text, at, |byte| byte == b' ' && !self.is_run());
        while text.get(at) == Some(&b'"') {
            at = skip(text, at + 1, |byte| byte != b'"' && byte != b'\n');
            at += usize::from(text.get(at) == Some(&b'"'));
        }
        skip(text, at, |byte| byte != b'\n' && !self.is(byte))
    }

    /// The cell behind the one that ends at `end`; `None` where the line ends there.
    pub(super) fn next(self, text: &[u8], end: usize) -> Option<usize> {
        self.is(*text.get(end)?).then_some(())?;
        let next = self.first(text, end + 1);
        // Blanks at the end of a line stand before no cell.
        (!self.is_run() || text.get(next).is_some_and(|byte| *byte != b'\n')).then_some(next)
    }

    /// The cells of `line`, without blanks and quotes around them.
    pub(super) fn cells(self, line: &str) -> Vec<&str> {
        let text = line.as_bytes();
        let mut at = Some(self.first(text, 0));
        let mut cells = Vec::new();
        while let Some(from) = at {
            let end = self.end(text, from);
            cells.push(std::str::from_utf8(bare(&text[from..end])).unwrap_or_default().trim());
            at = self.next(text, end);
        }
        cells
    }
}

/// A cell without blanks and quotes around it.
pub(super) fn bare(cell: &[u8]) -> &[u8] {
    let cell = cell.trim_ascii();
    cell.strip_prefix(b"\"").and_then(|cell| cell.strip_suffix(b"\"")).map_or(cell, <[u8]>::trim_ascii)
}

/// The first place from `at` on where `passes` fails.
pub(super) fn skip(text: &[u8], at: usize, passes: impl Fn(u8) -> bool) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    at + rest.iter().position(|&byte| !passes(byte)).unwrap_or(rest.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_at_its_delimiters_but_for_those_in_quotes() {
        for (delimiter, line, expected) in [
            (b';', "1;2,5; 3 ;", &["1", "2,5", "3", ""][..]),
            (b',', "\"1,5\", \"a\"\"b, c\" ,\"\",\"open, 2", &["1,5", "a\"\"b, c", "", "\"open, 2"]),
            (b',', "5\" pipe,2", &["5\" pipe", "2"]),
            (b' ', "  1 \t 2  ", &["1", "2"]),
            (b' ', "\"a b\" c", &["a b", "c"]),
            (b'\t', "\t\t1", &["", "", "1"]),
            (b';', "", &[""]),
            (b' ', "", &[""]),
        ] {
            assert_eq!(Delimiter(delimiter).cells(line), expected, "{line:?}");
        }
    }
}
