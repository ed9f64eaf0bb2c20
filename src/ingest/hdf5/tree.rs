//! What is asked about an HDF5 file to answers, whoever reads it: its groups are walked, links followed, and
//! what stands beside samples is taken along.

use super::answer::{AttributeValue, Bytes, Object, Query, Reply, Slab};
use super::names;
use crate::ingest::vocabulary;
use std::collections::{BTreeMap, HashMap};
use std::io;

/// Groups deeper than this are not followed.
const DEEPEST: usize = 32;
/// At most so many objects are walked, for the same reason.
pub(super) const MOST_OBJECTS: usize = 10_000;
/// An attribute with more values than this is none that is read.
pub(super) const MOST_VALUES: usize = 4096;
/// Larger than any rate, unit or scale.
pub(super) const MOST_BYTES: usize = 1 << 20;
/// No unit, rate or scale is longer.
pub(super) const TEXT_BYTES: usize = 256;
/// More chunks than this are the library's to find: a table of them would take as long as it spares.
pub(super) const MOST_CHUNKS: usize = 1 << 20;

/// What numbers stand for that are none.
const MATLAB_OTHER: &[u8] = b"text or cells of MATLAB";

/// No group has more datasets of one value that say something of samples.
const MOST_ONES: usize = 64;

/// Names of a group that are looked at beside its samples.
const MOST_BESIDE: usize = 256;

pub(super) const ELSEWHERE: &str = "a link into another file, which is not followed";
const UNNAMED: &str =
    "its name is not UTF-8, and the HDF5 library is asked by names in UTF-8: rename it in a copy";

const SOFT: &str = "a soft link, which is followed only where the system keeps the library from other files: \
                    name what it leads to";

/// What bears a name in a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LinkKind {
    Hard,
    Soft,
    External,
}

/// The names in a group, and what bears each.
pub(super) type Members = BTreeMap<String, LinkKind>;

/// Where answers go, one after the other.
pub(super) type Send<'a> = &'a mut dyn FnMut(Reply) -> io::Result<()>;

/// An open file, by one library or another.
pub(super) trait Store {
    /// What tells an object from all others, whatever names lead to it.
    type Token: PartialEq;

    /// Of what stands at a path.
    fn token(&mut self, path: &str) -> Option<Self::Token>;

    /// Of the group at a path; none where it cannot be read.
    fn members(&mut self, group: &str) -> Members;

    /// What stands at a path, a group without its times; or the library's words why that cannot be told.
    fn object(&mut self, path: &str) -> Result<Object, Vec<Bytes>>;

    /// What a dataset of one value holds.
    fn value(&mut self, path: &str) -> Option<AttributeValue>;

    /// Sends the numbers of a dataset, or why they cannot be read.
    fn read(&mut self, path: &str, is_wide: bool, slab: Slab, send: Send) -> io::Result<()>;
}

/// A file that is asked.
pub(super) struct Tree<S: Store> {
    store: S,
    members: HashMap<String, Members>,
    /// Whether nothing but the file can be reached.
    is_walled: bool,
    /// The groups that were walked through: links may form circles.
    walked: Vec<S::Token>,
}

impl<S: Store> Tree<S> {
    pub(super) fn of(store: S, is_walled: bool) -> Self {
        Self { store, members: HashMap::new(), is_walled, walked: Vec::new() }
    }

    /// Sends all that is asked for.
    ///
    /// # Errors
    /// Nobody listens.
    pub(super) fn answer(&mut self, request: Query, send: Send) -> io::Result<()> {
        match request {
            Query::Look(path) => {
                let object = self.object_with_values(&path);
                send(Reply::Found(path, object))?;
            }
            Query::Walk => {
                self.walked.clear();
                self.walk("", 0, &mut 0, send)?;
            }
            Query::Read { path, is_wide, slab } => self.store.read(&path, is_wide, slab, send)?,
        }
        send(Reply::Done)
    }

