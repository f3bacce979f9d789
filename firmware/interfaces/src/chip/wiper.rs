//! A potentiometer as an absolute encoder: its wiper at a channel of an MCP3208 (`mcp3208`) of its own, whose reference is the
//! potentiometer's supply, so that the count is the ratio of the resistances.
//!
//! A broken wire to the wiper leaves a reading that jumps. A resistor of some hundred kilohms from the channel to
//! ground makes that reading 0. A potentiometer that is longer than the stroke keeps 0 outside the range of positions
//! (`encoder.zero_mm`).

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiDevice;

use super::ChipError;
use super::mcp3208::Mcp3208;
use crate::EncoderCounter;

/// The potentiometer.
#[derive(Debug)]
pub struct Wiper<SPI, D> {
    converter: Mcp3208<SPI, D>,
    channel: u8,
}

impl<SPI: SpiDevice, D: DelayNs> Wiper<SPI, D> {
    /// A potentiometer at this channel, 0 to 7; of a larger number the lowest three bits count.
    pub fn new(spi: SPI, delay: D, channel: u8) -> Wiper<SPI, D> {
        Wiper { converter: Mcp3208::new(spi, delay, [channel; 3]), channel }
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.converter.release()
    }
}

impl<SPI: SpiDevice, D: DelayNs> EncoderCounter for Wiper<SPI, D> {
    type Error = ChipError<SPI::Error>;

    const IS_ABSOLUTE: bool = true;

    /// 0 to 4095.
    fn count(&mut self) -> Result<i32, Self::Error> {
        self.converter.convert_channel(self.channel).map(i32::from)
    }
}
