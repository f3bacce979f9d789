//! The MCP3208 against its data sheet: Microchip DS21298, "2.7V 4-Channel/8-Channel 12-Bit A/D Converters with SPI
//! Serial Interface", Table 5-2 (channels) and Figure 6-1 (frames of eight bits).

use crate::chip_bus::{Frame, NO_WAIT, exchange};
use crate::failing_bus::FailingBus;
use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::delay::{CheckedDelay, Transaction as Wait};
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use pneudrive_interfaces::chip::ChipError;
use pneudrive_interfaces::chip::mcp3208::{Mcp3208, TIMES};
use pneudrive_interfaces::{Conversions, PressureInput};

/// One conversion on the bus.
fn frame(sent: [u8; 3], received: [u8; 3]) -> Frame {
    exchange(TIMES, &sent, &received)
}

fn converted(channels: [u8; 3], frames: &[Transaction<u8>]) -> Result<Conversions, ChipError<ErrorKind>> {
    let mut converter = Mcp3208::new(Mock::new(frames), NO_WAIT, channels);
    let converted = converter.convert();
    converter.release().done();
    converted
}

#[test]
fn pressure_1_pressure_2_and_spool_are_converted_in_this_order_at_their_channels() {
    let frames = [
        frame([0b0000_0110, 0b0000_0000, 0], [0, 0, 0]),
        frame([0b0000_0110, 0b0100_0000, 0], [0, 0b0000_1111, 0xff]),
        frame([0b0000_0111, 0b1100_0000, 0], [0, 0b0000_1000, 0x01]),
    ];
    let conversions = converted([0, 1, 7], frames.as_flattened()).expect("three conversions");
    assert_eq!(conversions, Conversions { pressure_1: 0, pressure_2: 4095, spool: 2049 });
}

#[test]
fn bits_in_front_of_the_null_bit_are_not_driven_and_mean_nothing() {
    let frames = [
        frame([0x06, 0x80, 0], [0xff, 0b1110_0001, 0x23]),
        frame([0x06, 0xc0, 0], [0xa5, 0b0100_0100, 0x56]),
        frame([0x07, 0x00, 0], [0x5a, 0b1010_0111, 0x89]),
    ];
    let conversions = converted([2, 3, 4], frames.as_flattened()).expect("three conversions");
    assert_eq!(conversions, Conversions { pressure_1: 0x123, pressure_2: 0x456, spool: 0x789 });
}

#[test]
fn a_line_that_is_stuck_high_or_pulled_up_is_an_error_and_no_pressure() {
    let stuck = frame([0x06, 0x00, 0], [0xff; 3]);
    let answer = 0x1fff;
    assert_eq!(converted([0, 1, 2], &stuck), Err(ChipError::Nonsense { chip: "MCP3208", answer }));
}

#[test]
fn a_chip_that_fails_at_the_second_channel_gives_none_of_the_three() {
    let good = frame([0x06, 0x00, 0], [0, 0x08, 0x00]);
    let bad = frame([0x06, 0x40, 0], [0, 0b0001_1000, 0x00]);
    let answer = 0x1800;
    let frames = [good, bad];
    assert_eq!(
        converted([0, 1, 2], frames.as_flattened()),
        Err(ChipError::Nonsense { chip: "MCP3208", answer })
    );
}

#[test]
fn a_bus_that_fails_is_an_error() {
    let mut converter = Mcp3208::new(FailingBus, NO_WAIT, [0, 1, 2]);
    assert_eq!(converter.convert(), Err(ChipError::Bus(ErrorKind::Other)));
}

#[test]
fn the_chip_select_is_high_for_500_ns_before_each_conversion() {
    let frames =
        [frame([0x06, 0x00, 0], [0; 3]), frame([0x06, 0x40, 0], [0; 3]), frame([0x06, 0x80, 0], [0; 3])];
    let mut waits = CheckedDelay::new(&[Wait::delay_ns(500), Wait::delay_ns(500), Wait::delay_ns(500)]);
    let mut converter = Mcp3208::new(Mock::new(frames.as_flattened()), waits.clone(), [0, 1, 2]);
    converter.convert().expect("three conversions");
    converter.release().done();
    waits.done();
}
