//! The MCP4922 against its data sheet: Microchip DS21897, "12-Bit DAC with SPI Interface", Register 5-1.

use crate::chip_bus::{NO_WAIT, exchange};
use crate::failing_bus::FailingBus;
use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::spi::Mock;
use pneudrive_controller::drive::DacCode;
use pneudrive_interfaces::ValveOutput;
use pneudrive_interfaces::chip::ChipError;
use pneudrive_interfaces::chip::mcp4922::{Channel, Mcp4922, TIMES};

/// The frame that goes out for a code.
fn expect(channel: Channel, code: u16, frame: [u8; 2]) {
    let bus = Mock::new(&exchange(TIMES, &frame, &[0xff; 2]));
    let mut converter = Mcp4922::new(bus, NO_WAIT, channel);
    converter.set_code(DacCode::new(code)).expect("the bus works");
    converter.release().done();
}

#[test]
fn a_code_goes_out_as_one_frame_with_gain_1_and_the_output_driven() {
    expect(Channel::A, 0, [0b0011_0000, 0]);
    expect(Channel::A, 2048, [0b0011_1000, 0]);
    expect(Channel::A, 4095, [0b0011_1111, 0xff]);
    expect(Channel::A, 0x0abc, [0b0011_1010, 0xbc]);
}

#[test]
fn bit_15_chooses_the_converter() {
    expect(Channel::B, 0x0abc, [0b1011_1010, 0xbc]);
}

#[test]
fn a_code_beyond_the_range_is_the_largest_and_changes_no_other_bit() {
    expect(Channel::A, 4096, [0b0011_1111, 0xff]);
    expect(Channel::A, u16::MAX, [0b0011_1111, 0xff]);
}

#[test]
fn a_bus_that_fails_is_an_error() {
    let mut converter = Mcp4922::new(FailingBus, NO_WAIT, Channel::A);
    assert_eq!(converter.set_code(DacCode::MIDDLE), Err(ChipError::Bus(ErrorKind::Other)));
}
