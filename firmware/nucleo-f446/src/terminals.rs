//! The digital inputs and outputs of a drive without a PC. High is on; an open input is pulled to low.

use pneudrive_interfaces::digital_pins::DigitalPins;
use stm32f4xx_hal::gpio::{
    ErasedPin, Input, Output, PA5, PB12, PB13, PB14, PC2, PC3, PC4, PC5, PC6, PC8, PC9, PC12,
    PartiallyErasedPin,
};

/// The pins.
pub type Terminals = DigitalPins<PartiallyErasedPin<'C', Input>, ErasedPin<Output>>;

/// Makes the pins inputs, number, start, acknowledge, run and enable, and outputs, ready, in position, fault and lamp.
pub fn start(
    (n0, n1, n2, n3, start, acknowledge, run, enable): (PC2, PC3, PC4, PC5, PC6, PC8, PC9, PC12),
    (ready, in_position, fault, lamp): (PB12, PB13, PB14, PA5),
) -> Terminals {
    let inputs = [
        n0.into_pull_down_input().erase_number(),
        n1.into_pull_down_input().erase_number(),
        n2.into_pull_down_input().erase_number(),
        n3.into_pull_down_input().erase_number(),
        start.into_pull_down_input().erase_number(),
        acknowledge.into_pull_down_input().erase_number(),
        run.into_pull_down_input().erase_number(),
        enable.into_pull_down_input().erase_number(),
    ];
    let outputs = [
        ready.into_push_pull_output().erase(),
        in_position.into_push_pull_output().erase(),
        fault.into_push_pull_output().erase(),
        lamp.into_push_pull_output().erase(),
    ];
    DigitalPins::new(inputs, outputs)
}
