//! The spool of a stepper valve, which nothing measures: through changes of the drive stage, resets and power cuts.

use crate::flash_drive::stepper_that_has_learned;
use pneudrive_app::control::{ChangeError, TakeError};
use pneudrive_controller::Refusal;
use pneudrive_controller::drive::SpoolLocation;
use pneudrive_controller::parameters::id;
use pneudrive_protocol::Values;
use pneudrive_protocol::change::{Entry, PART_BYTES};

#[test]
fn a_drive_does_not_change_to_a_solenoid_while_a_steppers_spool_is_open() {
    let mut drive = stepper_that_has_learned();
    drive.control.disarm();
    let refused = ChangeError::Refused(Refusal::ValveNotAtNull);
    assert_eq!(drive.control.set_parameters(id::STEPPER, [0].into_iter()), Err((id::STEPPER, refused)));
    let mut room = [0; 4];
    let values = Values::fill(&mut room, [0]).expect("room");
    let mut change = [0; PART_BYTES];
    let change = Entry::Parameters { first_id: id::STEPPER, values }.write(&mut change).expect("room");
    assert_eq!(drive.control.take_change(change), Err(TakeError::Refused(Refusal::ValveNotAtNull)));
    drive.samples(30);
    assert_eq!(drive.control.set_parameters(id::STEPPER, [0].into_iter()), Ok(()));
}

/// Every reset took the spool to be at mid-travel.
#[test]
fn a_reset_at_any_sample_of_a_walk_leaves_a_spool_that_has_to_be_sought_unless_it_was_at_mid_travel() {
    let mut drive = stepper_that_has_learned();
    drive.control.disarm();
    let mut open = drive.control.state().spool_location().steps();
    loop {
        let mut again = drive.reset();
        if again.board.spool == Some(SpoolLocation::default()) {
            break;
        }
        again.samples(3);
        again = again.reset();
        assert_eq!(
            again.control.arm(&mut again.board),
            Err(Refusal::SpoolInDoubt),
            "open by {open}, two resets"
        );
        again.control.seek_null().expect("it is known where it was");
        assert_eq!(again.control.arm(&mut again.board), Ok(()));
        drive.samples(1);
        open = drive.control.state().spool_location().steps();
    }
    assert_eq!(open, 0);
    assert_eq!(drive.reset().control.arm(&mut drive.board), Ok(()));
}

/// The last pulse may not have been given when the reset comes.
#[test]
fn a_spool_that_arrives_at_mid_travel_counts_as_open_until_its_last_pulse_is_over() {
    let mut drive = stepper_that_has_learned();
    drive.control.disarm();
    while drive.control.state().spool_location().steps() != 0 {
        drive.samples(1);
    }
    assert_eq!(drive.board.spool.map(SpoolLocation::steps).map(i16::abs), Some(1));
    drive.samples(1);
    assert_eq!(drive.board.spool, Some(SpoolLocation::default()));
}

#[test]
fn a_stepper_after_a_power_cut_arms_once_its_spool_is_said_to_be_at_null() {
    let mut drive = stepper_that_has_learned().power_cycle();
    assert_eq!(drive.control.arm(&mut drive.board), Err(Refusal::SpoolLost));
    assert_eq!(drive.control.seek_null(), Err(Refusal::SpoolLost));
    drive.control.at_null(&mut drive.board).expect("disarmed");
    assert_eq!(drive.control.arm(&mut drive.board), Ok(()));
    assert_eq!(drive.control.seek_null(), Err(Refusal::NotDisarmed));
    assert_eq!(drive.control.at_null(&mut drive.board), Err(Refusal::NotDisarmed));
    assert_eq!(drive.reset().control.arm(&mut drive.board), Ok(()), "it was kept that it is at null");
}
