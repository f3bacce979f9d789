//! A DMA controller. RM0390 section 9.5: streams with a channel each, a counter of transfers (NDTR) that restarts in
//! circular mode, and a flag at the end. A transfer takes no time here.

use crate::register::{Words, Write};

const LISR: u32 = 0x00;
const HISR: u32 = 0x04;
const LIFCR: u32 = 0x08;
const HIFCR: u32 = 0x0c;
const STREAMS: u32 = 0x10;
const STREAM_BYTES: u32 = 0x18;

/// Registers of a stream, from its start on.
const CR: u32 = 0x00;
const NDTR: u32 = 0x04;
const M0AR: u32 = 0x0c;

const ENABLE: u32 = 0;
const CIRCULAR: u32 = 8;
const MEMORY_INCREMENT: u32 = 10;

/// Where the flags of a stream stand in its status register, and the one of a transfer that is complete.
const SHIFTS: [u32; 4] = [0, 6, 16, 22];
const COMPLETE: u32 = 5;

/// Memory that the controller reaches.
pub trait Memory {
    /// Reads bytes.
    fn fetch(&mut self, address: u32, bytes: &mut [u8]);

    /// Writes bytes.
    fn store(&mut self, address: u32, bytes: &[u8]);
}

/// The controller.
pub struct Dma {
    words: Words<52>,
    /// NDTR of each stream when it was enabled.
    reload: [u32; 8],
}

impl Default for Dma {
    fn default() -> Dma {
        Dma { words: Words::after_reset(&[]), reload: [0; 8] }
    }
}

fn register(stream: u32, offset: u32) -> u32 {
    STREAMS + STREAM_BYTES * stream + offset
}

impl Dma {
    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        self.words.get(offset)
    }

    /// Writes a register; the stream that this has enabled.
    pub fn write(&mut self, write: Write) -> Option<u32> {
        match write.offset {
            LISR | HISR => {}
            LIFCR => self.words.set(LISR, self.words.get(LISR) & !write.value),
            HIFCR => self.words.set(HISR, self.words.get(HISR) & !write.value),
            offset => {
                let was_on = self.words.bit(offset, ENABLE);
                let value = self.words.keep(write);
                let stream = (offset - STREAMS) / STREAM_BYTES;
                if offset == register(stream, CR) && value & 1 == 1 && !was_on {
                    self.reload[stream as usize] = self.words.get(register(stream, NDTR));
                    return Some(stream);
                }
            }
        }
        None
    }

    /// Whether a stream is enabled and on a channel.
    #[must_use]
    pub fn serves(&self, stream: u32, channel: u32) -> bool {
        let cr = register(stream, CR);
        self.words.bit(cr, ENABLE) && self.words.field(cr, 25, 3) == channel
    }

    /// A peripheral's data, to where the stream stands.
    pub fn deliver(&mut self, stream: u32, data: &[u8], memory: &mut dyn Memory) {
        let left = self.words.get(register(stream, NDTR));
        if left == 0 {
            return;
        }
        let incremented = self.words.bit(register(stream, CR), MEMORY_INCREMENT);
        let done = (self.reload[stream as usize] - left) * u32::from(incremented);
        memory.store(self.words.get(register(stream, M0AR)) + done * data.len() as u32, data);
        self.count(stream, left - 1);
    }

    /// Everything that a stream has still to bring to a peripheral, bytes.
    #[must_use]
    pub fn outgoing(&self, stream: u32, memory: &mut dyn Memory) -> Vec<u8> {
        let mut bytes = vec![0; self.words.get(register(stream, NDTR)) as usize];
        memory.fetch(self.words.get(register(stream, M0AR)), &mut bytes);
        bytes
    }

    /// A stream has brought everything to its peripheral.
    pub fn complete(&mut self, stream: u32) {
        self.count(stream, 0);
    }

    fn count(&mut self, stream: u32, left: u32) {
        let (cr, ndtr) = (register(stream, CR), register(stream, NDTR));
        self.words.set(ndtr, left);
        if left > 0 {
            return;
        }
        let status = if stream < 4 { LISR } else { HISR };
        self.words.put(status, SHIFTS[stream as usize % 4] + COMPLETE, true);
        if self.words.bit(cr, CIRCULAR) {
            self.words.set(ndtr, self.reload[stream as usize]);
        } else {
            self.words.put(cr, ENABLE, false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Memory for Vec<u8> {
        fn fetch(&mut self, address: u32, bytes: &mut [u8]) {
            bytes.copy_from_slice(&self[address as usize..][..bytes.len()]);
        }

        fn store(&mut self, address: u32, bytes: &[u8]) {
            self[address as usize..][..bytes.len()].copy_from_slice(bytes);
        }
    }

    #[test]
    fn a_circular_stream_fills_its_memory_round_after_round_and_flags_each() {
        let (mut dma, mut memory) = (Dma::default(), vec![0; 8]);
        dma.write(Write::of(register(0, M0AR), 4, 2));
        dma.write(Write::of(register(0, NDTR), 4, 3));
        let cr = 1 << CIRCULAR | 1 << MEMORY_INCREMENT | 1;
        assert_eq!(dma.write(Write::of(register(0, CR), 4, cr)), Some(0));
        for byte in 1..=4 {
            dma.deliver(0, &[byte], &mut memory);
            assert_eq!(dma.read(LISR) >> COMPLETE & 1 == 1, byte >= 3);
        }
        assert_eq!(memory, [0, 0, 4, 2, 3, 0, 0, 0]);
        assert_eq!(dma.read(register(0, NDTR)), 2);
    }

    #[test]
    fn a_stream_that_is_not_circular_ends_and_its_flags_are_cleared_by_ones() {
        let (mut dma, mut memory) = (Dma::default(), vec![7, 8, 9]);
        dma.write(Write::of(register(6, NDTR), 4, 2));
        dma.write(Write::of(register(6, CR), 4, 4 << 25 | 1));
        assert!(dma.serves(6, 4) && !dma.serves(6, 3));
        assert_eq!(dma.outgoing(6, &mut memory), [7, 8]);
        dma.complete(6);
        assert!(!dma.serves(6, 4));
        assert_eq!(dma.read(HISR), 1 << (16 + COMPLETE));
        dma.write(Write::of(HIFCR, 4, u64::from(u32::MAX)));
        assert_eq!(dma.read(HISR), 0);
    }
}
