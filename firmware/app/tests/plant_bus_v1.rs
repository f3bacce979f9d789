//! The bytes of the plant bus.
//!
//! WHAT STANDS HERE DOES NOT CHANGE. If a test fails, an image and a plant of different builds no longer understand each other:
//! take the change back, and append instead. Give a meaning to bits that are 0, with a test of its own here; who does not know of it
//! passes it over. Only what cannot be said so raises `plant_bus::VERSION`.

use pneudrive_app::plant_bus::{
    HELLO, Inputs, Next, Outputs, Tempo, Ticks, VERSION, request_ticks, with_request_ticks,
};
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
    for (number, next) in [(0, Next::Stay), (1, Next::Advance), (3, Next::Hold)] {
        let mut bytes = [0; Outputs::BYTES];
        bytes[4] = number;
        let outputs = Outputs { next, ..Outputs::OFF };
        assert_eq!(outputs.to_bytes(), bytes);
        assert_eq!(Outputs::from_bytes(bytes), Some(outputs));
    }
    let mut later = [0; Outputs::BYTES];
    later[4] = 4;
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

#[test]
fn a_tempo_is_these_bits_of_the_inputs() {
    let inputs = Inputs { frozen: true, ..Inputs::default() };
    let mut bytes = inputs.to_bytes();
    let tempo = Tempo { late_us: 112, in_step: true };
    tempo.mark(&mut bytes);
    assert_eq!(bytes, [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 7]);
    assert_eq!((Tempo::of(&bytes), Inputs::from_bytes(bytes)), (tempo, inputs));
}

#[test]
fn inputs_without_a_tempo_are_punctual_and_apart_from_wall_time() {
    assert_eq!(Tempo::of(&Inputs::default().to_bytes()), Tempo { late_us: 0, in_step: false });
}

#[test]
fn a_lateness_is_rounded_down_and_has_a_largest_value() {
    for (late_us, said) in [(15, 0), (16, 16), (127, 112), (4080, 4080), (u16::MAX, 4080)] {
        let mut bytes = Inputs::default().to_bytes();
        Tempo { late_us, in_step: false }.mark(&mut bytes);
        assert_eq!(Tempo::of(&bytes).late_us, said);
    }
}

#[test]
fn ticks_of_a_request_are_these_bytes_of_the_outputs() {
    for (ticks, said) in [(0, 0), (0x0001_0203, 0x0001_0203), (u32::MAX, 0x00ff_ffff)] {
        let mut bytes = Outputs::OFF.to_bytes();
        with_request_ticks(&mut bytes, ticks);
        assert_eq!((bytes[5], request_ticks(&bytes)), (said as u8, said));
        assert_eq!(Outputs::from_bytes(bytes), Some(Outputs::OFF));
    }
}
