//! `simulate --from`: a recorded run simulated again, and a simulated one gone on with.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::{folder, ok, transcript, virtual_rig};

fn run_json(folder: &Path, run: &str) -> Value {
    let text = fs::read_to_string(folder.join(run).join("run.json")).expect("written");
    serde_json::from_str(&text).expect("JSON")
}

/// A column of a run, by its place.
fn column(folder: &Path, run: &str, place: usize) -> Vec<f64> {
    let text = fs::read_to_string(folder.join(run).join("trace.csv")).expect("written");
    let cell = |line: &str| line.split(',').nth(place).and_then(|cell| cell.parse().ok()).expect("a number");
    text.lines().skip(1).map(cell).collect()
}

#[test]
fn a_record_gives_a_simulation_its_moves_gains_and_initial_state() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let asked = "--set test.moves=[[0.05,8192],[0.3,12000],[0.5,9000]] --set test.duration_s=0.7 \
                 --set controller.velocity_gain=1500 --set controller.gain_profile=[1024,512]";
    ok(folder.path(), &format!("run servo-b-tuned {asked} --config --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    let printed =
        ok(folder.path(), "simulate servo-b-tuned --from TARGET01.DAT --ensemble 1 --no-report --out again");
    assert!(
        printed.contains("controller.velocity_gain is 1500, as recorded; the rig file has 2000"),
        "{printed}"
    );
    let keys = &run_json(folder.path(), "again")["keys"];
    assert_eq!(keys["controller.velocity_gain"], 1500);
    let targets: Vec<i64> =
        keys["test.moves"].as_array().expect("moves").iter().filter_map(|one| one[1].as_i64()).collect();
    assert_eq!(targets, [12_000, 9_000], "the first one is held anyway: {keys}");
    let times: Vec<f64> =
        keys["test.moves"].as_array().expect("moves").iter().filter_map(|one| one[0].as_f64()).collect();
    assert!((times[0] - 0.3003).abs() < 1e-9 && (times[1] - 0.5005).abs() < 1e-9, "at samples: {times:?}");
    // The same run as it was asked for, from the same place.
    ok(folder.path(), &format!("simulate servo-b-tuned {asked} --ensemble 1 --no-report --out first"));
    let [again, first] = ["again", "first"].map(|run| column(folder.path(), run, 5));
    let off = |samples: usize| {
        let pairs = again.iter().zip(&first).take(samples);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(off(1) <= 0.01205e-3, "it starts within a count: {} m", off(1));
    // Half a count and half a step of the converters at the start is what a record leaves open.
    assert!(off(380) < 0.02 * 45.9e-3, "2 % of the first step: {} m", off(380));
    let setpoints = ["again", "first"].map(|run| column(folder.path(), run, 1));
    assert_eq!(setpoints[0], setpoints[1][..setpoints[0].len()]);
}

/// A list of moves cannot say profiles: they come from the rig, or from the test that is given beside it.
#[test]
fn a_record_of_moves_with_profiles_is_simulated_with_these_moves_and_no_others() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let moves = "[{profile=\"step\",to_mm=98.72},{profile=\"s-curve\",at_s=0.1,to_mm=120}]";
    let asked = format!("--set test.move={moves} --set test.duration_s=0.5");
    ok(folder.path(), &format!("run servo-b-tuned {asked} --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    let again = "simulate servo-b-tuned --ensemble 1 --no-report --from TARGET01.DAT";
    ok(folder.path(), &format!("{again} {asked} --out again"));
    ok(folder.path(), &format!("simulate servo-b-tuned {asked} --ensemble 1 --no-report --out first"));
    let setpoints = ["again", "first"].map(|run| column(folder.path(), run, 1));
    assert!(setpoints[0] == setpoints[1], "{setpoints:?}");
    let file = format!("[test]\nmove = {moves}\nduration_s = 0.5\n");
    std::fs::write(folder.path().join("path.toml"), file).expect("written");
    ok(folder.path(), &format!("{again} --test path.toml --out by-test"));
    for (other, why) in [
        (String::new(), "give the [test] that was run, with --test or --set"),
        (format!("{asked} --set test.repeat_every_s=1"), "set test.repeat_every_s as it was run"),
    ] {
        let told = transcript(folder.path(), &format!("{again} {other} --out refused"));
        assert!(told.contains(why) && told.ends_with("= 1"), "{told}");
    }
}

/// In open loop moves are commands: what is not commanded is null, wherever the drive stands.
#[test]
fn a_record_in_open_loop_gives_its_commands() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    for (moves, expected) in
        [("[[0.0,0]]", "[[0.0,0]]"), ("[[0.0,0],[0.13,300],[0.26,0]]", "[[0.13,300],[0.26,0]]")]
    {
        let asked = format!("--set controller.loop=open --set test.moves={moves} --set test.duration_s=0.39");
        ok(folder.path(), &format!("run servo-b-tuned {asked} --config --port {}", rig.port()));
        let printed = ok(folder.path(), &format!("record --port {}", rig.port()));
        let name = printed.split(':').next().expect("a file");
        ok(
            folder.path(),
            &format!("simulate servo-b-tuned --from {name} --ensemble 1 --no-report --out open"),
        );
        let found = &run_json(folder.path(), "open")["keys"]["test.moves"];
        assert_eq!(*found, serde_json::from_str::<Value>(expected).expect("JSON"), "{moves}");
    }
}

#[test]
fn a_run_goes_on_from_the_end_of_another() {
    let folder = folder();
    let held =
        "servo-b-tuned --set test.moves=[[0.0,8192]] --set test.duration_s=1 --set operator.dither_mm=0";
    ok(folder.path(), &format!("simulate {held} --ensemble 1 --no-report --out one"));
    let printed =
        ok(folder.path(), &format!("simulate {held} --from one --ensemble 1 --no-report --out two"));
    assert!(printed.contains("are those of the run of servo-b-tuned at its end, 0.9997 s"), "{printed}");
    // Position, pressures, temperatures.
    for place in [5, 8, 9, 10, 11] {
        let end = column(folder.path(), "one", place).last().copied().expect("rows");
        let begin = column(folder.path(), "two", place)[0];
        assert!((begin / end - 1.0).abs() < 1e-9, "column {place}: {begin} after {end}");
    }
    assert_ne!(
        column(folder.path(), "one", 8)[0],
        column(folder.path(), "two", 8)[0],
        "pressures had gone on"
    );
    let moving = "simulate servo-b-tuned --set test.duration_s=0.36 --ensemble 1 --no-report --out moving";
    ok(folder.path(), moving);
    let printed = transcript(folder.path(), "simulate servo-b-tuned --from moving --ensemble 1 --out on");
    assert!(
        printed.contains("moving cannot be used as a starting point: its drive still moves at"),
        "{printed}"
    );
}

#[test]
fn a_record_of_another_rig_and_what_is_no_transient_are_refused() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    ok(folder.path(), &format!("run servo-b-tuned --set test.duration_s=0.2 --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    let fine = "--set encoder.mm_per_count=0.01";
    let printed =
        transcript(folder.path(), &format!("simulate servo-b-tuned {fine} --from TARGET01.DAT --out x"));
    assert!(printed.contains("its encoder has 0.01205 mm per count, not 0.01"), "{printed}");
    fs::write(folder.path().join("page.html"), "<p>no").expect("written");
    let printed = transcript(folder.path(), "simulate servo-b-tuned --from page.html --out x");
    assert!(printed.ends_with("= 1"), "{printed}");
    assert!(!folder.path().join("x/trace.csv").exists());
}
