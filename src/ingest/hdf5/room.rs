//! An HDF5 file to what stands in it, by way of a process that holds the C library and can do nothing else.
//!
//! The library crashes, loops and takes memory without bound on files that are damaged or made to do harm.
//! Where it does, that process ends, and the recording is refused; this one goes on.

#[cfg(any(test, fuzzing))]
mod thread_tests;

#[cfg(any(test, fuzzing))]
pub(in crate::ingest) use thread_tests::answer_by;

use super::super::error::IngestError;
use super::answer::{Object, Query, Reply, Slab, receive, send};
use super::fault;
use super::patience::{PATIENCE, ProcessEnd, Watched};
#[cfg(any(not(feature = "native"), test, fuzzing))]
use super::{answer::frame_bytes, pure, tree::Tree};
use crate::data::Samples;
use crate::ingest::refusal::Refusal;
use crate::ingest::{Limits, RecordingFile};
use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashMap;
#[cfg(any(not(feature = "native"), test, fuzzing))]
use std::collections::VecDeque;
use std::ffi::OsString;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::rc::Rc;
use std::sync::{Arc, OnceLock};

/// The word by which this program is started to take a file apart.
pub(super) const WORD: &str = "__hdf5";

/// The variable by which the C library loads no code at all, whatever filter a file names.
pub(super) const NO_PLUGINS: (&str, &str) = ("HDF5_PLUGIN_PRELOAD", "::");

/// All that is noted of a file. Ten thousand datasets with their attributes take 5 MB.
const MOST_NOTED_BYTES: usize = 128 << 20;

/// How the process is started that takes HDF5 files apart.
#[derive(Debug, Clone, Default)]
pub struct Hdf5Program {
    /// The program.
    pub path: PathBuf,
    /// Its words before `__hdf5` and the recording.
    pub words: Vec<OsString>,
    /// Variables that it needs in an environment that is else empty, such as the places of its libraries.
    pub variables: Vec<(OsString, OsString)>,
}

static PROGRAM: OnceLock<Hdf5Program> = OnceLock::new();

/// Names the program that takes HDF5 files apart when started with its own words and `__hdf5`, which then
/// calls [`crate::ingest::take_hdf5_apart`]; the first name stays.
pub fn use_program(program: Hdf5Program) {
    let _ = PROGRAM.set(program);
}

/// An open file, and what is known of it.
pub(super) struct File {
    pub path: PathBuf,
    /// All of it, where it is not on disk.
    pub in_memory: Option<Arc<[u8]>>,
    pub bytes: u64,
    pub opened: Opened,
    pub limits: Limits,
    link: RefCell<Link>,
    known: RefCell<HashMap<String, Rc<Object>>>,
    noted_bytes: Cell<usize>,
    /// Why no more can be had from it.
    lost: OnceCell<Refusal>,
}

