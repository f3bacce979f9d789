//! The buses of the converters: SPI0 for the MCP3208 of the sensors, SPI1 for the MCP4922 of the valve. Each chip has a
//! bus of its own, at its own clock; nothing is shared.

use embedded_hal::spi::MODE_0;
use embedded_hal_bus::spi::ExclusiveDevice;
use rp235x_hal::Spi;
use rp235x_hal::fugit::{HertzU32, RateExtU32};
use rp235x_hal::gpio::bank0::{Gpio10, Gpio11, Gpio13, Gpio16, Gpio17, Gpio18, Gpio19};
use rp235x_hal::gpio::{FunctionSio, FunctionSpi, Pin, PullNone, PullUp, SioOutput};
use rp235x_hal::pac::{RESETS, SPI0, SPI1};
use rp235x_hal::spi::Enabled;

use crate::clock::Wait;

/// A chip select: high at rest.
type Select<I> = Pin<I, FunctionSio<SioOutput>, PullNone>;

/// SPI0: output, input, clock. The input is pulled up: a converter that is not there makes an error.
pub type SensorPins = (
    Pin<Gpio19, FunctionSpi, PullNone>,
    Pin<Gpio16, FunctionSpi, PullUp>,
    Pin<Gpio18, FunctionSpi, PullNone>,
);

/// SPI1: output and clock.
pub type ValvePins = (Pin<Gpio11, FunctionSpi, PullNone>, Pin<Gpio10, FunctionSpi, PullNone>);

/// The bus of the sensors' converter.
pub type SensorBus = ExclusiveDevice<Spi<Enabled, SPI0, SensorPins>, Select<Gpio17>, Wait>;

/// The bus of the valve's converter.
pub type ValveBus = ExclusiveDevice<Spi<Enabled, SPI1, ValvePins>, Select<Gpio13>, Wait>;

/// 1 MHz: what an MCP3208 takes at 2.7 V and more.
pub fn sensors(
    device: SPI0,
    pins: SensorPins,
    select: Select<Gpio17>,
    resets: &mut RESETS,
    peripheral_clock: HertzU32,
) -> SensorBus {
    let bus = Spi::new(device, pins).init(resets, peripheral_clock, 1.MHz(), MODE_0);
    let Ok(device) = ExclusiveDevice::new(bus, select, Wait);
    device
}

/// 10 MHz: half of what an MCP4922 takes.
pub fn valve(
    device: SPI1,
    pins: ValvePins,
    select: Select<Gpio13>,
    resets: &mut RESETS,
    peripheral_clock: HertzU32,
) -> ValveBus {
    let bus = Spi::new(device, pins).init(resets, peripheral_clock, 10.MHz(), MODE_0);
    let Ok(device) = ExclusiveDevice::new(bus, select, Wait);
    device
}
