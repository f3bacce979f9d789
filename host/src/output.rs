//! What the program says: lines on standard output (`say!`) and on standard error (`tell!`).
//!
//! Either can break: the reader of a pipe goes, a disk is full, a file reaches its limit. `println!` and `eprintln!`
//! panic then, and leave a drive that moves. Here the first failure of each is kept, and what would follow on the same
//! one is dropped. Work that leaves files goes on; whoever moves a drive asks [`is_broken`] and stops it; and [`end`]
//! gives the program's exit code.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;

use crate::exit::Exit;

/// A line on standard output: what was asked for.
macro_rules! say {
    ($($argument:tt)*) => {
        $crate::output::Stream::Output.line(format_args!($($argument)*))
    };
}

/// A line on standard error: notes, progress, errors.
macro_rules! tell {
    ($($argument:tt)*) => {
        $crate::output::Stream::Errors.line(format_args!($($argument)*))
    };
}

/// Tells the notes of this project's crates, which they leave to the log.
struct Notes;

impl log::Log for Notes {
    fn enabled(&self, about: &log::Metadata<'_>) -> bool {
        about.target().starts_with("pneudrive")
    }

    fn log(&self, note: &log::Record<'_>) {
        if self.enabled(note.metadata()) {
            tell!("note: {}", note.args());
        }
    }

    fn flush(&self) {}
}

/// Has notes told from now on.
pub fn report_notes() {
    static NOTES: Notes = Notes;
    // Whoever uses this crate as a library may have a log already: the notes go there.
    if log::set_logger(&NOTES).is_ok() {
        log::set_max_level(log::LevelFilter::Info);
    }
}

/// Where a line goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// Standard output.
    Output,
    /// Standard error.
    Errors,
}

/// Both.
const STREAMS: [Stream; 2] = [Stream::Output, Stream::Errors];

/// The first failure of each.
static BROKEN: [OnceLock<io::Error>; 2] = [const { OnceLock::new() }; 2];

impl Stream {
    /// Writes a line in one piece, unless an earlier one was not taken.
    pub fn line(self, line: Arguments<'_>) {
        if self.failure().is_none() {
            self.note(self.write(format!("{line}\n").as_bytes()));
        }
    }

    /// Writes bytes, and tells whether they were taken.
    ///
    /// # Errors
    /// Why they were not.
    pub fn write(self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Stream::Output => {
                let mut output = io::stdout().lock();
                output.write_all(bytes).and_then(|()| output.flush())
            }
            Stream::Errors => io::stderr().lock().write_all(bytes),
        }
    }

    /// Keeps the first failure.
    pub fn note(self, written: io::Result<()>) {
        if let Err(error) = written {
            let _ = BROKEN[self as usize].set(error);
        }
    }

    /// Its first failure.
    #[must_use]
    pub fn failure(self) -> Option<&'static io::Error> {
        BROKEN[self as usize].get()
    }

    fn name(self) -> &'static str {
        match self {
            Stream::Output => "standard output",
            Stream::Errors => "standard error",
        }
    }

    /// Notes that the reader of a pipe has gone, or a terminal has been closed, before anything is written.
    #[cfg(unix)]
    fn look(self) {
        use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
        use std::os::fd::AsFd;
        let (output, errors) = (io::stdout(), io::stderr());
        let descriptor = if self == Stream::Output { output.as_fd() } else { errors.as_fd() };
        // Asked for nothing, the system tells of errors alone.
        let mut polled = [PollFd::new(descriptor, PollFlags::empty())];
        if poll(&mut polled, PollTimeout::ZERO).is_ok_and(|count| count > 0) {
            self.note(Err(ErrorKind::BrokenPipe.into()));
        }
    }

    #[cfg(not(unix))]
    fn look(self) {}
}

/// Whether something that was said did not arrive, or nobody is left to read what will be.
#[must_use]
pub fn is_broken() -> bool {
    STREAMS.into_iter().any(|stream| {
        stream.look();
        stream.failure().is_some()
    })
}

/// How what was said ends the program: a reader that has gone is no failure to tell of, a full disk is.
#[must_use]
pub fn verdict() -> Exit {
    let failures = || STREAMS.into_iter().filter_map(Stream::failure);
    match failures().next() {
        None => Exit::Done,
        Some(_) if failures().all(|error| error.kind() == ErrorKind::BrokenPipe) => Exit::ReaderGone,
        Some(_) => Exit::Unwritten,
    }
}

/// The end of the program: tells of either stream that could not be written on the other one. The code is that of
/// `exit`, or, if all else went well, that of the output.
#[must_use]
pub fn end(exit: Exit) -> Exit {
    for (stream, other) in [(Stream::Output, Stream::Errors), (Stream::Errors, Stream::Output)] {
        if let Some(error) = stream.failure().filter(|error| error.kind() != ErrorKind::BrokenPipe) {
            other.line(format_args!("error: cannot write to {}: {error}", stream.name()));
        }
    }
    if exit == Exit::Done { verdict() } else { exit }
}