    /// Each group once, by the first name that is no soft link: those lead to what is walked through anyway.
    fn walk(&mut self, group: &str, depth: usize, count: &mut usize, send: Send) -> io::Result<()> {
        let token = self.store.token(if group.is_empty() { "/" } else { group });
        self.walked.extend(token);
        for (name, link) in self.members(group).clone() {
            let (path, is_hard) = (format!("{group}/{name}"), link == LinkKind::Hard);
            let token = if is_hard { self.store.token(&path) } else { None };
            if token.is_some_and(|token| self.walked.contains(&token)) {
                continue;
            }
            if *count >= MOST_OBJECTS {
                break;
            }
            *count += 1;
            let object = self.object_with_values(&path);
            let is_group = matches!(object, Object::Group { .. });
            send(Reply::Found(path.clone(), object))?;
            if is_hard && is_group && depth < DEEPEST {
                self.walk(&path, depth + 1, count, send)?;
            }
        }
        Ok(())
    }

    /// What stands at an absolute path, by way of links within the file alone.
    fn object(&mut self, path: &str) -> Object {
        let mut group = String::new();
        for name in path.split('/').filter(|name| !name.is_empty()) {
            match self.members(&group).get(name).copied() {
                None => return Object::Nothing,
                Some(LinkKind::External) => return Object::NotFollowed(ELSEWHERE.into()),
                Some(LinkKind::Soft) if !self.is_walled => return Object::NotFollowed(SOFT.into()),
                Some(_) => group = format!("{group}/{name}"),
            }
        }
        match self.store.object(path) {
            Ok(Object::Group { attributes, .. }) => {
                let is_beside = |name: &&String| {
                    names::is_time(name) || names::is_sensor(name) || vocabulary::may_count(name)
                };
                let mut times: Vec<String> = self.members(&group).keys().cloned().collect();
                times.sort_by_key(|name| !is_beside(&name));
                times.truncate(MOST_BESIDE);
                Object::Group { attributes, times }
            }
            Ok(Object::Dataset(mut told)) => {
                let is_class = |(name, _): &&(String, AttributeValue)| name == names::MATLAB_CLASS;
                if let Some((_, AttributeValue::Texts(class))) = told.attributes.iter().find(is_class)
                    && let b"char" | b"cell" = &class.concat()[..]
                {
                    (told.type_name, told.number) = (MATLAB_OTHER.to_vec(), None);
                }
                Object::Dataset(told)
            }
            Ok(object) => object,
            // The wrapper hands names over with what is no UTF-8 replaced, and nothing is found under those.
            Err(_) if path.contains(char::REPLACEMENT_CHARACTER) => Object::NotFollowed(UNNAMED.into()),
            Err(words) => Object::Broken(words),
        }
    }

    /// What stands at a path, a group with the datasets of one value in it: attributes of it, as MATLAB
    /// writes all numbers. Their own stand behind their name: `Fs_unit`.
    fn object_with_values(&mut self, path: &str) -> Object {
        let mut object = self.object(path);
        let group = path.trim_end_matches('/');
        // What MATLAB's cells hold is named by chance.
        if let Object::Group { attributes, .. } = &mut object
            && !group.ends_with("/#refs#")
        {
            let names = names::likeliest(self.members(group).keys().cloned().collect());
            for name in names.into_iter().take(MOST_ONES) {
                let path = format!("{group}/{name}");
                if let Object::Dataset(told) = self.object(&path)
                    && told.type_name != MATLAB_OTHER
                    && told
                        .shape
                        .is_some_and(|shape| shape.iter().all(|n| *n == 1) || may_be_factors(&name, &shape))
                    && let Some(held) = self.store.value(&path)
                {
                    let inner =
                        told.attributes.into_iter().map(|(inner, held)| (format!("{name}_{inner}"), held));
                    attributes.extend(inner.chain([(name.clone(), held)]));
                }
            }
        }
        object
    }

    /// The members of a group, named by its path without a slash at its end.
    fn members(&mut self, group: &str) -> &Members {
        let Self { store, members, .. } = self;
        members
            .entry(group.to_owned())
            .or_insert_with(|| store.members(if group.is_empty() { "/" } else { group }))
    }
}

/// Whether a dataset holds a factor for each of some channels: `channel_bit_volts`.
fn may_be_factors(name: &str, shape: &[usize]) -> bool {
    names::is_read(name)
        && names::role(name, 1).is_none()
        && names::rate_meaning(name).is_none()
        && shape.iter().product::<usize>() <= MOST_ONES
}

/// One value in place of several that are the same, so that nobody goes through them for every column.
pub(super) fn joined<T: PartialEq>(mut values: Vec<T>) -> Vec<T> {
    if values.windows(2).all(|two| two[0] == two[1]) {
        values.truncate(1);
    }
    values
}
