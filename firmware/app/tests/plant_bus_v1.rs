//! The bytes of version 1 of the plant bus.
//!
//! DO NOT CHANGE THIS TEST. If it fails, an image and a plant of different builds no longer understand
//! each other: raise `plant_bus::VERSION`, and put what is new into a file of its own.

use pneudrive_app::plant_bus::{HELLO, Inputs, Next, Outputs, Ticks, VERSION};
use pneudrive_controller::{Command, Sample};

#[test]
fn a_hello_is_three_letters_and_the_version() {
    assert_eq!((HELLO, VERSION), (*b"PNB\x01", 1));
}

#[test]
fn outputs_are_these_bytes() {
    let begin = Outputs {
        command: Command { counts: -2048, step: -1, drive_enable: true },
        next: Next::Begin { period_us: 1300, delay_us: 500 },
        ticks: Ticks { sample: 0x0102_0304, output: 65_535 },
    };
    let bytes = [
        0x00, 0xf8, 0xff, 1, 2, 0, 0, 0, //
        0x14, 0x05, 0, 0, 0xf4, 0x01, 0, 0, //
        0x04, 0x03, 0x02, 0x01, 0xff, 0xff, 0, 0,
    ];
    assert_eq!(begin.to_bytes(), bytes);
    assert_eq!(Outputs::from_bytes(bytes), Some(begin));
}

#[test]
fn each_step_of_the_plant_has_its_number_and_others_are_refused() {
    for (number, next) in [(0, Next::Stay), (1, Next::Advance)] {
        let mut bytes = [0; Outputs::BYTES];
        bytes[4] = number;
        let outputs = Outputs { next, ..Outputs::OFF };
        assert_eq!(outputs.to_bytes(), bytes);
        assert_eq!(Outputs::from_bytes(bytes), Some(outputs));
    }
    let mut later = [0; Outputs::BYTES];
    later[4] = 3;
    assert_eq!(Outputs::from_bytes(later), None);
}

#[test]
fn inputs_are_these_bytes() {
    let sample = Sample { position: -17, pressure_1: 1638, pressure_2: 2412, spool: 2047, home_switch: true };
    let bytes = [0xef, 0xff, 0xff, 0xff, 0x66, 0x06, 0x6c, 0x09, 0xff, 0x07, 3, 0];
    let inputs = Inputs { sample, frozen: true };
    assert_eq!(inputs.to_bytes(), bytes);
    assert_eq!(Inputs::from_bytes(bytes), inputs);
    assert_eq!(Inputs { frozen: false, ..inputs }.to_bytes()[10], 2);
}

#[test]
fn switches_of_a_later_version_are_passed_over() {
    let mut bytes = Inputs::default().to_bytes();
    bytes[10] = 0xfc;
    assert_eq!(Inputs::from_bytes(bytes), Inputs::default());
}
