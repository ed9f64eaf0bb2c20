//! What a person reads, held to the letter: terminal tables and the report's text of three fixtures.
//!
//! `BLESS=1 cargo test --test it golden` writes the files anew; read the difference before committing it.

use crate::moved;
use crate::run::root;
use std::process::Command;

/// Runs `analyze` in the repository's folder, so that paths read as a user would type them.
fn analyze(stem: &str, extension: &str, more: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_dropcheck"))
        .current_dir(root())
        .env("NO_COLOR", "1")
        .env("COLUMNS", "80")
        .env("SOURCE_DATE_EPOCH", "0")
        .args([
            "analyze",
            &format!("fixtures/examples/{stem}.{extension}"),
            "--cask",
            &format!("fixtures/examples/{stem}.toml"),
        ])
        .args(more)
        .output()
        .expect("the program runs");
    String::from_utf8(output.stdout).expect("UTF-8")
}

fn hold(name: &str, found: &str) {
    moved::hold(&root().join("tests/golden").join(name), found, moved::lines);
}

#[test]
fn the_table_of_a_sound_drop() {
    hold("anf18-json.txt", &analyze("anf18-json", "mcap", &["--full"]));
}

#[test]
fn the_table_of_a_drop_with_rest_and_an_axial_channel() {
    hold("vhlw-rest.txt", &analyze("vhlw-rest", "h5", &["--full"]));
}

#[test]
fn the_table_of_a_clipped_drop() {
    hold("damaged-clipped.txt", &analyze("damaged-clipped", "h5", &["--full"]));
}

#[test]
fn the_report_without_its_pictures() {
    let out = tempfile::tempdir().expect("a folder");
    let folder = out.path().join("report");
    analyze("anf18-json", "mcap", &["--out", &folder.display().to_string()]);
    let page = std::fs::read_to_string(folder.join("report.html")).expect("a report");
    // Behind the footer stand the page's own scripts.
    let body =
        page.split("</style>").nth(1).expect("a style sheet").split("</footer>").next().expect("a body");
    // Pictures are drawn from a thousand points each: their text is what is held elsewhere.
    let mut text = String::new();
    let mut rest = body;
    while let Some(start) = rest.find("<svg") {
        text.push_str(&rest[..start]);
        // A drawing holds smaller ones; its caption follows the last of them.
        let figure = rest[start..].find("<figcaption").expect("a caption");
        rest = &rest[start + figure..];
    }
    text.push_str(rest);
    hold("anf18-json.html", &text.replace("</tr>", "</tr>\n").replace("</h2>", "</h2>\n"));
}
