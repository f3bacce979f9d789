//! The headline on the emulated board: the image that is flashed gives the same commands as the
//! simulator, equal in every bit.
#![cfg(unix)]

use std::path::Path;

use pneudrive_controller::Fault;
use pneudrive_hil_tests::emulated_board::EmulatedBoard;
use pneudrive_hil_tests::{QemuTarget, Supplied, Target, body};
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

fn started(rig: &Rig) -> QemuTarget {
    QemuTarget::start(rig).unwrap_or_else(|error| panic!("no emulated board: {error:#}"))
}

fn emulated_board(rig: &Rig) -> Box<dyn Target> {
    Box::new(started(rig))
}

fn supplied(rig: &Rig) -> Box<dyn Supplied> {
    Box::new(started(rig))
}

#[test]
fn the_record_of_the_emulated_board_is_the_simulation_in_closed_loop() {
    body::closed_loop(emulated_board);
}

#[test]
fn the_record_of_the_emulated_board_is_the_simulation_in_open_loop() {
    body::open_loop(emulated_board);
}

#[test]
fn the_record_of_the_emulated_board_is_the_simulation_of_the_other_built_in_rigs() {
    body::other_built_in_rigs(emulated_board);
}

#[test]
fn the_record_of_an_emulated_board_that_reads_its_channels_in_turn_is_the_simulation() {
    body::channels_read_in_turn(emulated_board);
}

#[test]
fn the_record_of_the_emulated_board_whose_controller_starts_late_is_the_simulation() {
    body::a_late_controller(emulated_board);
}

#[test]
fn a_drive_whose_first_move_comes_late_stays_where_it_is_on_the_emulated_board() {
    body::a_late_first_move(emulated_board);
}

#[test]
fn profiles_of_the_emulated_board_are_those_of_the_simulation_and_replay() {
    body::profiles(emulated_board);
}

#[test]
fn an_error_beyond_16_bits_is_limited_in_the_record_of_the_emulated_board() {
    body::an_error_beyond_16_bits(emulated_board);
}

#[test]
fn a_fault_after_the_moves_of_a_run_trips_the_drive_that_holds() {
    body::a_fault_after_the_moves(emulated_board);
}

#[test]
fn an_open_loop_that_runs_away_trips() {
    body::an_open_loop_that_runs_away(emulated_board);
}

#[test]
fn the_largest_commands_of_the_dac_are_recorded_as_such() {
    body::the_largest_commands_of_the_dac(emulated_board);
}

#[test]
fn the_record_of_an_emulated_stepper_drive_is_the_simulation() {
    body::stepper(emulated_board);
}

#[test]
fn the_records_of_the_emulated_board_replay_on_the_pc() {
    body::records_replay(emulated_board);
}

#[test]
fn a_run_of_the_emulated_board_that_was_stopped_replays_up_to_there() {
    body::the_record_of_a_stopped_run_replays(emulated_board);
}

#[test]
fn each_start_of_the_emulated_board_begins_from_the_same_state() {
    body::each_start_begins_from_the_same_state(emulated_board);
}

#[test]
fn an_emulated_board_that_is_given_another_period_keeps_that_time() {
    body::another_period(emulated_board);
}

#[test]
fn a_run_that_the_memory_of_the_emulated_board_could_not_hold_is_streamed() {
    body::stream::a_run_that_the_memory_could_not_hold_is_streamed(emulated_board);
}

#[test]
fn a_stop_ends_a_run_of_the_emulated_board() {
    body::a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it(emulated_board);
}

#[test]
fn faults_of_the_plant_trip_the_emulated_board_by_name() {
    body::axis::faults_of_the_plant_trip_by_name(emulated_board);
}

#[test]
fn a_homing_run_of_the_emulated_board_finds_the_stop() {
    body::axis::homing_finds_the_stop(emulated_board);
}

#[test]
fn a_dead_encoder_is_not_homed() {
    body::axis::a_dead_encoder_is_not_homed(emulated_board);
}

#[test]
fn moves_of_the_emulated_board_wait_for_the_arrival() {
    body::axis::moves_on_arrival(emulated_board);
}

#[test]
fn a_rest_outside_the_tolerance_is_told_by_the_emulated_board() {
    body::axis::a_rest_outside_the_tolerance_is_told(emulated_board);
}

#[test]
fn a_step_of_the_emulated_board_meets_its_requirements() {
    body::axis::a_step_meets_its_requirements(emulated_board);
}

#[test]
fn parameters_are_saved_on_the_emulated_board() {
    body::axis::parameters_are_saved(emulated_board);
}

#[test]
fn a_power_cut_in_a_save_leaves_the_old_or_the_new_configuration_on_the_emulated_board() {
    body::keeping::a_power_cut_in_a_save_leaves_the_old_or_the_new(supplied);
}

