//! The headline on the image that is flashed: its records are the simulation in every integer, whether an instruction
//! takes one cycle or six.

use pneudrive_flashed_image::machine::Machine;
use pneudrive_flashed_image::target::{FlashedTarget, NUCLEO};
use pneudrive_flashed_image::time::{Corner, FAST, SLOWEST};
use pneudrive_hil_tests::body::soak;
use pneudrive_hil_tests::converter::command_of;
use pneudrive_hil_tests::{Supplied, Target, body, rounding};
use pneudrive_sim::Rig;

fn started(rig: &Rig, corner: Corner) -> FlashedTarget {
    FlashedTarget::start(rig, corner).unwrap_or_else(|error| panic!("no board: {error:#}"))
}

fn fast(rig: &Rig) -> Box<dyn Target> {
    Box::new(started(rig, FAST))
}

fn slow(rig: &Rig) -> Box<dyn Target> {
    Box::new(started(rig, SLOWEST))
}

fn supplied(rig: &Rig) -> Box<dyn Supplied> {
    Box::new(started(rig, FAST))
}

/// The body that CI runs: short, at both ends.
#[test]
fn a_short_run_of_the_flashed_image_is_the_simulation() {
    let moves = "test.moves=[[0.0, 8192], [0.1, 16384]]";
    let rig = body::rig("servo-b-tuned", &["test.duration_s=0.5", moves]);
    for start in [fast, slow] {
        body::assert_equal_in_every_integer(&*start(&rig), &rig);
    }
}

#[test]
fn the_watchdog_of_the_flashed_image_bites_when_it_is_tried() {
    body::watchdog::a_watchdog_that_is_tried_resets_the_board(fast);
    body::watchdog::a_watchdog_that_is_tried_resets_the_board(slow);
}

#[test]
fn the_flashed_image_without_pressure_sensors_records_none() {
    body::without_pressure_sensors(fast);
}

#[test]
fn move_records_of_the_flashed_image_begin_by_the_levels_at_its_pins() {
    body::records::records_begin_by_their_numbers(fast);
}

#[test]
fn a_stop_at_a_pin_of_the_flashed_image_always_wins() {
    body::records::a_stop_by_an_input_always_wins(fast);
    body::records::a_stop_by_an_input_always_wins(slow);
}

#[test]
fn pins_or_a_host_own_the_flashed_image_and_never_both() {
    body::records::a_drive_has_one_owner(fast);
}

#[test]
fn a_stop_by_a_host_withdraws_what_the_inputs_may() {
    body::records::a_stop_by_a_host_withdraws_what_the_inputs_may(fast);
}

#[test]
fn a_power_cut_while_a_table_is_saved_in_its_flash_leaves_the_old_or_the_new() {
    body::records::a_power_cut_while_a_table_is_saved_leaves_the_old_or_the_new(supplied);
}

#[test]
fn the_record_of_the_flashed_image_is_the_simulation_in_closed_loop() {
    body::closed_loop(fast);
    body::closed_loop(slow);
}

#[test]
fn the_record_of_the_flashed_image_is_the_simulation_in_open_loop() {
    body::open_loop(fast);
    body::open_loop(slow);
}

#[test]
fn the_record_of_the_flashed_image_is_the_simulation_of_the_other_built_in_rigs() {
    body::other_built_in_rigs(fast);
    body::other_built_in_rigs(slow);
}

#[test]
fn the_record_of_a_flashed_image_that_reads_its_channels_in_turn_is_the_simulation() {
    body::channels_read_in_turn(fast);
}

#[test]
fn the_record_of_the_flashed_image_whose_controller_starts_late_is_the_simulation() {
    body::a_late_controller(fast);
}

#[test]
fn a_drive_whose_first_move_comes_late_stays_where_it_is_on_the_flashed_image() {
    body::a_late_first_move(fast);
}

#[test]
fn profiles_of_the_flashed_image_are_those_of_the_simulation_and_replay() {
    body::profiles(fast);
}

#[test]
fn a_fault_after_the_moves_of_a_run_trips_the_drive_that_holds() {
    body::a_fault_after_the_moves(slow);
}

#[test]
fn an_open_loop_that_runs_away_trips() {
    body::an_open_loop_that_runs_away(slow);
}

