//! MCP3208: a converter of 12 bits with eight channels on SPI, for the pressure sensors.
//!
//! Data sheet: Microchip DS21298, "2.7V 4-Channel/8-Channel 12-Bit A/D Converters with SPI Serial Interface",
//! section 5, Table 5-2 and Figure 6-1. A conversion is one frame of three bytes:
//!
//! ```text
//! sent      0 0 0 0 0 1 S D2    D1 D0 x x x x x x      x x x x x x x x     1: start bit, S: single-ended
//! received  ? ? ? ? ? ? ? ?     ?  ?  ? 0 B11..B8      B7..B0              0: null bit
//! ```
//!
//! The fifth bit of the answer's second byte, the null bit, is always 0: a line that is stuck high or held up by a
//! resistor makes an error. A line that is stuck low reads as 0 counts, which the supervisor takes for an open sensor
//! (`safety.sensor_margin`).
//!
//! Mode 0 or 3. At most 2 MHz with a supply of 5 V and 1 MHz with 2.7 V; at least 10 kHz, as the capacitor of the
//! sample discharges. Three channels at 1 MHz take 75 microseconds and more.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiDevice;

use super::ChipError;
use super::frame::{Frames, Times};
use crate::{Conversions, PressureInput};

/// Name for messages.
const CHIP: &str = "MCP3208";

/// Section 1, timing parameters: t_CSH 500 ns, t_SUCS 100 ns; no time is required after the last clock.
pub const TIMES: Times = Times { rest_ns: 500, lead_ns: 100, trail_ns: 0 };

const START: u16 = 1 << 10;
const SINGLE_ENDED: u16 = 1 << 9;

/// The null bit, in the second and third byte of the answer.
const NULL_BIT: u16 = 1 << 12;

/// The converter, with sensors at three of its channels.
#[derive(Debug)]
pub struct Mcp3208<SPI, D> {
    frames: Frames<SPI, D>,
    channels: [u8; 3],
}

impl<SPI: SpiDevice, D: DelayNs> Mcp3208<SPI, D> {
    /// A converter with pressure 1, pressure 2 and spool at these channels, 0 to 7; of a larger number the lowest three
    /// bits count.
    pub fn new(spi: SPI, delay: D, channels: [u8; 3]) -> Mcp3208<SPI, D> {
        Mcp3208 { frames: Frames::new(spi, delay, TIMES), channels }
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.frames.release()
    }

    /// Converts one channel, 0 to 4095.
    ///
    /// # Errors
    /// When the bus fails, or the null bit is not 0.
    pub(super) fn convert_channel(&mut self, channel: u8) -> Result<u16, ChipError<SPI::Error>> {
        let [high, low] = request(channel);
        let mut bytes = [high, low, 0];
        self.frames.exchange(&mut bytes)?;
        let [_, high, low] = bytes;
        let answer = u16::from_be_bytes([high, low]) & (NULL_BIT | 0x0fff);
        if answer & NULL_BIT != 0 {
            return Err(ChipError::Nonsense { chip: CHIP, answer: u32::from(answer) });
        }
        Ok(answer)
    }
}

/// The first two bytes of the frame for a channel.
fn request(channel: u8) -> [u8; 2] {
    (START | SINGLE_ENDED | u16::from(channel & 7) << 6).to_be_bytes()
}

impl<SPI: SpiDevice, D: DelayNs> PressureInput for Mcp3208<SPI, D> {
    type Error = ChipError<SPI::Error>;

    fn convert(&mut self) -> Result<Conversions, Self::Error> {
        let [pressure_1, pressure_2, spool] = self.channels;
        Ok(Conversions {
            pressure_1: self.convert_channel(pressure_1)?,
            pressure_2: self.convert_channel(pressure_2)?,
            spool: self.convert_channel(spool)?,
        })
    }
}
