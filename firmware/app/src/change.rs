//! A change in transit: its parts, collected until all have arrived.

use heapless::Vec;
use pneudrive_protocol::change::MAX_CHANGE;
use pneudrive_protocol::frame;

/// A part is missing, or the bytes are not those that the CRC names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotWhole;

/// The parts of a change that have come.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Parts {
    crc32: u32,
    bytes: Vec<u8, MAX_CHANGE>,
}

impl Parts {
    /// Takes a part. One that begins at byte 0 begins a new change, unless it is the first part of this one again.
    ///
    /// # Errors
    /// When an earlier part is missing, or the change is too long; the parts received so far stay.
    pub fn add(&mut self, crc32: u32, first: u16, part: &[u8]) -> Result<(), NotWhole> {
        let first = usize::from(first);
        let end = first.saturating_add(part.len());
        if self.crc32 == crc32 && self.bytes.get(first..end) == Some(part) {
            return Ok(());
        }
        let follows = self.crc32 == crc32 && first == self.bytes.len();
        if (first != 0 && !follows) || end > MAX_CHANGE {
            return Err(NotWhole);
        }
        self.bytes.truncate(first);
        self.crc32 = crc32;
        self.bytes.extend_from_slice(part).map_err(|_| NotWhole)
    }

    /// The change that has this CRC-32, whole.
    ///
    /// # Errors
    /// When it is not.
    pub fn whole(&self, crc32: u32) -> Result<&[u8], NotWhole> {
        let is_whole = self.crc32 == crc32 && frame::crc32(&self.bytes) == crc32;
        if is_whole { Ok(&self.bytes) } else { Err(NotWhole) }
    }

    /// Forgets the parts received so far.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.crc32 = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: u32 = 0xcbf4_3926; // of "123456789"

    #[test]
    fn parts_that_follow_each_other_are_a_change_also_if_some_come_twice() {
        let mut parts = Parts::default();
        for (first, part) in
            [(0, &b"1234"[..]), (0, b"1234"), (4, b"567"), (0, b"1234"), (4, b"567"), (7, b"89")]
        {
            assert_eq!(parts.whole(ONE), Err(NotWhole));
            parts.add(ONE, first, part).expect("follows");
        }
        parts.add(ONE, 0, b"1234").expect("it is there already");
        assert_eq!(parts.whole(ONE), Ok(&b"123456789"[..]));
        assert_eq!(parts.whole(ONE + 1), Err(NotWhole));
        parts.clear();
        assert_eq!(parts.whole(ONE), Err(NotWhole));
    }

    #[test]
    fn a_gap_another_change_and_wrong_bytes_are_no_whole() {
        let mut parts = Parts::default();
        parts.add(ONE, 0, b"1234").expect("begins");
        assert_eq!(parts.add(ONE, 5, b"6789"), Err(NotWhole), "a byte is missing");
        assert_eq!(parts.add(ONE + 1, 4, b"56789"), Err(NotWhole), "of another change");
        parts.add(ONE, 4, b"56780").expect("follows");
        assert_eq!(parts.whole(ONE), Err(NotWhole), "not these bytes");
        parts.add(ONE + 1, 0, b"1").expect("begins another change");
        assert_eq!(parts.add(ONE, 1, b"23456789"), Err(NotWhole));
    }

    #[test]
    fn a_change_that_has_no_room_is_refused() {
        let mut parts = Parts::default();
        parts.add(7, 0, &[1; MAX_CHANGE]).expect("it fits");
        assert_eq!(parts.add(7, MAX_CHANGE as u16, &[1]), Err(NotWhole));
        assert_eq!(parts.add(7, 0, &[1; MAX_CHANGE + 1]), Err(NotWhole));
    }
}
