//! A change: parameters, a test and move records that a drive takes together or not at all.
//!
//! It is a run of [`Entry`]s, each as postcard writes it, and travels in parts under the CRC-32 of all its bytes.
//! A test has a CRC-32 of its own, over its entries alone: a start names test and parameters by [`start_crc32`], so
//! that nothing runs that the host does not mean.

use serde::{Deserialize, Serialize};

use crate::record::RecordCrc;
use crate::{MAX_MESSAGE, Values};

/// The longest change, bytes.
pub const MAX_CHANGE: usize = 4096;

/// The most of it that one message carries, bytes.
pub const PART_BYTES: usize = MAX_MESSAGE - 64;

/// A piece of a change. Variants are added at the end.
///
/// ```
/// use pneudrive_protocol::change::{Entries, Entry, PART_BYTES};
///
/// let entries = [
///     Entry::Test { name: "step", last_sample: 2000, round: 0, decimation: 1, pre_trigger: 0 },
///     Entry::Move { at_sample: 0, target: 8192 },
/// ];
/// let mut change = Vec::new();
/// for entry in &entries {
///     change.extend_from_slice(entry.write(&mut [0; PART_BYTES]).expect("a short name"));
/// }
/// assert!(Entries::of(&change).eq(entries.map(Ok)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Entry<'a> {
    /// Parameters of consecutive ids.
    Parameters {
        /// Id of the first one.
        first_id: u16,
        /// Their values, each in the unit of its parameter.
        #[serde(borrow)]
        values: Values<'a>,
    },
    /// A new test, which has no moves yet. At most one, before its moves.
    Test {
        /// Name of the test, kept with the record.
        name: &'a str,
        /// Number of the last sample, up to [`UNTIL_STOPPED`](crate::UNTIL_STOPPED).
        last_sample: u32,
        /// The moves repeat every this many samples; 0: they come once.
        round: u32,
        /// Every nth sample is stored; 1: all.
        decimation: u16,
        /// Stored samples before k = 0.
        pre_trigger: u16,
    },
    /// A move of the test; in order of time.
    Move {
        /// In force from this sample on.
        at_sample: u32,
        /// Setpoint (open loop: command), counts.
        target: i32,
    },
    /// A move with a profile; in order of time.
    Profile {
        /// As [`ProfiledMove`](crate::ProfiledMove) writes it.
        bytes: &'a [u8],
    },
    /// A move record: a move that is begun by its number, without a PC.
    MoveRecord {
        /// 1 to [`MOVE_RECORDS`](crate::MOVE_RECORDS).
        number: u8,
        /// As [`ProfiledMove`](crate::ProfiledMove) writes it, with the dwell (samples) in place of the first sample;
        /// kind [`NO_MOVE`](crate::profiled::NO_MOVE) removes the record of this number.
        bytes: &'a [u8],
    },
}

impl Entry<'_> {
    /// The entry's bytes at the front of `out`; None if they have no room there. [`PART_BYTES`] are enough for an
    /// entry whose name is no longer than [`MAX_TEXT`](crate::MAX_TEXT).
    #[must_use]
    pub fn write<'out>(&self, out: &'out mut [u8]) -> Option<&'out [u8]> {
        postcard::to_slice(self, out).ok().map(|written| &*written)
    }

    fn is_of_the_test(&self) -> bool {
        !matches!(self, Entry::Parameters { .. } | Entry::MoveRecord { .. })
    }
}

/// The bytes are no entry of this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Malformed;

/// The entries of a change, in order. After one that is malformed there is none.
#[derive(Clone, Debug)]
pub struct Entries<'a>(&'a [u8]);

impl<'a> Entries<'a> {
    /// The entries in these bytes.
    #[must_use]
    pub fn of(change: &'a [u8]) -> Entries<'a> {
        Entries(change)
    }
}

impl<'a> Iterator for Entries<'a> {
    type Item = Result<Entry<'a>, Malformed>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.0.is_empty() {
            return None;
        }
        let taken = postcard::take_from_bytes(self.0).map_err(|_| Malformed);
        self.0 = taken.map_or(&[], |(_, rest)| rest);
        Some(taken.map(|(entry, _)| entry))
    }
}

