//! MCP4922: two converters of 12 bits on SPI, for the command of a valve amplifier.
//!
//! Data sheet: Microchip DS21897, "12-Bit DAC with SPI Interface", section 5 and Register 5-1. A write is one frame of
//! 16 bits, most significant first; the rising edge of the chip select takes it over.
//!
//! | bit | name | here |
//! |---|---|---|
//! | 15 | A/B | 0: converter A, 1: converter B |
//! | 14 | BUF | 0: the reference is not buffered, so it may be the supply |
//! | 13 | GA | 1: U = U(ref) * code / 4096 |
//! | 12 | SHDN | 1: the output is driven |
//! | 11..0 | D | code |
//!
//! Mode 0 or 3, up to 20 MHz. The chip cannot be read: a code that is lost on the wire goes unnoticed until the drive
//! does not move as it should. After its power came, the output is not driven, and the amplifier sees whatever its own
//! resistor says: `drive_enable` must be low then.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::SpiDevice;
use pneudrive_controller::drive::DacCode;

use super::ChipError;
use super::frame::{Frames, Times};
use crate::ValveOutput;

/// One of the two converters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// On the pin VOUTA.
    A,
    /// On the pin VOUTB.
    B,
}

/// Section 1, SPI timing: t_IDLE 40 ns, which holds t_CSH 15 ns, t_CSSR 40 ns, t_CHS 15 ns.
pub const TIMES: Times = Times { rest_ns: 40, lead_ns: 40, trail_ns: 15 };

const CHANNEL_B: u16 = 1 << 15;
const GAIN_1: u16 = 1 << 13;
const ACTIVE: u16 = 1 << 12;

/// The converter of a valve.
#[derive(Debug)]
pub struct Mcp4922<SPI, D> {
    frames: Frames<SPI, D>,
    channel: Channel,
}

impl<SPI: SpiDevice, D: DelayNs> Mcp4922<SPI, D> {
    /// One of the chip's converters. Nothing is driven before the first code.
    pub fn new(spi: SPI, delay: D, channel: Channel) -> Mcp4922<SPI, D> {
        Mcp4922 { frames: Frames::new(spi, delay, TIMES), channel }
    }

    /// Gives the bus back.
    pub fn release(self) -> SPI {
        self.frames.release()
    }
}

/// The frame that sets a converter to a code.
fn frame(channel: Channel, code: DacCode) -> [u8; 2] {
    let select = if channel == Channel::B { CHANNEL_B } else { 0 };
    (select | GAIN_1 | ACTIVE | code.get()).to_be_bytes()
}

impl<SPI: SpiDevice, D: DelayNs> ValveOutput for Mcp4922<SPI, D> {
    type Error = ChipError<SPI::Error>;

    fn set_code(&mut self, code: DacCode) -> Result<(), Self::Error> {
        self.frames.exchange(&mut frame(self.channel, code))
    }
}
