//! USART2, the line to the host. RM0390 section 25.6.
//!
//! ```text
//! baud rate = PCLK1 / (8 (2 - OVER8) USARTDIV)
//! ```
//!
//! Both directions go by DMA. A byte of the host lasts as long as at its own rate; the receiver takes it for damaged
//! where the two rates are more than 3 % apart (25.4.5). A read of SR and then of DR clears the errors.

use std::collections::VecDeque;

use crate::register::{Words, Write};
use crate::time::{SECOND, Ticks};

const SR: u32 = 0x00;
const DR: u32 = 0x04;
const BRR: u32 = 0x08;
const CR1: u32 = 0x0c;
const CR3: u32 = 0x14;

const FRAMING: u32 = 1 << 1;
const NOISE: u32 = 1 << 2;
const OVERRUN: u32 = 1 << 3;
const RECEIVED: u32 = 1 << 5;
const SENT: u32 = 1 << 6;
const EMPTY: u32 = 1 << 7;

/// Bits of a byte on the line: start, eight, stop.
const BITS: Ticks = 10;

/// The host's rate, bits a second.
const HOST_BAUD: Ticks = 921_600;

/// A byte from the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// When its stop bit is over.
    pub at: Ticks,
    /// What came.
    pub byte: u8,
    /// Whether noise has hit it.
    pub noisy: bool,
}

/// The peripheral.
pub struct Usart {
    words: Words<7>,
    clock: Ticks,
    arrivals: VecDeque<Arrival>,
    /// What is being sent, and when its last stop bit is over.
    sending: Option<(Ticks, Vec<u8>)>,
}

impl Usart {
    /// After a reset; `clock` is a cycle of PCLK1.
    #[must_use]
    pub fn new(clock: Ticks) -> Usart {
        let words = Words::after_reset(&[(SR, SENT | EMPTY)]);
        Usart { words, clock, arrivals: VecDeque::new(), sending: None }
    }

    /// The peripheral's clock is another one.
    pub fn set_clock(&mut self, clock: Ticks) {
        self.clock = clock;
    }

    /// A register.
    pub fn read(&mut self, offset: u32) -> u32 {
        let value = self.words.get(offset);
        if offset == DR {
            let errors = FRAMING | NOISE | OVERRUN | RECEIVED;
            self.words.set(SR, self.words.get(SR) & !errors);
        }
        if offset == SR && self.sending.is_some() { value & !SENT } else { value }
    }

    /// Writes a register.
    pub fn write(&mut self, write: Write) {
        if write.offset != SR {
            self.words.keep(write);
        }
    }

    /// The host says a byte; its line is free again when it is over.
    pub fn hear(&mut self, byte: u8, noisy: bool, now: Ticks) {
        let free = self.arrivals.back().map_or(now, |last| last.at.max(now));
        self.arrivals.push_back(Arrival { at: free + BITS * SECOND / HOST_BAUD, byte, noisy });
    }

    /// When the next byte has come.
    #[must_use]
    pub fn next_arrival(&self) -> Option<Ticks> {
        self.arrivals.front().map(|arrival| arrival.at)
    }

    /// A byte that has come by now, and whether DMA is to take it. What is not taken in time is lost.
    pub fn receive(&mut self, now: Ticks, dma_serves: bool) -> Option<u8> {
        let arrival = self.arrivals.pop_front_if(|arrival| arrival.at <= now)?;
        let receives = self.words.bit(CR1, 13) && self.words.bit(CR1, 2);
        if !receives {
            return None;
        }
        let damage = if !self.keeps_the_rate() {
            FRAMING
        } else if arrival.noisy {
            NOISE
        } else {
            0
        };
        let byte = if damage == FRAMING { !arrival.byte } else { arrival.byte };
        let status = self.words.get(SR) | damage;
        if dma_serves && self.words.bit(CR3, 6) {
            self.words.set(SR, status);
            return Some(byte);
        }
        let overrun = if status & RECEIVED == 0 { 0 } else { OVERRUN };
        self.words.set(SR, status | RECEIVED | overrun);
        self.words.set(DR, u32::from(byte));
        None
    }

    /// Whether a byte waits that has come by now.
    #[must_use]
    pub fn has_come(&self, now: Ticks) -> bool {
        self.next_arrival().is_some_and(|at| at <= now)
    }

    /// Sends what the DMA brings.
    pub fn send(&mut self, bytes: Vec<u8>, now: Ticks) {
        let sends = self.words.bit(CR1, 13) && self.words.bit(CR1, 3) && self.words.bit(CR3, 7);
        if sends && !bytes.is_empty() {
            let takes = bytes.len() as Ticks * BITS * self.bit_ticks();
            self.sending = Some((now + takes, bytes));
        }
    }

    /// When the last byte has gone.
    #[must_use]
    pub fn sent_at(&self) -> Option<Ticks> {
        self.sending.as_ref().map(|(at, _)| *at)
    }

    /// What has gone by now.
    pub fn sent(&mut self, now: Ticks) -> Option<Vec<u8>> {
        self.sending.take_if(|(at, _)| *at <= now).map(|(_, bytes)| bytes)
    }

    /// Ticks of a bit at the board's rate.
    fn bit_ticks(&self) -> Ticks {
        let divider = Ticks::from(self.words.field(BRR, 0, 16));
        let over_8 = self.words.bit(CR1, 15);
        // USARTDIV is in sixteenths; at eight samples a bit, its fraction in eighths.
        self.clock * if over_8 { (divider & !0xf) / 2 + (divider & 7) } else { divider }
    }

    fn keeps_the_rate(&self) -> bool {
        let host = SECOND / HOST_BAUD;
        self.bit_ticks().abs_diff(host) * 100 <= 3 * host
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 45 MHz and a divider of 49 sixteenths: 918,367 baud.
    fn open() -> Usart {
        let mut usart = Usart::new(16);
        for (offset, value) in [(BRR, 49), (CR1, 1 << 13 | 1 << 3 | 1 << 2), (CR3, 1 << 6 | 1 << 7)] {
            usart.write(Write::of(offset, 4, value));
        }
        usart
    }

    #[test]
    fn bytes_come_one_after_the_other_at_the_rate_of_the_host() {
        let mut usart = open();
        usart.hear(1, false, 0);
        usart.hear(2, false, 0);
        assert_eq!(usart.receive(7811, true), None);
        assert_eq!(usart.receive(7812, true), Some(1));
        assert_eq!(usart.next_arrival(), Some(2 * 7812));
    }

    #[test]
    fn noise_leaves_a_flag_that_reading_the_data_clears() {
        let mut usart = open();
        usart.hear(1, true, 0);
        assert_eq!(usart.receive(8000, true), Some(1));
        assert_eq!(usart.read(SR) & NOISE, NOISE);
        usart.read(DR);
        assert_eq!(usart.read(SR) & NOISE, 0);
    }

    #[test]
    fn another_rate_damages_every_byte() {
        let mut usart = open();
        usart.write(Write::of(BRR, 4, 98));
        usart.hear(1, false, 0);
        assert_eq!(usart.receive(8000, true), Some(!1));
        assert_eq!(usart.read(SR) & FRAMING, FRAMING);
    }

    #[test]
    fn what_is_sent_has_gone_after_ten_bits_a_byte() {
        let mut usart = open();
        usart.send(vec![5, 6], 100);
        assert_eq!(usart.read(SR) & SENT, 0);
        assert_eq!(usart.sent(100 + 20 * 784 - 1), None);
        assert_eq!(usart.sent(100 + 20 * 784), Some(vec![5, 6]));
        assert_eq!(usart.read(SR) & SENT, SENT);
    }
}
