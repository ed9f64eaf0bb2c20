//! The title of a panel and the names of its lines, above the axes.

use super::super::text::printable;
use super::panel::{Area, Dash, FONT, Fill, INK, LEFT, Line, Panel, RIGHT, WIDTH};
use plotters::prelude::*;

/// Height of the title's row.
const HEAD: i32 = 62;
/// Height of each further row of the legend.
const LEGEND_ROW: i32 = 40;
/// Width of the sample of a line before its words.
const SAMPLE: i32 = 58;

/// What an entry of a legend stands for.
#[derive(Clone, Copy)]
enum Key<'a> {
    Line(&'a Line),
    Fill(&'a Fill),
}

/// One entry of a legend: what it stands for, its words, its row and where it begins.
struct Entry<'a> {
    key: Key<'a>,
    label: String,
    row: usize,
    left: i32,
}

impl Panel {
    /// The legend in reading order, each row set to the right; the first leaves room for the title.
    fn legend(&self) -> Vec<Entry<'_>> {
        // The width of a letter is about 0.52 em: 13 at 25 units, 19 for the bold title.
        let width = |label: &str, letter: i32| i32::try_from(label.chars().count()).unwrap_or(0) * letter;
        let limit = WIDTH.cast_signed() - RIGHT;
        let room = limit - LEFT.cast_signed();
        let mut left_over = room - width(&self.title, 19) - 40;
        let mut rows: Vec<Vec<(Key, String, i32)>> = vec![Vec::new()];
        let lines = self.lines.iter().map(|line| (Key::Line(line), line.label.as_deref()));
        let fills = self.fills.iter().map(|fill| (Key::Fill(fill), fill.label.as_deref()));
        for (key, label) in lines.chain(fills) {
            let Some(label) = label.map(printable) else { continue };
            let takes = SAMPLE + width(&label, 13) + 26;
            if takes > left_over && !(rows.len() > 1 && rows.last().is_some_and(Vec::is_empty)) {
                rows.push(Vec::new());
                left_over = room;
            }
            left_over -= takes;
            if let Some(row) = rows.last_mut() {
                row.push((key, label, takes));
            }
        }
        let mut entries = Vec::new();
        for (row, members) in rows.into_iter().enumerate() {
            let mut left = limit + 26 - members.iter().map(|(_, _, takes)| takes).sum::<i32>();
            for (key, label, takes) in members {
                entries.push(Entry { key, label, row, left });
                left += takes;
            }
        }
        entries
    }

    /// Height of title and legend.
    pub(super) fn head(&self) -> i32 {
        let last = self.legend().last().map_or(0, |entry| entry.row);
        HEAD + LEGEND_ROW * i32::try_from(last).unwrap_or(0)
    }
}

/// The panel's title at the left, its legend at the right of one line.
pub(super) fn heading(area: &Area, panel: &Panel) -> Result<(), String> {
    let fail = |e: DrawingAreaErrorKind<_>| e.to_string();
    let title = TextStyle::from((FONT, 36).into_font().style(FontStyle::Bold)).color(&INK);
    area.draw(&Text::new(printable(&panel.title), (LEFT.cast_signed(), 14), title)).map_err(fail)?;
    let entry = TextStyle::from((FONT, 31).into_font()).color(&INK);
    for Entry { key, label, row, left } in panel.legend() {
        let drop = LEGEND_ROW * i32::try_from(row).unwrap_or(0);
        area.draw(&Text::new(label, (left + SAMPLE, 17 + drop), entry.clone())).map_err(fail)?;
        match key {
            Key::Fill(fill) => {
                let corners = [(left, 18 + drop), (left + 48, 40 + drop)];
                let style = fill.colour.mix(fill.opacity).filled();
                area.draw(&Rectangle::new(corners, style)).map_err(fail)?;
            }
            Key::Line(line) => {
                let style = line.colour.mix(line.opacity).stroke_width(line.stroke.max(3));
                for &(from, to) in sample(line.dash) {
                    let stroke = vec![(left + from, 29 + drop), (left + to, 29 + drop)];
                    area.draw(&PathElement::new(stroke, style)).map_err(fail)?;
                }
            }
        }
    }
    Ok(())
}

/// From where to where the pieces of a line's sample reach.
fn sample(dash: Dash) -> &'static [(i32, i32)] {
    match dash {
        Dash::Solid => &[(0, 48)],
        Dash::Dashed => &[(0, 20), (28, 48)],
        Dash::Dotted => &[(0, 6), (14, 20), (28, 34), (42, 48)],
    }
}

#[cfg(test)]
mod tests {
    use super::super::panel::tests::panel;
    use super::*;

    #[test]
    fn a_long_legend_takes_more_rows_within_the_width() {
        let panel = panel(16);
        let entries = panel.legend();
        assert_eq!(entries.len(), 16);
        assert!(entries.iter().all(|e| e.left >= LEFT.cast_signed() && e.left < WIDTH.cast_signed()));
        assert!(entries.iter().any(|e| e.row > 0));
        assert!(entries.windows(2).all(|w| w[0].row < w[1].row || w[0].left < w[1].left));
    }
}
