//! ADC1: a scan of channels when the program asks. RM0390 section 13 (13.3.5 single scan, 13.8 DMA, 13.12 and 13.13
//! registers).
//!
//! ```text
//! a channel takes (sampling time + 12) cycles of ADCCLK = PCLK2 / ADCPRE
//! code = floor(U / U(ref) * 4096), within 0 to 4095
//! ```

use std::collections::VecDeque;

use pneudrive_hil_tests::converter::code_of;

use crate::register::{Words, Write};
use crate::time::Ticks;

const SR: u32 = 0x00;
const CR2: u32 = 0x08;
const SMPR1: u32 = 0x0c;
const SMPR2: u32 = 0x10;
const SQR1: u32 = 0x2c;
const SQR3: u32 = 0x34;
const DR: u32 = 0x4c;

/// The registers that the converters share, from the start of the first one on.
pub const COMMON: u32 = 0x300;
const CCR: u32 = 0x04;

const ADON: u32 = 0;
const DMA: u32 = 8;
const SWSTART: u32 = 30;
const STARTED: u32 = 4;

/// Cycles of each sampling time.
const SAMPLING: [Ticks; 8] = [3, 15, 28, 56, 84, 112, 144, 480];

/// The peripheral.
pub struct Adc {
    words: Words<22>,
    common: Words<3>,
    /// Conversions on their way: when each is done, and its channel.
    scan: VecDeque<(Ticks, u32)>,
    /// No conversion comes any more.
    pub stuck: bool,
}

impl Adc {
    /// After a reset.
    #[must_use]
    pub fn new(stuck: bool) -> Adc {
        let (words, common) = (Words::after_reset(&[]), Words::after_reset(&[]));
        Adc { words, common, scan: VecDeque::new(), stuck }
    }

    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        if offset >= COMMON { self.common.get(offset - COMMON) } else { self.words.get(offset) }
    }

    /// Writes a register; `clock` is a cycle of PCLK2.
    pub fn write(&mut self, write: Write, clock: Ticks, now: Ticks) {
        match write.offset {
            offset if offset >= COMMON => {
                self.common.keep(Write { offset: offset - COMMON, ..write });
            }
            // Zeros clear.
            SR => self.words.set(SR, self.words.get(SR) & (write.value | !write.mask)),
            CR2 => {
                let value = self.words.keep(write);
                self.words.put(CR2, SWSTART, false);
                if value >> ADON & 1 == 0 {
                    self.scan.clear();
                } else if value >> SWSTART & 1 == 1 && !self.stuck {
                    self.start(clock, now);
                }
            }
            _ => {
                self.words.keep(write);
            }
        }
    }

    /// Puts the channels of the sequence on their way.
    fn start(&mut self, clock: Ticks, now: Ticks) {
        let cycle = clock * Ticks::from(2 * self.common.field(CCR, 16, 2) + 2);
        let mut done = now;
        for rank in 0..=self.words.field(SQR1, 20, 4) {
            let channel = self.words.field(SQR3 - 4 * (rank / 6), 5 * (rank % 6), 5);
            done += cycle * (SAMPLING[self.sampling(channel)] + 12);
            self.scan.push_back((done, channel));
        }
        self.words.put(SR, STARTED, true);
    }

    fn sampling(&self, channel: u32) -> usize {
        let (register, place) = if channel < 10 { (SMPR2, channel) } else { (SMPR1, channel - 10) };
        self.words.field(register, 3 * place, 3) as usize
    }

    /// The channel of the next conversion that is done by now.
    pub fn done(&mut self, now: Ticks) -> Option<u32> {
        let (done, channel) = *self.scan.front()?;
        (done <= now && !self.stuck).then(|| {
            self.scan.pop_front();
            channel
        })
    }

    /// Takes a conversion of a voltage into the data register; the code, where it is asked to go on by DMA.
    pub fn convert(&mut self, volts: f64) -> Option<u16> {
        let code = code_of(volts);
        self.words.set(DR, u32::from(code));
        self.words.bit(CR2, DMA).then_some(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_hil_tests::converter::code_centre_v;

    #[test]
    fn every_code_comes_back_from_the_middle_of_its_voltages() {
        let mut adc = Adc::new(false);
        adc.write(Write::of(CR2, 4, 1 << ADON | 1 << DMA), 8, 0);
        for code in 0..4096 {
            assert_eq!(adc.convert(code_centre_v(code)), Some(code as u16));
        }
        assert_eq!((adc.convert(-0.1), adc.convert(3.4)), (Some(0), Some(4095)));
    }

    #[test]
    fn three_channels_of_28_cycles_at_22_5_mhz_take_5_3_microseconds() {
        let mut adc = Adc::new(false);
        let set = [(COMMON + CCR, 1 << 16), (SQR1, 2 << 20), (SQR3, 10 | 11 << 5 | 8 << 10)];
        let sampling = [(SMPR1, 2 | 2 << 3), (SMPR2, 2 << 24), (CR2, 1 << SWSTART | 1)];
        for (offset, value) in set.into_iter().chain(sampling) {
            adc.write(Write::of(offset, 4, value), 8, 0);
        }
        let done: Vec<_> = adc.scan.iter().copied().collect();
        assert_eq!(done, [(1280, 10), (2560, 11), (3840, 8)]);
        assert_eq!((adc.done(1279), adc.done(1280), adc.done(1281)), (None, Some(10), None));
    }
}
