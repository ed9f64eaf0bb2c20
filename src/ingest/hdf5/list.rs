//! An HDF5 file to the list of its datasets and columns, each as reading would take it.

use super::account::Account;
use super::answer::Object;
use super::channel::{self, Based, DatasetChannel};
use super::column::DatasetColumn;
use super::fault;
use super::find;
use super::room::File;
use super::sensors::RecordSensors;
use crate::data::{
    AttributeFinding, ChannelSpec, ClockFinding, End, Finding, ListedChannel, Listing, RecordingFormat,
    RowsOf,
};
use crate::ingest::listed::count_from_first;
use crate::ingest::refusal::Refusal;
use crate::ingest::{IngestError, Progress, ReadRequest};
use crate::numerics::as_f64;
use std::collections::BTreeMap;
use std::rc::Rc;

/// So many channels are listed at most.
const MOST_CHANNELS: usize = 10_000;
/// So many values are read in all: names may stand for one large dataset many times over.
const MOST_VALUES: u64 = 1 << 30;

const UNGUARDED: &str = ", which this system keeps from no other file or call: read files of strangers \
                         elsewhere (docs/dependencies.md)";

/// What links are to what is not there or not followed; they stand behind the channels.
const BROKEN: &str = "link";

/// A list as it grows, and what it costs.
struct Lister {
    account: Account,
    listing: Listing,
}

/// Lists what an HDF5 file holds.
///
/// # Errors
/// A file that the library cannot open.
pub(in super::super) fn list(request: ReadRequest) -> Result<Listing, IngestError> {
    let file = File::open(request.file, request.limits)?;
    let listing = list_objects(&file, request.progress);
    file.whole().map(|()| listing)
}

fn list_objects(file: &Rc<File>, progress: Progress) -> Listing {
    let guard = if file.opened.is_walled { "" } else { UNGUARDED };
    let listing = Listing {
        counts: BTreeMap::from(["groups", "datasets"].map(|counted| (counted.to_owned(), 0))),
        facts: BTreeMap::from([("read with".into(), format!("{}{guard}", file.opened.library))]),
        ..Listing::new(&file.path, file.bytes, RecordingFormat::Hdf5)
    };
    // No number takes fewer than four bytes once it is unpacked and turned.
    let most_values = MOST_VALUES.min(file.limits.unpacked_bytes(file.bytes) / 4);
    let mut lister = Lister { account: Account::for_listing(most_values), listing };
    let objects = file.walk();
    for (number, (path, object)) in objects.iter().enumerate() {
        lister.add(file, path, object);
        progress(as_f64(number + 1) / as_f64(objects.len()));
    }
    if let Err(fault) = lister.account.require_common_start() {
        lister.listing.issues.push(ClockFinding::Refused(fault.beside("")).into());
    }
    let mut listing = lister.listing;
    listing.channels.sort_by_key(|listed| listed.kind == BROKEN);
    count_from_first(&mut listing);
    listing
}

impl Lister {
    fn add(&mut self, file: &Rc<File>, path: &str, object: &Object) {
        let unread = |kind, reason: &str| ListedChannel {
            unreadable: Some(reason.to_owned()),
            ..ListedChannel::new(path, kind)
        };
        match object {
            Object::Group { .. } => self.count("groups"),
            Object::Dataset(dataset) => {
                self.count("datasets");
                if self.listing.channels.len() >= MOST_CHANNELS {
                    return;
                }
                match find::channels(file, dataset, path, find::MOST_LISTED) {
                    Ok(channels) => channels.iter().for_each(|column| self.list(column)),
                    Err(fault) => self.listing.channels.push(ListedChannel {
                        encoding: dataset.described(),
                        ..unread("dataset", &why_unreadable(fault))
                    }),
                }
            }
            Object::NamedType | Object::Nothing => {}
            Object::NotFollowed(what) => self.listing.channels.push(unread(BROKEN, what)),
            Object::Broken(words) => {
                const NOTHING: &str = "a link to what is not there, or what the HDF5 library cannot open";
                let meaning = fault::meaning(words);
                let reason = meaning.as_ref().map_or(NOTHING, |fault| &fault.problem);
                self.listing.channels.push(unread(BROKEN, reason));
            }
        }
    }

