//! The spool location of a stepper valve: kept through a reset, and recovered after one.

use core::borrow::BorrowMut;

use pneudrive_controller::drive::SpoolLocation;
use pneudrive_controller::{Command, Config, Refusal};

use super::Control;
use crate::board::Board;
use crate::recorder::Recorder;

impl<R: BorrowMut<Recorder>> Control<R> {
    /// Walks the spool of a stepper valve back from where it was before a reset. The translator is enabled until it
    /// is at mid-travel, and the valve is open meanwhile.
    ///
    /// # Errors
    /// When the drive is enabled, or it is not known where the spool was.
    pub fn seek_null(&mut self) -> Result<(), Refusal> {
        self.must_be_disarmed()?;
        self.state.seek_null()
    }

    /// The spool of a stepper valve is at mid-travel: the operator has seen to it.
    ///
    /// # Errors
    /// When the drive is enabled, or the spool is on its way there.
    pub fn at_null(&mut self, board: &mut impl Board) -> Result<(), Refusal> {
        self.must_be_disarmed()?;
        self.state.at_null()?;
        board.keep_spool(SpoolLocation::default());
        Ok(())
    }

    /// Whether the drive is disabled and a stepper's spool at mid-travel. Writing flash stalls the processor, and an
    /// open spool would stay open meanwhile.
    pub(super) fn flash_may_be_written(&self) -> bool {
        !self.state.supervisor.drives() && self.spool_must_be_at_null().is_ok()
    }

    /// Refuses requests that must wait for the spool of a stepper valve.
    pub(super) fn spool_must_be_at_null(&self) -> Result<(), Refusal> {
        match self.state.spool_is_open(self.config()) {
            true => self.state.check_spool(self.config()).and(Err(Refusal::ValveNotAtNull)),
            false => Ok(()),
        }
    }

    /// Refuses a change between solenoid and stepper while a spool is open: nothing would close it.
    pub(super) fn stage_may_become(&self, config: &Config) -> Result<(), Refusal> {
        match config.drive.is_stepper() == self.config().drive.is_stepper() {
            true => Ok(()),
            false => self.spool_must_be_at_null(),
        }
    }

    /// Has the board keep where the spool is, before its pulse is given.
    #[inline(always)]
    pub(super) fn keep_spool(&self, command: &Command, board: &mut impl Board) {
        if let Some(location) = self.state.spool_to_keep(self.configuration.config(), command) {
            board.keep_spool(location);
        }
    }
}
