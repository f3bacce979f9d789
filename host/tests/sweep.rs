//! `pneudrive sweep` and `merge`: the same result in every bit however it was run, and nothing lost.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::program::{exists, folder, ok, transcript};

/// Eight short runs, one of which cannot be and one of which trips.
const SWEEP: &str = r#"
rig = "servo-b-tuned"
[set]
test.moves = [[0.0, 10000]]
test.duration_s = 0.1
[vary]
load.coulomb_extend_n = [40.0, 75.0]        # 75 N is more than the static friction
supply.pressure_pa = { uniform = [4e5, 6e5] }
[draw]
count = 4
[metrics]
speed = "top_speed_mm_s"
air = { figure = "air_l", move = 1 }
[objective]
maximise = "speed"
"#;

fn written(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn folder_with(sweep: &str) -> tempfile::TempDir {
    let folder = folder();
    fs::write(folder.path().join("s.toml"), sweep).expect("written");
    folder
}

#[test]
fn the_result_is_the_same_in_every_bit_with_one_thread_with_two_and_in_shards() {
    let folder = folder_with(SWEEP);
    let printed = ok(folder.path(), "sweep s.toml --threads 1");
    assert!(
        printed.contains("8 points, 4 failed.") && printed.contains("the best point (most speed)"),
        "{printed}"
    );
    exists(folder.path(), &["s/sweep.csv", "s/sweep.html", "s/sweep.journal"]);
    ok(folder.path(), "sweep s.toml --threads 2 --out two");
    for shard in 1..=3 {
        let printed = ok(folder.path(), &format!("sweep s.toml --shard {shard}/3 --out shard{shard}"));
        assert!(printed.contains("of 8 points; pneudrive merge joins the shards"), "{printed}");
        assert!(!folder.path().join(format!("shard{shard}/sweep.csv")).exists());
    }
    ok(folder.path(), "merge shard3 shard1 shard2 --out merged");
    for other in ["two", "merged"] {
        for file in ["sweep.csv", "sweep.html"] {
            let same = written(folder.path(), &format!("s/{file}"))
                == written(folder.path(), &format!("{other}/{file}"));
            assert!(same, "{other}/{file}");
        }
    }
}

#[test]
fn a_point_that_fails_stands_in_the_result_with_its_reason_and_the_others_go_on() {
    let folder = folder_with(SWEEP);
    ok(folder.path(), "sweep s.toml");
    let csv = written(folder.path(), "s/sweep.csv");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "point,load.coulomb_extend_n,supply.pressure_pa,speed,air,fault,failure");
    assert_eq!(lines.len(), 9);
    for (point, line) in lines[1..].iter().enumerate() {
        assert!(line.starts_with(&format!("{point},")), "{line}");
        let cells: Vec<&str> = line.splitn(7, ',').collect();
        assert_eq!(cells[3].parse::<f64>().is_ok(), point < 4, "{line}");
        assert_eq!(cells[6].contains("load.coulomb_extend_n"), point >= 4, "{line}");
    }
    let alone = SWEEP.replace("[40.0, 75.0]", "[75.0]");
    fs::write(folder.path().join("s.toml"), alone).expect("written");
    let printed = transcript(folder.path(), "sweep s.toml --out alone");
    assert!(
        printed.contains("! error: every point failed; the first: ") && printed.ends_with("= 1"),
        "{printed}"
    );
}

/// Two rigs of their own, no draws.
const GRID: &str = r#"
rig = "servo-b-tuned"
[set]
test.duration_s = 0.6
[vary]
load.mass_kg = [10.0, 20.0]
[metrics]
end = { figure = "end_mm", move = 2 }
"#;

