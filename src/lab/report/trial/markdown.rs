//! A trial to the Markdown that stands in `docs/measured/trial.md`: charts, the place of each default, where methods fail.

use super::breaks;
use super::families::families;
use super::page::{again, error_words};
use super::reasons::reason;
use crate::lab::data::Trial;
use crate::report::rounding::significant;
use crate::report::text::printable;
use std::fmt::Write;

/// The extract; `folder` is what leads from the document to the charts ("" or ending in "/"), none leaves them out.
#[must_use]
pub fn markdown(trial: &Trial, folder: Option<&str>) -> String {
    let mut out = String::new();
    let run = if trial.request.quick { "quick" } else { "full" };
    let _ = writeln!(
        out,
        "{} points of methods and classes, {} failure maps; {run} run, seed {}, version {}. {}, {} threads, {}. {} Again: `{}`.",
        trial.points.len(),
        trial.maps.len(),
        trial.request.seed,
        trial.version,
        cell(&trial.machine.processor),
        trial.machine.cores,
        cell(&trial.machine.system),
        trial.peers,
        again(trial)
    );
    if !trial.machine.is_optimised {
        out.push_str("\nBuilt without optimisation: the times say nothing.\n");
    }
    out.push_str("\n### Speed against accuracy\n");
    for family in families(trial) {
        let _ = writeln!(out, "\n#### {}\n", cell(family.name));
        if let Some(folder) = folder {
            let _ = writeln!(
                out,
                "![Speed against accuracy: {}]({folder}{}.svg)\n",
                cell(family.name),
                family.file_name()
            );
        }
        let _ = writeln!(
            out,
            "| class | method | median error, {} | 95 % | ns a {} | front |\n|---|---|---|---|---|---|",
            cell(family.error_unit),
            cell(family.time_per)
        );
        // The front and the default; all points are in points.csv.
        for (p, on_front) in family.points.iter().filter(|(p, on)| *on || p.is_default) {
            let _ = writeln!(
                out,
                "| {} | {}{} | {} | {} | {} | {} |",
                cell(&p.class),
                cell(&p.method),
                if p.is_default { " (default)" } else { "" },
                error_words(Some(p.median_error)),
                error_words(Some(p.p95_error)),
                significant(p.time_ns, 3),
                if *on_front { "yes" } else { "no" }
            );
        }
        let (beaten, never) = (family.beaten(), family.never_on_front());
        if !beaten.is_empty() {
            let _ = writeln!(
                out,
                "\nThe default is off the front in: {}. {}",
                cell(&beaten.join("; ")),
                reason(family.name).unwrap_or("No reason is written for this.")
            );
        }
        if !never.is_empty() {
            let _ = writeln!(out, "\nOn no front, and not offered: {}.", cell(&never.join("; ")));
        }
    }
    out.push_str("\n### Where methods fail\n");
    for map in &trial.maps {
        // One stress may have a map for each quantity.
        let _ = writeln!(out, "\n#### {}: {}\n", cell(&map.title), cell(&map.error));
        if let Some(folder) = folder {
            let _ = writeln!(
                out,
                "![{}]({folder}{}.svg)\n",
                cell(&map.title),
                super::failure_chart::file_name(map)
            );
        }
        let _ = writeln!(
            out,
            "| method | {} passes {} at: {} | largest | noticed |\n|---|---|---|---|",
            cell(&map.error),
            significant(map.limit, 2),
            cell(&map.stress)
        );
        for line in &map.lines {
            let broken = breaks::of(map, line);
            let _ = writeln!(
                out,
                "| {} | {} | {} | {} |",
                cell(&line.method),
                broken.at_words(),
                error_words(broken.worst),
                broken.noticed_words()
            );
        }
    }
    out
}

/// Text that cannot leave its cell or begin markup.
fn cell(text: &str) -> String {
    printable(text).replace('|', "\\|").replace('<', "&lt;").replace(['\n', '`'], " ")
}
