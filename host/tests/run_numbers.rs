//! A run is known by its number, its date and its rig, and the run of another rig stays.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::program::{folder, ok, transcript};

const SHORT: &str = "--set test.duration_s=0.05 --ensemble 1 --no-report";

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).expect("written")
}

fn description(folder: &Path, run: &str) -> Value {
    serde_json::from_str(&text(folder, &format!("{run}/run.json"))).expect("JSON")
}

#[test]
fn the_runs_of_a_folder_are_counted_and_dated() {
    let folder = folder();
    for number in 1..=3 {
        let printed = ok(folder.path(), &format!("simulate servo-b {SHORT} --out a"));
        assert!(printed.contains(&format!("run.json; run {number}")), "{printed}");
        let run = description(folder.path(), "a");
        assert_eq!((run["run"].as_u64(), run["rig"].as_str()), (Some(number), Some("servo-b")));
        let date = run["date"].as_str().expect("a date");
        assert!(date.len() == 20 && date.starts_with("20") && date.ends_with('Z'), "{date}");
    }
    ok(folder.path(), &format!("simulate servo-b {SHORT} --out b"));
    assert_eq!(description(folder.path(), "b")["run"], 1, "each folder counts its own");
}

#[test]
fn with_a_fixed_date_a_run_is_written_byte_for_byte_again() {
    let folder = folder();
    let simulate = |out: &str, date: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
        command.current_dir(folder.path()).env("SOURCE_DATE_EPOCH", date);
        let arguments = format!("simulate servo-b {SHORT} --out {out}");
        command.args(arguments.split_whitespace()).output().expect("the program runs")
    };
    for out in ["a", "b"] {
        assert!(simulate(out, "1700000000").status.success());
    }
    assert_eq!(text(folder.path(), "a/run.json"), text(folder.path(), "b/run.json"));
    assert_eq!(description(folder.path(), "a")["date"], "2023-11-14T22:13:20Z");
    let refused = simulate("c", "today");
    let printed = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(!refused.status.success() && printed.contains("SOURCE_DATE_EPOCH is \"today\""), "{printed}");
    assert!(!folder.path().join("c/trace.csv").exists());
}

#[test]
fn the_run_of_another_rig_stays_unless_it_is_to_be_replaced() {
    let folder = folder();
    ok(folder.path(), &format!("simulate servo-b {SHORT} --out a"));
    let before = text(folder.path(), "a/trace.csv");
    for command in [format!("simulate servo-c {SHORT} --out a"), "demo --rig servo-c --out a".to_owned()] {
        let printed = transcript(folder.path(), &command);
        assert!(printed.contains("a has a run of servo-b; choose another folder for servo-c"), "{printed}");
        assert!(printed.contains("or replace it with --overwrite") && printed.ends_with("= 1"), "{printed}");
        assert_eq!(text(folder.path(), "a/trace.csv"), before);
    }
    assert!(!folder.path().join("a/TARGET01.DAT").exists(), "refused before the work");
    ok(folder.path(), &format!("simulate servo-b {SHORT} --set load.mass_kg=3 --out a"));
    ok(folder.path(), &format!("simulate servo-c {SHORT} --out a --overwrite"));
    let run = description(folder.path(), "a");
    assert_eq!((run["run"].as_u64(), run["rig"].as_str()), (Some(3), Some("servo-c")));
}
