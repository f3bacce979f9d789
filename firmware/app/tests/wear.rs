//! How often the flash is erased: a machine that runs for years must not wear it out.

use crate::flash_drive::DriveWithFlash;
use crate::nor_flash::{Flash, SECTOR};
use pneudrive_app::fault_log::{FaultLog, FaultStore, MEMORY_BYTES, Restored};
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_controller::choice::{Adapt, Law};
use pneudrive_controller::law::cascade::kept::Changed;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Mode};

/// Bytes of a slot of the fault log on both boards; the second one of the Nucleo is longer.
const SLOT: u32 = 16 * 1024;
const SECTORS: usize = SLOT as usize / SECTOR;

/// Erases of the slot that is erased most in a day of so many faults, each flushed before the next.
fn erases_of_a_day(faults: u32) -> u32 {
    let mut flash = Flash::<4>::new(2 * SECTORS);
    let store = FaultStore::new(&flash, [0..SLOT, SLOT..2 * SLOT]).expect("it fits");
    let (mut log, _) = FaultLog::recover([0; MEMORY_BYTES]);
    log.restore(&store, &mut flash);
    log.count_boot(&store, &mut flash).expect("counted");
    for number in 0..faults {
        log.record(Fault::Stop.code(), number, 0, u64::from(number) * 60_000_000);
        log.flush(&store, &mut flash).expect("flushed");
    }
    let (mut again, _) = FaultLog::recover([0; MEMORY_BYTES]);
    assert_eq!(again.restore(&store, &mut flash), Restored::Events(100));
    assert!(again.newest_first().eq(log.newest_first()), "after a power cut nothing is lost");
    flash.erases.into_iter().max().unwrap_or(0)
}

/// A sector of the Nucleo bears 10,000 erases.
#[test]
fn a_plc_that_stops_the_drive_once_a_minute_wears_a_sector_out_in_10_years_at_the_earliest() {
    let erases = erases_of_a_day(24 * 60);
    assert!(erases <= 2, "{erases}");
}

#[test]
fn twenty_thousand_stops_a_day_cost_two_dozen_erases() {
    let erases = erases_of_a_day(20_000);
    assert!((20..=24).contains(&erases), "{erases}");
}

/// A run that ends so many counts short teaches the drive as many.
fn run(drive: &mut DriveWithFlash, short: i32) {
    drive.take_test(9, drive.board.position + short);
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.start(&mut drive.board).expect("armed");
    drive.samples(11);
    assert_eq!(drive.mode(), Mode::Done);
    drive.control.disarm();
    drive.control.tidy_up(&mut drive.board).expect("stored");
}

fn learning_drive() -> DriveWithFlash {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.control.set_referenced().expect("disarmed");
    drive.set(id::LEARNING_GAIN, 256);
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    drive
}

#[test]
fn a_null_that_wanders_by_less_than_a_512th_of_the_range_is_not_stored() {
    let mut drive = learning_drive();
    let before = drive.board.store.flash().erases();
    for round in 0..100 {
        run(&mut drive, if round % 2 == 0 { 3 } else { -3 });
    }
    assert_eq!(drive.board.store.flash().erases(), before);
    assert!(drive.control.configuration().is_saved(), "but for what was learned");
    assert_eq!(drive.power_cycle().get(id::NULL_OFFSET_COUNTS), 0);
}

#[test]
fn a_null_that_drifts_is_stored_each_time_that_it_has_moved_on() {
    let mut drive = learning_drive();
    for _ in 0..40 {
        run(&mut drive, 1);
    }
    let in_force = drive.get(id::NULL_OFFSET_COUNTS);
    let stored = drive.power_cycle().get(id::NULL_OFFSET_COUNTS);
    assert!(in_force >= 35 && (0..4).contains(&(in_force - stored)), "{in_force}, stored {stored}");
    let [one, other, ..] = drive.board.store.flash().erases();
    assert!((8..=11).contains(&(one + other)), "{one} and {other} erases");
}

