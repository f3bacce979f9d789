//! Changes of parameters and test: while the drive is disarmed.

use core::borrow::BorrowMut;

use pneudrive_controller::config::ConfigError;
use pneudrive_controller::drive::DriveConfig;
use pneudrive_controller::parameters::{SetError, id};
use pneudrive_controller::{Config, Parameters, Refusal};

use super::{Control, Test};
use crate::board::Board;
use crate::configuration::Prepared;
use crate::recorder::Recorder;
use crate::store::NotStored;

/// Why a change of the configuration was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeError {
    /// The controller refuses it in the present state of the drive.
    Refused(Refusal),
    /// A parameter does not exist, or its value is out of range.
    Value(SetError),
    /// The parameters do not go together.
    Inconsistent(ConfigError),
}

/// Why the parameters were not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveRefusal {
    /// The controller refuses it in the present state of the drive.
    NotNow(Refusal),
    /// The flash did not take them.
    NotStored,
}

impl<R: BorrowMut<Recorder>> Control<R> {
    /// Changes parameters with consecutive ids: all of them or none.
    ///
    /// # Errors
    /// When the drive is not disarmed, or with the id of the first value that is wrong.
    pub fn set_parameters(
        &mut self,
        first_id: u16,
        values: impl Iterator<Item = i32>,
    ) -> Result<(), (u16, ChangeError)> {
        self.must_be_disarmed().map_err(|refusal| (first_id, ChangeError::Refused(refusal)))?;
        let mut changed = self.parameters().clone();
        let mut id = first_id;
        for value in values {
            changed.set(id, value).map_err(|error| (id, ChangeError::Value(error)))?;
            id = id.saturating_add(1);
        }
        let changed =
            self.of_its_own(changed).map_err(|error| (first_id, ChangeError::Inconsistent(error)))?;
        self.put_in_force(changed).map_err(|refusal| (first_id, ChangeError::Refused(refusal)))
    }

    /// Parameters that fit together. What the law keeps are parts of what the others say: where these say something else, it begins afresh.
    fn of_its_own(&self, changed: Parameters) -> Result<Prepared, ConfigError> {
        let changed = Prepared::of(changed)?;
        match changed.config().law.is_of_another_drive(&self.config().law) {
            true => changed.afresh(),
            false => Ok(changed),
        }
    }

    /// Puts parameters in force, unless a spool is open that the drive stage of these would not close.
    pub(super) fn put_in_force(&mut self, changed: Prepared) -> Result<(), Refusal> {
        self.stage_may_become(changed.config())?;
        self.forget_what_depends(changed.parameters(), changed.config());
        self.configuration.replace(changed);
        // A reference that somebody has set stays as long as counts mean the same.
        if !self.state.supervisor.is_referenced() {
            self.locate();
        }
        self.restart_clock();
        Ok(())
    }

    /// A new meaning of counts takes the reference with it, a new timing, loop or drive stage the moves,
    /// and a record is not to be read with parameters that it was not taken with. Nor is kept what the law has learned with others.
    fn forget_what_depends(&mut self, changed: &Parameters, config: &Config) {
        let encoder = |p: &Parameters| {
            (p.get(id::ENCODER_PM_PER_COUNT), p.get(id::ENCODER_INVERTED), p.absolute_zero())
        };
        if encoder(changed) != encoder(self.parameters()) {
            self.state.supervisor.clear_referenced();
        }
        let meaning = |c: &Config| (c.timing, c.law.control_loop, matches!(c.drive, DriveConfig::Dac(_)));
        if meaning(config) != meaning(self.config()) {
            self.test = Test::default();
        }
        if changed != self.parameters() {
            self.recorder.borrow_mut().empty();
            self.state.forget_run();
        }
    }

    /// Takes over a whole set of parameters, as from storage after a reset.
    ///
    /// # Errors
    /// When they do not go together; nothing is changed then.
    pub fn load_parameters(&mut self, parameters: Parameters) -> Result<(), ConfigError> {
        self.configuration.replace(Prepared::of(parameters)?);
        Ok(())
    }

    /// Stores parameters and move records for the next reset.
    ///
    /// # Errors
    /// When the drive is enabled, or the flash does not take them.
    pub fn save_parameters(&mut self, board: &mut impl Board) -> Result<(), SaveRefusal> {
        self.must_be_disarmed().map_err(SaveRefusal::NotNow)?;
        self.spool_must_be_at_null().map_err(SaveRefusal::NotNow)?;
        self.configuration.save(board.store()).map_err(|NotStored| SaveRefusal::NotStored)
    }

    pub(super) fn put_test(&mut self, test: Test) {
        self.test = test;
        self.recorder.borrow_mut().empty();
    }

    pub(super) fn must_be_disarmed(&self) -> Result<(), Refusal> {
        if self.state.supervisor.drives() { Err(Refusal::NotDisarmed) } else { Ok(()) }
    }
}