#[test]
fn the_points_of_a_grid_tell_whether_they_are_converged_and_have_perturbed_runs_on_request() {
    let folder = folder_with(GRID);
    ok(folder.path(), "sweep s.toml");
    let alone = written(folder.path(), "s/sweep.csv");
    assert!(alone.starts_with("point,load.mass_kg,end,converged,fault,failure\n"), "{alone}");
    let converged = alone.lines().skip(1).map(|line| line.split(',').nth(3).expect("a cell"));
    assert!(converged.clone().all(|cell| ["yes", "no"].contains(&cell)) && converged.count() == 2, "{alone}");
    let refused = transcript(folder.path(), "sweep s.toml --ensemble 3");
    assert!(refused.contains("belongs to another sweep") && refused.ends_with("= 1"), "{refused}");
    for shard in 1..=2 {
        let shard = format!("sweep s.toml --ensemble 3 --shard {shard}/2 --out shard{shard}");
        ok(folder.path(), &shard);
    }
    ok(folder.path(), "merge shard1 shard2 --out merged");
    let ranges = written(folder.path(), "merged/sweep.csv");
    assert!(ranges.starts_with("point,load.mass_kg,end,end_least,end_most,converged,"), "{ranges}");
    for (one, other) in ranges.lines().zip(alone.lines()).skip(1) {
        let [ranged, alone] = [one, other].map(|line| line.split(',').collect::<Vec<_>>());
        assert_eq!(ranged[..3], alone[..3], "the nominal run is the same");
        let [end, least, most] = [2, 3, 4].map(|cell| ranged[cell].parse::<f64>().expect("mm"));
        assert!(least <= end && end <= most && least < most, "{one}");
    }
    let twice = GRID.replace("end = {", "end_least = \"end_mm\"\nend = {");
    fs::write(folder.path().join("s.toml"), twice).expect("written");
    let refused = transcript(folder.path(), "sweep s.toml --ensemble 3 --out twice");
    assert!(refused.contains("two columns end_least") && refused.ends_with("= 1"), "{refused}");
    fs::write(folder.path().join("s.toml"), format!("ensemble = 8\n{SWEEP}")).expect("written");
    let refused = transcript(folder.path(), "sweep s.toml --out drawn");
    assert!(refused.contains("draws are already an ensemble"), "{refused}");
}

#[test]
fn a_run_that_trips_is_told_by_its_fault_and_is_not_the_best() {
    let text = SWEEP.replace("[40.0, 75.0]", "[40.0]").replace(
        "test.duration_s = 0.1",
        "test.duration_s = 0.1\nfaults.event = [{ at_s = 0.05, kind = \"encoder-jump\", counts = 4000 }]",
    );
    let folder = folder_with(&text);
    let printed = ok(folder.path(), "sweep s.toml");
    assert!(
        printed.contains("4 points, 4 ended by a fault.") && printed.contains("no allowed point has a value"),
        "{printed}"
    );
    let csv = written(folder.path(), "s/sweep.csv");
    assert!(csv.lines().skip(1).all(|line| line.ends_with(",encoder-step,")), "{csv}");
}

#[test]
fn a_journal_that_was_cut_at_any_byte_is_gone_on_with_to_the_same_result() {
    let folder = folder_with(SWEEP);
    ok(folder.path(), "sweep s.toml");
    let (whole, journal) = (written(folder.path(), "s/sweep.csv"), written(folder.path(), "s/sweep.journal"));
    let places = (0..journal.len()).step_by(journal.len() / 7).chain([5, journal.len() - 1]);
    for place in places {
        fs::remove_file(folder.path().join("s/sweep.csv")).expect("there");
        fs::write(folder.path().join("s/sweep.journal"), &journal.as_bytes()[..place]).expect("written");
        let printed = ok(folder.path(), "sweep s.toml --threads 1");
        assert_eq!(written(folder.path(), "s/sweep.csv"), whole, "cut at {place}");
        // No point whose line was whole is run again; a line may lack its end alone.
        let there = printed
            .split_once(" points are already")
            .map_or("0", |(front, _)| front.rsplit(' ').next().unwrap_or("0"));
        let there: usize = there.parse().expect("a number");
        let kept = rows(&journal[..place]);
        assert!(
            there == kept || there == rows(&format!("{}\n", &journal[..place])),
            "cut at {place}: {printed}"
        );
    }
}

/// Rows that stand whole in a journal.
fn rows(journal: &str) -> usize {
    let whole = journal.rfind('\n').map_or("", |end| &journal[..end]);
    let texts = whole.lines().filter_map(|line| line.split_once(' '));
    texts.filter(|(_, text)| text.contains(',') && !text.starts_with('{')).count()
}

