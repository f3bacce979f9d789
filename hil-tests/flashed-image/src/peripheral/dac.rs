//! Digital-to-analogue converter, channel 1. RM0390 section 14.5: without a trigger a code in DHR12R1 goes to the output
//! at once.
//!
//! ```text
//! U = U(ref) * DOR1 / 4096        (14.3.5), U(ref) = 3.3 V; 0 while the channel is off
//! ```
//!
//! The output's stage, which does not reach the last 0.2 V to either side, is not modelled.

use pneudrive_hil_tests::converter::output_v;

use crate::register::{Words, Write};

const CR: u32 = 0x00;
const DHR12R1: u32 = 0x08;
const DOR1: u32 = 0x2c;

/// The peripheral.
pub struct Dac(Words<14>);

impl Default for Dac {
    fn default() -> Dac {
        Dac(Words::after_reset(&[]))
    }
}

impl Dac {
    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        let source = if offset == DOR1 { DHR12R1 } else { offset };
        self.0.get(source)
    }

    /// Writes a register; whether it is a code.
    pub fn write(&mut self, write: Write) -> bool {
        self.0.keep(write);
        write.offset == DHR12R1
    }

    /// What stands at the pin, V.
    #[must_use]
    pub fn volts(&self) -> f64 {
        if self.0.bit(CR, 0) { output_v(self.0.field(DHR12R1, 0, 12) as u16) } else { 0.0 }
    }
}
