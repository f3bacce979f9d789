//! A frame: bytes under the chip select of one chip, with the times that its data sheet asks for around them.
//!
//! ```text
//! select  ‾‾‾‾‾‾\_______________________________/‾‾‾‾
//! clock   ____________/‾\_/‾\_/‾\_ ... /‾\___________
//!         rest  | lead |                  | trail |
//! ```
//!
//! Half a clock before the first rising edge and half a clock after the last one are the bus's own, and come on top.

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{Operation, SpiDevice};

use super::ChipError;

/// The shortest times of a chip, ns. Each chip's module has its own, from the data sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Times {
    /// The select is high between two frames.
    pub rest_ns: u32,
    /// The select is low before the first clock.
    pub lead_ns: u32,
    /// The select stays low after the last clock.
    pub trail_ns: u32,
}

/// A chip on its bus, and its timer.
#[derive(Debug)]
pub(super) struct Frames<SPI, D> {
    spi: SPI,
    delay: D,
    times: Times,
}

impl<SPI: SpiDevice, D: DelayNs> Frames<SPI, D> {
    pub(super) fn new(spi: SPI, delay: D, times: Times) -> Frames<SPI, D> {
        Frames { spi, delay, times }
    }

    /// Sends the bytes, and stores the received bytes in their place. It waits for the pause before the frame,
    /// whatever time has passed since the frame before.
    pub(super) fn exchange(&mut self, bytes: &mut [u8]) -> Result<(), ChipError<SPI::Error>> {
        let Times { rest_ns, lead_ns, trail_ns } = self.times;
        self.delay.delay_ns(rest_ns);
        self.spi
            .transaction(&mut [
                Operation::DelayNs(lead_ns),
                Operation::TransferInPlace(bytes),
                Operation::DelayNs(trail_ns),
            ])
            .map_err(ChipError::Bus)
    }

    pub(super) fn release(self) -> SPI {
        self.spi
    }
}
