//! Requests that enable, move and disable the drive.

use core::borrow::BorrowMut;

use pneudrive_controller::drive::MAX_COUNTS;
use pneudrive_controller::law::cascade::kept::Kept;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Mode, Parameters, Refusal};
use pneudrive_protocol::session::NOBODY;

use super::Control;
use crate::board::Board;
use crate::configuration::Prepared;
use crate::ownership::{Ownership, Requester};
use crate::recorder::Recorder;

impl<R: BorrowMut<Recorder>> Control<R> {
    /// Enables the drive with the valve at null, and empties the recorder; nobody owns it.
    /// What the last run has learned becomes part of the parameters, and of those that are stored:
    /// at once if the drive rests, else after it has come to rest ([`Control::tidy_up`]).
    ///
    /// # Errors
    /// The controller's refusal, or the refusal of a drive whose stored configuration is lost.
    pub fn arm(&mut self, board: &mut impl Board) -> Result<(), Refusal> {
        let learned = self.learned_parameters().and_then(|learned| Prepared::of(learned).ok());
        let by = Requester { session: NOBODY, host: "", sequence: None };
        self.arm_with(learned.as_ref(), &by, board)
    }

    /// The same, for a host that owns the drive from now on, with [`Control::learned_parameters`] that have been prepared
    /// before: that takes longer than a control interrupt may wait.
    ///
    /// # Errors
    /// As for [`Control::arm`].
    pub(crate) fn arm_with(
        &mut self,
        learned: Option<&Prepared>,
        by: &Requester<'_>,
        board: &mut impl Board,
    ) -> Result<(), Refusal> {
        if self.configuration.is_lost() {
            return Err(Refusal::NoConfiguration);
        }
        // The pin would have another command than the record.
        if board.has_converter() && !self.config().drive.has_codes() {
            return Err(Refusal::NoCode);
        }
        self.log_fault(board);
        if let Some(learned) = learned {
            self.learn(learned, board);
        }
        self.state.arm(self.configuration.config())?;
        self.state.forget_run();
        if !self.state.supervisor.is_referenced() {
            self.locate();
        }
        self.ownership = Ownership::of(by, board.host_clock_ms());
        self.logged = false;
        self.selector.leave_fault();
        // Storing has stalled the processor: what was late while disarmed is no fault.
        self.restart_clock();
        self.recorder.borrow_mut().arm(self.test.decimation, self.test.pre_trigger);
        Ok(())
    }

    /// The parameters with what the last run has learned of the valve's null, and the law of its drive, so that the next run starts
    /// from there. None if nothing was learned, and while a run is on: a record is read with the parameters that it was taken with.
    #[must_use]
    pub(crate) fn learned_parameters(&self) -> Option<Parameters> {
        if matches!(self.state.supervisor.mode(), Mode::Running | Mode::Homing) {
            return None;
        }
        let (learned, kept) = (self.state.learned_null_offset(), self.state.kept(self.config()));
        if learned == 0 && kept.is_none() {
            return None;
        }
        let largest = i32::from(MAX_COUNTS);
        let mut changed = self.parameters().clone();
        let old = changed.get(id::NULL_OFFSET_COUNTS).unwrap_or(0);
        let new = old.saturating_add(learned).clamp(-largest, largest);
        for (id, value) in kept.iter().flat_map(Kept::values).chain([(id::NULL_OFFSET_COUNTS, new)]) {
            changed.set(id, value).ok()?;
        }
        Some(changed)
    }

    /// What [`Control::learned_parameters`] follow from, apart from the run: a run may end, and a drive trip, while they are prepared.
    pub(crate) fn mode(&self) -> Mode {
        self.state.supervisor.mode()
    }

    /// Puts what was learned in force, and stores it at once if the drive rests.
    fn learn(&mut self, learned: &Prepared, board: &mut impl Board) {
        self.configuration.learn(learned);
        self.state.forget_null_offset();
        if self.flash_may_be_written() {
            // A flash that refuses does not keep the drive from arming.
            let _ = self.configuration.save_learned(board.store());
        }
    }

    /// Disables the drive.
    pub fn disarm(&mut self) {
        self.state.supervisor.disarm();
    }

    /// Runs the test from the next sample on.
    ///
    /// # Errors
    /// The controller's refusal.
    pub fn start(&mut self, board: &mut impl Board) -> Result<(), Refusal> {
        self.set_off(board)?;
        board.run_begins(self.configuration.config());
        Ok(())
    }

    /// The same from where the axis stands, on a simulated plant, too.
    pub(super) fn set_off(&mut self, board: &impl Board) -> Result<(), Refusal> {
        self.record();
        self.state.start(self.configuration.config(), &self.test.sequence)?;
        self.recorder.borrow_mut().start();
        self.restart_clock();
        self.ownership.refresh(board.host_clock_ms());
        Ok(())
    }

    /// Stops at once: a fault that only arming leaves. Digital inputs begin nothing before they have acknowledged it, also if
    /// the drive was disabled or has tripped before.
    pub fn stop(&mut self) {
        self.selector.stop();
        self.trip(Fault::Stop);
    }

    /// A fault that the board has found, such as why it was reset.
    pub fn trip(&mut self, fault: Fault) {
        self.state.supervisor.trip(fault);
    }

    /// Whether the watchdog may be fed: not while it is tried.
    #[must_use]
    pub fn feeds_watchdog(&self) -> bool {
        self.state.supervisor.mode() != Mode::Fault(Fault::WatchdogTried)
    }

    /// The axis stands at `counts` now: counts mean positions from here on.
    ///
    /// # Errors
    /// When the drive is enabled.
    pub fn reference(&mut self, counts: i32) -> Result<(), Refusal> {
        self.must_be_disarmed()?;
        self.state.reference(counts);
        Ok(())
    }

    /// Homes the axis from the next sample on; with an absolute encoder at once.
    ///
    /// # Errors
    /// The controller's refusal.
    pub fn home(&mut self, board: &mut impl Board) -> Result<(), Refusal> {
        self.record();
        self.state.home(self.configuration.config())?;
        self.locate();
        self.ownership.refresh(board.host_clock_ms());
        // What is kept from before has positions of another origin.
        self.recorder.borrow_mut().arm(self.test.decimation, self.test.pre_trigger);
        Ok(())
    }

    /// Counts mean positions as they are: a simulated rig.
    ///
    /// # Errors
    /// When the drive is enabled.
    pub fn set_referenced(&mut self) -> Result<(), Refusal> {
        self.must_be_disarmed()?;
        self.state.supervisor.set_referenced();
        Ok(())
    }
}
