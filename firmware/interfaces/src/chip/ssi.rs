//! An absolute encoder with a synchronous serial interface (SSI), read by SPI.
//!
//! Source: "SSI", Posital, single transmission: clock and data are high at rest. The first falling edge of the clock
//! takes the position over, each rising edge puts the next bit on the line, the most significant one first, and the
//! rising edge after the last bit pulls the line low until the monoflop of the encoder has run out (10 to 30
//! microseconds), which is the least pause between two readings.
//!
//! In mode 2 (clock high at rest, data taken at the falling edge) the bus thus takes
//!
//! ```text
//! 1   bit n-1 .. bit 0   0
//! ```
//!
//! The 1 in front and the 0 behind are checked: a line that is stuck, an encoder without supply and one of another
//! number of bits make errors, the last of them at some positions only. Clocks beyond the 0, up to a whole byte, are
//! ignored.
//!
//! Nobody waits for that pause: readings are a period apart, 100 microseconds and more. One that comes too early finds the
//! line low, and is an error.
//!
//! At most 1.5 MHz on a short line, 100 kHz on one of 400 m. The bus must not be shared with chips of another mode.

use embedded_hal::spi::SpiDevice;

use super::ChipError;
use crate::EncoderCounter;

/// Name for messages.
const CHIP: &str = "SSI encoder";

/// Most bits: with one in front and one behind they fit 32 clocks.
pub const MAX_BITS: u8 = 30;

/// How an encoder puts its position on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coding {
    /// As a binary number.
    Binary,
    /// In Gray code: neighbouring positions differ in one bit.
    Gray,
}

/// The encoder.
#[derive(Debug)]
pub struct SsiEncoder<SPI> {
    spi: SPI,
    bits: u8,
    coding: Coding,
}

impl<SPI: SpiDevice> SsiEncoder<SPI> {
    /// An encoder with this many bits; None for less than one and more than [`MAX_BITS`].
    pub fn new(spi: SPI, bits: u8, coding: Coding) -> Option<SsiEncoder<SPI>> {
        (1..=MAX_BITS).contains(&bits).then_some(SsiEncoder { spi, bits, coding })
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.spi
    }
}

/// The position in a reading; None if the bits before and after it are wrong.
fn position(answer: u32, bits: u8, coding: Coding) -> Option<u32> {
    let behind = u32::BITS.checked_sub(u32::from(bits) + 2)?;
    let frame = answer >> behind;
    let is_frame = frame >> (u32::from(bits) + 1) == 1 && frame & 1 == 0;
    let sent = (frame >> 1) & !(1 << bits);
    is_frame.then_some(match coding {
        Coding::Binary => sent,
        Coding::Gray => from_gray(sent),
    })
}

/// Each bit is the parity of the bits from the highest one down to it.
fn from_gray(mut code: u32) -> u32 {
    for shift in [1, 2, 4, 8, 16] {
        code ^= code >> shift;
    }
    code
}

impl<SPI: SpiDevice> EncoderCounter for SsiEncoder<SPI> {
    type Error = ChipError<SPI::Error>;

    const IS_ABSOLUTE: bool = true;

    /// 0 to 2^bits - 1.
    fn count(&mut self) -> Result<i32, Self::Error> {
        let mut bytes = [0; 4];
        let clocked = (usize::from(self.bits) + 2).div_ceil(8);
        let read = bytes.get_mut(..clocked).unwrap_or_default();
        self.spi.read(read).map_err(ChipError::Bus)?;
        let answer = u32::from_be_bytes(bytes);
        let position = position(answer, self.bits, self.coding);
        position.map(u32::cast_signed).ok_or(ChipError::Nonsense { chip: CHIP, answer })
    }
}
