//! The host that commands the drive: whether it is there, and what becomes of a drive without it.

use core::borrow::BorrowMut;

use pneudrive_controller::{Fault, Refusal};
use pneudrive_protocol::{Owner, Presence};

use super::Control;
use crate::board::Board;
use crate::ownership::{Need, Ownership};
use crate::recorder::Recorder;

impl<R: BorrowMut<Recorder>> Control<R> {
    /// A drive that moves trips once its owner has been silent for too long. Requests of other hosts do not count.
    #[inline(always)]
    pub(super) fn watch_host(&mut self, board: &impl Board) {
        if !self.state.supervisor.moves() {
            return;
        }
        let limit_ms = self.config().timing.host_silence_ms;
        if limit_ms > 0 && self.ownership.silent_ms(board.host_clock_ms()) > u64::from(limit_ms) {
            self.state.supervisor.trip(Fault::HostSilent);
        }
    }

    /// A request of this session has come just now.
    pub fn host_heard(&mut self, session: u32, board: &impl Board) {
        self.ownership.heard(session, board.host_clock_ms());
    }

    /// The host of this session has gone; what it has armed stays as it is.
    pub fn host_leaves(&mut self, session: u32) {
        self.ownership.leave(session);
    }

    /// Whether the host that has armed the drive is there.
    #[must_use]
    pub fn presence(&self, board: &impl Board) -> Presence {
        if !self.state.supervisor.drives() {
            return Presence::Nobody;
        }
        self.ownership.presence(board.host_clock_ms(), self.config().timing.host_silence_ms)
    }

    /// Whether a host may do what has this need.
    #[must_use]
    pub fn allows(&self, session: u32, need: Need, board: &impl Board) -> bool {
        self.ownership.allows(session, need, self.presence(board))
    }

    /// Who commands the drive.
    #[must_use]
    pub fn owner(&self, board: &impl Board) -> Owner<'_> {
        let presence = self.presence(board);
        if presence == Presence::Nobody {
            return Owner::default();
        }
        Owner {
            presence,
            session: self.ownership.session(),
            silent_ms: u32::try_from(self.ownership.silent_ms(board.host_clock_ms())).unwrap_or(u32::MAX),
            host: self.ownership.host(),
        }
    }

    /// A host takes over the drive that another one has armed.
    ///
    /// # Errors
    /// When the drive is not enabled.
    pub fn take_over(&mut self, session: u32, host: &str, board: &impl Board) -> Result<(), Refusal> {
        if !self.state.supervisor.drives() {
            return Err(Refusal::NotArmed);
        }
        self.ownership = Ownership::of(session, host, board.host_clock_ms());
        Ok(())
    }
}