/// The CRC-32 of the test in a change: of the bytes of its entries. That of no bytes if it has no test.
#[must_use]
pub fn test_crc32(change: &[u8]) -> u32 {
    let (mut crc, mut entries) = (RecordCrc::new(), Entries::of(change));
    loop {
        let before = entries.0;
        let Some(Ok(entry)) = entries.next() else { return crc.finish() };
        let bytes = before.len() - entries.0.len();
        if entry.is_of_the_test() {
            crc.update(before.get(..bytes).unwrap_or(&[]));
        }
    }
}

/// What a start names: the CRC-32 of the test's CRC-32 and of that of the parameters in force, little endian.
#[must_use]
pub fn start_crc32(test_crc32: u32, parameters_crc32: u32) -> u32 {
    let mut crc = RecordCrc::new();
    crc.update(&test_crc32.to_le_bytes());
    crc.update(&parameters_crc32.to_le_bytes());
    crc.finish()
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::MAX_VALUES;
    use std::vec::Vec;

    const TEST: Entry<'_> =
        Entry::Test { name: "step", last_sample: 3076, round: 0, decimation: 1, pre_trigger: 7 };
    const MOVE: Entry<'_> = Entry::Move { at_sample: 231, target: -5 };

    fn change(entries: &[Entry<'_>]) -> Vec<u8> {
        let mut room = [0; PART_BYTES];
        entries.iter().flat_map(|entry| entry.write(&mut room).expect("room").to_vec()).collect()
    }

    fn parameters(room: &mut [u8]) -> Entry<'_> {
        Entry::Parameters { first_id: 1, values: Values::fill(room, [1300, 500]).expect("room") }
    }

    #[test]
    fn the_entries_of_a_change_come_back_in_order() {
        let mut room = [0; 8];
        let entries = [parameters(&mut room), TEST, MOVE];
        assert!(Entries::of(&change(&entries)).eq(entries.map(Ok)));
        assert_eq!(Entries::of(&[]).next(), None);
    }

    #[test]
    fn after_what_is_no_entry_there_is_none() {
        let mut bytes = change(&[TEST]);
        bytes.extend([99, 1, 2]);
        assert!(Entries::of(&bytes).eq([Ok(TEST), Err(Malformed)]));
        let cut = &change(&[MOVE])[..2];
        assert!(Entries::of(cut).eq([Err(Malformed)]));
    }

    #[test]
    fn a_test_is_known_by_its_entries_whatever_parameters_stand_between() {
        let mut room = [0; 8];
        let with = change(&[TEST, parameters(&mut room), MOVE]);
        let without = change(&[TEST, MOVE]);
        assert_eq!(test_crc32(&with), test_crc32(&without));
        assert_eq!(test_crc32(&without), crate::frame::crc32(&without));
        assert_ne!(test_crc32(&without), test_crc32(&change(&[TEST])));
        assert_eq!(test_crc32(&change(&[parameters(&mut room)])), 0, "no test at all");
    }

    #[test]
    fn a_start_names_both_test_and_parameters() {
        let named = start_crc32(1, 2);
        assert_eq!(named, crate::frame::crc32(&[1, 0, 0, 0, 2, 0, 0, 0]));
        assert!(
            [start_crc32(2, 1), start_crc32(1, 3), start_crc32(0, 2)].iter().all(|&other| other != named)
        );
    }

    #[test]
    fn the_longest_entry_fits_a_part() {
        let mut room = [0; 4 * MAX_VALUES];
        let values = Values::fill(&mut room, [-1; MAX_VALUES]).expect("room");
        let longest = Entry::Parameters { first_id: u16::MAX, values };
        assert!(longest.write(&mut [0; PART_BYTES]).is_some());
    }
}
