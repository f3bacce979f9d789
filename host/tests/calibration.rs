//! Errors of scales, offsets and clock, which nobody tells a fit: its intervals hold what is true, or it names the error.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::hidden_rigs::rigs::EXACT;
use crate::program::{folder, recorded_with, transcript};

/// One stroke each way; the rig is as its file says, but for an error of its calibration.
const STROKES: &str = "\
controller.loop = \"open\"
operator.dither_mm = 0.0
sensors.noise_counts = 1
test.moves = [[0.0, 0], [0.066, 900], [0.19, -1100], [0.35, 0]]
test.position_m = 0.1
test.duration_s = 0.45
";

/// The errors, each larger than the tolerance that a file without a word on it has.
const ERRORS: [&[(&str, f64)]; 3] = [
    &[("encoder.scale_error_percent", 0.5)],
    &[("sensors.pressure_1_gain_error_percent", 2.0), ("sensors.pressure_2_gain_error_percent", 2.0)],
    &[("controller.clock_error_percent", 1.0)],
];

/// What the terminal and identification.json say of a fit of everything, by a file with these tolerances.
fn identified(folder: &Path, tolerances: &str, errors: &[(&'static str, f64)]) -> (String, Value) {
    recorded_with(folder, &format!("{STROKES}{tolerances}"), errors);
    let printed = transcript(folder, "identify rig.toml TARGET01.DAT");
    let json = fs::read_to_string(folder.join("identified/identification.json")).expect("there");
    (printed, serde_json::from_str(&json).expect("JSON"))
}

/// How far each parameter is off the truth, which is the file's value, in standard errors, and whether its interval holds
/// that.
fn misses(json: &Value) -> Vec<(f64, bool)> {
    let number = |value: &Value| value.as_f64().expect("a number");
    let miss = |told: &Value| {
        let truth = number(&told["file"]);
        let off = (number(&told["estimate"]) - truth) / number(&told["standard_error"]);
        let [low, high] = [0, 1].map(|end| number(&told["interval"][end]));
        (off.abs(), low <= truth && truth <= high)
    };
    json["parameters"].as_array().expect("a list").iter().map(miss).collect()
}

#[test]
fn intervals_hold_although_encoder_pressures_or_clock_are_off() {
    for errors in ERRORS {
        let folder = folder();
        let (printed, json) = identified(folder.path(), "", errors);
        assert!(printed.ends_with("= 0"), "{errors:?}: {printed}");
        let misses = misses(&json);
        assert!(misses.len() > 12 && misses.iter().all(|(_, held)| *held), "{errors:?}: {misses:?}");
    }
}

/// What all fits did before: exit code 0, and intervals that miss by far.
#[test]
fn a_file_that_calls_its_calibration_exact_is_believed() {
    for errors in ERRORS {
        let folder = folder();
        let (printed, json) = identified(folder.path(), EXACT, errors);
        assert!(printed.ends_with("= 0"), "{errors:?}: {printed}");
        assert!(misses(&json).iter().any(|(off, held)| *off > 8.0 && !held), "{errors:?}: {printed}");
        assert_eq!(json["calibration"], serde_json::json!([]), "{errors:?}");
    }
}

#[test]
fn an_error_far_beyond_its_tolerance_is_named_as_the_cause_of_the_misfit() {
    let folder = folder();
    let tolerances = format!(
        "{}sensors.pressure_gain_tolerance_percent = 0.2\n",
        EXACT.replace("sensors.pressure_gain_tolerance_percent = 0\n", "")
    );
    let key = "sensors.pressure_2_gain_error_percent";
    let (printed, json) = identified(folder.path(), &tolerances, &[(key, 2.0)]);
    assert!(printed.ends_with("= 7") && printed.contains("Beyond 3 tolerances"), "{printed}");
    assert!(printed.contains("another scale of pressure sensor 2"), "{printed}");
    let causes = json["causes"].as_array().expect("a list");
    let named = causes.iter().find(|cause| cause["settings"].as_str().is_some_and(|s| s.starts_with(key)));
    let named = named.unwrap_or_else(|| panic!("{causes:?}"));
    assert_eq!((&named["significant"], &named["leaves_noise"]), (&true.into(), &true.into()), "{named}");
    let number = |name: &str| named[name].as_f64().expect("a number");
    assert!((number("value") - 2.0).abs() < 3.0 * number("standard_error"), "{named}");
}
