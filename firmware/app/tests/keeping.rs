//! What a board keeps: a configuration through a reset, a fault through it, what was learned of the null.

use crate::flash_drive::{DriveWithFlash, stepper_that_has_learned};
use pneudrive_app::configuration::Source;
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::store::Store;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Mode, Refusal};
use pneudrive_protocol::ProfiledMove;
use pneudrive_protocol::change::{Entry, PART_BYTES};

/// Flash in which both slots hold something else.
fn damaged_flash() -> RamFlash {
    use embedded_storage::nor_flash::NorFlash;
    let mut flash = RamFlash::default();
    for slot in RamFlash::layout().config {
        for word in 0..(slot.len() / 4) as u32 {
            flash.write(slot.start + 4 * word, &[0x12, 0x34, 0x56, 0x78]).expect("written");
        }
    }
    flash
}

#[test]
fn a_configuration_is_taken_up_after_a_reset_once_it_was_saved() {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    assert_eq!(drive.control.configuration().source(), Source::NeverSaved);
    drive.set(id::VELOCITY_GAIN, 2000);
    assert_eq!(drive.power_cycle().get(id::VELOCITY_GAIN), 1, "not saved");
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    let again = drive.power_cycle();
    assert_eq!((again.get(id::VELOCITY_GAIN), again.mode()), (2000, Mode::Disarmed));
    assert_eq!(again.control.configuration().source(), Source::Stored);
    assert!(again.control.configuration().is_saved());
    assert_eq!(again.control.config().law.velocity_gain, 2000, "the law runs on it");
}

#[test]
fn move_records_are_taken_up_after_a_reset_once_they_were_saved() {
    let told = ProfiledMove { at_sample: 9, target: -7, ..ProfiledMove::default() };
    let entry = Entry::MoveRecord { number: 4, bytes: &told.to_bytes() };
    let mut room = [0; PART_BYTES];
    let change = entry.write(&mut room).expect("room");
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    drive.control.take_change(change).expect("disarmed");
    assert!(!drive.control.configuration().is_saved(), "the records are not");
    let mut drive = drive.power_cycle();
    assert_eq!(drive.control.configuration().records().get(4), None, "not saved");
    drive.control.take_change(change).expect("disarmed");
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    let again = drive.power_cycle();
    assert_eq!(again.control.configuration().records().get(4).map(|record| record.next.target), Some(-7));
    assert!(again.control.configuration().is_saved());
}

#[test]
fn a_configuration_that_is_lost_is_a_fault_and_arms_nothing_before_one_is_saved() {
    let mut drive = DriveWithFlash::on(damaged_flash());
    assert_eq!(drive.mode(), Mode::Fault(Fault::BadConfiguration));
    assert_eq!(drive.control.arm(&mut drive.board), Err(Refusal::NoConfiguration));
    drive.set(id::VELOCITY_GAIN, 2000);
    assert_eq!(drive.control.arm(&mut drive.board), Err(Refusal::NoConfiguration), "set, but not saved");
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    assert_eq!(drive.control.arm(&mut drive.board), Ok(()));
    assert_eq!(drive.power_cycle().mode(), Mode::Disarmed);
}

#[test]
fn each_time_that_it_is_switched_on_a_board_has_another_boot_number() {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    for boot in 1..200 {
        assert_eq!(drive.board.store.boot(), boot);
        drive = drive.power_cycle();
    }
}

#[test]
fn a_fault_is_logged_once_with_its_sample_and_outlives_a_power_cut_once_it_was_flushed() {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.control.set_referenced().expect("disarmed");
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.samples(3);
    drive.board.position = 90_000;
    drive.samples(5);
    assert_eq!(drive.mode(), Mode::Fault(Fault::EncoderStep));
    let event = drive.board.store.event(0).expect("logged");
    assert_eq!((event.code, event.position, event.time_us), (Fault::EncoderStep.code(), 90_000, 3 * 1300));
    assert_eq!(drive.board.store.event(1), None, "once");
    assert_eq!(drive.power_cycle().board.store.event(0), None, "flash is written by tidy_up alone");
    drive.control.tidy_up(&mut drive.board).expect("flushed");
    let again = drive.power_cycle();
    assert_eq!(again.board.store.event(0).map(|event| event.code), Some(Fault::EncoderStep.code()));
}

#[test]
fn flash_is_not_written_while_the_drive_is_enabled() {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.control.set_referenced().expect("disarmed");
    drive.control.stop();
    drive.samples(1);
    drive.control.arm(&mut drive.board).expect("leaves the fault");
    let before = format!("{:?}", drive.board.store.flash());
    drive.control.tidy_up(&mut drive.board).expect("waits");
    assert!(drive.control.save_parameters(&mut drive.board).is_err());
    assert_eq!(format!("{:?}", drive.board.store.flash()), before);
}

