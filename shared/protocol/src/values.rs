//! Runs of numbers as they travel: plain bytes, read from where they are.

use core::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use crate::MAX_VALUES;

/// A run of up to [`MAX_VALUES`] numbers, little endian, left in the bytes they came in.
#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Values<'a>(&'a [u8]);

impl<'a> Values<'a> {
    /// The numbers in these bytes, four each; None if they end within one or are too many.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Option<Values<'a>> {
        let (values, rest) = bytes.as_chunks::<4>();
        (rest.is_empty() && values.len() <= MAX_VALUES).then_some(Values(bytes))
    }

    /// Writes the numbers to the front of `buffer`; None if it has no room for them or they are
    /// too many. 4 * [`MAX_VALUES`] bytes are always enough.
    #[must_use]
    pub fn fill(buffer: &'a mut [u8], values: impl IntoIterator<Item = i32>) -> Option<Values<'a>> {
        let mut slots = buffer.as_chunks_mut::<4>().0.iter_mut();
        let mut len = 0;
        for value in values {
            *slots.next()? = value.to_le_bytes();
            len += 1;
        }
        Values::new(buffer.as_chunks::<4>().0.get(..len)?.as_flattened())
    }

    /// The numbers in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = i32> + Clone + use<'a> {
        self.0.as_chunks().0.iter().map(|&bytes| i32::from_le_bytes(bytes))
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.iter().len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl fmt::Debug for Values<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for Values<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let bytes = <&[u8]>::deserialize(deserializer)?;
        Values::new(bytes).ok_or_else(|| D::Error::invalid_length(bytes.len(), &"whole 32-bit values"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_from_where_they_are() {
        let bytes = [1, 0, 0, 0, 0xfe, 0xff, 0xff, 0xff];
        let values = Values::new(&bytes).expect("two values");
        assert!(values.iter().eq([1, -2]));
        assert_eq!((values.len(), values.is_empty()), (2, false));
        assert!(Values::new(&[]).expect("none").is_empty());
        for end in [1, 3, 5, 7] {
            assert_eq!(Values::new(&bytes[..end]), None, "{end} bytes");
        }
        assert!(Values::new(&[0; 4 * MAX_VALUES]).is_some());
        assert_eq!(Values::new(&[0; 4 * MAX_VALUES + 4]), None);
    }

    #[test]
    fn values_fill_a_buffer_that_has_room() {
        let mut buffer = [0xaa; 11];
        assert!(Values::fill(&mut buffer, [i32::MIN, 7]).expect("room").iter().eq([i32::MIN, 7]));
        assert_eq!(buffer, [0, 0, 0, 0x80, 7, 0, 0, 0, 0xaa, 0xaa, 0xaa]);
        assert_eq!(Values::fill(&mut buffer, [1, 2, 3]), None);
        assert_eq!(Values::fill(&mut [0; 1000], 0..), None, "no end of them");
        assert_eq!(Values::fill(&mut [0; 1000], [0; MAX_VALUES + 1]), None);
        assert!(Values::fill(&mut [], []).expect("none").is_empty());
    }
}
