//! The drive as its two users share it: the interrupt that controls it, and the task that talks to the host.
//!
//! The interrupt may come at any time during a request. So the request locks the drive only for the pieces of work
//! that need it. Each of them is short (docs/reference/firmware-figures.md). Decoding a request, framing its reply and
//! computing a CRC need no lock.

use core::borrow::BorrowMut;

use crate::board::Board;
use crate::configuration::Prepared;
use crate::control::Control;
use crate::recorder::Recorder;

/// A drive that an interrupt controls meanwhile.
pub trait SharedDrive {
    /// The recorder, owned or lent.
    type Recorder: BorrowMut<Recorder>;
    /// The board.
    type Board: Board;

    /// Does a piece of work with the interrupt locked out.
    fn lock<T>(&mut self, work: impl FnOnce(&mut Control<Self::Recorder>, &mut Self::Board) -> T) -> T;
}

/// A drive without an interrupt, on boards that run both halves from one thread.
impl<R: BorrowMut<Recorder>, B: Board> SharedDrive for (&mut Control<R>, &mut B) {
    type Recorder = R;
    type Board = B;

    fn lock<T>(&mut self, work: impl FnOnce(&mut Control<R>, &mut B) -> T) -> T {
        work(self.0, self.1)
    }
}

/// Does a piece of work with what the last run has learned, which is prepared before, while the control goes on. It is prepared again if
/// a run ends or the drive trips meanwhile: what is kept would be of a drive that still runs, or has not tripped. No mode comes back by
/// itself, so this ends.
pub(crate) fn with_learned<D: SharedDrive, T>(
    drive: &mut D,
    mut work: impl FnMut(&mut Control<D::Recorder>, Option<&Prepared>, &mut D::Board) -> T,
) -> T {
    loop {
        let (mode, learned) = drive.lock(|control, _| (control.mode(), control.learned_parameters()));
        let learned = learned.and_then(|learned| Prepared::of(learned).ok());
        let done = drive
            .lock(|control, board| (control.mode() == mode).then(|| work(control, learned.as_ref(), board)));
        if let Some(done) = done {
            return done;
        }
    }
}
