//! Digital inputs and outputs on pins: a bit each, and a pin that cannot be read is off.

use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock, State, Transaction};
use pneudrive_app::selector::{input, output};
use pneudrive_interfaces::Terminals;
use pneudrive_interfaces::digital_pins::DigitalPins;

fn state(high: bool) -> State {
    if high { State::High } else { State::Low }
}

/// Pins of which each is read once, with these answers, and each output driven once.
fn pins(answers: [Transaction; 8], driven: [bool; 4]) -> DigitalPins<Mock, Mock> {
    let outputs = driven.map(|high| Mock::new(&[Transaction::set(state(high))]));
    DigitalPins::new(answers.map(|answer| Mock::new(&[answer])), outputs)
}

fn done(pins: DigitalPins<Mock, Mock>) {
    let (inputs, outputs) = pins.release();
    inputs.into_iter().chain(outputs).for_each(|mut pin| pin.done());
}

#[test]
fn each_pin_is_a_bit() {
    let levels = [true, false, true, false, true, false, true, true];
    let mut wired = pins(levels.map(|high| Transaction::get(state(high))), [true, false, true, false]);
    assert_eq!(wired.read(), 5 | input::START | input::RUN | input::ENABLE);
    wired.write(output::READY | output::FAULT);
    done(wired);
}

#[test]
fn a_pin_that_cannot_be_read_is_off() {
    let broken = MockError::Io(std::io::ErrorKind::Other);
    let answer = |pin| match pin {
        7 => Transaction::get(State::High).with_error(broken.clone()),
        _ => Transaction::get(State::High),
    };
    let mut wired = pins(std::array::from_fn(answer), [false; 4]);
    assert_eq!(wired.read(), !input::ENABLE);
    wired.write(0);
    done(wired);
}
