//! A port of general-purpose pins. RM0390 section 7.4.
//!
//! A pin is driven by the board where MODER says output, and belongs to a peripheral where it says alternate function
//! and AFR that peripheral's number. The wiring determines the level of any other pin.

use crate::register::{Words, Write};

const MODER: u32 = 0x00;
const PUPDR: u32 = 0x0c;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const AFRL: u32 = 0x20;

/// The port.
pub struct Port {
    words: Words<10>,
    /// What the wiring drives, by pin; a pin that nobody drives follows its pull, else is low.
    wired: [Option<bool>; 16],
}

impl Port {
    /// After a reset: port A and B have pins of the debugger.
    #[must_use]
    pub fn new(mode: u32, pull: u32) -> Port {
        Port { words: Words::after_reset(&[(MODER, mode), (PUPDR, pull)]), wired: [None; 16] }
    }

    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        match offset {
            IDR => (0..16).map(|pin| u32::from(self.level(pin)) << pin).sum(),
            BSRR => 0,
            _ => self.words.get(offset),
        }
    }

    /// Writes a register.
    pub fn write(&mut self, write: Write) {
        if write.offset == BSRR {
            let (set, reset) = (write.value & 0xffff, write.value >> 16);
            self.words.set(ODR, self.words.get(ODR) & !reset | set);
        } else {
            self.words.keep(write);
        }
    }

    /// What the wiring drives a pin to; None: nobody does.
    pub fn wire(&mut self, pin: u32, level: Option<bool>) {
        self.wired[pin as usize] = level;
    }

    /// The level of a pin.
    #[must_use]
    pub fn level(&self, pin: u32) -> bool {
        let pulled_up = self.words.field(PUPDR, 2 * pin, 2) == 1;
        self.driven(pin).unwrap_or(self.wired[pin as usize].unwrap_or(pulled_up))
    }

    /// The level that the program drives a pin to; None where it is no output.
    #[must_use]
    pub fn driven(&self, pin: u32) -> Option<bool> {
        (self.words.field(MODER, 2 * pin, 2) == 1).then(|| self.words.bit(ODR, pin))
    }

    /// Whether a pin belongs to a peripheral, by the number of the alternate function.
    #[must_use]
    pub fn is_alternate(&self, pin: u32, function: u32) -> bool {
        let chosen = self.words.field(AFRL + 4 * (pin / 8), 4 * (pin % 8), 4);
        self.words.field(MODER, 2 * pin, 2) == 2 && chosen == function
    }

    /// Whether a pin is analogue.
    #[must_use]
    pub fn is_analogue(&self, pin: u32) -> bool {
        self.words.field(MODER, 2 * pin, 2) == 3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pin_is_an_input_until_the_program_drives_it() {
        let mut port = Port::new(0, 0);
        port.write(Write::of(ODR, 4, 1 << 10));
        assert_eq!((port.driven(10), port.level(10)), (None, false), "the pull-down holds it");
        port.write(Write::of(MODER, 4, 1 << 20));
        assert_eq!(port.driven(10), Some(true));
        port.write(Write::of(BSRR, 4, 1 << 26));
        assert_eq!(port.driven(10), Some(false));
    }

    #[test]
    fn an_open_pin_follows_its_pull_and_a_contact_overcomes_it() {
        let mut port = Port::new(0, 1 << 18);
        assert!(port.level(9));
        port.wire(9, Some(false));
        assert!(!port.level(9));
    }
}
