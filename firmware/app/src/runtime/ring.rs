//! The bytes that have arrived in a circular buffer that the hardware fills.

/// Where the reader stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reader(usize);

impl Reader {
    /// The place of the next received byte in a ring of this size, from the number of bytes that the hardware has left
    /// before it wraps. A reader that is a whole round late misses that round; the frames of the protocol show it.
    pub fn next(&mut self, places: usize, left: usize) -> Option<usize> {
        let filled = places.saturating_sub(left);
        if self.0 == filled || self.0 >= places {
            return None;
        }
        let place = self.0;
        self.0 = if place + 1 < places { place + 1 } else { 0 };
        Some(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_out_in_their_order_round_after_round() {
        let (mut ring, mut reader, mut left) = ([0; 8], Reader::default(), 8);
        let mut seen = 0_u8;
        for sent in 0..100_u8 {
            ring[8 - left] = sent;
            left = if left == 1 { 8 } else { left - 1 };
            // Looks once in a while, at most seven bytes late.
            while sent % 7 == 0
                && let Some(place) = reader.next(8, left)
            {
                assert_eq!(ring[place], seen);
                seen += 1;
            }
        }
        assert_eq!(seen, 99, "the last look was at byte 98");
    }

    #[test]
    fn an_empty_ring_gives_nothing_whatever_the_hardware_says() {
        for left in [0, 7, 8, 9] {
            assert_eq!(Reader::default().next(0, left), None);
        }
        assert_eq!(Reader::default().next(2, 2), None);
    }
}
