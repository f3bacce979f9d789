//! The control and its board: what the control interrupt and the idle task share.

use core::borrow::BorrowMut;

use super::clock::{Clock, Timer};
use crate::board::Board;
use crate::control::Control;
use crate::recorder::Recorder;

/// Nothing is stored before the drive has been disabled for this long, microseconds: an erasure stalls the
/// processor, and a host that asks for the reason of a fault gets it first.
pub const REST_US: u64 = 1_000_000;

/// A board whose control runs by a clock of its own.
pub trait ClockedBoard: Board {
    /// The clock's timer.
    type Timer: Timer;

    /// The clock.
    fn clock(&self) -> &Clock<Self::Timer>;

    /// The clock, to be set.
    fn clock_mut(&mut self) -> &mut Clock<Self::Timer>;

    /// When the drive was last enabled, microseconds since the reset.
    fn enabled_us(&self) -> u64;
}

/// The control and its board.
#[derive(Debug)]
pub struct Drive<B, R = Recorder> {
    /// The half with a deadline.
    pub control: Control<R>,
    /// Sensors, drive stage and clock.
    pub board: B,
    /// The longest piece of a request to an enabled drive, microseconds: none begins with less time left before the
    /// control is due.
    piece_us: u32,
    /// The control has run since the watchdog was last fed.
    ran: bool,
}

impl<B: ClockedBoard, R: BorrowMut<Recorder>> Drive<B, R> {
    /// A drive whose requests are carried out in pieces of at most `piece_us` microseconds between two instants of the
    /// control.
    pub fn new(control: Control<R>, board: B, piece_us: u32) -> Drive<B, R> {
        Drive { control, board, piece_us, ran: false }
    }

    /// The timer's interrupt: whatever is due.
    #[inline]
    pub fn tick(&mut self) {
        if self.board.clock_mut().sample_is_due() {
            self.control.on_sample(&mut self.board);
        }
        if self.board.clock_mut().output_is_due() {
            self.control.on_output(&mut self.board);
            self.ran = true;
        }
    }

    /// Whether the control has run since this was last asked; its times are settled then.
    pub fn has_run(&mut self) -> bool {
        self.control.settle_timing();
        core::mem::take(&mut self.ran)
    }

    /// Whether a piece of a request can be done before the control is due. A disabled drive has no deadline.
    #[must_use]
    pub fn has_time(&self) -> bool {
        !self.control.state().supervisor.drives() || self.board.clock().has_time(self.piece_us)
    }

    /// Takes over the timing that a request may have changed.
    #[inline(never)] // At the end of every piece of a request.
    pub fn keep_timing(&mut self) {
        let timing = self.control.config().timing;
        self.board.clock_mut().keep(timing);
    }

    /// Stores the waiting data of a drive that has been disabled for a while. Returns false if the flash does not
    /// take it.
    pub fn tidy_up(&mut self) -> bool {
        let rests = self.board.now_us().saturating_sub(self.board.enabled_us()) > REST_US;
        !rests || self.control.tidy_up(&mut self.board).is_ok()
    }
}
