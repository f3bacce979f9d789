//! The distance from its setpoint within which a move has settled: one key of the rig, for every figure.

use std::fs;

use crate::program::{folder, ok, transcript};

/// A drive that rests two tenths of a millimetre from its setpoint, and a sweep of it.
const RIG: &str = "[test]\ntolerance_mm = 3\nmoves = [[0.0, 8192], [0.05, 13171]]\nduration_s = 0.9\n";
const SWEEP: &str =
    "rig = \"d.toml\"\n[vary]\nload.mass_kg = [6.0]\n[metrics]\nsettling_s = \"settling_s\"\n";

fn with_rig() -> tempfile::TempDir {
    let folder = folder();
    let own = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let (head, _) = own.split_once("[test]").expect("a test");
    fs::write(folder.path().join("d.toml"), format!("{head}{RIG}")).expect("written");
    fs::write(folder.path().join("s.toml"), SWEEP).expect("written");
    folder
}

#[test]
fn figures_of_a_run_are_within_the_tolerance_of_its_rig_file_unless_another_is_asked_for() {
    let folder = with_rig();
    let within = |arguments: &str, mm: &str| {
        let printed = ok(folder.path(), arguments);
        assert!(printed.contains(&format!("settled: within {mm} mm")), "{arguments}: {printed}");
    };
    within("simulate d.toml --ensemble 1 --out run", "3");
    within("eval run --out e.html", "3");
    within("eval run --tolerance-mm 0.5 --out e.html", "0.5");
    within("simulate d.toml --ensemble 1 --tolerance-mm 7 --out run", "7");
    within("eval run --out e.html", "7");
    within("simulate servo-b-tuned --ensemble 1 --set test.duration_s=0.1 --out usual", "0.05");
    let range = "must be between 0.0001 mm and 1000 mm";
    for (wrong, why) in [("0", range), ("1001", range), ("-3", range), ("NaN", "must be a number in mm")] {
        let printed = transcript(folder.path(), &format!("simulate d.toml --tolerance-mm={wrong} --out bad"));
        assert!(printed.contains(&format!("test.tolerance_mm: {why}")), "{wrong}: {printed}");
        assert!(!folder.path().join("bad").join("run.json").exists(), "{wrong}");
    }
}

#[test]
fn a_tuning_asks_for_the_tolerance_of_its_rig_file_and_leaves_the_one_that_was_asked_for() {
    let folder = with_rig();
    let tuned = |more: &str| {
        ok(folder.path(), &format!("tune d.toml --generations 0 --draws 1 --time 0.3 {more} --out t"));
        ["tune.html", "tuned.toml"]
            .map(|name| fs::read_to_string(folder.path().join("t").join(name)).expect("there"))
    };
    let [page, rig] = tuned("");
    assert!(page.contains("settled within 3 mm") && rig.contains("tolerance_mm = 3\n"), "{rig}");
    let [page, rig] = tuned("--tolerance-mm 0.7");
    assert!(page.contains("settled within 0.7 mm"));
    assert!(rig.contains("tolerance_mm = 0.7"), "{rig}");
    let [page, _] = tuned("--settled 0.6");
    assert!(page.contains("settled within 0.6 mm"), "the older word of the option");
}

#[test]
fn a_sweep_takes_the_tolerance_of_its_rig_file_or_its_own() {
    let folder = with_rig();
    let settles = |text: &str| {
        fs::write(folder.path().join("s.toml"), text).expect("written");
        ok(folder.path(), "sweep s.toml --out s");
        let rows = fs::read_to_string(folder.path().join("s/sweep.csv")).expect("there");
        fs::remove_dir_all(folder.path().join("s")).expect("there");
        let cell = rows.lines().nth(1).and_then(|row| row.split(',').nth(2)).expect("a figure").to_owned();
        cell.parse::<f64>().ok()
    };
    let wide = settles(SWEEP).expect("it settles within 3 mm");
    let own = settles(&format!("settled_mm = 10\n{SWEEP}")).expect("it settles within 10 mm");
    let narrow = settles(&format!("settled_mm = 0.001\n{SWEEP}"));
    assert!(own < wide && narrow.is_none(), "{own} {wide} {narrow:?}");
    let both = SWEEP.replace("[vary]", "[set]\ntest.tolerance_mm = 2\n[vary]");
    fs::write(folder.path().join("s.toml"), format!("settled_mm = 1\n{both}")).expect("written");
    let printed = transcript(folder.path(), "sweep s.toml --out s");
    assert!(printed.contains("settled_mm: is also in [set], as test.tolerance_mm"), "{printed}");
}