impl File {
    /// Opens the file.
    ///
    /// # Errors
    /// The library does not open it.
    pub(super) fn open<'a>(
        file: impl Into<RecordingFile<'a>>,
        limits: Limits,
    ) -> Result<Rc<Self>, IngestError> {
        let file = file.into();
        let bytes = file.length().unwrap_or(0);
        let (link, opened) =
            Link::opened(file).map_err(|refusal| fault::of_file(file.path, bytes, refusal))?;
        Ok(Rc::new(Self {
            path: file.path.to_owned(),
            in_memory: file.in_memory.cloned(),
            bytes,
            opened,
            limits,
            link: RefCell::new(link),
            known: RefCell::default(),
            noted_bytes: Cell::new(0),
            lost: OnceCell::new(),
        }))
    }

    /// Whether all that was asked was answered.
    ///
    /// # Errors
    /// The library broke off.
    pub(super) fn whole(&self) -> Result<(), IngestError> {
        self.lost.get().map_or(Ok(()), |lost| Err(fault::of_file(&self.path, self.bytes, lost.clone())))
    }

    /// What stands at an absolute path.
    pub(super) fn object(&self, path: &str) -> Rc<Object> {
        let known = || self.known.borrow().get(path).cloned();
        known()
            .or_else(|| {
                self.ask(Query::Look(path.to_owned()));
                self.note();
                known()
            })
            .unwrap_or_else(|| Rc::new(Object::Nothing))
    }

    /// Everything in the file, by path, in its order.
    pub(super) fn walk(&self) -> Vec<(String, Rc<Object>)> {
        self.ask(Query::Walk);
        self.note()
    }

    /// `count` numbers of a dataset, turned into f64 or f32 by the library.
    pub(super) fn values(
        &self,
        path: &str,
        slab: Slab,
        count: usize,
        is_wide: bool,
    ) -> Result<Samples, Refusal> {
        self.ask(Query::Read { path: path.to_owned(), is_wide, slab });
        let mut samples = if is_wide { Samples::F64(Vec::new()) } else { Samples::F32(Vec::new()) };
        while self.lost.get().is_none() {
            self.link.borrow().wait_for(count.saturating_mul(8) as u64);
            let answer = self.link.borrow_mut().answer();
            let left = count - samples.len();
            match (answer.map(|(answer, _)| answer), &mut samples) {
                (Ok(Reply::Narrow(more)), Samples::F32(held)) if more.len() <= left => held.extend(more),
                (Ok(Reply::Wide(more)), Samples::F64(held)) if more.len() <= left => held.extend(more),
                (Ok(Reply::Refused(words)), _) => {
                    self.note();
                    return Err(fault::of_words(&words).at(path));
                }
                (Ok(Reply::Done), _) if left == 0 => return Ok(samples),
                _ => {
                    self.lose();
                }
            }
        }
        Err(self.lose().clone())
    }

    fn ask(&self, request: Query) {
        if self.lost.get().is_none() && self.link.borrow_mut().ask(request).is_err() {
            self.lose();
        }
    }

    /// Takes down what is found until all of a request is answered.
    fn note(&self) -> Vec<(String, Rc<Object>)> {
        let mut found = Vec::new();
        while self.lost.get().is_none() {
            let answer = self.link.borrow_mut().answer();
            match answer {
                Ok((Reply::Done, _)) => break,
                Ok((Reply::Found(path, object), bytes)) if self.has_room_for(bytes) => {
                    let sane = match object {
                        Object::Dataset(told) if !told.is_sane(self.bytes) => Object::NotFollowed(
                            "a dataset whose parts contradict each other: it is damaged".into(),
                        ),
                        object => object,
                    };
                    let object = Rc::new(sane);
                    self.known.borrow_mut().insert(path.clone(), Rc::clone(&object));
                    found.push((path, object));
                }
                _ => {
                    self.lose();
                }
            }
        }
        found
    }

    fn has_room_for(&self, bytes: usize) -> bool {
        let noted_bytes = self.noted_bytes.get().saturating_add(bytes);
        self.noted_bytes.set(noted_bytes);
        noted_bytes <= MOST_NOTED_BYTES
    }

    fn lose(&self) -> &Refusal {
        self.lost.get_or_init(|| self.link.borrow_mut().end())
    }
}

/// What was said of a file when it was opened.
pub(super) struct Opened {
    /// Bytes before its beginning.
    pub user_block: u64,
    /// The library and its version.
    pub library: String,
    /// Whether the system keeps the process from every other file.
    pub is_walled: bool,
}

/// The way to the library and back.
struct Link {
    ask: Box<dyn FnMut(Query) -> io::Result<()>>,
    /// The next answer, and its length in bytes.
    answer: Box<dyn FnMut() -> io::Result<(Reply, usize)>>,
    process: Option<Watched>,
}

impl Link {
    /// To another process or thread, in frames.
    fn by_frames(
        mut to: impl Write + 'static,
        mut from: impl Read + 'static,
        process: Option<Watched>,
    ) -> Self {
        let ask = move |query: Query| {
            send(&mut to, &query)?;
            to.flush()
        };
        Self { ask: Box::new(ask), answer: Box::new(move || receive(&mut from)), process }
    }

    /// To what answers at once.
    #[cfg(any(not(feature = "native"), test, fuzzing))]
    fn on_the_spot(mut tree: Tree<pure::InMemory>) -> Self {
        let answers = Rc::new(RefCell::new(VecDeque::new()));
        let unheard = answers.clone();
        let ask = move |query| {
            tree.answer(query, &mut |reply| {
                answers.borrow_mut().push_back(reply);
                Ok(())
            })
        };
        let answer = move || {
            let reply: Reply = unheard.borrow_mut().pop_front().ok_or(io::ErrorKind::UnexpectedEof)?;
            let bytes = if let Reply::Found(..) = &reply { frame_bytes(&reply)? } else { 0 };
            Ok((reply, bytes))
        };
        Self { ask: Box::new(ask), answer: Box::new(answer), process: None }
    }

    fn opened(file: RecordingFile) -> Result<(Self, Opened), Refusal> {
        #[cfg(any(not(feature = "native"), test, fuzzing))]
        if let Some(bytes) = file.in_memory {
            let (store, user_block) = pure::opened(bytes).map_err(|words| fault::of_words(&words))?;
            let opened = Opened { user_block, library: pure::READER.into(), is_walled: true };
            return Ok((Self::on_the_spot(Tree::of(store, true)), opened));
        }
        // The tests of this library are no program that could be started.
        #[cfg(any(test, fuzzing))]
        let link = thread_tests::link(file.path);
        #[cfg(not(any(test, fuzzing)))]
        let link = Self::by_process(file.path);
        let mut link = link.map_err(|refusal| unstarted(&refusal))?;
        match link.answer() {
            Ok((Reply::Opened { user_block, library: (major, minor, patch), is_walled }, _)) => {
                let library = format!("HDF5 library {major}.{minor}.{patch}");
                Ok((link, Opened { user_block, library, is_walled }))
            }
            Ok((Reply::Refused(words), _)) => Err(fault::of_words(&words)),
            _ => Err(link.end_before_answer()),
        }
    }

