//! The sensor noise of a virtual rig, new in every run and repeatable; and rigs without noise and off level, identified as a
//! user does it.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use pneudrive_records::target::TargetFile;
use pneudrive_sim::Rig;

use crate::hidden_rigs::rigs::EXACT;
use crate::program::{folder, ok, transcript};

/// Fifty samples of a drive that stands still.
const TEST: &str = "servo-b-tuned --set test.moves=[[0.0,8192]] --set test.duration_s=0.065";

/// `pneudrive virtual` as a user starts it.
struct Served {
    program: Child,
    port: String,
    terminal: BufReader<std::process::ChildStdout>,
}

impl Served {
    fn start(arguments: &str) -> Served {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
        command.args(arguments.split_whitespace()).stdout(Stdio::piped());
        let mut program = command.spawn().expect("the program runs");
        let mut terminal = BufReader::new(program.stdout.take().expect("a pipe"));
        let mut line = String::new();
        terminal.read_line(&mut line).expect("a line");
        let port = line.trim().rsplit(' ').next().expect("a port").to_owned();
        Served { program, port, terminal }
    }

    /// What stands on its terminal up to a line with `last`.
    fn printed_until(&mut self, last: &str) -> String {
        let mut printed = String::new();
        while !printed.contains(last) && self.terminal.read_line(&mut printed).expect("a line") > 0 {}
        printed
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// The pressures that two runs in a row have recorded.
fn two_runs(folder: &Path, port: &str) -> [Vec<i16>; 2] {
    [(); 2].map(|()| {
        ok(folder, &format!("run {TEST} --port {port}"));
        let printed = ok(folder, &format!("record --port {port}"));
        ok(folder, &format!("device --port {port} disarm"));
        let name = printed.split_whitespace().find(|word| word.contains("TARGET")).expect("a file");
        let file = TargetFile::read(&folder.join(name.trim_end_matches(':'))).expect("a record");
        file.samples.iter().map(|(_, sample)| sample.pressure_1).collect()
    })
}

#[test]
fn every_run_has_its_own_noise_and_a_seed_repeats_the_sequence() {
    let folder = folder();
    let noisy = "virtual servo-b-tuned --listen tcp:127.0.0.1:0 --fast --set sensors.noise_counts=2 --seed 5";
    let mut rig = Served::start(noisy);
    let [first, second] = two_runs(folder.path(), &rig.port);
    assert_ne!(first, second, "the same noise in every run is averaged away by no number of runs");
    let printed = rig.printed_until("run 2");
    assert!(printed.contains("--seed 5") && printed.contains("run 1"), "{printed}");
    let info = ok(folder.path(), &format!("device --port {} info", rig.port));
    assert!(info.contains("virtual rig, seed 5"), "{info}");
    let again = Served::start(noisy);
    assert_eq!(two_runs(folder.path(), &again.port), [first, second]);
}

#[test]
fn runs_without_noise_are_equal() {
    let folder = folder();
    let rig = Served::start("virtual servo-b-tuned --listen tcp:127.0.0.1:0 --fast");
    let [first, second] = two_runs(folder.path(), &rig.port);
    assert_eq!(first, second);
}

/// The middle of its stroke, without dither.
const MIDDLE: &str = "\
[operator]
dither_mm = 0.0
[test]
position_m = 0.15
duration_s = 0.2
";

/// What the terminal and identification.json say where a plan finds out about a virtual rig: that of a file with a setting.
fn identified(folder: &Path, file: &str, setting: &str) -> (String, serde_json::Value) {
    fs::write(folder.join("rig.toml"), file).expect("written");
    let path = folder.join("rig.toml");
    let served = format!("virtual {} {setting} --listen tcp:127.0.0.1:0 --fast", path.display());
    let rig = Served::start(&served);
    let printed = transcript(folder, &format!("identify rig.toml --plan {}", rig.port));
    let json = fs::read_to_string(folder.join("identified/identification.json")).expect("there");
    (printed, serde_json::from_str(&json).expect("JSON"))
}

/// Every 95 % interval holds what a rig has.
fn assert_intervals_hold(json: &serde_json::Value, real: &Rig) {
    let told = json["parameters"].as_array().expect("a list");
    let key = |parameter: &serde_json::Value| parameter["key"].as_str().expect("a key").to_owned();
    let of_the_load = told.iter().filter(|parameter| key(parameter).starts_with("load."));
    assert_eq!(of_the_load.count(), 6, "mass, viscous friction, and friction both ways: {told:?}");
    for parameter in told {
        let truth = real.number_at(&key(parameter)).expect("a number");
        let [low, high] = [0, 1].map(|end| parameter["interval_95"][end].as_f64().expect("a number"));
        assert!(low <= truth && truth <= high, "{parameter}");
    }
}

/// What a first user does: the rounding of readings without noise follows their course, and such residuals were called no
/// fit after minutes of search.
#[test]
#[ignore = "long: cargo xtask test long"]
fn a_virtual_rig_without_noise_is_a_fit_whose_intervals_hold_what_its_file_says() {
    let folder = folder();
    let file = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("built in");
    let (printed, json) = identified(folder.path(), file, "");
    assert!(printed.ends_with("= 0") && printed.contains("less noise than a count"), "{printed}");
    assert_eq!(json["fits"], true);
    let rounded = json["channels_rounded"].as_array().expect("channels");
    assert!(rounded.contains(&"pressure 1".into()) && rounded.contains(&"pressure 2".into()), "{rounded:?}");
    assert_intervals_hold(&json, &Rig::read("servo-b-tuned", file).expect("valid"));
    assert!(json["runs"].as_u64().expect("a number") < 6000, "the search begins but once: {}", json["runs"]);
}

/// No transient tells an incline from friction that is stronger one way; that all friction is off by one force does.
#[test]
#[ignore = "long: cargo xtask test long"]
fn an_incline_that_friction_seems_to_make_up_for_is_told() {
    let folder = folder();
    let settings = "--set load.incline_deg=30 --set valve.null_offset_mm=-0.005";
    let (printed, json) = identified(folder.path(), MIDDLE, settings);
    assert!(printed.ends_with("= 0") && printed.contains("Measure it with a level"), "{printed}");
    let told = json["incline_suggested_deg"].as_f64().expect("told");
    assert!((told - 30.0).abs() < 2.0, "{told}");
    let real = Rig::read("rig.toml", MIDDLE).expect("valid");
    let null = real.with_numbers(&[("valve.null_offset_mm", -0.005)]).expect("valid");
    assert_intervals_hold(&json, &null);
}

/// The weight of the load is more than Coulomb friction of retraction. Calibration is exact: pressures that may be 2 % off make
/// the weight as uncertain, and the angle by more than a degree.
#[test]
#[ignore = "long: cargo xtask test long"]
fn an_incline_that_friction_cannot_make_up_for_is_a_misfit_and_named_with_its_size() {
    let folder = folder();
    let file = format!("{EXACT}{MIDDLE}");
    let (printed, json) = identified(folder.path(), &file, "--set load.incline_deg=65");
    assert!(printed.ends_with("= 7"), "{printed}");
    let cause = &json["causes"][0];
    assert_eq!((&cause["effect"], &cause["significant"]), (&"an incline".into(), &true.into()), "{cause}");
    let number = |name: &str| cause[name].as_f64().expect("a number");
    // Its friction is the file's, so that the weight alone is to be found.
    assert!((number("value") - 65.0).abs() < 0.5 && number("standard_error") < 0.5, "{cause}");
    assert_eq!(
        json["incline_suggested_deg"],
        serde_json::Value::Null,
        "friction at its end tells another one"
    );
    assert!(printed.contains("load.coulomb_retract_n. Check that the file belongs to this rig"), "{printed}");
}

/// Bristles yield as the pressures change, long before the load slips: the first count that it moves is neither the end of
/// its rest nor its stiction.
#[test]
#[ignore = "long: cargo xtask test long"]
fn a_drive_on_bristles_is_identified_over_the_link() {
    let folder = folder();
    let file = "[operator]\nmodel = \"stepper\"\n[load]\nfriction = \"lugre\"\n[test]\nposition_m = 0.15\nduration_s = 0.2\n";
    let settings = "--set load.bristle_stiffness_n_per_m=3e5 --set sensors.noise_counts=0.5 --seed 3";
    let (printed, json) = identified(folder.path(), file, settings);
    assert!(printed.ends_with("= 0"), "{printed}");
    assert!(printed.contains("cannot be seen: the load yields before it slips"), "{printed}");
    assert!(!printed.contains("the rig's parameters differ"), "the plan itself chooses the loop: {printed}");
    let parameters = json["parameters"].as_array().expect("a list");
    let stiffness =
        parameters.iter().find(|one| one["key"] == "load.bristle_stiffness_n_per_m").expect("fitted");
    let [low, high] = [0, 1].map(|end| stiffness["interval_95"][end].as_f64().expect("a number"));
    assert!(low <= 3e5 && 3e5 <= high && high < 1.2 * low, "{stiffness}");
}
