//! The runner for a real board, tried on what answers like one.
#![cfg(unix)]

use std::process::{Command, Output};

use pneudrive_hil_tests::emulated_board::EmulatedBoard;
use pneudrive_hil_tests::{Target, VirtualTarget, board_runner, body, image};

/// The runner's exit code and all that it says.
fn run(variables: &[(&str, &str)], bodies: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(board_runner().expect("the runner is built"));
    for name in ["PNEUDRIVE_BOARD", "PNEUDRIVE_BOARD_PLANT", "PNEUDRIVE_BOARD_RIG"] {
        command.env_remove(name);
    }
    let variables = variables.iter().copied();
    let Output { status, stdout, stderr } = command.envs(variables).args(bodies).output().expect("it runs");
    (status.code(), String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr))
}

#[test]
fn without_a_board_the_runner_says_what_to_set_and_passes_nothing() {
    let (code, said) = run(&[], &[]);
    assert!(code == Some(2) && said.contains("PNEUDRIVE_BOARD is not set"), "{said}");
    let (code, said) = run(&[("PNEUDRIVE_BOARD", "tcp://127.0.0.1:1")], &[]);
    assert!(code == Some(2) && said.contains("set PNEUDRIVE_BOARD_PLANT"), "{said}");
}

#[test]
fn a_board_with_a_simulated_plant_at_its_second_port_is_put_through_the_bodies() {
    // Built before: the board's plant must call soon.
    board_runner().expect("the runner is built");
    let (board, plant) = EmulatedBoard::start_without_plant(image().expect("an image")).expect("a board");
    let variables = [("PNEUDRIVE_BOARD", board.port()), ("PNEUDRIVE_BOARD_PLANT", &plant)];
    let (code, said) = run(&variables, &["another period", "a stopped run", "a stop ends", "a step meets"]);
    assert!(code == Some(0) && said.ends_with("board: 4 passed, 0 failed\n"), "{said}");
}

#[test]
fn a_board_with_a_cylinder_runs_the_test_that_was_named_and_its_record_replays() {
    let rig = body::rig("servo-b-tuned", &[]);
    let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
    let port = target.port().to_owned();
    let (code, said) = run(&[("PNEUDRIVE_BOARD", &port), ("PNEUDRIVE_BOARD_RIG", "servo-b-tuned")], &[]);
    assert!(code == Some(0) && said.ends_with("board: 1 passed, 0 failed\n"), "{said}");
    // The parameters of the drive are its own.
    let mut client = target.connect().expect("a rig that answers");
    assert_eq!(client.parameters().expect("an answer").values, rig.parameters());
}

#[test]
fn a_body_that_fails_on_the_board_fails_the_runner() {
    let rig = body::rig("servo-b-tuned", &["faults.event=[{kind = \"encoder-jump\", at_s = 0.35}]"]);
    let target = VirtualTarget::start(&rig, "tcp:127.0.0.1:0").expect("a virtual rig");
    let port = target.port().to_owned();
    let (code, said) = run(&[("PNEUDRIVE_BOARD", &port), ("PNEUDRIVE_BOARD_RIG", "servo-b-tuned")], &[]);
    assert!(code == Some(1) && said.contains("0 passed, 1 failed\n"), "{said}");
    assert!(said.contains("encoder-step"), "{said}");
}
