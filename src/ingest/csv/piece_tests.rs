//! Random tables by pieces of any size: the rows, the error and the ending are those of reading it in order.

use super::super::lines::Lines;
use super::columns::HeldColumn;
use super::pieces::Sizes;
use super::rows::{RowError, read};
use super::wanted::Wanted;
use super::*;
use proptest::prelude::*;
use std::io::Cursor;

const HEADER: &str = "time_s,A1,A2\n";
const LINE_BYTES: usize = 256;
/// One piece a batch: row by row.
const IN_ORDER: Sizes = Sizes {
    piece_bytes: LINE_BYTES,
    batch_bytes: LINE_BYTES,
    line_bytes: LINE_BYTES,
    samples_bytes: u64::MAX,
};

fn layout(decimal: &str) -> Layout {
    let text = format!("{HEADER}0,1{decimal},2\n1,2,3\n2,3,1\n");
    Layout::of(&Text::of(Box::new(Cursor::new(text)), 0, "").unwrap()).unwrap()
}

/// The header and `rows`, of which `ahead` bytes are read with it.
fn input(rows: &[u8], ahead: usize) -> Text {
    let all = Cursor::new([HEADER.as_bytes(), rows].concat());
    let mut text = Text::of(Box::new(all), (HEADER.len() + rows.len()) as u64, "").unwrap();
    let mut behind = text.head.split_off((HEADER.len() + ahead).min(text.head.len()));
    behind.extend(text.rest.has_zeros.then_some(0));
    text.rest = Lines::of(Box::new(Cursor::new(behind)));
    text
}

/// All that the readers of `analyze` and of `inspect` tell of the rows.
fn told(rows: &[u8], ahead: usize, sizes: Sizes, layout: &Layout) -> [String; 2] {
    let plans = [1, 2].map(|column| ColumnPlan::of_column(column, Some(0), layout));
    let wanted = Wanted::of(&plans, layout, false);
    let empty = || Table::new(layout, &[], &wanted);
    let mut table = empty();
    let end = read(input(rows, ahead), (layout, &wanted), &mut table, sizes, &|_| ());
    let kept = match end {
        Ok(end) => {
            let columns: Vec<_> = table.columns.iter().map(HeldColumn::values).collect();
            format!("{end:?} {columns:?} {:?}", table.stamps)
        }
        Err(error) => format!("{error:?}"),
    };
    let mut listed = empty().for_listing();
    let end = read(input(rows, ahead), (layout, &wanted), &mut listed, sizes, &|_| ());
    [kept, end.map_or_else(|error| format!("{error:?}"), |end| format!("{end:?} {listed:?}"))]
}

/// A line with its break: mostly a row, now and then one that ends the reading.
fn line() -> impl Strategy<Value = String> {
    let row = "[0-9]{1,9}(\\.[0-9]{0,12})?,-?[0-9]{0,4}(\\.[0-9]{1,3})?,[+-]?[0-9]\\.?(e-?[0-9])?\r?\n";
    prop_oneof![
        400 => row,
        40 => "[0-9]{1,3},(nan)?,\r?\n",
        40 => "([0-9]{1,3},[0-9],[0-9](,[0-9])?\r{1,2}){1,3}\n?",
        40 => "\"[0-9]{1,3}\", \"[0-9]\" ,\"\"\"?,?\"\n",
        40 => "[ \t]{0,2}\r?\n",
        20 => "[0-9],[0-9]\n",
        1 => "[0-9],oops,[0-9]\n",
        1 => "2026-11-20T12:00:0[0-9]Z,[0-9],[0-9]\n",
        1 => ",[0-9],[0-9]\n",
        1 => "\0{1,40}\n",
        1 => "[0-9],[0-9]{250,300},1\n",
    ]
}

