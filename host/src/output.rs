//! The output of the program: lines on standard output (`say!`) and on standard error (`tell!`).
//!
//! Either can fail: the reader of a pipe exits, a disk is full, a file reaches its limit. `println!` and `eprintln!`
//! would panic then and leave a drive moving. Here the first failure of each stream is kept, and later lines on the same
//! stream are dropped. Work that writes files continues; code that moves a drive asks [`is_broken`] and stops it; and
//! [`end`] gives the program's exit code.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::Exit;

/// A line on standard output: results.
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

/// Prints the notes that this project's crates write to the log.
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

/// Prints notes from now on.
pub fn report_notes() {
    static NOTES: Notes = Notes;
    // A program that uses this crate as a library may have its own logger: the notes go there.
    if log::set_logger(&NOTES).is_ok() {
        log::set_max_level(log::LevelFilter::Info);
    }
}

/// An output stream.
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

/// Whether standard output is for a document, and text is left out of it.
static IS_WITHOUT_TEXT: AtomicBool = AtomicBool::new(false);

/// Leaves lines of text out of standard output from now on: a document stands there.
pub fn leave_text_out() {
    IS_WITHOUT_TEXT.store(true, Ordering::Relaxed);
}

impl Stream {
    /// Writes a line in one piece, unless an earlier write has failed, or text is left out.
    pub fn line(self, line: Arguments<'_>) {
        let is_left_out = self == Stream::Output && IS_WITHOUT_TEXT.load(Ordering::Relaxed);
        if !is_left_out && self.failure().is_none() {
            self.note(self.write(format!("{line}\n").as_bytes()));
        }
    }

    /// Writes bytes.
    ///
    /// # Errors
    /// When the stream does not accept them.
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

    /// Detects that the reader of a pipe has exited, or a terminal was closed, without writing anything.
    #[cfg(unix)]
    fn look(self) {
        use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
        use std::os::fd::AsFd;
        let (output, errors) = (io::stdout(), io::stderr());
        let descriptor = if self == Stream::Output { output.as_fd() } else { errors.as_fd() };
        // With no events requested, the system reports only errors.
        let mut polled = [PollFd::new(descriptor, PollFlags::empty())];
        if poll(&mut polled, PollTimeout::ZERO).is_ok_and(|count| count > 0) {
            self.note(Err(ErrorKind::BrokenPipe.into()));
        }
    }

    #[cfg(not(unix))]
    fn look(self) {}
}

/// Whether a write has failed, or nobody is left to read the next one.
#[must_use]
pub fn is_broken() -> bool {
    STREAMS.into_iter().any(|stream| {
        stream.look();
        stream.failure().is_some()
    })
}

/// Whether a terminal takes escape codes: TERM=dumb says that it does not, NO_COLOR that nobody wants them.
#[must_use]
pub fn takes_escapes() -> bool {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !is_set("NO_COLOR") && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// The exit code that the output calls for: a reader that has gone is not worth a message, a full disk is.
#[must_use]
pub fn verdict() -> Exit {
    let failures = || STREAMS.into_iter().filter_map(Stream::failure);
    match failures().next() {
        None => Exit::Done,
        Some(_) if failures().all(|error| error.kind() == ErrorKind::BrokenPipe) => Exit::ReaderGone,
        Some(_) => Exit::Unwritten,
    }
}

/// The end of the program: reports the failure of either stream on the other one. The code is that of `exit` or, if
/// everything else succeeded, that of the output.
#[must_use]
pub fn end(exit: Exit) -> Exit {
    for (stream, other) in [(Stream::Output, Stream::Errors), (Stream::Errors, Stream::Output)] {
        if let Some(error) = stream.failure().filter(|error| error.kind() != ErrorKind::BrokenPipe) {
            other.line(format_args!("error: cannot write to {}: {error}", stream.name()));
        }
    }
    if exit == Exit::Done { verdict() } else { exit }
}
