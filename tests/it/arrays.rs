//! Samples in memory to the same result as from their file, or to the line that is missing.

use crate::run::fixture;
use dropcheck::data::{CaskFile, DropResult, HeldSamples, Samples};
use dropcheck::ingest::{self, read_arrays};

/// A fixture's samples as a program would hold them, named by their source, with its cask file.
fn held() -> (Vec<HeldSamples>, CaskFile) {
    let mut cask_file = ingest::cask_file(&fixture("anf10-plain.toml")).unwrap();
    let recording = dropcheck::read(&fixture("anf10-plain.csv"), &cask_file, &|_| ()).unwrap();
    let as_held = |channel: &dropcheck::data::Channel| {
        let Samples::F64(values) = channel.samples.clone() else { panic!("a table holds f64") };
        HeldSamples {
            name: channel.source.clone(),
            values,
            sample_rate_hz: Some(channel.sample_rate_hz),
            unit: Some("g".into()),
            times_s: None,
            start_s: channel.start_s + 7.0,
        }
    };
    // A column that the cask file names is no matter of arrays with a rate.
    cask_file.time = Some("time".into());
    (recording.channels.iter().map(as_held).collect(), cask_file)
}

/// A result without what tells a file from an array.
fn told(mut result: DropResult) -> DropResult {
    result.input.recording.clear();
    result.input.recording_sha256.clear();
    result.input.format = dropcheck::data::RecordingFormat::Samples;
    result.channels.iter_mut().for_each(|channel| channel.unit.clear());
    result.keys = serde_json::Value::Null;
    result
}

#[test]
fn samples_in_memory_give_what_their_file_gives() {
    let (held, cask_file) = held();
    let analysed = |recording| told(dropcheck::analyze(&recording, &cask_file).result);
    let of_file = analysed(
        dropcheck::read(
            &fixture("anf10-plain.csv"),
            &ingest::cask_file(&fixture("anf10-plain.toml")).unwrap(),
            &|_| (),
        )
        .unwrap(),
    );
    let of_arrays = analysed(read_arrays(&held, &cask_file).unwrap());
    assert!(of_file.slap_down.speed.is_some());
    assert_eq!(of_arrays, of_file);
    // By the names of all channels as well.
    let mut named = held.clone();
    for (held, spec) in named.iter_mut().zip(&cask_file.channels) {
        held.name.clone_from(&spec.name);
    }
    assert_eq!(analysed(read_arrays(&named, &cask_file).unwrap()), of_file);
}

#[test]
fn what_nobody_states_is_asked_for() {
    let refused = |change: &dyn Fn(&mut Vec<HeldSamples>)| {
        let (mut held, mut cask_file) = held();
        cask_file.channels.iter_mut().for_each(|spec| spec.unit = None);
        change(&mut held);
        let error = read_arrays(&held, &cask_file).unwrap_err();
        format!("{error} {}", miette::Diagnostic::help(&error).unwrap())
    };
    for (change, words) in [
        (&|held: &mut Vec<HeldSamples>| held[0].sample_rate_hz = None, "give them a rate_hz, or times_s"),
        (&|held| held[0].unit = None, "write `unit = \"g\"`"),
        (&|held| held[0].name = "other".into(), "name the samples of every channel by its `source`"),
        (&|held| held.clear(), "there is: none"),
        (&|held| held[0].values.truncate(1), "at least two are needed"),
        (&|held| held[0].times_s = Some(vec![0.0]), "each sample needs one time of its own"),
        (&|held| held[0].values.fill(f64::NAN), "holds no number"),
    ] as [(&dyn Fn(&mut Vec<HeldSamples>), &str); 7]
    {
        let said = refused(change);
        assert!(said.starts_with("samples in memory: channel") && said.contains(words), "{said}");
    }
}
