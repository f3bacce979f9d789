//! LS7366R: a quadrature counter of 32 bits on SPI.
//!
//! Data sheet: LSI/CSI 7366R, "32-bit quadrature counter with serial interface", the register description and Table 1.
//! An instruction is one byte, with the function in bits 7 and 6 and the register in bits 5 to 3; data follow, most
//! significant byte first.
//!
//! | sent | does |
//! |---|---|
//! | `88 03` | MDR0: four counts a period, free-running, no index, filter clock undivided |
//! | `90 00` | MDR1: four bytes, counting, no flags |
//! | `20` | clears CNTR |
//! | `60` and four bytes | takes CNTR over into OTR at once and reads OTR: the count at this instant |
//! | `48` and a byte | reads MDR0 |
//!
//! MDR0 is read with every count. It is cleared when the chip's power comes, and a line that is stuck reads as 00 or ff,
//! so a chip that is missing, or has lost its power and with it the count, makes an error.
//!
//! Mode 0. The clock of SPI may have 5 MHz with 5 V and 4 MHz with 3.3 V. The clock of the filter must be four times
//! as fast as the edges of the encoder.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiDevice;

use super::ChipError;
use super::frame::{Frames, Times};
use crate::EncoderCounter;

/// Name for messages.
const CHIP: &str = "LS7366R";

/// A whole clock at 2 MHz each. Of the data sheet the table of these times was not at hand; its clock may have 4 MHz
/// with 3.3 V, so no half of a clock is longer than 125 ns.
pub const TIMES: Times = Times { rest_ns: 500, lead_ns: 500, trail_ns: 500 };

const CLEAR_COUNTER: u8 = 0x20;
const READ_MODE_0: u8 = 0x48;
const READ_COUNTER: u8 = 0x60;
const WRITE_MODE_0: u8 = 0x88;
const WRITE_MODE_1: u8 = 0x90;

/// Four counts a period of the encoder.
const MODE_0: u8 = 0x03;
/// Four bytes.
const MODE_1: u8 = 0x00;

/// The counter of an encoder.
#[derive(Debug)]
pub struct Ls7366r<SPI, D> {
    frames: Frames<SPI, D>,
}

impl<SPI: SpiDevice, D: DelayNs> Ls7366r<SPI, D> {
    /// Starts counting from 0.
    ///
    /// # Errors
    /// When the bus fails, or the chip does not keep its mode.
    pub fn start(spi: SPI, delay: D) -> Result<Ls7366r<SPI, D>, ChipError<SPI::Error>> {
        let mut counter = Ls7366r { frames: Frames::new(spi, delay, TIMES) };
        counter.frames.exchange(&mut [WRITE_MODE_0, MODE_0])?;
        counter.frames.exchange(&mut [WRITE_MODE_1, MODE_1])?;
        counter.frames.exchange(&mut [CLEAR_COUNTER])?;
        counter.check_mode()?;
        Ok(counter)
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.frames.release()
    }

    /// Whether the chip has the mode that it was given.
    fn check_mode(&mut self) -> Result<(), ChipError<SPI::Error>> {
        let mut bytes = [READ_MODE_0, 0];
        self.frames.exchange(&mut bytes)?;
        match bytes {
            [_, MODE_0] => Ok(()),
            [_, mode] => Err(ChipError::Nonsense { chip: CHIP, answer: u32::from(mode) }),
        }
    }
}

impl<SPI: SpiDevice, D: DelayNs> EncoderCounter for Ls7366r<SPI, D> {
    type Error = ChipError<SPI::Error>;

    fn count(&mut self) -> Result<i32, Self::Error> {
        let mut bytes = [READ_COUNTER, 0, 0, 0, 0];
        self.frames.exchange(&mut bytes)?;
        let [_, count @ ..] = bytes;
        self.check_mode()?;
        Ok(i32::from_be_bytes(count))
    }
}
