//! The bytes of tempo and request ticks, which go with version 1 of the plant bus: who does not know of them passes
//! them over.
//!
//! DO NOT CHANGE THIS TEST. If it fails, an image and a plant of different builds no longer understand
//! each other: raise `plant_bus::VERSION`, and put what is new into a file of its own.

use pneudrive_app::plant_bus::{Inputs, Outputs, Tempo, request_ticks, with_request_ticks};

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
