//! The LS7366R against its data sheet: LSI/CSI 7366R-122205, "32-bit quadrature counter with serial interface", the
//! registers MDR0 and MDR1, and Table 1 (instructions).

use crate::chip_bus::{Frame, NO_WAIT, exchange};
use crate::failing_bus::FailingBus;
use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::spi::Mock;
use pneudrive_interfaces::EncoderCounter;
use pneudrive_interfaces::chip::ChipError;
use pneudrive_interfaces::chip::ls7366r::{Ls7366r, TIMES};

fn write(bytes: &[u8]) -> Frame {
    exchange(TIMES, bytes, &vec![0xff; bytes.len()])
}

fn transfer(sent: &[u8], received: &[u8]) -> Frame {
    exchange(TIMES, sent, received)
}

/// What a start sends, and the mode that is read back.
fn start(mode: u8) -> Vec<Frame> {
    vec![write(&[0x88, 0x03]), write(&[0x90, 0x00]), write(&[0x20]), transfer(&[0x48, 0], &[0xff, mode])]
}

/// A count, and the mode that is read with it.
fn reading(count: [u8; 4], mode: u8) -> Vec<Frame> {
    let [a, b, c, d] = count;
    vec![transfer(&[0x60, 0, 0, 0, 0], &[0xff, a, b, c, d]), transfer(&[0x48, 0], &[0xff, mode])]
}

/// What the counts are on a bus with these frames after those of a start.
fn counts(frames: &[Vec<Frame>]) -> Vec<Result<i32, ChipError<ErrorKind>>> {
    let all: Vec<Frame> = start(0x03).into_iter().chain(frames.iter().flatten().cloned()).collect();
    let mut counter =
        Ls7366r::start(Mock::new(all.as_flattened()), NO_WAIT).expect("a chip that keeps its mode");
    let counts = frames.iter().map(|_| counter.count()).collect();
    counter.release().done();
    counts
}

const STUCK_LOW: ChipError<ErrorKind> = ChipError::Nonsense { chip: "LS7366R", answer: 0x00 };
const STUCK_HIGH: ChipError<ErrorKind> = ChipError::Nonsense { chip: "LS7366R", answer: 0xff };

#[test]
fn four_edges_a_period_are_counted_in_32_bits_from_0_on() {
    let frames = [
        reading([0, 0, 0, 0], 3),
        reading([0x00, 0x01, 0x02, 0x03], 3),
        reading([0xff, 0xff, 0xff, 0xfe], 3),
    ];
    assert_eq!(counts(&frames), [Ok(0), Ok(0x0001_0203), Ok(-2)]);
}

#[test]
fn the_counter_wraps_through_32_bits() {
    let frames = [reading([0x7f, 0xff, 0xff, 0xff], 3), reading([0x80, 0, 0, 0], 3)];
    assert_eq!(counts(&frames), [Ok(i32::MAX), Ok(i32::MIN)]);
}

#[test]
fn a_chip_that_has_lost_its_power_and_its_count_is_an_error() {
    assert_eq!(counts(&[reading([0, 0, 0, 0], 0)]), [Err(STUCK_LOW)]);
}

#[test]
fn a_line_that_is_stuck_is_an_error_and_no_count() {
    assert_eq!(counts(&[reading([0xff; 4], 0xff), reading([0; 4], 0)]), [Err(STUCK_HIGH), Err(STUCK_LOW)]);
}

#[test]
fn without_a_chip_nothing_starts() {
    for (mode, error) in [(0x00, STUCK_LOW), (0xff, STUCK_HIGH)] {
        let mut bus = Mock::new(start(mode).as_flattened());
        assert_eq!(Ls7366r::start(bus.clone(), NO_WAIT).err(), Some(error));
        bus.done();
    }
}

#[test]
fn a_bus_that_fails_is_an_error() {
    assert_eq!(Ls7366r::start(FailingBus, NO_WAIT).err(), Some(ChipError::Bus(ErrorKind::Other)));
}