    fn count(&mut self, counted: &str) {
        *self.listing.counts.entry(counted.to_owned()).or_default() += 1;
    }

    fn list(&mut self, column: &DatasetColumn) {
        let sensors = channel::sensors_of(column, None, &mut self.account).ok().flatten();
        let all = sensors.iter().flat_map(|sensors| sensors.all.iter().cloned().map(Some));
        let all: Vec<Option<RowsOf>> = if sensors.is_some() { all.collect() } else { vec![None] };
        for rows in all {
            let mut listed = ListedChannel {
                rows,
                samples: Some(column.length as u64),
                encoding: column.dataset.described(),
                ..ListedChannel::new(&column.source, column.kind_name())
            };
            if let Err(fault) = self.fill(column.clone(), sensors.as_ref(), &mut listed) {
                listed.unreadable = Some(why_unreadable(fault));
            }
            self.listing.channels.push(listed);
        }
    }

    /// What reading would take of a column into `listed`; where it would refuse the clock, the refusal stands
    /// in its place.
    fn fill(
        &mut self,
        column: DatasetColumn,
        sensors: Option<&RecordSensors>,
        listed: &mut ListedChannel,
    ) -> Result<(), Refusal> {
        let (source, account) = (&listed.source.clone(), &mut self.account);
        let spec = ChannelSpec { rows: listed.rows.clone(), ..ChannelSpec::new("", End::First, source, 0.0) };
        let channel = match DatasetChannel::of(column, &spec, None, sensors, account) {
            Ok(channel) => channel,
            // What holds one value is no channel.
            Err(_) if listed.samples == Some(1) => return Ok(()),
            Err(fault) => {
                self.doubt(source, &fault, AttributeFinding::Refused);
                return Ok(());
            }
        };
        let DatasetChannel { column, attributes, claims, times, .. } = &channel;
        listed.encoding += &attributes.scaling();
        listed.unit.clone_from(&attributes.unit);
        let has_room = [column].into_iter().chain(times.first()).all(|it| account.has_for_a_while(it));
        if let Some(two) = &attributes.two_units {
            self.doubt(source, &two.clone().at(source), AttributeFinding::Refused);
        }
        self.listing.issues.extend(attributes.issues.iter().map(|issue| issue.clone().tag(source)));
        if !has_room {
            listed.sample_rate_hz = claims.stated.first().map(|stated| stated.rate_hz);
            return Ok(());
        }
        let samples = channel.samples()?;
        let count = samples.len();
        let values = (0..count).map(|i| samples.get(i));
        (listed.range, listed.samples) = (ListedChannel::value_range(values), Some(count as u64));
        if channel.has_no_clock() || count < 2 {
            return Ok(());
        }
        match channel.on_base(samples, &mut self.account) {
            Err(fault) => self.doubt(source, &fault, ClockFinding::Refused),
            Ok(Based { uniform, start }) => {
                uniform.list(listed);
                self.account.begin(source, start);
                self.listing.issues.extend(uniform.issues.into_iter().map(|issue| issue.tag(source)));
            }
        }
        Ok(())
    }

    /// That reading would refuse a channel, in its words.
    fn doubt<F: Into<Finding>>(&mut self, source: &str, fault: &Refusal, refused: fn(String) -> F) {
        let found: Finding = refused(fault.beside(source)).into();
        self.listing.issues.push(found.tag(source));
    }
}

/// The problem of what the list names, and the command that cures it where there is one.
fn why_unreadable(Refusal { problem, remedy, .. }: Refusal) -> String {
    let is_command = find::COMMANDS.iter().any(|command| remedy.ends_with(command));
    if is_command { format!("{problem}: {remedy}") } else { problem }
}