#[test]
fn what_is_stored_on_the_emulated_board_is_in_force_after_a_power_cut() {
    body::keeping::what_is_stored_is_in_force_after_a_power_cut(supplied);
}

#[test]
fn a_damaged_configuration_on_the_emulated_board_is_named_and_arms_nothing_before_one_is_stored() {
    body::keeping::a_damaged_configuration_is_named_and_arms_nothing_before_one_is_stored(supplied);
}

#[test]
fn the_watchdog_ends_a_stalled_loop_and_the_drive_comes_up_disabled_with_the_reason() {
    let rig = body::rig("servo-b", &["test.duration_s=3000"]);
    let target = started(&rig);
    let mut client = target.connect().expect("a board that answers");
    client.save_parameters().expect("disarmed");
    client.download_test(&rig).expect("disarmed");
    client.arm().expect("referenced");
    client.start().expect("armed");
    while client.status().expect("an answer").index < 100 {}
    target.board().stall().expect("a debugger");

    let status = client.status().expect("an answer after the reset");
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::Watchdog.code()));
    let newest = client.events().expect("a log").first().copied().expect("an event");
    assert_eq!((newest.code, newest.boot), (Fault::Watchdog.code(), 2), "in the life after the first");
    assert_eq!(client.parameters().expect("an answer").values, rig.parameters(), "stored before");
    let error = client.arm().expect_err("it means the first life").to_string();
    assert!(error.contains("the rig was reset since this program connected (boot 2 now)"), "{error}");
    drop(client);
    let mut client = target.connect().expect("a board that answers");
    client.arm().expect("arming leaves the fault");
    client.disarm().expect("an answer");
    drop(client);
    body::assert_equal_in_every_integer(&target, &body::rig("servo-b", &["test.duration_s=0.5"]));
}

#[test]
fn the_watchdog_of_the_emulated_board_bites_when_it_is_tried() {
    body::watchdog::a_watchdog_that_is_tried_resets_the_board(emulated_board);
}

#[test]
fn the_emulated_board_without_pressure_sensors_records_none() {
    body::without_pressure_sensors(emulated_board);
}

#[test]
fn the_emulated_board_follows_a_measured_spool_as_the_simulation_does() {
    body::a_measured_spool(emulated_board);
}

#[test]
fn the_emulated_board_moves_a_stepped_spool_as_the_simulation_does() {
    body::a_stepped_spool(emulated_board);
}

#[test]
fn each_run_of_the_emulated_board_begins_with_what_the_ones_before_have_learned() {
    body::kept::each_run_begins_with_what_the_ones_before_have_learned(emulated_board);
}

#[test]
fn a_late_sample_trips_the_emulated_board_by_name() {
    body::jitter::a_late_sample_trips_by_name(|rig| Box::new(started(rig)));
}

#[test]
fn a_silent_host_trips_the_emulated_board_by_name() {
    body::jitter::a_silent_host_trips_by_name(|rig| {
        Box::new(QemuTarget::start_in_step(rig).unwrap_or_else(|error| panic!("{error:#}")))
    });
}

/// Ten minutes of it: `cargo xtask soak`.
#[test]
fn runs_again_and_again_on_the_emulated_board_are_the_simulation() {
    let soaked = body::soak::soak(&started(&body::soak::drive()), 11.0);
    println!("{soaked:?}");
}

#[test]
fn a_file_that_is_no_image_is_refused_with_the_reason_of_the_emulator() {
    let rig = body::rig("servo-b", &[]);
    let started = EmulatedBoard::start(&rig, Path::new("no-such-image"), 0);
    let error = format!("{:#}", started.err().expect("no image, no board"));
    assert!(error.contains("no-such-image") && error.contains("ended with"), "{error}");
    assert_eq!(error.lines().count(), 1);
}

#[test]
fn move_records_begin_by_their_numbers_on_the_emulated_board() {
    body::records::records_begin_by_their_numbers(emulated_board);
}

#[test]
fn a_stop_by_an_input_always_wins_on_the_emulated_board() {
    body::records::a_stop_by_an_input_always_wins(emulated_board);
}

#[test]
fn inputs_or_a_host_own_the_emulated_board_and_never_both() {
    body::records::a_drive_has_one_owner(emulated_board);
}

#[test]
fn a_stop_by_a_host_withdraws_what_the_inputs_may() {
    body::records::a_stop_by_a_host_withdraws_what_the_inputs_may(emulated_board);
}

#[test]
fn a_power_cut_while_a_table_is_saved_leaves_the_old_or_the_new_on_the_emulated_board() {
    body::records::a_power_cut_while_a_table_is_saved_leaves_the_old_or_the_new(supplied);
}
