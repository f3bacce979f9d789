//! Power controller. RM0390 section 5.4: the over-drive of 180 MHz is ready as soon as it is requested.

use crate::register::{Words, Write};

const CR: u32 = 0x00;
const CSR: u32 = 0x04;

/// The peripheral.
pub struct Pwr(Words<2>);

impl Default for Pwr {
    fn default() -> Pwr {
        Pwr(Words::after_reset(&[(CR, 0xc000)]))
    }
}

impl Pwr {
    /// A register: ODRDY and ODSWRDY follow ODEN and ODSWEN, and the regulator is ready.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        const REGULATOR_READY: u32 = 1 << 14;
        match offset {
            CSR => self.0.get(CR) & (1 << 16 | 1 << 17) | REGULATOR_READY,
            _ => self.0.get(offset),
        }
    }

    /// Writes a register.
    pub fn write(&mut self, write: Write) {
        self.0.keep(write);
    }
}