/// The program itself, by the signal that nothing can catch.
#[test]
fn a_sweep_that_is_killed_goes_on_where_it_was() {
    let folder = folder_with(&SWEEP.replace("count = 4", "count = 20").replace("0.1\n", "0.3\n"));
    let journal = folder.path().join("s/sweep.journal");
    let mut program = Command::new(env!("CARGO_BIN_EXE_pneudrive"))
        .current_dir(folder.path())
        .args(["sweep", "s.toml", "--threads", "1"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs");
    while fs::read_to_string(&journal).map_or(0, |text| text.lines().count()) < 5 {
        std::thread::sleep(Duration::from_millis(1));
    }
    let _ = program.kill();
    program.wait().expect("it was started");
    let printed = ok(folder.path(), "sweep s.toml");
    ok(folder.path(), "sweep s.toml --out whole");
    assert!(printed.contains("points are already done"), "{printed}");
    assert_eq!(written(folder.path(), "s/sweep.csv"), written(folder.path(), "whole/sweep.csv"));
}

#[test]
fn a_journal_of_another_sweep_and_files_of_the_users_are_refused_and_stay() {
    let folder = folder_with(SWEEP);
    ok(folder.path(), "sweep s.toml --out out");
    let before = written(folder.path(), "out/sweep.journal");
    fs::write(folder.path().join("s.toml"), SWEEP.replace("[4e5, 6e5]", "[4e5, 5e5]")).expect("written");
    let printed = transcript(folder.path(), "sweep s.toml --out out");
    assert!(
        printed.contains("sweep.journal belongs to another sweep (s.toml); delete it")
            && printed.ends_with("= 1"),
        "{printed}"
    );
    assert_eq!(written(folder.path(), "out/sweep.journal"), before);
    for mine in ["sweep.csv", "sweep.html", "sweep.journal"] {
        let place = format!("mine-{mine}");
        fs::create_dir(folder.path().join(&place)).expect("made");
        fs::write(folder.path().join(&place).join(mine), "mine").expect("written");
        let printed = transcript(folder.path(), &format!("sweep s.toml --out {place}"));
        assert!(
            printed.contains(&format!("{mine} was not written by this program")) && printed.ends_with("= 1"),
            "{printed}"
        );
        assert_eq!(written(folder.path(), &format!("{place}/{mine}")), "mine");
    }
}

#[test]
fn another_goal_needs_no_run_again() {
    let folder = folder_with(SWEEP);
    ok(folder.path(), "sweep s.toml");
    let rows_before = rows(&written(folder.path(), "s/sweep.journal"));
    fs::write(folder.path().join("s.toml"), SWEEP.replace("maximise", "minimise")).expect("written");
    let printed = ok(folder.path(), "sweep s.toml");
    assert!(printed.contains("8 points are already done") && printed.contains("(least speed)"), "{printed}");
    assert_eq!(rows(&written(folder.path(), "s/sweep.journal")), rows_before);
}

#[test]
fn shards_with_gaps_or_of_other_sweeps_are_not_merged() {
    let folder = folder_with(SWEEP);
    ok(folder.path(), "sweep s.toml --shard 1/2 --out one");
    let printed = transcript(folder.path(), "merge one --out all");
    assert!(
        printed.contains("4 of 8 points are missing (1, 3, 5 and 1 more); run their shards"),
        "{printed}"
    );
    fs::write(folder.path().join("s.toml"), SWEEP.replace("count = 4", "count = 5")).expect("written");
    ok(folder.path(), "sweep s.toml --shard 2/2 --out two");
    let printed = transcript(folder.path(), "merge one two --out all");
    assert!(
        printed.contains("two belongs to another sweep (s.toml)") && printed.ends_with("= 1"),
        "{printed}"
    );
    assert!(!folder.path().join("all").exists());
    assert!(transcript(folder.path(), "merge nothing --out all").ends_with("= 3"));
    for shard in ["0/2", "3/2", "1", "a/b"] {
        let printed = transcript(folder.path(), &format!("sweep s.toml --shard {shard}"));
        assert!(printed.contains("write I/N with I from 1 to N") && printed.ends_with("= 2"), "{printed}");
    }
}

#[test]
fn a_sweep_says_how_large_it_is_before_it_begins_and_how_long_it_will_take() {
    let folder = folder_with(&SWEEP.replace("[40.0, 75.0]", "[40.0, 41.0]"));
    let printed = transcript(folder.path(), "sweep s.toml --threads 2");
    let lines: Vec<&str> = printed.lines().filter(|line| line.starts_with("! sweeping")).collect();
    assert_eq!(lines[0], "! sweeping: 2 combinations x 4 draws = 8 points, on 2 threads");
    assert!(lines[1].ends_with("for the other 6, estimated from the first 2"), "{printed}");
    assert!(printed.ends_with("= 0"), "{printed}");
    let printed = transcript(folder.path(), "sweep s.toml --threads 2");
    assert!(printed.contains("= 8 points, 0 of them still to be run, on 2 threads\n"), "{printed}");
    fs::write(folder.path().join("s.toml"), GRID).expect("written");
    let printed = transcript(folder.path(), "sweep s.toml --threads 2 --ensemble 3 --out grid");
    assert!(printed.contains("! sweeping: 2 points x 3 runs, on 2 threads\n"), "{printed}");
}

/// Nobody is at a terminal: what was run goes on with --yes.
#[test]
fn a_sweep_of_hours_is_not_begun_unasked() {
    let many = "test.duration_s = 2.0\n[vary]\n\
        load.mass_kg = { from = 1.0, to = 2.0, steps = 1000 }\n\
        supply.pressure_pa = { from = 4e5, to = 6e5, steps = 1000 }\n[metrics]";
    let text = GRID.replace("test.duration_s = 0.6\n[vary]\nload.mass_kg = [10.0, 20.0]\n[metrics]", many);
    let folder = folder_with(&text);
    let printed = transcript(folder.path(), "sweep s.toml --threads 1");
    assert!(printed.contains("! sweeping: 1000000 points, on 1 threads\n"), "{printed}");
    let refused = "! error: the sweep would take about ";
    assert!(printed.contains(refused) && printed.ends_with("; add --yes to run it\n= 2"), "{printed}");
    let journal = written(folder.path(), "s/sweep.journal");
    assert_eq!(journal.lines().count(), 3, "what was run stays: {journal}");
    assert!(!folder.path().join("s/sweep.csv").exists());
}

/// Once a pipe in the place of the journal was waited at for ever.
#[cfg(unix)]
#[test]
fn a_journal_that_is_no_plain_file_is_refused() {
    let folder = folder_with(SWEEP);
    fs::create_dir(folder.path().join("s")).expect("a folder");
    let pipe = folder.path().join("s/sweep.journal");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let printed = transcript(folder.path(), "sweep s.toml");
    assert!(printed.contains("sweep.journal: it is not a regular file, but a link, a pipe"), "{printed}");
}

#[test]
fn the_example_runs_and_has_a_best_point() {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/examples/sweep-load.toml");
    let text = fs::read_to_string(example).expect("the example");
    // One draw instead of eight: the rest is the same.
    let folder = folder_with(&text.replace("count = 8", "count = 1"));
    let printed = ok(folder.path(), "sweep s.toml");
    assert!(text.contains("count = 8") && printed.contains("3 points, "), "{printed}");
    assert!(
        printed.contains("the best point (least settling_s)") && printed.contains("velocity_gain"),
        "{printed}"
    );
    assert!(!printed.contains("failed") && !printed.contains("fault"), "{printed}");
}

/// A run that ends while the drive still moves shows no overshoot, no settling and no limit cycle: none of them may
/// be taken for 0.
#[test]
fn what_a_move_does_not_show_is_an_empty_cell_and_keeps_no_constraint() {
    let text = r#"
rig = "servo-b-tuned"
[set]
test.moves = [[0.0, 8192], [0.3, 13171]]
[vary]
test.duration_s = [0.42, 6.3]
[metrics]
limit_cycle_mm = { figure = "limit_cycle_mm", move = 2 }
limit_cycle_hz = { figure = "limit_cycle_hz", move = 2 }
limit_cycle_swing_mm = { figure = "limit_cycle_swing_mm", move = 2 }
overshoot_mm = { figure = "overshoot_mm", move = 2 }
settling_s = { figure = "settling_s", move = 2 }
steady_error_mm = { figure = "steady_error_mm", move = 2 }
[constraints]
limit_cycle_mm = { max = 0.0 }
"#;
    let folder = folder_with(text);
    let printed = ok(folder.path(), "sweep s.toml");
    assert!(printed.contains("2 points, 1 allowed."), "{printed}");
    let csv = written(folder.path(), "s/sweep.csv");
    let [cut, whole] = [1, 2].map(|line| csv.lines().nth(line).expect("a point"));
    assert_eq!(cut, "0,0.42,,,,,,,yes,,", "{csv}");
    assert!(whole.starts_with("1,6.3,0.0,0.0,0.0,"), "{csv}");
}
