//! The board's end of the plant bus and the plant that waits on the PC, each as it is at a real board.

use pneudrive_controller::Fault;
use pneudrive_hil_tests::Target;
use pneudrive_hil_tests::body::{self, rig};
use pneudrive_hil_tests::linked::LinkedTarget;
use pneudrive_protocol::Mode;
use pneudrive_sim::Rig;

fn linked(rig: &Rig) -> Box<dyn Target> {
    Box::new(LinkedTarget::start(rig).expect("board and plant"))
}

#[test]
fn the_record_of_a_board_whose_plant_is_at_a_port_is_the_simulation() {
    for name in ["servo-a", "servo-b-tuned", "servo-c"] {
        let rig = rig(name, &["test.duration_s=0.6", "test.moves=[[0.0, 8192], [0.1, 12000]]"]);
        body::assert_equal_in_every_integer(&*linked(&rig), &rig);
    }
}

#[test]
fn a_drive_whose_first_move_comes_late_stays_where_it_is() {
    body::a_late_first_move(linked);
}

#[test]
fn profiles_are_those_of_the_simulation_and_replay() {
    body::profiles(linked);
}

#[test]
fn a_fault_after_the_moves_of_a_run_trips_the_drive_that_holds() {
    body::a_fault_after_the_moves(linked);
}

#[test]
fn absolute_encoders_need_no_homing() {
    body::axis::absolute_encoders_need_no_homing(linked);
}

#[test]
fn each_start_begins_from_the_same_state_though_inputs_are_on_their_way() {
    body::each_start_begins_from_the_same_state(linked);
}

#[test]
fn the_plant_is_told_another_period() {
    body::another_period(linked);
}

#[test]
fn a_run_that_was_stopped_replays_up_to_there() {
    body::the_record_of_a_stopped_run_replays(linked);
}

#[test]
fn a_stop_ends_a_run() {
    body::a_stop_ends_a_run_in_a_named_fault_and_arming_leaves_it(linked);
}

#[test]
fn a_plant_that_goes_trips_the_run_by_name_and_one_that_comes_back_is_taken_up() {
    let long = rig("servo-b", &["test.duration_s=3000"]);
    let mut target = LinkedTarget::start(&long).expect("board and plant");
    let mut client = target.connect().expect("a board that answers");
    body::start_run(&mut client, &long);
    while client.status().expect("an answer").index < 100 {}
    target.plant_goes();
    while client.status().expect("the port is served").mode == Mode::Running {}
    let status = client.status().expect("an answer");
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::LateSample.code()));
    let newest = client.events().expect("a log").first().copied().expect("an event");
    assert_eq!(newest.code, Fault::LateSample.code());
    let short = rig("servo-b", &["test.duration_s=0.3"]);
    target.plant_comes(&short).expect("the board says hello");
    client.arm().expect("arming leaves the fault");
    client.disarm().expect("an answer");
    drop(client);
    body::assert_equal_in_every_integer(&target, &short);
}

#[test]
fn move_records_begin_by_their_numbers_on_a_board_whose_plant_is_at_a_port() {
    body::records::records_begin_by_their_numbers(linked);
}

#[test]
fn a_stop_by_an_input_always_wins_on_a_board_whose_plant_is_at_a_port() {
    body::records::a_stop_by_an_input_always_wins(linked);
}

#[test]
fn inputs_or_a_host_own_a_board_whose_plant_is_at_a_port_and_never_both() {
    body::records::a_drive_has_one_owner(linked);
}

#[test]
fn a_stop_by_a_host_withdraws_what_the_inputs_may() {
    body::records::a_stop_by_a_host_withdraws_what_the_inputs_may(linked);
}
