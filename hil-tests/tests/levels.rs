//! The headline: the same samples give the same commands, equal in every bit, on every execution level. Here the
//! virtual rig.

use std::sync::atomic::AtomicBool;

use pneudrive_hil_tests::body::{self, rig, run_and_record};
use pneudrive_hil_tests::{Supplied, Target, VirtualTarget};
use pneudrive_protocol::Mode;
use pneudrive_sim::{Accuracy, Rig, run};

fn virtual_rig(rig: &Rig) -> Box<dyn Target> {
    Box::new(VirtualTarget::start(rig, "tcp:127.0.0.1:0").expect("a virtual rig"))
}

fn supplied(rig: &Rig) -> Box<dyn Supplied> {
    Box::new(VirtualTarget::start(rig, "tcp:127.0.0.1:0").expect("a virtual rig"))
}

#[test]
fn the_record_of_the_virtual_rig_is_the_simulation_in_closed_loop() {
    body::closed_loop(virtual_rig);
}

#[test]
fn the_record_of_the_virtual_rig_is_the_simulation_of_the_other_built_in_rigs() {
    body::other_built_in_rigs(virtual_rig);
}

#[test]
fn the_record_of_the_virtual_rig_is_the_simulation_in_open_loop() {
    body::open_loop(virtual_rig);
}

#[test]
fn the_record_of_a_virtual_rig_that_reads_its_channels_in_turn_is_the_simulation() {
    body::channels_read_in_turn(virtual_rig);
}

#[test]
fn the_record_of_the_virtual_rig_whose_controller_starts_late_is_the_simulation() {
    body::a_late_controller(virtual_rig);
}

#[test]
fn an_error_beyond_16_bits_is_limited_in_the_record_of_the_virtual_rig() {
    body::an_error_beyond_16_bits(virtual_rig);
}

#[test]
fn a_drive_whose_first_move_comes_late_stays_where_it_is_on_the_virtual_rig() {
    body::a_late_first_move(virtual_rig);
}

#[test]
fn a_virtual_rig_without_pressure_sensors_records_none() {
    body::without_pressure_sensors(virtual_rig);
}

#[test]
fn the_virtual_rig_follows_a_measured_spool_as_the_simulation_does() {
    body::a_measured_spool(virtual_rig);
}

#[test]
fn the_virtual_rig_moves_a_stepped_spool_as_the_simulation_does() {
    body::a_stepped_spool(virtual_rig);
}

#[test]
fn each_run_of_a_virtual_rig_begins_with_what_the_ones_before_have_learned() {
    body::kept::each_run_begins_with_what_the_ones_before_have_learned(virtual_rig);
}

#[test]
fn a_power_cut_while_a_virtual_rig_stores_what_it_learned_leaves_the_old_or_the_new() {
    body::kept::a_power_cut_while_it_is_stored_leaves_the_old_or_the_new(supplied);
}

#[test]
fn the_watchdog_of_the_virtual_rig_bites_when_it_is_tried() {
    body::watchdog::a_watchdog_that_is_tried_resets_the_board(virtual_rig);
}

#[test]
fn profiles_of_the_virtual_rig_are_those_of_the_simulation_and_replay() {
    body::profiles(virtual_rig);
}

#[test]
fn a_fault_after_the_moves_of_a_run_trips_the_drive_that_holds() {
    body::a_fault_after_the_moves(virtual_rig);
}

#[test]
fn an_open_loop_that_runs_away_trips() {
    body::an_open_loop_that_runs_away(virtual_rig);
}

#[test]
fn the_largest_commands_of_the_dac_are_recorded_as_such() {
    body::the_largest_commands_of_the_dac(virtual_rig);
}

#[test]
fn the_record_of_a_stepper_drive_is_the_simulation() {
    body::stepper(virtual_rig);
}

#[test]
fn the_records_of_the_virtual_rig_replay_on_the_pc() {
    body::records_replay(virtual_rig);
}

#[test]
fn a_run_of_the_virtual_rig_that_was_stopped_replays_up_to_there() {
    body::the_record_of_a_stopped_run_replays(virtual_rig);
}

#[test]
fn each_start_begins_from_the_same_state() {
    body::each_start_begins_from_the_same_state(virtual_rig);
}

#[test]
fn a_rig_that_is_given_another_period_keeps_that_time() {
    body::another_period(virtual_rig);
}

#[test]
fn a_run_that_the_memory_of_the_virtual_rig_could_not_hold_is_streamed() {
    body::stream::a_run_that_the_memory_could_not_hold_is_streamed(virtual_rig);
}

#[test]
fn a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it() {
    body::a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it(virtual_rig);
}

#[test]
fn rows_of_a_trace_in_between_change_nothing() {
    // 2.6 s is both a sample and a millisecond: the two end alike.
    let every_sample = rig("servo-b", &["test.duration_s=2.6"]);
    let every_millisecond = rig("servo-b", &["test.duration_s=2.6", "test.trace_period_s=0.001"]);
    let transient = |rig: &Rig| run(rig, Accuracy::of(rig)).expect("a transient");
    let (a, b) = (transient(&every_sample), transient(&every_millisecond));
    assert_eq!(a.observations, b.observations);
    assert_eq!(a.work.integrator, b.work.integrator, "the same steps");
    let at = |run: &pneudrive_sim::Run, time: f64| {
        run.rows.iter().find(|row| (row.time - time).abs() < 1e-9).map(|row| row.plant)
    };
    assert_eq!(at(&a, 2.6), at(&b, 2.6), "the same bits");
}

