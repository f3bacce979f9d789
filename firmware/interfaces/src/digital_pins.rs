//! Digital inputs and outputs on pins, a bit each: high is on.
//!
//! An input that may be open is pulled to low, so an open wire is off: run off stops the drive, enable off disables it.

use embedded_hal::digital::{InputPin, OutputPin, PinState};

use crate::Terminals;

/// Inputs and outputs.
#[derive(Debug)]
pub struct DigitalPins<I, O> {
    inputs: [I; 8],
    outputs: [O; 4],
}

impl<I: InputPin, O: OutputPin> DigitalPins<I, O> {
    /// The pins in the order of their bits, the lowest first: number (four), start, acknowledge, run, enable; ready, in
    /// position, fault, lamp.
    pub fn new(inputs: [I; 8], outputs: [O; 4]) -> DigitalPins<I, O> {
        DigitalPins { inputs, outputs }
    }

    /// Gives the pins back.
    pub fn release(self) -> ([I; 8], [O; 4]) {
        (self.inputs, self.outputs)
    }
}

impl<I: InputPin, O: OutputPin> Terminals for DigitalPins<I, O> {
    fn read(&mut self) -> u8 {
        self.inputs.iter_mut().rev().fold(0, |bits, pin| bits << 1 | u8::from(pin.is_high().unwrap_or(false)))
    }

    /// Nothing can be done about a pin that cannot be driven.
    fn write(&mut self, outputs: u8) {
        for (bit, pin) in self.outputs.iter_mut().enumerate() {
            let _ = pin.set_state(PinState::from(outputs >> bit & 1 == 1));
        }
    }
}
