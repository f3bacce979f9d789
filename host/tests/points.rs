//! Paths through the points of a table, in the simulator and on a drive.

use std::fs;

use crate::program::{folder, ok, transcript, virtual_rig};

const PATH: &str = "time_s,position_mm\n0,100\n0.1,100\n0.35,130\n0.6,130\n";

#[test]
fn a_way_is_simulated_and_run_as_the_same_moves() {
    let folder = folder();
    fs::write(folder.path().join("path.csv"), PATH).expect("written");
    let told = ok(folder.path(), "simulate servo-b-tuned --points path.csv --out sim --ensemble 1");
    assert!(told.contains("goes through 4 of 4 points") && told.contains("120.0 mm/s"), "{told}");
    assert!(told.contains("sim: trace.csv"), "{told}");
    let rig = virtual_rig("servo-b-tuned");
    ok(folder.path(), &format!("run servo-b-tuned --points path.csv --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    let record = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("written");
    assert_eq!(record.lines().filter(|line| line.starts_with("# move.")).count(), 4, "{record:.3000}");
    assert!(ok(folder.path(), "replay TARGET01.DAT").contains("as recorded"));
}

#[test]
fn what_a_table_has_wrong_is_named_with_file_and_line_and_limits_are_raised_as_it_says() {
    let folder = folder();
    fs::write(folder.path().join("path.csv"), "time_s,position_mm\n0,100\n0.1,180\n").expect("written");
    let simulate = "simulate servo-b-tuned --points path.csv --out sim --ensemble 1 --no-report";
    let told = transcript(folder.path(), simulate);
    assert!(told.contains("path.csv: line 3: 800.0 mm/s") && told.ends_with("= 1"), "{told}");
    let raised = "--set test.velocity_mm_s=800 --set test.acceleration_mm_s2=8000";
    ok(folder.path(), &format!("{simulate} {raised}"));
    for (other, code) in [("--test servo-b", 2), ("--from run", 2), ("--set controller.loop=open", 1)] {
        let told = transcript(folder.path(), &format!("{simulate} {other}"));
        assert!(told.ends_with(&format!("= {code}")), "{other}: {told}");
    }
    let none = transcript(folder.path(), "simulate servo-b-tuned --points none.csv --out sim");
    assert!(none.contains("none.csv") && !none.ends_with("= 0"), "{none}");
}

/// Profiles, and their limits, go to a drive with the moves.
#[test]
fn a_run_takes_the_profile_of_its_moves_from_the_command_line() {
    let folder = folder();
    let rig = virtual_rig("servo-b-tuned");
    let profile =
        "--set test.profile=s-curve --set test.velocity_mm_s=300 --set test.moves=[[0.0,8192],[0.9,9000]]";
    let told = ok(
        folder.path(),
        &format!("run servo-b-tuned --set test.duration_s=1.1 {profile} --port {}", rig.port()),
    );
    assert!(told.contains("servo-b-tuned: done"), "{told}");
}
