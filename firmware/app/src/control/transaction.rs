//! Parameters, a test and move records that are accepted together or not at all, while the drive is disarmed.

use core::borrow::BorrowMut;

use pneudrive_controller::config::ConfigError;
use pneudrive_controller::parameters::SetError;
use pneudrive_controller::sequencer::SequenceError;
use pneudrive_controller::{Move, Parameters, Refusal};
use pneudrive_protocol::change::{Entries, Entry, start_crc32, test_crc32};
use pneudrive_protocol::{ProfiledMove, UNTIL_STOPPED};

use super::{Control, Test};
use crate::configuration::Prepared;
use crate::move_records::{MoveRecords, NoRecord};
use crate::moves::meant;
use crate::recorder::Recorder;

/// Why a change was not taken. Nothing was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TakeError {
    /// The controller refuses it in the present state of the drive.
    Refused(Refusal),
    /// A parameter does not exist, or its value is out of range.
    Value {
        /// Id of the parameter.
        id: u16,
        /// The value.
        value: i32,
        /// Why it is refused.
        error: SetError,
    },
    /// The parameters do not go together.
    Inconsistent(ConfigError),
    /// The sequence does not take a move.
    Sequence(SequenceError),
    /// The test lasts more samples than can be counted.
    TooLong,
    /// The bytes are not a change: moves without a test, two tests, an invalid profile, a record without a number, or
    /// an entry that this version does not know.
    Malformed,
}

/// The data that the drive will have once the whole change has been read.
struct Draft {
    parameters: Parameters,
    records: MoveRecords,
    test: Option<Test>,
}

impl Draft {
    fn add(&mut self, entry: Entry<'_>) -> Result<(), TakeError> {
        match entry {
            Entry::Parameters { first_id, values } => {
                // Behind the last id there is none: a value there is refused before.
                values.iter().zip(first_id..=u16::MAX).try_for_each(|(value, id)| {
                    let set = self.parameters.set(id, value);
                    set.map_err(|error| TakeError::Value { id, value, error })
                })
            }
            Entry::Test { .. } if self.test.is_some() => Err(TakeError::Malformed),
            Entry::Test { last_sample, .. } if last_sample > UNTIL_STOPPED => Err(TakeError::TooLong),
            Entry::Test { name, last_sample, round, decimation, pre_trigger } => {
                let mut test = Test::new(name, last_sample, decimation, pre_trigger);
                test.sequence.repeat_every(round).map_err(TakeError::Sequence)?;
                self.test = Some(test);
                Ok(())
            }
            Entry::Move { at_sample, target } => self.push(Move::step(at_sample, target)),
            Entry::Profile { bytes } => {
                let next = ProfiledMove::from_bytes(bytes).and_then(|told| meant(&told));
                self.push(next.ok_or(TakeError::Malformed)?)
            }
            Entry::MoveRecord { number, bytes } => {
                let told = ProfiledMove::from_bytes(bytes).ok_or(TakeError::Malformed)?;
                self.records.put(number, told).map_err(|NoRecord| TakeError::Malformed)
            }
        }
    }

    fn push(&mut self, next: Move) -> Result<(), TakeError> {
        let test = self.test.as_mut().ok_or(TakeError::Malformed)?;
        test.sequence.push(next).map_err(TakeError::Sequence)
    }
}

impl<R: BorrowMut<Recorder>> Control<R> {
    /// Takes a change: all of it or nothing.
    ///
    /// # Errors
    /// When the drive is not disarmed, or the first problem of the change.
    pub fn take_change(&mut self, change: &[u8]) -> Result<(), TakeError> {
        self.must_be_disarmed().map_err(TakeError::Refused)?;
        let records = self.configuration.records().clone();
        let mut draft = Draft { parameters: self.parameters().clone(), records, test: None };
        for entry in Entries::of(change) {
            draft.add(entry.map_err(|_| TakeError::Malformed)?)?;
        }
        let changed = Prepared::of(draft.parameters).map_err(TakeError::Inconsistent)?;
        self.put_in_force(changed).map_err(TakeError::Refused)?;
        self.configuration.replace_records(draft.records);
        if let Some(test) = draft.test {
            self.put_test(test.named(test_crc32(change)));
        }
        Ok(())
    }

    /// Whether test and parameters are those that this CRC-32 names ([`start_crc32`]).
    #[must_use]
    pub fn is_named(&self, crc32: u32) -> bool {
        let hash = self.configuration().hash();
        self.test().crc32().is_some_and(|test| start_crc32(test, hash) == crc32)
    }
}