/// An erase stalls the processor, and a spool that is on its way would stay open meanwhile.
#[test]
fn flash_is_not_written_while_a_steppers_spool_walks_to_mid_travel() {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.set(id::STEPPER, 1);
    drive.set(id::OPEN_LOOP, 1);
    drive.control.at_null(&mut drive.board).expect("disarmed");
    drive.take_test(99, 40);
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.start(&mut drive.board).expect("armed");
    drive.samples(5);
    drive.control.disarm();
    let refused = Err(pneudrive_app::control::SaveRefusal::NotNow(Refusal::ValveNotAtNull));
    assert_eq!(drive.control.save_parameters(&mut drive.board), refused);
    drive.samples(5);
    assert_eq!(drive.control.save_parameters(&mut drive.board), Ok(()));
}

/// 8.2.3: what a run has learned is part of the parameters from the next arming on, also through a reset;
/// the record of the run still has the parameters that it was taken with.
#[test]
fn what_was_learned_of_the_null_is_kept_at_the_next_arming() {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.control.set_referenced().expect("disarmed");
    drive.set(id::LEARNING_GAIN, 256);
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    drive.take_test(9, 107);
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.start(&mut drive.board).expect("armed");
    drive.samples(11);
    assert_eq!(drive.mode(), Mode::Done);
    drive.control.disarm();
    assert_eq!(drive.get(id::NULL_OFFSET_COUNTS), 0, "the record is still to be read");
    drive.control.arm(&mut drive.board).expect("disarmed");
    assert_eq!(drive.get(id::NULL_OFFSET_COUNTS), 7);
    assert_eq!(drive.power_cycle().get(id::NULL_OFFSET_COUNTS), 7);
}

/// It was stored at once, and the erase kept the spool open for 400 ms without a pulse.
#[test]
fn a_stepper_that_is_armed_with_its_spool_open_stores_what_it_has_learned_once_it_rests() {
    let mut drive = stepper_that_has_learned();
    drive.control.disarm();
    let before = format!("{:?}", drive.board.store.flash());
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.tidy_up(&mut drive.board).expect("waits");
    drive.control.disarm();
    drive.control.tidy_up(&mut drive.board).expect("waits");
    assert_eq!(drive.get(id::NULL_OFFSET_COUNTS), 7, "in force all the same");
    assert_eq!(format!("{:?}", drive.board.store.flash()), before, "the spool is open");
    drive.samples(30);
    assert_eq!(drive.control.state().spool_location().steps(), 0);
    drive.control.tidy_up(&mut drive.board).expect("stored");
    assert_eq!(drive.power_cycle().get(id::NULL_OFFSET_COUNTS), 7);
}

/// Once it was not stored at all, neither then nor after any later run.
#[test]
fn what_was_learned_before_a_drive_was_armed_again_without_being_disarmed_is_stored_once_it_rests() {
    let mut drive = stepper_that_has_learned();
    let before = format!("{:?}", drive.board.store.flash());
    drive.control.arm(&mut drive.board).expect("it holds");
    drive.samples(30);
    drive.control.tidy_up(&mut drive.board).expect("waits");
    assert_eq!(format!("{:?}", drive.board.store.flash()), before, "the drive is enabled");
    drive.control.disarm();
    drive.control.tidy_up(&mut drive.board).expect("stored");
    assert_eq!(drive.power_cycle().get(id::NULL_OFFSET_COUNTS), 7);
}

#[test]
fn parameters_that_were_set_but_not_saved_are_not_stored_with_what_was_learned() {
    let mut drive = stepper_that_has_learned();
    drive.control.arm(&mut drive.board).expect("it holds");
    drive.control.disarm();
    drive.set(id::VELOCITY_GAIN, 2000);
    drive.samples(30);
    drive.control.tidy_up(&mut drive.board).expect("nothing to store");
    assert_eq!(drive.power_cycle().get(id::VELOCITY_GAIN), 1);
}

#[test]
fn move_records_that_were_set_but_not_saved_are_not_stored_with_what_was_learned() {
    let mut drive = stepper_that_has_learned();
    drive.control.arm(&mut drive.board).expect("it holds");
    drive.control.disarm();
    let told = ProfiledMove { at_sample: 9, target: -7, ..ProfiledMove::default() };
    let entry = Entry::MoveRecord { number: 4, bytes: &told.to_bytes() };
    let mut room = [0; PART_BYTES];
    drive.control.take_change(entry.write(&mut room).expect("room")).expect("disarmed");
    drive.samples(30);
    drive.control.tidy_up(&mut drive.board).expect("nothing to store");
    assert_eq!(drive.power_cycle().control.configuration().records().get(4), None);
}
