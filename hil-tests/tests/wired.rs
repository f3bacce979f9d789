//! A board of chips on SPI: drivers, clock and control as on a microcontroller, the plant at the pins of the modelled chips.

use std::time::Duration;

use pneudrive_controller::Fault;
use pneudrive_hil_tests::body::{self, rig};
use pneudrive_hil_tests::wired::{Chip, Loss, WiredTarget};
use pneudrive_hil_tests::{Delayed, Target};
use pneudrive_link::client::Trial;
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

fn wired(rig: &Rig) -> Box<dyn Target> {
    Box::new(WiredTarget::start(rig).expect("a board"))
}

fn delayed(rig: &Rig) -> Box<dyn Delayed> {
    Box::new(WiredTarget::start(rig).expect("a board"))
}

#[test]
fn the_record_of_a_board_of_chips_is_the_simulation_in_closed_loop() {
    body::closed_loop(wired);
}

#[test]
fn the_record_of_a_board_of_chips_is_the_simulation_in_open_loop() {
    body::open_loop(wired);
}

#[test]
fn the_record_of_a_board_of_chips_is_the_simulation_of_the_other_built_in_rigs() {
    body::other_built_in_rigs(wired);
}

#[test]
fn the_record_of_a_board_of_chips_that_reads_its_channels_in_turn_is_the_simulation() {
    body::channels_read_in_turn(wired);
}

#[test]
fn the_record_of_a_board_of_chips_whose_controller_starts_late_is_the_simulation() {
    body::a_late_controller(wired);
}

#[test]
fn an_error_beyond_16_bits_is_limited_in_the_record_of_a_board_of_chips() {
    body::an_error_beyond_16_bits(wired);
}

#[test]
fn a_drive_whose_first_move_comes_late_stays_where_it_is_on_a_board_of_chips() {
    body::a_late_first_move(wired);
}

#[test]
fn a_board_of_chips_without_pressure_sensors_records_none() {
    body::without_pressure_sensors(wired);
}

#[test]
fn a_board_of_chips_follows_a_measured_spool_as_the_simulation_does() {
    body::a_measured_spool(wired);
}

#[test]
fn a_board_of_chips_moves_a_stepped_spool_as_the_simulation_does() {
    body::a_stepped_spool(wired);
}

#[test]
fn each_run_of_a_board_of_chips_begins_with_what_the_ones_before_have_learned() {
    body::kept::each_run_begins_with_what_the_ones_before_have_learned(wired);
}

/// The modelled microcontroller has none.
#[test]
fn a_board_of_chips_without_a_watchdog_says_so() {
    let target = wired(&rig("servo-b", &[]));
    let mut client = target.connect().expect("a board that answers");
    let trial = client.try_watchdog(Duration::from_secs(1), &mut || Ok(()));
    assert_eq!(trial.expect("disarmed"), Trial::NoWatchdog);
    assert_eq!(client.status().expect("an answer").mode, Mode::Disarmed);
}

#[test]
fn profiles_of_a_board_of_chips_are_those_of_the_simulation_and_replay() {
    body::profiles(wired);
}

#[test]
fn a_fault_after_the_moves_of_a_run_trips_a_board_of_chips() {
    body::a_fault_after_the_moves(wired);
}

#[test]
fn an_open_loop_that_runs_away_trips_a_board_of_chips() {
    body::an_open_loop_that_runs_away(wired);
}

#[test]
fn the_largest_commands_of_the_converter_are_recorded_as_such() {
    body::the_largest_commands_of_the_dac(wired);
}

#[test]
fn a_board_of_chips_refuses_to_arm_for_commands_that_its_converter_has_no_code_for() {
    body::commands_without_a_code(wired);
}

#[test]
fn the_record_of_a_stepper_drive_on_two_pins_is_the_simulation() {
    body::stepper(wired);
}

#[test]
fn the_records_of_a_board_of_chips_replay_on_the_pc() {
    body::records_replay(wired);
}

#[test]
fn a_run_of_a_board_of_chips_that_was_stopped_replays_up_to_there() {
    body::the_record_of_a_stopped_run_replays(wired);
}

#[test]
fn each_start_of_a_board_of_chips_begins_from_the_same_state() {
    body::each_start_begins_from_the_same_state(wired);
}

#[test]
fn a_board_of_chips_that_is_given_another_period_keeps_that_time() {
    body::another_period(wired);
}

#[test]
fn a_stop_ends_a_run_of_a_board_of_chips() {
    body::a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it(wired);
}

