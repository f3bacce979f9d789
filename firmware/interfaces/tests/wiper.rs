//! A potentiometer at an MCP3208, against the converter's data sheet: Microchip DS21298, Table 5-2 and Figure 6-1.

use crate::chip_bus::{NO_WAIT, exchange};
use crate::failing_bus::FailingBus;
use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::spi::Mock;
use pneudrive_interfaces::EncoderCounter;
use pneudrive_interfaces::chip::ChipError;
use pneudrive_interfaces::chip::mcp3208::TIMES;
use pneudrive_interfaces::chip::wiper::Wiper;

fn counted(channel: u8, sent: [u8; 3], received: [u8; 3]) -> Result<i32, ChipError<ErrorKind>> {
    let frame = exchange(TIMES, &sent, &received);
    let mut wiper = Wiper::new(Mock::new(&frame), NO_WAIT, channel);
    let counted = wiper.count();
    wiper.release().done();
    counted
}

#[test]
fn a_count_is_one_conversion_of_the_channel_of_the_wiper() {
    assert_eq!(counted(0, [0x06, 0x00, 0], [0, 0x0f, 0xff]), Ok(4095));
    assert_eq!(counted(5, [0x07, 0x40, 0], [0, 0x01, 0x23]), Ok(0x123));
}

#[test]
fn a_converter_that_is_missing_is_an_error_and_no_count() {
    let answer = 0x1fff;
    assert_eq!(counted(0, [0x06, 0x00, 0], [0xff; 3]), Err(ChipError::Nonsense { chip: "MCP3208", answer }));
    assert_eq!(Wiper::new(FailingBus, NO_WAIT, 0).count(), Err(ChipError::Bus(ErrorKind::Other)));
}

#[test]
fn it_knows_the_position_after_a_reset() {
    const { assert!(<Wiper<FailingBus, NoopDelay> as EncoderCounter>::IS_ABSOLUTE) };
}
