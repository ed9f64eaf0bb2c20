//! The library on a thread, without a wall, in place of the process that unit tests cannot start; or stored
//! answers in place of both.

use super::super::library;
use super::Link;
use std::cell::Cell;
use std::io::{self, BufReader, BufWriter};
use std::path::Path;

thread_local!(static ANSWERS: Cell<Option<Vec<u8>>> = const { Cell::new(None) });

/// The next file that is opened on this thread is answered for by these bytes.
pub(in crate::ingest) fn answer_by(bytes: &[u8]) {
    ANSWERS.set(Some(bytes.to_vec()));
}

pub(super) fn link(path: &Path) -> io::Result<Link> {
    if let Some(from) = ANSWERS.take() {
        return Ok(Link::by_frames(io::sink(), io::Cursor::new(from), None));
    }
    let ((mut requests, to), (from, mut answers)) = (io::pipe()?, io::pipe()?);
    let path = path.to_owned();
    std::thread::spawn(move || library::answer(&path, &mut requests, &mut answers, true, &mut |_, _| {}));
    Ok(Link::by_frames(BufWriter::new(to), BufReader::new(from), None))
}