/// A drive under the law that learns its drive, which has kept twice the mass of its rig file and finds nothing new at rest: each
/// arming takes an eighth back.
fn drive_that_keeps() -> DriveWithFlash {
    let mut drive = DriveWithFlash::on(RamFlash::default());
    drive.control.set_referenced().expect("disarmed");
    let mut parameters = drive.control.parameters().clone();
    for (id, value) in [
        (id::LAW, Law::Cascade as i32),
        (id::CASCADE_STROKE, 25_000),
        (id::ADAPT, Adapt::Kept as i32),
        (id::KEPT_MASS, 131_072),
    ] {
        parameters.set(id, value).expect("in range");
    }
    drive.control.load_parameters(parameters).expect("they go together");
    drive.control.save_parameters(&mut drive.board).expect("disarmed");
    drive
}

#[test]
fn what_a_law_keeps_is_in_force_at_each_arming_and_stored_at_the_first_the_fourth_and_the_sixteenth() {
    let mut drive = drive_that_keeps();
    let mut stored = vec![];
    for armings in 1..=20 {
        run(&mut drive, 0);
        // The first one begins with what is stored; what each run finds counts from the next arming on.
        assert_eq!(drive.get(id::KEPT_ARMINGS), armings - 1);
        let of_flash = drive.power_cycle().get(id::KEPT_ARMINGS);
        if stored.last() != Some(&of_flash) {
            stored.push(of_flash);
        }
    }
    assert_eq!(stored, [0, 1, 4, 16]);
    let left = drive.power_cycle().get(id::KEPT_MASS) - 65_536;
    assert!(left.abs_diff(7738) < 4, "7/8 of each before, 16 times, of 65,536: {left}");
    assert!(drive.control.configuration().is_saved(), "but for what was learned");
}

/// The mains were switched off before anybody had armed it again: it began with the same once more.
#[test]
fn what_has_tripped_a_drive_is_not_kept_through_a_power_cut() {
    let mut drive = drive_that_keeps();
    for arming in 1..=2 {
        run(&mut drive, 0);
        assert_eq!(drive.get(id::KEPT_ARMINGS), arming - 1);
    }
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.start(&mut drive.board).expect("armed");
    drive.samples(5);
    drive.control.trip(Fault::PressureDoubtful);
    let before = drive.control.parameters().clone();
    for _ in 0..3 {
        drive.control.tidy_up(&mut drive.board).expect("stored");
    }
    assert_eq!(drive.control.parameters(), &before, "the record is read with them");
    assert!(drive.control.configuration().is_saved(), "but for what was learned");
    let again = drive.power_cycle();
    assert_eq!(again.get(id::KEPT_MASS), 65_536);
    assert_eq!(again.get(id::KEPT_CHANGED), Changed::Tripped as i32);
    let erases = drive.board.store.flash().erases();
    drive.control.arm(&mut drive.board).expect("leaves the fault");
    drive.control.disarm();
    drive.control.tidy_up(&mut drive.board).expect("nothing to store");
    assert_eq!(drive.get(id::KEPT_MASS), 65_536);
    assert_eq!(drive.board.store.flash().erases(), erases, "it stands there already");
}

#[test]
fn a_stop_takes_nothing_of_what_is_kept_through_a_power_cut() {
    let mut drive = drive_that_keeps();
    run(&mut drive, 0);
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.start(&mut drive.board).expect("armed");
    drive.samples(5);
    drive.control.stop();
    drive.control.tidy_up(&mut drive.board).expect("nothing to store");
    assert!(drive.power_cycle().get(id::KEPT_MASS) > 100_000);
}

/// Nobody has asked for them to be stored.
#[test]
fn a_trip_stores_no_parameters_that_were_not_saved() {
    let mut drive = drive_that_keeps();
    drive.set(id::VELOCITY_GAIN, 2000);
    drive.take_test(9, drive.board.position);
    drive.control.arm(&mut drive.board).expect("disarmed");
    drive.control.start(&mut drive.board).expect("armed");
    drive.samples(5);
    drive.control.trip(Fault::PressureDoubtful);
    drive.control.tidy_up(&mut drive.board).expect("nothing to store");
    assert_eq!(drive.power_cycle().get(id::VELOCITY_GAIN), 1);
}
