//! The table of move records: moves that digital inputs start by number, without a PC.
//!
//! A record has a target, a profile and a dwell: how long the axis stays there before it counts as in position.
//! Numbers go from 1 to [`MOVE_RECORDS`]; 0 is none, and 15 stands for homing. The table is part of the stored
//! configuration. There each record has nine pairs of id and value, like parameters:
//!
//! | id | value |
//! |---|---|
//! | 0x8000 + 16 number | dwell, samples |
//! | + 1 | target, counts |
//! | + 2 to + 7 | the numbers of its profile, as [`ProfiledMove`] has them |
//! | + 8 | the kind of its profile |
//!
//! Firmware that has no records leaves these ids out as unknown ones, and keeps the parameters beside them.

use pneudrive_controller::Move;
use pneudrive_protocol::profiled::NO_MOVE;
use pneudrive_protocol::{MOVE_RECORDS, ProfiledMove};

use crate::moves::meant;

/// Places of the table.
const PLACES: usize = MOVE_RECORDS as usize;
/// Pairs of a record.
const WORDS: usize = 9;
/// The id of the first pair of record 0, if there were one.
const FIRST_ID: u16 = 0x8000;

/// The most pairs that a table takes.
pub(crate) const MAX_PAIRS: usize = PLACES * WORDS;

/// The contents of an empty place.
const NOTHING: ProfiledMove = ProfiledMove { at_sample: 0, target: 0, kind: NO_MOVE, numbers: [0; 6] };

/// A move that is started by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MoveRecord {
    /// Target, counts, and profile; from the first sample on.
    pub next: Move,
    /// From the arrival until it counts as in position, samples.
    pub dwell: u32,
}

/// There is no record of this number, or its profile is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoRecord;

/// The table. By default it is empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MoveRecords([ProfiledMove; PLACES]);

impl Default for MoveRecords {
    fn default() -> Self {
        MoveRecords([NOTHING; PLACES])
    }
}

impl MoveRecords {
    /// The record of a number; None if there is none.
    #[must_use]
    pub fn get(&self, number: u8) -> Option<MoveRecord> {
        let told = self.from(number).first()?;
        let next = meant(told)?;
        Some(MoveRecord { next: Move { at_sample: 0, ..next }, dwell: told.at_sample })
    }

    /// The records from a number on, as they travel: the dwell in place of the first sample.
    #[must_use]
    pub fn from(&self, number: u8) -> &[ProfiledMove] {
        usize::from(number).checked_sub(1).and_then(|place| self.0.get(place..)).unwrap_or(&[])
    }

    /// Puts a record as it travels, or removes one.
    ///
    /// # Errors
    /// For a number that the table does not have, or an invalid profile.
    pub fn put(&mut self, number: u8, told: ProfiledMove) -> Result<(), NoRecord> {
        let slot = usize::from(number).checked_sub(1).and_then(|place| self.0.get_mut(place));
        let slot = slot.ok_or(NoRecord)?;
        *slot = match told.kind {
            NO_MOVE => NOTHING,
            _ => meant(&told).map(|_| told).ok_or(NoRecord)?,
        };
        Ok(())
    }

    /// All pairs (id, value): the form in which the table is stored.
    pub fn pairs(&self) -> impl Iterator<Item = (u16, i32)> + '_ {
        (0..MAX_PAIRS).filter_map(|nth| {
            let (place, word) = (nth / WORDS, nth % WORDS);
            let told = self.0.get(place).filter(|told| told.kind != NO_MOVE)?;
            let value = match word {
                0 => told.at_sample,
                1 => told.target as u32,
                8 => told.kind.into(),
                _ => *told.numbers.get(word - 2)?,
            };
            Some((FIRST_ID + 16 * (place as u16 + 1) + word as u16, value.cast_signed()))
        })
    }

    /// Takes a pair. Returns false if it does not belong to a record.
    pub(crate) fn take(&mut self, id: u16, value: i32) -> bool {
        let Some(nth) = id.checked_sub(FIRST_ID + 16) else { return false };
        let (place, word, value) = (usize::from(nth / 16), usize::from(nth % 16), value.cast_unsigned());
        let Some(told) = self.0.get_mut(place) else { return false };
        let slot = match word {
            0 => &mut told.at_sample,
            1 => {
                told.target = value.cast_signed();
                return true;
            }
            8 => {
                told.kind = u8::try_from(value).unwrap_or(NO_MOVE);
                return true;
            }
            _ => match told.numbers.get_mut(word.wrapping_sub(2)) {
                Some(number) => number,
                None => return false,
            },
        };
        *slot = value;
        true
    }

    /// Removes records with a profile that this firmware does not know. Returns how many there were.
    pub(crate) fn sift(&mut self) -> u16 {
        let mut removed = 0;
        for told in &mut self.0 {
            if meant(told).is_none() {
                removed += u16::from(told.kind != NO_MOVE);
                *told = NOTHING;
            }
        }
        removed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(target: i32) -> ProfiledMove {
        ProfiledMove { at_sample: 77, target, kind: 1, numbers: [300, 50, 7, 0, 0, 0] }
    }

    #[test]
    fn a_record_is_known_by_its_number_and_others_are_not() {
        let mut table = MoveRecords::default();
        table.put(3, ramp(-5)).expect("a place");
        let record = table.get(3).expect("it was put");
        assert_eq!((record.next.at_sample, record.next.target, record.dwell), (0, -5, 77));
        for number in [0, 2, 4, MOVE_RECORDS, MOVE_RECORDS + 1, 255] {
            assert_eq!(table.get(number), None, "{number}");
        }
        table.put(3, NOTHING).expect("a place");
        assert_eq!(table, MoveRecords::default());
    }

    #[test]
    fn numbers_beyond_the_table_and_ramps_that_are_none_are_refused() {
        let mut table = MoveRecords::default();
        for number in [0, MOVE_RECORDS + 1, 255] {
            assert_eq!(table.put(number, ramp(1)), Err(NoRecord), "{number}");
        }
        assert_eq!(table.put(1, ProfiledMove { numbers: [0; 6], ..ramp(1) }), Err(NoRecord));
        assert_eq!(table.put(1, ProfiledMove { kind: 9, ..ramp(1) }), Err(NoRecord));
        assert_eq!(table, MoveRecords::default());
    }

    #[test]
    fn the_pairs_of_a_table_make_the_same_one_again() {
        let mut table = MoveRecords::default();
        for number in 1..=MOVE_RECORDS {
            table.put(number, ramp(i32::MIN + i32::from(number))).expect("a place");
        }
        assert_eq!(table.pairs().count(), MAX_PAIRS);
        table.put(2, NOTHING).expect("a place");
        let mut again = MoveRecords::default();
        assert!(table.pairs().all(|(id, value)| again.take(id, value)));
        assert_eq!((again.sift(), again), (0, table));
    }

    #[test]
    fn pairs_of_nothing_and_profiles_of_later_firmware_are_left_out() {
        let mut table = MoveRecords::default();
        for id in [0, 0x8000, 0x800f, 0x8019, 0x8100, u16::MAX] {
            assert!(!table.take(id, 1), "{id:x}");
        }
        assert!(table.take(0x8018, 9), "a kind that nobody knows");
        assert_eq!((table.sift(), table), (1, MoveRecords::default()));
    }
}
