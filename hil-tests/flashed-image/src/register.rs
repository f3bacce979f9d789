//! Registers of peripherals, and accesses to them.

/// A write: where, what, and which of its bits are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Write {
    /// Bytes from the start of the peripheral; a multiple of four.
    pub offset: u32,
    /// In its place within the word.
    pub value: u32,
    /// Ones where bits are written.
    pub mask: u32,
}

impl Write {
    /// A write of 1, 2 or 4 bytes.
    #[must_use]
    pub fn of(offset: u32, bytes: usize, value: u64) -> Write {
        let shift = 8 * (offset % 4);
        let mask = (((1_u64 << (8 * bytes)) - 1) as u32) << shift;
        Write { offset: offset & !3, value: ((value as u32) << shift) & mask, mask }
    }

    /// What becomes of a register that keeps what is written.
    #[must_use]
    pub fn into(self, old: u32) -> u32 {
        (old & !self.mask) | self.value
    }
}

/// The registers of a peripheral that keep what is written, `N` words from its start on.
#[derive(Clone, Debug)]
pub struct Words<const N: usize>([u32; N]);

impl<const N: usize> Words<N> {
    /// All zero but these, each an offset and its value after a reset.
    #[must_use]
    pub fn after_reset(others: &[(u32, u32)]) -> Words<N> {
        let mut words = Words([0; N]);
        others.iter().for_each(|&(offset, value)| words.set(offset, value));
        words
    }

    /// A register; those beyond the last read 0.
    #[must_use]
    pub fn get(&self, offset: u32) -> u32 {
        self.0.get(offset as usize / 4).copied().unwrap_or(0)
    }

    /// Sets a register.
    pub fn set(&mut self, offset: u32, value: u32) {
        if let Some(word) = self.0.get_mut(offset as usize / 4) {
            *word = value;
        }
    }

    /// Keeps what is written; the new value.
    pub fn keep(&mut self, write: Write) -> u32 {
        let value = write.into(self.get(write.offset));
        self.set(write.offset, value);
        value
    }

    /// Whether a bit is set.
    #[must_use]
    pub fn bit(&self, offset: u32, bit: u32) -> bool {
        self.get(offset) >> bit & 1 == 1
    }

    /// The field of `bits` bits from `low` on.
    #[must_use]
    pub fn field(&self, offset: u32, low: u32, bits: u32) -> u32 {
        self.get(offset) >> low & ((1 << bits) - 1)
    }

    /// Sets or clears a bit.
    pub fn put(&mut self, offset: u32, bit: u32, on: bool) {
        let value = self.get(offset) & !(1 << bit) | u32::from(on) << bit;
        self.set(offset, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_word_leaves_the_other_half() {
        let write = Write::of(6, 2, 0xabcd);
        assert_eq!(write, Write { offset: 4, value: 0xabcd_0000, mask: 0xffff_0000 });
        assert_eq!(write.into(0x1111_2222), 0xabcd_2222);
        assert_eq!(Write::of(8, 4, 0xffff_ffff).into(5), u32::MAX);
    }
}
