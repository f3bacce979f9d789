//! A plan that is killed leaves nothing on the rig that the next one does not put right.
#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;

use crate::program::{folder, transcript, unhurried_rig, virtual_rig};

const PATIENCE: Duration = Duration::from_secs(20);

fn plan(folder: &Path, port: &str) -> Child {
    started(folder, &format!("identify servo-b-tuned --plan {port} --fit load.mass_kg"), Stdio::null())
}

fn started(folder: &Path, asked: &str, told: Stdio) -> Child {
    Command::new(env!("CARGO_BIN_EXE_pneudrive"))
        .current_dir(folder)
        .args(asked.split(' '))
        .env("PNEUDRIVE_STATE", folder.join("state"))
        .stdout(Stdio::null())
        .stderr(told)
        .spawn()
        .expect("the program runs")
}

fn wait_for(rig: &mut Client, mode: Mode) {
    let begun = Instant::now();
    while rig.status().expect("a status").mode != mode {
        assert!(begun.elapsed() < PATIENCE, "never {mode:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// All but the null, which each run learns.
fn given(rig: &mut Client) -> Parameters {
    let mut values = rig.parameters().expect("an answer").values;
    values.set(id::NULL_OFFSET_COUNTS, 0).expect("in range");
    values
}

#[test]
fn a_plan_after_one_that_was_killed_in_an_open_loop_leaves_the_parameters_from_before_both() {
    let (rig, folders) = (unhurried_rig("servo-b-tuned"), [folder(), folder()]);
    let mut other = Client::connect(rig.port()).expect("a rig");
    let before = given(&mut other);
    assert_eq!(before.get(id::OPEN_LOOP), Some(0));
    let mut killed = plan(folders[0].path(), rig.port());
    wait_for(&mut other, Mode::Running);
    killed.kill().expect("it runs");
    killed.wait().expect("it was started");
    wait_for(&mut other, Mode::Fault);
    assert_eq!(given(&mut other).get(id::OPEN_LOOP), Some(1), "it could not put it back");
    // Clears the fault.
    other.arm().expect("armed");
    other.disarm().expect("disarmed");
    let mut next = plan(folders[0].path(), rig.port());
    wait_for(&mut other, Mode::Running);
    let interrupted = Command::new("kill").args(["-INT", &next.id().to_string()]).status();
    assert!(interrupted.expect("kill runs").success());
    assert_eq!(next.wait().expect("it was started").code(), Some(130), "Ctrl-C ends it");
    assert_eq!(given(&mut other), before);
    let left = std::fs::read_dir(folders[0].path().join("state")).expect("a folder").count();
    assert_eq!(left, 0, "what was given back is not kept");
}

/// What was kept is for the drive as it was, and not for another one or for what somebody has set since.
#[test]
fn what_a_killed_plan_has_kept_is_not_given_to_a_drive_that_somebody_has_set_since() {
    let (rig, folder) = (unhurried_rig("servo-b-tuned"), folder());
    let mut other = Client::connect(rig.port()).expect("a rig");
    let mut killed = plan(folder.path(), rig.port());
    wait_for(&mut other, Mode::Running);
    killed.kill().expect("it runs");
    killed.wait().expect("it was started");
    wait_for(&mut other, Mode::Fault);
    other.arm().expect("armed");
    other.disarm().expect("disarmed");
    other.set_parameters(id::VELOCITY_GAIN, &[77]).expect("disarmed");
    let since = given(&mut other);
    let mut next = plan(folder.path(), rig.port());
    wait_for(&mut other, Mode::Running);
    let interrupted = Command::new("kill").args(["-INT", &next.id().to_string()]).status();
    assert!(interrupted.expect("kill runs").success());
    next.wait().expect("it was started");
    assert_eq!(given(&mut other), since);
}

/// Once a plan that was interrupted began anew, and its records were of no use.
#[test]
fn a_plan_goes_on_behind_the_records_of_one_that_was_killed() {
    let (rig, folder) = (virtual_rig("servo-b-tuned"), folder());
    let records = || {
        let there = std::fs::read_dir(folder.path().join("identified")).into_iter().flatten().flatten();
        there.filter(|entry| entry.file_name().to_string_lossy().starts_with("TARGET")).count()
    };
    let mut killed = plan(folder.path(), rig.port());
    let begun = Instant::now();
    while records() < 3 {
        assert!(begun.elapsed() < PATIENCE, "it records nothing");
        std::thread::sleep(Duration::from_millis(2));
    }
    killed.kill().expect("it runs");
    killed.wait().expect("it was started");
    let of_the_first = records();
    let asked = format!("identify servo-b-tuned --plan {} --fit load.mass_kg", rig.port());
    let printed = transcript(folder.path(), &asked);
    assert!(printed.contains("the plan goes on behind the "), "{printed}");
    let told = printed.lines().filter(|line| line.contains("TARGET") && line.contains(".DAT: ")).count();
    assert!(told < 9 && records() <= of_the_first + told, "{told} tests are run again: {printed}");
    assert!(printed.contains("load.mass_kg"), "all of them are fitted: {printed}");
    assert!(!folder.path().join("identified/plan.state").exists());
}

#[test]
fn a_plan_that_is_killed_while_it_fits_moves_nothing_the_next_time() {
    const TESTS: usize = 9;
    let (rig, folder) = (virtual_rig("servo-b-tuned"), folder());
    let state = folder.path().join("identified/plan.state");
    let asked = format!("identify servo-b-tuned --plan {}", rig.port());
    let mut killed = started(folder.path(), &asked, Stdio::piped());
    let told = BufReader::new(killed.stderr.take().expect("piped"));
    let fits = |line: &String| line.contains("of each transient");
    assert!(told.lines().map_while(Result::ok).any(|line| fits(&line)), "it ends before it fits");
    killed.kill().expect("it runs");
    killed.wait().expect("it was started");
    let recorded = std::fs::read_to_string(&state).expect("kept while it fits");
    assert_eq!(recorded.matches(".DAT").count(), TESTS, "{recorded}");
    let printed = transcript(folder.path(), &format!("{asked} --fit load.mass_kg"));
    assert!(printed.contains("the plan goes on behind the 9 tests"), "{printed}");
    assert!(!printed.contains(".DAT: "), "a test is run again: {printed}");
    assert!(printed.contains("load.mass_kg") && !state.exists(), "{printed}");
}