#[test]
fn the_largest_commands_of_the_dac_are_recorded_as_such() {
    body::the_largest_commands_of_the_dac(slow);
}

#[test]
fn the_record_of_a_stepper_drive_is_the_simulation() {
    body::stepper(fast);
    body::stepper(slow);
}

#[test]
fn the_records_of_the_flashed_image_replay_on_the_pc() {
    body::records_replay(slow);
}

#[test]
fn a_run_of_the_flashed_image_that_was_stopped_replays_up_to_there() {
    body::the_record_of_a_stopped_run_replays(fast);
}

#[test]
fn each_start_of_the_flashed_image_begins_from_the_same_state() {
    body::each_start_begins_from_the_same_state(slow);
}

#[test]
fn a_flashed_image_that_is_given_another_period_keeps_that_time() {
    body::another_period(fast);
}

#[test]
fn a_run_that_the_memory_of_the_board_could_not_hold_is_streamed() {
    body::stream::a_run_that_the_memory_could_not_hold_is_streamed(slow);
}

#[test]
fn a_stop_ends_a_run_of_the_flashed_image() {
    body::a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it(slow);
}

#[test]
fn faults_of_the_plant_trip_the_flashed_image_by_name() {
    body::axis::faults_of_the_plant_trip_by_name(slow);
}

#[test]
fn a_homing_run_of_the_flashed_image_finds_the_stop() {
    body::axis::homing_finds_the_stop(fast);
}

#[test]
fn a_dead_encoder_is_not_homed() {
    body::axis::a_dead_encoder_is_not_homed(slow);
}

#[test]
fn moves_of_the_flashed_image_wait_for_the_arrival() {
    body::axis::moves_on_arrival(slow);
}

#[test]
fn a_step_of_the_flashed_image_meets_its_requirements() {
    body::axis::a_step_meets_its_requirements(fast);
}

#[test]
fn parameters_are_saved_on_the_flashed_image() {
    body::axis::parameters_are_saved(slow);
}

#[test]
fn a_power_cut_in_a_save_leaves_the_old_or_the_new_configuration() {
    body::keeping::a_power_cut_in_a_save_leaves_the_old_or_the_new(supplied);
}

#[test]
fn what_is_stored_is_in_force_after_a_power_cut() {
    body::keeping::what_is_stored_is_in_force_after_a_power_cut(supplied);
}

#[test]
fn a_silent_host_trips_the_flashed_image_by_name() {
    body::jitter::a_silent_host_trips_by_name(slow);
}

/// With one rounding changed in the image, and nowhere else, the comparison fails.
#[test]
fn a_changed_rounding_in_the_flashed_image_is_seen() {
    let (rig, image) = (rounding::rig(), rounding::changed(NUCLEO).expect("an image"));
    let target = FlashedTarget::start_image(&rig, FAST, &image).expect("a board");
    println!("{}", rounding::failure(&target, &rig).expect("it is seen"));
}

/// The voltage at the pin, and the command in the record: the same, whatever is asked for.
#[test]
fn the_pin_has_the_command_of_the_record_up_to_the_largest() {
    for asked in [2046, 2047, 2048, -2047, -2048] {
        let moves = format!("test.moves=[[0.0, {asked}]]");
        let rig = body::rig("servo-b", &["controller.loop=open", &moves, "test.duration_s=0.1"]);
        let target = started(&rig, FAST);
        let (tell, told) = std::sync::mpsc::channel();
        let look =
            move |machine: &mut Machine| tell.send(machine.board().dac_volts()).expect("a test that waits");
        target.with(move |machine| machine.inject_at(10, Box::new(look))).expect("a board that runs");
        let record = body::run_and_record(&target, &rig);
        let volts = told.recv().expect("a run of ten samples");
        let expected = asked.clamp(-2047, 2047);
        assert_eq!((command_of(volts), record.samples[10].command), (expected, expected), "{asked} counts");
    }
}

/// The thesis's commands of +-2048 counts have 4097 values, the converter 4096.
#[test]
fn the_flashed_image_refuses_to_arm_for_commands_that_its_converter_has_no_code_for() {
    body::commands_without_a_code(fast);
}

/// Two runs of a soak.
#[test]
fn runs_again_and_again_on_the_flashed_image_are_the_simulation() {
    let target = started(&soak::drive(), FAST);
    println!("{:?}", soak::soak(&target, 11.0));
}
