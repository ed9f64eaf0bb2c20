//! A drop made by the bench itself to the throughput of every stage, in samples a second, and of the whole.
//!
//! `cargo bench` runs all; `cargo bench -- read` those with that word in their name.

mod predictions;
mod recordings;

use divan::Bencher;
use divan::counter::ItemsCount;
use dropcheck::data::{
    Analysis, CaskFile, CoarseEvent, Corrections, Events, FlightFit, Recording, Setup, Signal,
};
use dropcheck::{ingest, report, stages};
use recordings::{Folder, Kind};

/// Samples a channel.
const SIZES: [usize; 2] = [100_000, 1_000_000];
const KINDS: [Kind; 5] = [Kind::Hdf5, Kind::Hdf5Gzip, Kind::Csv, Kind::McapJson, Kind::McapProtobuf];

fn main() {
    ingest::read_hdf5_with(std::path::Path::new(env!("CARGO_BIN_EXE_dropcheck")));
    divan::Divan::from_args().sample_count(20).main();
}

/// Samples of both channels.
fn items(samples: usize) -> ItemsCount {
    ItemsCount::new(2 * samples)
}

fn read(folder: &Folder) -> Recording {
    dropcheck::read(&folder.recording, &folder.cask_file, &|_| ()).expect("the bench's own file")
}

/// What the stages hand on, for those that start in the middle.
struct Middle {
    cask_file: CaskFile,
    recording: Recording,
    event: CoarseEvent,
    signals: Vec<Signal>,
    flight: FlightFit,
    events: Events,
    setup: Setup,
    analysis: Analysis,
}

impl Middle {
    fn new(samples: usize) -> Self {
        let folder = Folder::with(Kind::Hdf5, samples);
        let recording = read(&folder);
        let cask_file = folder.cask_file.clone();
        let analysis = dropcheck::analyze(&recording, &cask_file);
        let event = stages::Changes::new(&recording.channels)
            .locate(cask_file.drop.transverse_velocity_m_s())
            .expect("an impact");
        let (signals, _) = stages::condition(
            &recording,
            &event,
            &stages::Reach::for_drop(&cask_file.cask, &cask_file.drop),
            cask_file.corrections,
        );
        let setup = stages::sticking(&cask_file);
        let flight = analysis.result.flight.clone().expect("a flight");
        let events = analysis.result.events;
        Self { cask_file, recording, event, signals, flight, events, setup, analysis }
    }

    fn integrated(&self) -> stages::Integrated<'_> {
        stages::Integrated::new(&self.signals, self.events.first_contact_s().expect("a contact"))
    }

    fn window(&self) -> stages::Window {
        stages::Window {
            from_s: self.flight.from_s,
            to_s: self.flight.to_s,
            drift: true,
            angular_velocity_rad_s: 5.0,
        }
    }

    fn conditioned(&self) -> ItemsCount {
        ItemsCount::new(self.signals.iter().map(|s| s.force_m_s2.len()).sum::<usize>())
    }
}

#[divan::bench(args = KINDS, consts = SIZES)]
fn read_format<const N: usize>(bencher: Bencher, kind: Kind) {
    let folder = Folder::with(kind, N);
    bencher.counter(items(N)).bench(|| read(&folder));
}

#[divan::bench(args = SIZES)]
fn locate(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    bencher.counter(items(samples)).bench(|| {
        stages::Changes::new(&m.recording.channels).locate(m.cask_file.drop.transverse_velocity_m_s())
    });
}

#[divan::bench(args = SIZES)]
fn condition_channels(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    let reach = stages::Reach::for_drop(&m.analysis.cask_file.cask, &m.analysis.cask_file.drop);
    bencher
        .counter(items(samples))
        .bench(|| stages::condition(&m.recording, &m.event, &reach, Corrections::default()));
}

#[divan::bench(args = SIZES)]
fn low_pass(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    bencher.counter(m.conditioned()).bench(|| stages::filter(&m.signals, 299.0));
}

#[divan::bench(args = SIZES)]
fn integrate(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    bencher.counter(m.conditioned()).bench(|| m.integrated());
}

#[divan::bench(args = SIZES)]
fn flight_fit(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    let integrated = m.integrated();
    bencher
        .counter(m.conditioned())
        .bench(|| stages::fit_flights(&integrated, &m.window(), None, m.cask_file.cask.cog_m, 3));
}

#[divan::bench(args = SIZES)]
fn reconstruct(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    let integrated = m.integrated();
    bencher
        .counter(m.conditioned())
        .bench(|| stages::reconstruct(&integrated, &m.flight, &m.events, &m.setup).expect("a motion"));
}

#[divan::bench(args = SIZES)]
fn quantities(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    let measured = stages::FitData {
        signals: &m.signals,
        flight: &m.flight,
        events: &m.events,
        setup: &m.setup,
        friction: None,
        specs: &[],
        tolerances: dropcheck::data::Tolerances::default(),
        inertia_m2: Some(2.58),
        rests: &[],
        fall_s: None,
        rotations: &[],
        stood_in: None,
        second: None,
    };
    let integrated = m.integrated();
    bencher.counter(m.conditioned()).bench(|| {
        let moved = |flight: &_, events: &_, setup: &_| stages::outcome(&integrated, flight, events, setup);
        stages::run_methods(&measured, &moved).expect("quantities")
    });
}

#[divan::bench(args = SIZES)]
fn analyze_after_reading(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    bencher.counter(items(samples)).bench(|| dropcheck::analyze(&m.recording, &m.cask_file));
}

#[divan::bench(args = SIZES, sample_count = 5)]
fn report_files(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    bencher.counter(items(samples)).bench(|| report::files(&m.analysis).expect("a report"));
}

#[divan::bench(args = SIZES)]
fn report_table_and_json(bencher: Bencher, samples: usize) {
    let m = Middle::new(samples);
    bencher.counter(items(samples)).bench(|| {
        (report::table(&m.analysis, 80), report::pretty_json(&m.analysis.result).expect("a result"))
    });
}

#[divan::bench(args = KINDS, consts = SIZES, sample_count = 5)]
fn whole<const N: usize>(bencher: Bencher, kind: Kind) {
    let folder = Folder::with(kind, N);
    bencher.counter(items(N)).bench(|| {
        let analysis = dropcheck::analyze(&read(&folder), &folder.cask_file);
        report::files(&analysis).expect("a report")
    });
}
