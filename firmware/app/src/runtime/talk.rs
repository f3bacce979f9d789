//! The idle task: serves the port and the stream, reads the digital inputs, stores what waits for a disabled drive,
//! feeds the watchdog.
//!
//! A request locks out the control for short pieces of its work. Each piece begins only if there is time for it
//! before the control is due ([`Served::has_time`]).

use core::borrow::BorrowMut;
use core::convert::Infallible;

use embedded_io::Write;
use rtic_core::Mutex;

use super::drive::{ClockedBoard, Drive};
use crate::board::Board;
use crate::control::Control;
use crate::inputs;
use crate::log::LogState;
use crate::recorder::Recorder;
use crate::server::Server;
use crate::shared_drive::SharedDrive;
use crate::store::NotStored;

/// A serial port. Written bytes are collected and then sent in one go; a frame always fits.
pub trait Port: Write<Error = Infallible> {
    /// Whether the last reply has gone.
    fn is_free(&self) -> bool;

    /// A byte that has come.
    fn read(&mut self) -> Option<u8>;

    /// Whether there is a reply to be sent.
    fn has_collected(&self) -> bool;

    /// Sends the collected bytes. The port must be free.
    fn send(&mut self);

    /// Clears the errors that noise on the line has left, so that reception goes on.
    fn clear_errors(&mut self);
}

/// A watchdog that resets the board if it is not fed.
pub trait Watchdog {
    /// The control and the idle task have run.
    fn feed(&mut self);
}

/// A drive as the idle task sees it.
pub trait Served {
    /// Its board.
    type Board: Board;
    /// Its recorder.
    type Recorder: BorrowMut<Recorder>;

    /// The control and the board, for a request.
    fn parts(&mut self) -> (&mut Control<Self::Recorder>, &mut Self::Board);

    /// Whether the control has run since this was last asked.
    fn has_run(&mut self) -> bool;

    /// Whether a piece of a request can be done before the control is due.
    fn has_time(&self) -> bool;

    /// Takes over the timing that a request may have changed.
    fn keep_timing(&mut self);

    /// Stores the waiting data of a disabled drive. Returns false if the flash does not take it.
    fn tidy_up(&mut self) -> bool;
}

impl<B: ClockedBoard, R: BorrowMut<Recorder>> Served for Drive<B, R> {
    type Board = B;
    type Recorder = R;

    fn parts(&mut self) -> (&mut Control<R>, &mut B) {
        (&mut self.control, &mut self.board)
    }

    fn has_run(&mut self) -> bool {
        self.has_run()
    }

    fn has_time(&self) -> bool {
        self.has_time()
    }

    fn keep_timing(&mut self) {
        self.keep_timing();
    }

    fn tidy_up(&mut self) -> bool {
        self.tidy_up()
    }
}

/// The half that talks, and its buffers.
#[derive(Debug)]
pub struct Talk<P, W> {
    server: Server,
    port: P,
    watchdog: W,
    /// The flash has refused; it is not worn out by trying again and again.
    flash_refuses: bool,
    log: LogState,
}

impl<P: Port, W: Watchdog> Talk<P, W> {
    /// A task that has nothing to say yet.
    pub fn new(port: P, watchdog: W) -> Talk<P, W> {
        Talk { server: Server::default(), port, watchdog, flash_refuses: false, log: LogState::default() }
    }

    /// One round of the idle task.
    ///
    /// # Errors
    /// Once, when the flash does not take the fault log; it is not tried again before the next reset.
    pub fn round<D: Served>(&mut self, drive: &mut impl Mutex<T = D>) -> Result<(), NotStored> {
        self.port.clear_errors();
        InPieces(drive).lock(|control, _| self.server.attend(control));
        if self.port.is_free() {
            self.listen(drive);
            self.speak();
            self.port.send();
        }
        if cfg!(feature = "log") {
            let mode = drive.lock(|drive| drive.parts().0.state().supervisor.mode());
            self.log.log_changes(mode, self.server.damaged_frames());
        }
        if !drive.lock(D::has_run) {
            return Ok(());
        }
        inputs::attend(&mut InPieces(drive));
        // Nor is anything stored then: writing flash feeds the watchdog, too.
        if !drive.lock(|drive| drive.parts().0.feeds_watchdog()) {
            return Ok(());
        }
        self.watchdog.feed();
        self.tidy_up(drive)
    }

    /// The bytes that have come, up to one that ends a request.
    fn listen<D: Served>(&mut self, drive: &mut impl Mutex<T = D>) {
        while !self.port.has_collected() {
            let Some(byte) = self.port.read() else { return };
            let Ok(()) = self.server.receive_beside(&[byte], &mut InPieces(drive), &mut self.port);
        }
    }

    /// Sends unasked rows, after the replies.
    fn speak(&mut self) {
        if !self.port.has_collected() {
            let Ok(()) = self.server.speak(&mut self.port);
        }
    }

    fn tidy_up<D: Served>(&mut self, drive: &mut impl Mutex<T = D>) -> Result<(), NotStored> {
        if self.flash_refuses || drive.lock(D::tidy_up) {
            return Ok(());
        }
        self.flash_refuses = true;
        Err(NotStored)
    }
}

/// The drive, locked for a piece of a request at a time.
struct InPieces<'a, M>(&'a mut M);

impl<D: Served, M: Mutex<T = D>> InPieces<'_, M> {
    /// Waits until there is time for a piece: the control does not come before it is done, nor before it begins.
    #[inline(never)]
    fn await_time(&mut self) {
        while !self.0.lock(|drive| drive.has_time()) {}
    }
}

impl<D: Served, M: Mutex<T = D>> SharedDrive for InPieces<'_, M> {
    type Recorder = D::Recorder;
    type Board = D::Board;

    fn lock<T>(&mut self, work: impl FnOnce(&mut Control<D::Recorder>, &mut D::Board) -> T) -> T {
        self.await_time();
        self.0.lock(|drive| {
            let (control, board) = drive.parts();
            let done = work(control, board);
            drive.keep_timing();
            done
        })
    }
}
