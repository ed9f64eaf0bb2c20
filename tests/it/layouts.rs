//! From recordings laid out in other ways than the examples to their numbers, or to what is wrong with them.

use crate::run::{Answer, dropcheck};
use std::path::Path;
use std::{fs, iter};

fn init(path: &Path) -> Answer {
    dropcheck(["init".as_ref(), path.as_os_str()])
}

/// The table of `rows` under a header, in a file of its own.
fn table(header: &str, rows: impl Fn(u32) -> String) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("drop.csv");
    let lines = iter::once(header.to_owned()).chain((0..400).map(rows));
    fs::write(&path, lines.collect::<Vec<_>>().join("\n") + "\n").expect("a temporary file");
    (folder, path)
}

#[test]
fn init_refuses_a_recording_that_no_cask_file_could_read() {
    for (header, word) in
        [("t [s];A1 [g];A2 [g]", "1.234,5"), ("t [s];A1;A2", "oops"), ("t [s];A1 [g];n", "1 234,0")]
    {
        let row = |i: u32| {
            format!(
                "{},{:04};{word};{}",
                i / 10_000,
                i % 10_000,
                if header.ends_with('n') { "7" } else { word }
            )
        };
        let (_folder, path) = table(header, row);
        let answer = init(&path);
        assert_eq!((answer.status, answer.stdout.as_str()), (2, ""), "{header}: {}", answer.stderr);
        let told = answer.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in ["drop.csv", "A1", word, "inspect"] {
            assert!(told.contains(part), "{header}: {told} without {part:?}");
        }
    }
}

#[test]
fn init_names_what_it_leaves_out() {
    let cell = |i: u32| if i == 40 { "oops".into() } else { format!("{i},5") };
    let (_folder, path) = table("t [s];A1 [g];A2 [g]", |i| format!("0,{i:04};{};{i},25", cell(i)));
    let answer = init(&path);
    assert_eq!(answer.status, 0, "{}", answer.stderr);
    assert!(
        answer.stdout.contains("#   A1 [g]: 1 of 400 cells are no numbers, such as \"oops\""),
        "{}",
        answer.stdout
    );
    assert_eq!(answer.stdout.matches("\n[[channel]]\n").count(), 1, "{}", answer.stdout);
}
