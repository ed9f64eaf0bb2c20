//! From a result alone to the same result again, and to what differs.

use crate::command_line::at_fault;
use crate::run::{dropcheck, fixture};
use std::fs;
use std::path::Path;

#[test]
fn a_result_alone_gives_the_same_result_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (recording, cask) = (fixture("vhlw-rest.h5"), fixture("vhlw-rest.toml"));
    let (first, second) = (folder.path().join("first.json"), folder.path().join("second.json"));
    let with = |more: [&std::ffi::OsStr; 4], json: &Path| {
        let words = ["analyze".as_ref(), recording.as_os_str(), "--json".as_ref(), json.as_os_str()];
        dropcheck(words.into_iter().chain(more.into_iter().filter(|word| !word.is_empty())))
    };
    with(["--cask".as_ref(), cask.as_os_str(), "--without".as_ref(), "hum".as_ref()], &first);
    let answer = with(["--from".as_ref(), first.as_os_str(), "".as_ref(), "".as_ref()], &second);
    assert!(answer.stdout.contains("The same as"), "{}", answer.stdout);
    let [before, after] = [&first, &second].map(|path| fs::read(path).expect("a result"));
    assert!(before == after, "not to the byte");
    let result: serde_json::Value = serde_json::from_slice(&before).expect("JSON");
    let text = fs::read_to_string(&cask).expect("a cask file");
    assert_eq!(result["cask_text"], text.as_str());
    assert_eq!(result["analysed"], "1970-01-01T00:00:00Z");
    assert_eq!(result["program"]["name"], "dropcheck");
    // Every key is there as a number or a text, and says where it is from.
    let settings = &result["settings"];
    assert_eq!(settings["drop"]["angle_deg"], serde_json::json!({"value": 15.0, "from": "stated"}));
    assert_eq!(settings["tolerance"]["angle_deg"], serde_json::json!({"value": 0.4, "from": "default"}));
    assert_eq!(settings["channel"][0]["sample_rate_hz"]["from"], "recording");
    for (name, table) in settings.as_object().expect("tables").iter().filter(|(name, _)| *name != "channel") {
        for (key, entry) in table.as_object().expect("keys") {
            assert!(entry.get("value").is_some() && entry["from"].is_string(), "{name}.{key}");
        }
    }
    // What is changed is said.
    let changed = String::from_utf8(before).expect("UTF-8").replace("angle_deg = 15", "angle_deg = 16");
    fs::write(&first, changed).expect("a file");
    let answer = with(["--from".as_ref(), first.as_os_str(), "".as_ref(), "".as_ref()], &second);
    assert!(
        answer.stdout.contains("settings.drop.angle_deg.value: 15.0 before, 16.0 now"),
        "{}",
        answer.stdout
    );
    at_fault(&with(["--from".as_ref(), cask.as_os_str(), "".as_ref(), "".as_ref()], &second), &["not JSON"]);
}