fn last_line() -> impl Strategy<Value = String> {
    prop_oneof![4 => "", 1 => "[0-9],[0-9],[0-9]", 1 => "[0-9],[0-9]", 1 => "[0-9],[0-9],1\\.5e",
        1 => "\0{1,300}"]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn pieces_give_what_the_text_in_order_gives(
        lines in prop::collection::vec(line(), 0..150),
        last in last_line(),
        (piece_bytes, pieces, ahead) in (16_usize..=LINE_BYTES, 1_usize..6, 0_usize..600),
        decimal in prop_oneof![Just(""), Just(".0")],
    ) {
        let rows = lines.concat() + &last;
        let layout = layout(decimal);
        let sizes = Sizes { piece_bytes, batch_bytes: pieces * piece_bytes, ..IN_ORDER };
        let [kept, seen] = told(rows.as_bytes(), ahead, sizes, &layout);
        let [kept_in_order, seen_in_order] = told(rows.as_bytes(), 0, IN_ORDER, &layout);
        prop_assert_eq!(kept, kept_in_order);
        prop_assert_eq!(seen, seen_in_order);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn lines_taken_whole_give_what_their_cells_give(lines in prop::collection::vec(line(), 0..100)) {
        let layout = layout(".0");
        // A blank more may make a line too long.
        let lines: Vec<String> = lines.into_iter().filter(|line| line.len() + 1 < LINE_BYTES).collect();
        // A blank before its first number has a line read cell by cell.
        let blank = |line: &str| if line.starts_with(|c: char| c.is_ascii_digit()) { " " } else { "" };
        let by_cells: String = lines.iter().flat_map(|line| [blank(line), line]).collect();
        let cells = told(by_cells.as_bytes(), 0, IN_ORDER, &layout);
        prop_assert_eq!(told(lines.concat().as_bytes(), 0, IN_ORDER, &layout), cells);
    }
}

#[test]
fn the_first_fault_in_order_is_told_with_its_line() {
    let layout = layout(".0");
    let sizes = Sizes { piece_bytes: 64, batch_bytes: 64 * 8, ..IN_ORDER };
    let good = "1,2,3\n".repeat(50);
    let long = format!("1,{},3\n", "2".repeat(LINE_BYTES));
    for (rows, expected) in [
        (format!("{good}1,oops,3\n{good},2,3\n{good}"), "Word { line: 52, slot: 1, cell: \"oops\" }"),
        (format!("{good},2,3\n{good}1,oops,3\n{good}"), "NoTime { line: 52, slot: 0 }"),
        (format!("{good}{long}1,oops,3\n"), "TooLong { line: 52 }"),
        (format!("{good}1,oops,3\n{long}"), "Word { line: 52, slot: 1, cell: \"oops\" }"),
        (format!("{good}\0\0\n{good}1,oops,3\n"), "Some(ZeroBytes { line: 52 })"),
    ] {
        let [kept, _] = told(rows.as_bytes(), 0, sizes, &layout);
        assert!(kept.starts_with(expected), "{kept:?} is not {expected:?}");
    }
}

#[test]
fn rows_past_the_memory_are_refused_before_later_faults() {
    let layout = layout(".0");
    // 24 bytes a row held, checked after every piece of 64 bytes or 10 rows.
    let sizes = Sizes { piece_bytes: 64, batch_bytes: 64 * 8, samples_bytes: 24 * 100, ..IN_ORDER };
    let rows = |before: usize| "1,2,3\n".repeat(before) + "1,oops,3\n" + &"1,2,3\n".repeat(200);
    for (before, expected) in [(95, "Word"), (115, "TooMany")] {
        let [kept, _] = told(rows(before).as_bytes(), 0, sizes, &layout);
        assert!(kept.starts_with(expected), "{before}: {kept}");
    }
    let fits = "1,2,3\n".repeat(100);
    assert!(told(fits.as_bytes(), 0, sizes, &layout)[0].starts_with("None"));
}

/// A reader that fails once its text is read.
struct Broken(Cursor<Vec<u8>>);

impl std::io::Read for Broken {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        match self.0.read(buffer)? {
            0 => Err(std::io::Error::other("unplugged")),
            read => Ok(read),
        }
    }
}

#[test]
fn rows_before_a_failure_to_read_are_looked_at_first() {
    let layout = layout(".0");
    let plans = [1, 2].map(|column| ColumnPlan::of_column(column, Some(0), &layout));
    let wanted = Wanted::of(&plans, &layout, false);
    let sizes = Sizes { piece_bytes: 64, batch_bytes: 256, ..IN_ORDER };
    let good = "1,2,3\n".repeat(42);
    for (rows, is_word) in [(good.clone() + "1,oops,3\n" + &good, true), (good.clone() + &good, false)] {
        let mut text = input(b"", 0);
        text.rest = Lines::of(Box::new(Broken(Cursor::new(rows.into_bytes()))));
        let mut table = Table::new(&layout, &[], &wanted);
        let error = read(text, (&layout, &wanted), &mut table, sizes, &|_| ()).unwrap_err();
        assert_eq!(matches!(error, RowError::Word { line: 44, .. }), is_word, "{error:?}");
        assert_eq!(matches!(error, RowError::Io(_)), !is_word, "{error:?}");
    }
}
