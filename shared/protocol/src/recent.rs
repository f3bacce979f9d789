//! Messages that went or came lately, by their CRC: to know them again when they come back.
//!
//! Requests and replies share their numbers, and on a line that is coupled into itself each side hears what it
//! has said: a `RecordInfo` reply reads as an `Arm` request of the same number, a `ConfigSet` request as a
//! `Done` reply. So both sides pass over what they have said themselves.

/// The last `N` messages, by their CRC.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Recent<const N: usize>([Option<u32>; N]);

impl<const N: usize> Default for Recent<N> {
    fn default() -> Self {
        Recent([None; N])
    }
}

impl<const N: usize> Recent<N> {
    /// Whether a message with this CRC is among them.
    #[must_use]
    pub fn holds(&self, crc32: u32) -> bool {
        self.0.contains(&Some(crc32))
    }

    /// Adds a message, in place of the oldest one; one that is among them stays where it is.
    pub fn add(&mut self, crc32: u32) {
        if !self.holds(crc32) {
            self.0.rotate_right(1);
            if let Some(newest) = self.0.first_mut() {
                *newest = Some(crc32);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_ones_are_known_again_and_older_ones_are_not() {
        let mut recent = Recent::<3>::default();
        assert!(!recent.holds(0));
        for crc32 in [0, 7, 7, 8, 9] {
            recent.add(crc32);
        }
        assert_eq!([0, 7, 8, 9].map(|crc32| recent.holds(crc32)), [false, true, true, true]);
    }
}
