//! What has come into a circular buffer that the hardware fills.

/// Where the reader stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reader(usize);

impl Reader {
    /// The next byte, given how many places the hardware has left before it begins anew. A reader that is
    /// a whole round late misses that round; the frames of the protocol tell.
    pub fn next(&mut self, ring: &[u8], left: usize) -> Option<u8> {
        let filled = ring.len().saturating_sub(left);
        if self.0 == filled {
            return None;
        }
        let byte = ring.get(self.0).copied();
        self.0 = self.0.saturating_add(1);
        if self.0 >= ring.len() {
            self.0 = 0;
        }
        byte
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
            while sent % 7 == 0 && let Some(byte) = reader.next(&ring, left) {
                assert_eq!(byte, seen);
                seen += 1;
            }
        }
        assert_eq!(seen, 99, "the last look was at byte 98");
    }

    #[test]
    fn an_empty_ring_gives_nothing_whatever_the_hardware_says() {
        for left in [7, 8, 9] {
            assert_eq!(Reader::default().next(&[], left), None);
        }
        assert_eq!(Reader::default().next(&[1, 2], 2), None);
    }
}