#[cfg(unix)]
#[test]
fn a_pty_carries_the_same_record_as_tcp() {
    let rig = rig("servo-b-tuned", &["test.duration_s=0.5"]);
    let over = |listener: &str| {
        let target = VirtualTarget::start(&rig, listener).expect("a virtual rig");
        run_and_record(&target, &rig).samples
    };
    assert_eq!(over("pty"), over("tcp:127.0.0.1:0"));
}

#[test]
fn a_rig_without_a_record_says_so() {
    let rig = rig("servo-b", &[]);
    let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
    let mut client = target.connect().expect("a rig that answers");
    let error = client.record(|_, _| {}).expect_err("no record").to_string();
    assert!(error.contains("nothing has been recorded"), "{error}");
}

/// A second program must reach the rig while the first one follows a run.
#[test]
fn a_stop_from_another_program_reaches_a_running_rig() {
    let (target, mut first) = body::in_a_long_run(virtual_rig);
    target.connect().expect("the same rig").stop().expect("an answer");
    let error = first.follow(&AtomicBool::new(false), |_| {}).expect_err("stopped").to_string();
    assert!(error.contains("stop (a stop was requested)"), "{error}");
}

#[test]
fn an_interrupted_run_is_stopped() {
    let (_target, mut client) = body::in_a_long_run(virtual_rig);
    client.follow(&AtomicBool::new(true), |_| {}).expect_err("stopped");
    assert_eq!(client.status().expect("an answer").mode, Mode::Fault);
}

#[test]
fn faults_of_the_plant_trip_the_virtual_rig_by_name() {
    body::axis::faults_of_the_plant_trip_by_name(virtual_rig);
}

#[test]
fn a_homing_run_of_the_virtual_rig_finds_the_stop() {
    body::axis::homing_finds_the_stop(virtual_rig);
}

#[test]
fn a_dead_encoder_is_not_homed() {
    body::axis::a_dead_encoder_is_not_homed(virtual_rig);
}

#[test]
fn absolute_encoders_need_no_homing() {
    body::axis::absolute_encoders_need_no_homing(virtual_rig);
}

#[test]
fn moves_of_the_virtual_rig_wait_for_the_arrival() {
    body::axis::moves_on_arrival(virtual_rig);
}

#[test]
fn a_rest_outside_the_tolerance_is_told_by_the_virtual_rig() {
    body::axis::a_rest_outside_the_tolerance_is_told(virtual_rig);
}

#[test]
fn a_step_of_the_virtual_rig_meets_its_requirements() {
    body::axis::a_step_meets_its_requirements(virtual_rig);
}

#[test]
fn parameters_are_saved_on_the_virtual_rig() {
    body::axis::parameters_are_saved(virtual_rig);
}

#[test]
fn a_power_cut_in_a_save_leaves_the_old_or_the_new_configuration_on_the_virtual_rig() {
    body::keeping::a_power_cut_in_a_save_leaves_the_old_or_the_new(supplied);
}

#[test]
fn what_is_stored_on_the_virtual_rig_is_in_force_after_a_power_cut() {
    body::keeping::what_is_stored_is_in_force_after_a_power_cut(supplied);
}

#[cfg(unix)]
#[test]
fn a_damaged_configuration_on_the_virtual_rig_is_named_and_arms_nothing_before_one_is_stored() {
    body::keeping::a_damaged_configuration_is_named_and_arms_nothing_before_one_is_stored(supplied);
}

#[test]
fn a_late_sample_trips_the_virtual_rig_by_name() {
    body::jitter::a_late_sample_trips_by_name(|rig| {
        Box::new(VirtualTarget::start(rig, "tcp:127.0.0.1:0").expect("a virtual rig"))
    });
}

#[test]
fn a_silent_host_trips_the_virtual_rig_by_name() {
    body::jitter::a_silent_host_trips_by_name(|rig| {
        Box::new(VirtualTarget::start_in_step(rig, "tcp:127.0.0.1:0").expect("a virtual rig"))
    });
}

#[test]
fn runs_again_and_again_on_the_virtual_rig_are_the_simulation() {
    use body::soak::{drive, soak};
    let target = VirtualTarget::start(&drive(), "tcp:127.0.0.1:0").expect("a virtual rig");
    let soaked = soak(&target, 11.0);
    println!("{soaked:?}");
}

#[test]
fn move_records_begin_by_their_numbers_on_the_virtual_rig() {
    body::records::records_begin_by_their_numbers(virtual_rig);
}

#[test]
fn a_stop_by_an_input_always_wins_on_the_virtual_rig() {
    body::records::a_stop_by_an_input_always_wins(virtual_rig);
}

#[test]
fn inputs_or_a_host_own_the_virtual_rig_and_never_both() {
    body::records::a_drive_has_one_owner(virtual_rig);
}

#[test]
fn a_stop_by_a_host_withdraws_what_the_inputs_may() {
    body::records::a_stop_by_a_host_withdraws_what_the_inputs_may(virtual_rig);
}

#[test]
fn a_power_cut_while_a_table_is_saved_leaves_the_old_or_the_new_on_the_virtual_rig() {
    body::records::a_power_cut_while_a_table_is_saved_leaves_the_old_or_the_new(supplied);
}
