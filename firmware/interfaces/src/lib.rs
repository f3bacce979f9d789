//! The wiring of a servo-pneumatic drive as interfaces for any board: encoder, valve, translator, pressure sensors.
//! The drivers need only the traits of `embedded-hal` 1.0.
//!
//! | interface | drivers |
//! |---|---|
//! | [`EncoderCounter`] | [`chip::ls7366r`]: quadrature counter on SPI; [`chip::ssi`]: absolute encoder; [`chip::wiper`]: potentiometer |
//! | [`PressureInput`] | [`chip::mcp3208`]: converter of eight channels on SPI |
//! | [`ValveOutput`] | [`chip::mcp4922`]: two converters on SPI |
//! | [`StepDirection`] | [`step_pins`]: two output pins |
//! | [`Terminals`] | [`digital_pins`]: eight input pins, four output pins |
//!
//! [`wired_board`] makes the application's [`pneudrive_app::Board`] of any of them, and [`spi_board`] of the three
//! chips on SPI.
//!
//! Counts, codes and conversions are integers in the units of the hardware. A chip that gives an answer which it
//! cannot give makes an error, never a figure.
#![no_std]
#![forbid(unsafe_code)]

pub mod chip;
pub mod digital_pins;
pub mod spi_board;
pub mod step_pins;
pub mod wired_board;

use pneudrive_controller::drive::{DacCode, Translator};

/// A counter of an encoder's edges, or an encoder that knows its position.
pub trait EncoderCounter {
    /// Why there is no count.
    type Error;

    /// Whether the count gives the position after a reset, too.
    const IS_ABSOLUTE: bool = false;

    /// The position at this instant, counts. An incremental counter starts at 0 and wraps through 32 bits, as the
    /// differences of the controller do.
    ///
    /// # Errors
    /// When the counter does not answer, or its answer is impossible.
    fn count(&mut self) -> Result<i32, Self::Error>;
}

/// The conversions of a sample, 0 to 4095 each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Conversions {
    /// Pressure in chamber 1, on the blind side.
    pub pressure_1: u16,
    /// Pressure in chamber 2, on the rod side.
    pub pressure_2: u16,
    /// Displacement of the spool; any value without such a sensor.
    pub spool: u16,
}

/// The pressure sensors and the spool sensor, behind a converter of 12 bits.
pub trait PressureInput {
    /// Why there is no conversion.
    type Error;

    /// Converts pressure 1, pressure 2 and spool, in this order, one right after the other.
    ///
    /// # Errors
    /// When the converter does not answer, or its answer is impossible.
    fn convert(&mut self) -> Result<Conversions, Self::Error>;
}

/// The command of a valve amplifier, behind a converter of 12 bits.
pub trait ValveOutput {
    /// Why the command was not taken.
    type Error;

    /// Sets the converter to a code.
    ///
    /// # Errors
    /// When the converter cannot be reached. A converter that cannot be read back may miss a code unnoticed.
    fn set_code(&mut self, code: DacCode) -> Result<(), Self::Error>;

    /// The code of the valve's null by the present configuration, for a board whose program sets it when it breaks
    /// down. Called before every command.
    fn note_null(&mut self, _code: DacCode) {}
}

/// Where a step takes the spool of a stepper valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Toward extension: the direction line is high.
    Extend,
    /// Toward retraction: the direction line is low.
    Retract,
}

/// A translator of step pulses.
pub trait StepDirection {
    /// Why there was no step.
    type Error;

    /// Gives one pulse of `pulse_width_us`, after the direction has stood for `direction_setup_us`. It may return
    /// before the pulse is over; the pulse is over before the next sample.
    ///
    /// # Errors
    /// When a line cannot be driven.
    fn step(&mut self, translator: &Translator, direction: Direction) -> Result<(), Self::Error>;
}

/// The digital inputs and outputs of a drive without a PC.
pub trait Terminals {
    /// The inputs, as [`input`](pneudrive_app::selector::input) has their bits. One that cannot be read is off.
    fn read(&mut self) -> u8;

    /// Drives the outputs, as [`output`](pneudrive_app::selector::output) has their bits.
    fn write(&mut self, outputs: u8);
}
