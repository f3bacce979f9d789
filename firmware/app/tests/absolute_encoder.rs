//! A drive with an absolute encoder is homed when it starts, whatever was before.

use crate::flash_drive::DriveWithFlash;
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Mode, Refusal};

/// Where the board's encoder reads 0, counts; it reads 100.
const ZERO: i32 = -30;

fn absolute() -> DriveWithFlash {
    let mut drive = DriveWithFlash::with_encoder(RamFlash::default(), None, true);
    let values = [2, ZERO];
    drive.control.set_parameters(id::ENCODER_MODEL, values.into_iter()).expect("disarmed");
    drive
}

fn is_referenced(drive: &DriveWithFlash) -> bool {
    drive.control.state().supervisor.is_referenced()
}

fn position(drive: &DriveWithFlash) -> i32 {
    drive.control.state().observation().position
}

#[test]
fn the_axis_is_where_the_encoder_says_from_the_first_sample_on() {
    let mut drive = absolute();
    assert!(is_referenced(&drive), "as soon as the configuration says so");
    drive.samples(1);
    assert_eq!(position(&drive), 100 + ZERO);
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    let mut drive = drive.reset();
    assert!(is_referenced(&drive), "and after a reset");
    drive.samples(1);
    assert_eq!(position(&drive), 100 + ZERO);
}

/// Somebody has said where the axis stands: another parameter or another test does not take that back.
#[test]
fn a_reference_stays_until_counts_mean_something_else() {
    let mut drive = absolute();
    drive.samples(1);
    drive.control.reference(500).expect("disarmed");
    drive.set(id::VELOCITY_GAIN, 3);
    drive.samples(1);
    assert_eq!((position(&drive), is_referenced(&drive)), (500, true));
    drive.set(id::ENCODER_ZERO_COUNTS, ZERO - 10);
    drive.samples(1);
    assert_eq!(position(&drive), 100 + ZERO - 10, "a new zero says where it stands");
}

#[test]
fn a_board_that_counts_edges_is_not_homed_by_its_configuration() {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.set(id::ENCODER_MODEL, 2);
    assert!(!is_referenced(&drive));
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    let mut drive = drive.reset();
    drive.control.arm(&mut drive.board).expect("disarmed");
    assert!(!is_referenced(&drive));
}

#[test]
fn a_homing_run_ends_before_it_moves_anything() {
    let mut drive = absolute();
    drive.samples(1);
    assert_eq!(drive.control.home(&mut drive.board), Err(Refusal::NotArmed));
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.home(&mut drive.board).expect("armed");
    assert_eq!((drive.mode(), is_referenced(&drive), position(&drive)), (Mode::Armed, true, 70));
    drive.samples(600);
    assert_eq!((drive.mode(), drive.control.state().observation().command), (Mode::Armed, 0));
}

/// A reading that jumps is a fault of the sensor; once it is back, it tells the position as before.
#[test]
fn a_reading_that_jumps_trips_and_is_believed_again_after_the_next_arming() {
    let mut drive = absolute();
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.samples(3);
    drive.board.position = 3000;
    drive.samples(1);
    assert_eq!(drive.mode(), Mode::Fault(Fault::EncoderStep));
    assert!(!is_referenced(&drive));
    drive.board.position = 105;
    drive.samples(5);
    drive.control.arm(&mut drive.board).expect("leaves the fault");
    drive.samples(1);
    assert_eq!((drive.mode(), is_referenced(&drive)), (Mode::Armed, true));
    assert_eq!(position(&drive), 105 + ZERO);
}

/// With a range that is longer than the stroke, no position reads like a wire that has come off.
#[test]
fn an_encoder_that_reads_0_outside_of_the_stroke_keeps_the_drive_from_being_armed() {
    let mut drive = absolute();
    drive.set(id::ENCODER_ZERO_COUNTS, -415);
    drive.board.position = 0;
    drive.samples(1);
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.samples(1);
    assert_eq!(drive.mode(), Mode::Fault(Fault::PositionOutside));
}

#[test]
fn another_zero_is_in_force_at_once_and_no_absolute_encoder_no_reference() {
    let mut drive = absolute();
    drive.set(id::ENCODER_ZERO_COUNTS, 1000);
    drive.samples(1);
    assert_eq!((is_referenced(&drive), position(&drive)), (true, 1100));
    drive.set(id::ENCODER_MODEL, 0);
    assert!(!is_referenced(&drive));
}
