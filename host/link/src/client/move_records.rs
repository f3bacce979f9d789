//! The table of move records.

use anyhow::{Result, anyhow};
use pneudrive_app::moves::{meant, told};
use pneudrive_controller::Move;
use pneudrive_protocol::change::Entry;
use pneudrive_protocol::profiled::NO_MOVE;
use pneudrive_protocol::{MOVE_RECORDS, ProfiledMove, ReplyBody, RequestBody};
use pneudrive_records::move_records::MoveRecord;

use super::Client;
use super::answer::unexpected;
use super::change::Change;

impl Client {
    /// The move records of the drive, in the order of their numbers.
    ///
    /// # Errors
    /// When its firmware has none, it does not answer, or its answer is not a record.
    pub fn move_records(&mut self) -> Result<Vec<MoveRecord>> {
        let (mut records, mut number) = (Vec::new(), 1);
        while number <= MOVE_RECORDS {
            let bytes = self.move_records_from(number)?;
            if bytes.is_empty() {
                return Err(self.no_records());
            }
            for bytes in bytes.chunks(ProfiledMove::BYTES) {
                let told = ProfiledMove::from_bytes(bytes).filter(|_| number <= MOVE_RECORDS);
                let told = told.ok_or_else(|| self.no_records())?;
                if told.kind != NO_MOVE {
                    let next = meant(&told).ok_or_else(|| self.no_records())?;
                    let next = Move { at_sample: 0, ..next };
                    records.push(MoveRecord { number, next, dwell: told.at_sample });
                }
                number += 1;
            }
        }
        Ok(records)
    }

    fn move_records_from(&mut self, number: u8) -> Result<Vec<u8>> {
        self.ask(RequestBody::MoveRecordsRead { first: number }, |reply| match *reply {
            ReplyBody::MoveRecords { first, records } if first == number => Ok(records.to_vec()),
            ref other => Err(unexpected(other)),
        })
    }

    /// Puts records in the table, all of them or none; those of other numbers stay.
    ///
    /// # Errors
    /// When the firmware has no table, or the drive is not disarmed.
    pub fn put_move_records(&mut self, records: &[MoveRecord]) -> Result<()> {
        self.change_move_records(records.iter().map(travelling))
    }

    /// Makes these records the whole table: others are removed.
    ///
    /// # Errors
    /// As [`Client::put_move_records`].
    pub fn replace_move_records(&mut self, records: &[MoveRecord]) -> Result<()> {
        let one = |number| records.iter().find(|one| one.number == number).map(travelling);
        self.change_move_records((1..=MOVE_RECORDS).map(|number| one(number).unwrap_or_else(|| none(number))))
    }

    /// Removes the record of a number.
    ///
    /// # Errors
    /// As [`Client::put_move_records`].
    pub fn remove_move_record(&mut self, number: u8) -> Result<()> {
        self.change_move_records([none(number)].into_iter())
    }

    fn change_move_records(&mut self, records: impl Iterator<Item = (u8, ProfiledMove)>) -> Result<()> {
        let mut change = Change::default();
        for (number, told) in records {
            change.add(&Entry::MoveRecord { number, bytes: &told.to_bytes() });
        }
        self.take(&change)
    }

    fn no_records(&self) -> anyhow::Error {
        anyhow!(
            "{}: what it says of its move records is none; update its firmware or this program",
            self.name
        )
    }
}

/// A record as it travels.
fn travelling(record: &MoveRecord) -> (u8, ProfiledMove) {
    (record.number, ProfiledMove { at_sample: record.dwell, ..told(&record.next) })
}

/// No record of this number.
fn none(number: u8) -> (u8, ProfiledMove) {
    (number, ProfiledMove { kind: NO_MOVE, ..ProfiledMove::default() })
}
