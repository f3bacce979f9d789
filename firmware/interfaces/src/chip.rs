//! Drivers of chips, over `embedded-hal` 1.0. The data sheets are named in each file.
//!
//! Each chip has its own [`embedded_hal::spi::SpiDevice`], which holds its chip select; several of them may share a
//! bus whose clock and mode suit them all. The module of each chip says which, and how long its chip select must be
//! high and low around a frame ([`frame`]): the driver waits for that, whatever the bus does.

use core::fmt;

pub mod frame;
pub mod ls7366r;
pub mod mcp3208;
pub mod mcp4922;
pub mod ssi;
pub mod wiper;

/// Why a chip gave no figure. `E` is the error of the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChipError<E> {
    /// The bus has failed.
    Bus(E),
    /// An answer that the chip cannot give: it is missing, without supply or disturbed.
    Nonsense {
        /// The chip.
        chip: &'static str,
        /// The received bytes, as on the line.
        answer: u32,
    },
}

impl<E: fmt::Debug> fmt::Display for ChipError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ChipError::Bus(error) => write!(f, "the SPI bus has failed: {error:?}"),
            ChipError::Nonsense { chip, answer } => write!(
                f,
                "the {chip} answered {answer:#x}, which it cannot: check its supply, its chip select and the lines of the bus"
            ),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for ChipError<E> {}
