//! Tests of writing sets of files into folders of every kind, with and without interruption.

use super::*;

fn set(content: &str) -> Vec<(String, Vec<u8>)> {
    ["report.html", "result.json", "curves.csv"].map(|name| (name.to_owned(), content.into())).to_vec()
}

/// Contents of the set in `folder`.
fn contents(folder: &Path) -> Vec<String> {
    set("").iter().map(|(name, _)| fs::read_to_string(folder.join(name)).unwrap_or_default()).collect()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn what_is_not_of_the_set_survives_a_replacement() {
    let place = tempfile::tempdir().unwrap();
    for with_folder in [false, true] {
        let folder = place.path().join(format!("report-{with_folder}"));
        replace_set(&folder, &set("old")).unwrap();
        fs::write(folder.join("notes.txt"), "mine").unwrap();
        if with_folder {
            fs::create_dir(folder.join("photos")).unwrap();
            fs::write(folder.join("photos/1.jpg"), "photo").unwrap();
        }
        replace_set(&folder, &set("new")).unwrap();
        assert_eq!(contents(&folder), ["new"; 3]);
        assert_eq!(fs::read(folder.join("notes.txt")).unwrap(), b"mine");
        assert_eq!(fs::read(folder.join("photos/1.jpg")).is_ok(), with_folder);
        assert_eq!(names(&folder).len(), 4 + usize::from(with_folder));
    }
    assert_eq!(names(place.path()), ["report-false", "report-true"]);
}

#[cfg(unix)]
#[test]
fn a_replacement_keeps_the_folders_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("report");
    replace_set(&folder, &set("old")).unwrap();
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o750)).unwrap();
    replace_set(&folder, &set("new")).unwrap();
    assert_eq!(fs::metadata(&folder).unwrap().permissions().mode() & 0o777, 0o750);
}

#[test]
fn what_a_stopped_run_left_is_made_good_by_the_next() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("report");
    replace_set(&folder, &set("old")).unwrap();
    fs::create_dir(folder.join("photos")).unwrap();
    // The run was stopped between two moves: the JSON is in place, the other files are not.
    let unfinished = folder.join(UNFINISHED);
    fs::create_dir(&unfinished).unwrap();
    fs::write(folder.join("result.json"), "newer").unwrap();
    fs::write(unfinished.join("report.html"), "newer").unwrap();
    fs::write(unfinished.join("of-another-set.svg"), "newer").unwrap();
    // The run was killed while it staged files, beside the folder and in it.
    for stale in [place.path().join(".dropcheck-dead"), folder.join(".dropcheck-dead")] {
        fs::create_dir(&stale).unwrap();
        fs::write(stale.join("report.html"), "half").unwrap();
    }
    fs::write(folder.join(".dropcheck-probe"), "").unwrap();
    replace_set(&folder, &set("newest")).unwrap();
    assert_eq!(contents(&folder), ["newest"; 3]);
    assert_eq!(names(&folder), ["curves.csv", "of-another-set.svg", "photos", "report.html", "result.json"]);
    assert_eq!(names(place.path()), ["report"]);
}

#[test]
fn a_stale_folder_with_somebodys_file_stays() {
    let place = tempfile::tempdir().unwrap();
    let stale = place.path().join(".dropcheck-dead");
    fs::create_dir(&stale).unwrap();
    fs::write(stale.join("notes.txt"), "mine").unwrap();
    replace_set(&place.path().join("report"), &set("new")).unwrap();
    assert_eq!(fs::read(stale.join("notes.txt")).unwrap(), b"mine");
}

#[test]
fn whoever_writes_at_the_same_time_leaves_one_set_whole() {
    let place = tempfile::tempdir().unwrap();
    for with_folder in [false, true] {
        let folder = place.path().join(format!("report-{with_folder}"));
        if with_folder {
            fs::create_dir_all(folder.join("photos")).unwrap();
        }
        std::thread::scope(|scope| {
            for content in ["a", "b", "c", "d"] {
                let folder = &folder;
                scope.spawn(move || {
                    for _ in 0..10 {
                        replace_set(folder, &set(content)).unwrap();
                    }
                });
            }
        });
        let found = contents(&folder);
        assert!(found.iter().all(|content| *content == found[0] && !content.is_empty()), "{found:?}");
        assert_eq!(names(&folder).len(), 3 + usize::from(with_folder));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_reader_sees_one_set_or_the_other() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("report");
    replace_set(&folder, &set("0")).unwrap();
    let is_done = std::sync::atomic::AtomicBool::new(false);
    let order = std::sync::atomic::Ordering::Relaxed;
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for content in 1..100 {
                replace_set(&folder, &set(&content.to_string())).unwrap();
            }
            is_done.store(true, order);
        });
        while !is_done.load(order) {
            // One handle on the folder is used, so that all names belong to one moment.
            let Ok(handle) = File::open(&folder) else { panic!("the folder is gone for a moment") };
            let through = format!("/proc/self/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&handle));
            let found = contents(Path::new(&through));
            // A set that was replaced in the meantime is being removed: its remaining files still belong to
            // one set.
            let mut kinds: Vec<&String> = found.iter().filter(|content| !content.is_empty()).collect();
            kinds.dedup();
            assert!(kinds.len() <= 1, "{found:?}");
        }
    });
}

#[cfg(unix)]
#[test]
fn a_link_in_the_folders_place_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let elsewhere = place.path().join("elsewhere");
    fs::create_dir(&elsewhere).unwrap();
    let folder = place.path().join("report");
    std::os::unix::fs::symlink(&elsewhere, &folder).unwrap();
    assert!(replace_set(&folder, &set("new")).is_err());
    assert!(names(&elsewhere).is_empty());
}