    fn ask(&mut self, request: Query) -> io::Result<()> {
        self.wait_for(0);
        (self.ask)(request)
    }

    /// An answer and its length in bytes.
    fn answer(&mut self) -> io::Result<(Reply, usize)> {
        let answer = (self.answer)()?;
        match (&self.process, &answer.0) {
            (Some(process), Reply::Done | Reply::Opened { .. }) => process.rest(),
            _ => self.wait_for(0),
        }
        Ok(answer)
    }

    /// The other side may be silent for as long as reading `bytes` takes.
    fn wait_for(&self, bytes: u64) {
        if let Some(process) = &self.process {
            process.wait_for(bytes);
        }
    }

    /// As [`Self::end`] where there was no answer at all: the library breaks off by a signal, a program that
    /// is none for it by a status.
    fn end_before_answer(&mut self) -> Refusal {
        match self.process.take().map(Watched::end) {
            Some(ProcessEnd::With(status)) if status.code().is_some_and(|code| code != 0) => {
                unstarted(&io::Error::other(format!("{status}")))
            }
            ended => Self::fault(ended.as_ref()),
        }
    }

    /// Ends the process and says why it could not go on.
    fn end(&mut self) -> Refusal {
        Self::fault(self.process.take().map(Watched::end).as_ref())
    }

    fn fault(ended: Option<&ProcessEnd>) -> Refusal {
        let problem = match ended {
            Some(ProcessEnd::Silent) => format!("gave no sign of life for {} s", PATIENCE.as_secs()),
            Some(ProcessEnd::With(status)) => ending(*status),
            Some(ProcessEnd::ByReader) | None => "gave no answer that can be read".into(),
        };
        Refusal::new(
            format!("the HDF5 library {problem}: the file is damaged, or made to do harm"),
            "copy it from the logger again; if it is sound, `h5repack IN OUT` writes it anew",
        )
    }

    #[cfg_attr(any(test, fuzzing), allow(dead_code, reason = "tests have the library on a thread"))]
    fn by_process(path: &Path) -> io::Result<Self> {
        let program = PROGRAM.get().ok_or(io::ErrorKind::NotFound)?;
        let mut command = Command::new(&program.path);
        // No plugin path, no other driver or connector; and plugins that lie in the usual folder are off too.
        let path = if cfg!(unix) { path.canonicalize()? } else { std::path::absolute(path)? };
        command.args(&program.words).arg(WORD).arg(path);
        command.env_clear().envs(program.variables.iter().cloned()).env(NO_PLUGINS.0, NO_PLUGINS.1);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        #[cfg(unix)]
        command.current_dir("/");
        #[cfg(windows)]
        {
            /// No window of its own beside that of a program without a console (`winbase.h`).
            const CREATE_NO_WINDOW: u32 = 0x0800_0000;
            std::os::windows::process::CommandExt::creation_flags(&mut command, CREATE_NO_WINDOW);
            // Libraries of the system look for others there.
            command.envs(std::env::var_os("SystemRoot").map(|root| ("SystemRoot", root)));
        }
        let mut child = command.spawn()?;
        let pipes = child.stdin.take().zip(child.stdout.take()).ok_or(io::ErrorKind::BrokenPipe)?;
        let (to, from) = (BufWriter::new(pipes.0), BufReader::with_capacity(1 << 16, pipes.1));
        Ok(Self::by_frames(to, from, Some(Watched::of(child))))
    }
}

fn unstarted(refusal: &io::Error) -> Refusal {
    let what = match PROGRAM.get() {
        Some(program) => {
            let why = crate::ingest::shown::os_text(refusal);
            format!("{} could not be started for it: {why}", program.path.display())
        }
        None => "no program was named for it".into(),
    };
    Refusal::new(
        format!("HDF5 is read by a process of its own, and {what}"),
        "a program that uses this library names it: dropcheck::read_hdf5_with(program), in Python \
         dropcheck.read_hdf5_with(python)",
    )
}

/// How the process ended, after "the HDF5 library".
fn ending(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        use rustix::process::Signal;
        let took_too_long = [Signal::XCPU.as_raw(), Signal::KILL.as_raw()].contains(&signal);
        return if took_too_long {
            "took more processor time or memory than reading it can need and was stopped".into()
        } else {
            format!("broke off in it (signal {signal})")
        };
    }
    match status.code() {
        Some(0) | None => "ended before it had answered".into(),
        Some(code) => format!("broke off in it (status {code})"),
    }
}
