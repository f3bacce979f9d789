//! The host that commands the drive: whether it is present, and what happens to a drive without it.

use core::borrow::BorrowMut;

use pneudrive_controller::{Fault, Refusal};
use pneudrive_protocol::{Owner, Presence};

use super::Control;
use crate::board::Board;
use crate::ownership::{Need, Ownership, Requester};
use crate::recorder::Recorder;

impl<R: BorrowMut<Recorder>> Control<R> {
    /// Looks whether the owner is gone, on a board that judges silence.
    #[inline(always)]
    pub(super) fn watch_host(&mut self, board: &impl Board) {
        if let Some(now_ms) = board.host_clock_ms() {
            self.watch_owner(now_ms);
        }
    }

    /// Acts when the owner is gone: a moving drive trips at once, an armed or holding one is disarmed after
    /// `hold_ms`. Requests of other hosts do not count.
    #[inline(never)]
    fn watch_owner(&mut self, now_ms: u64) {
        let timing = &self.config().timing;
        let silence_ms = timing.host_silence_ms;
        if self.state.supervisor.moves() {
            if silence_ms > 0 && self.ownership.silent_ms(Some(now_ms)) > u64::from(silence_ms) {
                self.state.supervisor.trip(Fault::HostSilent);
            }
        } else if self.state.supervisor.drives() {
            let gone_for_ms = self.ownership.gone_for_ms(Some(now_ms), silence_ms);
            if gone_for_ms.is_some_and(|gone| gone > u64::from(timing.hold_ms)) {
                self.state.supervisor.disarm();
            }
        }
    }

    /// The request of this number of a session has come just now. A disabled drive listens to nobody, and forgets its owner.
    pub fn host_heard(&mut self, session: u32, sequence: u16, board: &impl Board) {
        if !self.state.supervisor.drives() {
            self.ownership = Ownership::default();
            return;
        }
        let silence_ms = self.config().timing.host_silence_ms;
        self.ownership.heard(session, sequence, board.host_clock_ms(), silence_ms);
    }

    /// Whether the owner of an enabled drive was silent for too long since it has armed it or taken it over.
    #[must_use]
    pub(crate) fn owner_was_silent(&self) -> bool {
        self.state.supervisor.drives() && self.ownership.has_lapsed()
    }

    /// The host of this session has gone; a drive that it has armed stays as it is.
    pub(crate) fn host_leaves(&mut self, session: u32) {
        if self.state.supervisor.drives() {
            self.ownership.leave(session);
        }
    }

    /// Whether the host that has armed the drive is there.
    #[must_use]
    pub fn presence(&self, board: &impl Board) -> Presence {
        if !self.state.supervisor.drives() {
            return Presence::Nobody;
        }
        self.ownership.presence(board.host_clock_ms(), self.config().timing.host_silence_ms)
    }

    /// Whether a host may make a request with this need.
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
    pub fn take_over(&mut self, by: &Requester<'_>, board: &impl Board) -> Result<(), Refusal> {
        if !self.state.supervisor.drives() {
            return Err(Refusal::NotArmed);
        }
        self.ownership = Ownership::of(by, board.host_clock_ms());
        Ok(())
    }
}