#[test]
fn faults_of_the_plant_trip_a_board_of_chips_by_name() {
    body::axis::faults_of_the_plant_trip_by_name(wired);
}

#[test]
fn a_homing_run_of_a_board_of_chips_finds_the_stop() {
    body::axis::homing_finds_the_stop(wired);
}

#[test]
fn a_dead_encoder_of_a_board_of_chips_is_not_homed() {
    body::axis::a_dead_encoder_is_not_homed(wired);
}

#[test]
fn moves_of_a_board_of_chips_wait_for_the_arrival() {
    body::axis::moves_on_arrival(wired);
}

#[test]
fn a_step_of_a_board_of_chips_meets_its_requirements() {
    body::axis::a_step_meets_its_requirements(wired);
}

#[test]
fn parameters_are_saved_on_a_board_of_chips() {
    body::axis::parameters_are_saved(wired);
}

#[test]
fn a_late_sample_trips_a_board_of_chips_by_name() {
    body::jitter::a_late_sample_trips_by_name(delayed);
}

/// The sample at which a run trips and its fault, when a chip loses its supply just before sample 200.
fn trip_after(loss: Loss) -> (u32, Option<Fault>, bool) {
    let rig = rig("servo-b-tuned", &["test.moves=[[0.0, 8192], [0.1, 16384]]", "test.duration_s=1"]);
    let target = WiredTarget::start(&rig).expect("a board");
    target.lose_supply(200, loss);
    let mut client = target.connect().expect("a board that answers");
    body::start_run(&mut client, &rig);
    while client.status().expect("the port is served").mode == Mode::Running {}
    let status = client.status().expect("an answer");
    assert_eq!((status.mode, status.command), (Mode::Fault, 0), "{loss:?}");
    let newest = client.events().expect("a log").first().copied().expect("an event");
    (newest.index, Fault::from_code(newest.code), status.referenced)
}

#[test]
fn a_counter_that_is_gone_or_has_lost_its_count_trips_at_that_sample_and_takes_the_reference_away() {
    for loss in [Loss::Off(Chip::Ls7366r), Loss::BrownOut] {
        assert_eq!(trip_after(loss), (200, Some(Fault::EncoderStep), false), "{loss:?}");
    }
}

#[test]
fn a_converter_that_is_gone_trips_as_an_open_sensor_does() {
    // sensor_samples = 4: the fourth sample without a pressure trips.
    assert_eq!(trip_after(Loss::Off(Chip::Mcp3208)), (203, Some(Fault::SensorRange), true));
}

/// The converter is not there, and what its wire reads is no pressure.
#[test]
fn without_pressure_sensors_a_drive_runs_without_their_converter_and_none_is_seen() {
    let rig = rig("servo-b-tuned", &["sensors.pressure=false", "test.duration_s=0.5"]);
    let target = WiredTarget::start(&rig).expect("a board");
    target.lose_supply(200, Loss::Off(Chip::Mcp3208));
    let mut client = target.connect().expect("a board that answers");
    body::start_run(&mut client, &rig);
    while client.status().expect("the port is served").mode == Mode::Running {}
    let status = client.status().expect("an answer");
    assert_ne!(status.mode, Mode::Fault);
    assert_eq!((status.pressure_1, status.pressure_2), (0, 0));
}

#[test]
fn parameters_of_an_absolute_encoder_do_not_home_an_axis_whose_edges_are_counted() {
    let target = WiredTarget::start(&rig("servo-b-tuned", &[])).expect("a board");
    let mut client = target.connect().expect("a board that answers");
    for settings in body::axis::ABSOLUTE_ENCODERS {
        let position = client.status().expect("an answer").position;
        client.reference(position).expect("at rest");
        let absolute = rig("servo-b-tuned", settings).parameters();
        client.import_parameters(&absolute).expect("disarmed");
        assert!(!client.status().expect("an answer").referenced, "{settings:?}");
    }
}

#[test]
fn move_records_begin_by_their_numbers_on_a_board_of_chips() {
    body::records::records_begin_by_their_numbers(wired);
}

#[test]
fn a_stop_by_an_input_always_wins_on_a_board_of_chips() {
    body::records::a_stop_by_an_input_always_wins(wired);
}

#[test]
fn inputs_or_a_host_own_a_board_of_chips_and_never_both() {
    body::records::a_drive_has_one_owner(wired);
}

#[test]
fn a_stop_by_a_host_withdraws_what_the_inputs_may() {
    body::records::a_stop_by_a_host_withdraws_what_the_inputs_may(wired);
}
