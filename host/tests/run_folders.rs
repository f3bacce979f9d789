//! A run folder is one thing: whoever writes it, however it ends, its files are of one run.
//!
//! Sixty kills, or as many as `PNEUDRIVE_KILLS` says.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use pneudrive_records::run_folder::{IDENTITY, StoredRun};

use crate::program::{folder, ok, pneudrive};
use crate::simulated_link::{Random, cases};

/// Two runs that nobody takes for each other; the second has no perturbed runs, and so no band.
const RUNS: [&str; 2] = [
    "simulate servo-b-tuned --set test.duration_s=0.35 --set load.mass_kg=10 --ensemble 3 --out run",
    "simulate servo-b-tuned --set test.duration_s=0.35 --set load.mass_kg=20 --ensemble 1 --out run",
];

fn simulate(folder: &Path, run: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder).args(run.split_whitespace()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Every file of a folder with what is in it, but for the number and the date of a run, which are another's each time.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let named = entries.map(|path| (path.file_name().expect("a name").to_string_lossy().into_owned(), path));
    let read = |name: &str, path| match name {
        "run.json" => without(&["  \"run\": ", "  \"date\": "], &fs::read_to_string(path).expect("a file")),
        "report.html" => without(&[GRAPHS], &fs::read_to_string(path).expect("a file")),
        _ => fs::read(path).expect("a file"),
    };
    named.map(|(name, path)| (name.clone(), read(&name, path))).collect()
}

/// The graphs of a page, compressed: number and date stand below each.
const GRAPHS: &str = "<script type=\"application/gzip\" id=\"graphs\">";

/// A text without the lines that begin with these, of which it has one each.
fn without(beginnings: &[&str], text: &str) -> Vec<u8> {
    let is_left_out = |line: &&str| beginnings.iter().any(|beginning| line.starts_with(beginning));
    assert_eq!(text.lines().filter(is_left_out).count(), beginnings.len(), "one line for each: {text}");
    text.lines()
        .filter(|line| !is_left_out(line))
        .flat_map(|line| [line, "\n"])
        .collect::<String>()
        .into_bytes()
}

/// What of a run does not change from one time to the next: all but the page's order of attributes is the run's own.
fn whole_runs(folder: &Path) -> [BTreeMap<String, Vec<u8>>; 2] {
    RUNS.map(|run| {
        ok(folder, run);
        contents(&folder.join("run"))
    })
}

#[test]
fn a_simulation_that_is_killed_leaves_the_old_run_or_the_new_one_whole() {
    let folder = folder();
    let began = Instant::now();
    let whole = whole_runs(folder.path());
    let longest = began.elapsed().as_micros() as usize;
    assert_ne!(whole[0].keys().collect::<Vec<_>>(), whole[1].keys().collect::<Vec<_>>());
    let mut random = Random(5);
    let mut seen = [0; 2];
    for kill in 0..cases("PNEUDRIVE_KILLS", 60) as usize {
        let mut child = simulate(folder.path(), RUNS[kill % 2]).spawn().expect("it starts");
        std::thread::sleep(Duration::from_micros(random.below(longest) as u64));
        child.kill().expect("killed");
        child.wait().expect("it ends");
        StoredRun::read(&folder.path().join("run")).unwrap_or_else(|error| panic!("kill {kill}: {error:#}"));
        let left = contents(&folder.path().join("run"));
        let which = whole.iter().position(|whole| *whole == left);
        let names: Vec<&String> = left.keys().collect();
        seen[which.unwrap_or_else(|| panic!("kill {kill} left files of two runs, or others: {names:?}"))] +=
            1;
    }
    assert!(seen.iter().all(|times| *times > 0), "both runs came to be: {seen:?}");
}

#[test]
fn simulations_that_write_at_the_same_time_leave_one_of_their_runs() {
    let folder = folder();
    let whole = whole_runs(folder.path());
    for _ in 0..6 {
        let children = [0, 1, 0, 1].map(|run| simulate(folder.path(), RUNS[run]).spawn().expect("it starts"));
        for mut child in children {
            assert!(child.wait().expect("it ends").success());
        }
        assert!(whole.contains(&contents(&folder.path().join("run"))), "files of two runs");
    }
}

#[test]
fn the_page_and_run_json_tell_of_one_run_and_a_changed_trace_is_refused() {
    let folder = folder();
    ok(folder.path(), RUNS[0]);
    let path = |name: &str| folder.path().join("run").join(name);
    let run: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(path("run.json")).expect("there")).expect("JSON");
    let mark = format!("<meta name=\"{IDENTITY}\" content={}>", run["identity"]);
    assert!(fs::read_to_string(path("report.html")).expect("there").contains(&mark), "{mark}");
    for name in ["trace.csv", "band.csv"] {
        let text = fs::read_to_string(path(name)).expect("there");
        fs::write(path(name), text.replacen("0.0013,", "0.0014,", 1)).expect("written");
        let refused = pneudrive(folder.path(), "eval run");
        let printed = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(
            !refused.status.success() && printed.contains(&format!("{name} does not belong")),
            "{printed}"
        );
        fs::write(path(name), text).expect("written");
    }
    ok(folder.path(), "eval run");
}

/// The members of the ensemble of a run are simulated again from what run.json says; so is a continued one.
#[test]
fn a_run_is_reproduced_from_its_values_whatever_its_moves_are() {
    let folder = folder();
    let settings = [
        "--set test.targets=[8192,9000]",
        "--set test.profile=s-curve --set test.moves=[[0,8192],[1.5,9000]]",
        "--test profiles.toml",
    ];
    let profiles = "[[test.move]]\nprofile = \"step\"\nto_mm = 100\n[[test.move]]\nat_s = 0.2\nprofile = \"sine\"\nto_mm = 100\namplitude_mm = 5\nfrequency_hz = 4\ncycles = 1\n";
    fs::write(folder.path().join("profiles.toml"), profiles).expect("written");
    for settings in settings {
        let run = format!(
            "simulate servo-a-tuned {settings} --set test.duration_s=0.6 --ensemble 2 --no-report --out run"
        );
        ok(folder.path(), &run);
        let printed = ok(folder.path(), "eval run");
        assert!(!printed.contains("does not reproduce"), "{settings}: {printed}");
        assert!(printed.contains("Least and most are over 2 runs"), "{settings}: {printed}");
    }
}
