//! Absolute encoders against the description of their interface: Posital, "SSI", single transmission. A reading is the
//! level at rest (1), the position from its most significant bit on, and a 0.

use crate::failing_bus::FailingBus;
use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use pneudrive_interfaces::EncoderCounter;
use pneudrive_interfaces::chip::ChipError;
use pneudrive_interfaces::chip::ssi::{Coding, MAX_BITS, SsiEncoder};

fn read(bits: u8, coding: Coding, answer: &[u8]) -> Option<i32> {
    let bus = Mock::new(&[
        Transaction::transaction_start(),
        Transaction::read_vec(answer.to_vec()),
        Transaction::transaction_end(),
    ]);
    let mut encoder = SsiEncoder::new(bus, bits, coding).expect("a number of bits that fits");
    let count = encoder.count();
    encoder.release().done();
    match count {
        Ok(count) => Some(count),
        Err(ChipError::Nonsense { chip: "SSI encoder", .. }) => None,
        Err(error) => panic!("{error}"),
    }
}

/// The bytes of a reading; clocks beyond it read as a repeated transmission would, the position once more.
fn reading(bits: u8, sent: u32) -> Vec<u8> {
    let frame = 1_u64 << (bits + 1) | u64::from(sent) << 1;
    let clocked = 8 * (usize::from(bits) + 2).div_ceil(8);
    let more = clocked - usize::from(bits) - 2;
    let line = frame << more | (u64::from(sent) << 8 >> bits) & ((1 << more) - 1);
    line.to_be_bytes()[8 - clocked / 8..].to_vec()
}

#[test]
fn a_binary_position_comes_most_significant_bit_first() {
    assert_eq!(read(12, Coding::Binary, &[0b1101_0101, 0b0101_0000]), Some(0b1010_1010_1010));
    // 13 bits: one turn of a single-turn encoder; the last bit of the second byte is clocked for nothing.
    assert_eq!(read(13, Coding::Binary, &[0b1000_0000, 0b0000_0100]), Some(1));
    assert_eq!(read(13, Coding::Binary, &[0b1000_0000, 0b0000_0101]), Some(1));
}

#[test]
fn every_number_of_bits_reads_its_ends() {
    for bits in 1..=MAX_BITS {
        let most = (1_u32 << bits) - 1;
        assert_eq!(read(bits, Coding::Binary, &reading(bits, 0)), Some(0), "{bits}");
        assert_eq!(read(bits, Coding::Binary, &reading(bits, most)), Some(most.cast_signed()), "{bits}");
    }
}

#[test]
fn every_position_of_a_gray_encoder_comes_back() {
    for position in 0_u32..1 << 12 {
        let code = position ^ position >> 1;
        assert_eq!(read(12, Coding::Gray, &reading(12, code)), Some(position.cast_signed()));
    }
    let most = (1 << 30) - 1;
    assert_eq!(read(30, Coding::Gray, &reading(30, most ^ most >> 1)), Some(most.cast_signed()));
}

#[test]
fn a_line_that_is_stuck_is_an_error_and_no_position() {
    for bits in 1..=MAX_BITS {
        let bytes = (usize::from(bits) + 2).div_ceil(8);
        assert_eq!(read(bits, Coding::Binary, &vec![0xff; bytes]), None, "high, {bits} bits");
        assert_eq!(read(bits, Coding::Gray, &vec![0x00; bytes]), None, "low, {bits} bits");
    }
}

#[test]
fn an_encoder_of_more_bits_is_noticed_where_its_next_bit_is_1() {
    assert_eq!(read(12, Coding::Binary, &reading(14, 0b10_1010_1010_1010)), None);
}

#[test]
fn no_encoder_has_no_bits_or_more_than_the_reading_holds() {
    for bits in [0, MAX_BITS + 1, u8::MAX] {
        let mut bus = Mock::new(&[]);
        assert!(SsiEncoder::new(bus.clone(), bits, Coding::Binary).is_none());
        bus.done();
    }
}

#[test]
fn a_bus_that_fails_is_an_error() {
    let mut encoder = SsiEncoder::new(FailingBus, 12, Coding::Gray).expect("a number of bits that fits");
    assert_eq!(encoder.count(), Err(ChipError::Bus(ErrorKind::Other)));
}
