//! `pneudrive characterise`: what it leaves, and what it refuses.

use std::fs;

use pneudrive_thesis::characteristics::CURVES;

use crate::program::{exists, folder, ok, transcript};

/// Rows of a CSV file below its header: graph, curve, x, value.
fn rows(text: &str) -> Vec<Vec<String>> {
    let cells = |line: &str| {
        let mut quoted = false;
        let split = line.split(|c| {
            quoted ^= c == '"';
            c == ',' && !quoted
        });
        split.map(str::to_owned).collect()
    };
    text.lines().skip(1).map(cells).collect()
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn all_curves_of_a_servo_drive_are_drawn_and_stored() {
    let folder = folder();
    let parts = "--set valve.flow_force=analytical --set actuator.leakage=adiabatic --set valve.null_drift_mm_per_h=0.01";
    let printed = ok(folder.path(), &format!("characterise servo-b all {parts} --out char"));
    for curve in &CURVES {
        assert!(printed.contains(&format!("{}: {}", curve.name, curve.about)), "{printed}");
        let names = ["csv", "html"].map(|kind| format!("char/{}.{kind}", curve.name));
        exists(folder.path(), &[&names[0], &names[1]]);
        let csv = fs::read_to_string(folder.path().join(&names[0])).expect("written");
        assert!(csv.starts_with("graph,curve,"), "{csv}");
        let rows = rows(&csv);
        assert!(rows.len() > 50 && rows.iter().all(|row| row.len() == 4), "{}", curve.name);
        assert!(rows.iter().all(|row| row[2].parse::<f64>().is_ok() && row[3].parse::<f64>().is_ok()));
    }
}

#[test]
fn the_null_of_a_rig_is_the_one_that_it_was_given() {
    let folder = folder();
    let printed =
        ok(folder.path(), "characterise servo-b pressure-gain --set valve.null_offset_mm=0.037 --out .");
    let nulls: Vec<&str> = printed.lines().filter(|line| line.starts_with("null, ")).collect();
    assert_eq!(nulls.len(), 6, "its own supply pressure and those of the thesis: {printed}");
    for null in nulls {
        let millimetres: f64 =
            null.split_whitespace().nth_back(2).and_then(|word| word.parse().ok()).expect("a number");
        assert!((millimetres - 0.037).abs() < 3e-4, "{null}");
    }
}

#[test]
fn a_curve_that_a_rig_has_not_is_refused_and_left_out_of_all() {
    let folder = folder();
    for (arguments, says) in [
        ("servo-a dither", "servo-a has no dither: only a solenoid has a dither"),
        ("servo-a frequency-response", "servo-a has no frequency-response: its operator has no moving mass"),
        ("burrows pressure-drop", "burrows has no pressure-drop: it has no tubes"),
        ("servo-b leakage", "servo-b has no leakage: its piston does not leak"),
        ("servo-b flow-force", "servo-b has no flow-force: its flow does not push the spool"),
        (
            "servo-b drift",
            "servo-b has no drift: its null does not drift (valve.null_drift_mm_per_h = 0); give a drift",
        ),
        ("bang-bang hysteresis", "bang-bang has no hysteresis: an on-off operator has three places"),
    ] {
        let printed = transcript(folder.path(), &format!("characterise {arguments} --out out"));
        assert!(printed.contains(&format!("! error: {says}")) && printed.ends_with("= 1"), "{printed}");
    }
    let printed = ok(folder.path(), "characterise burrows all --out all");
    assert!(printed.contains("pressure-drop: skipped, as it has no tubes"), "{printed}");
    exists(folder.path(), &["all/flow-gain.csv", "all/valve-models.html"]);
    assert!(!folder.path().join("all/pressure-drop.csv").exists());
}

/// Its friction is the same at rest and in motion, so that it breaks away without a surplus of force.
#[test]
fn a_spool_without_stiction_of_its_own_is_measured_under_its_dither() {
    let folder = folder();
    let settings = "--set operator.coulomb_friction_n=3.35 --set operator.dither_mm=0.4";
    for curve in ["dither", "hysteresis"] {
        let printed = ok(folder.path(), &format!("characterise servo-b-thesis {curve} {settings} --out ."));
        assert!(printed.contains(&format!("./{curve}.csv")), "{printed}");
    }
}

#[test]
fn a_curve_that_there_is_not_is_wrong_use_and_a_file_of_the_users_stays() {
    let folder = folder();
    let printed = transcript(folder.path(), "characterise servo-b gain --out .");
    assert!(
        printed.contains("choose one of nominal-flow, flow-gain, pressure-gain,") && printed.ends_with("= 2"),
        "{printed}"
    );
    for mine in ["flow-gain.csv", "valve-models.html"] {
        fs::write(folder.path().join(mine), "mine").expect("written");
        let printed = transcript(folder.path(), "characterise servo-b all --out .");
        assert!(
            printed.contains(&format!("{mine} was not written by this program")) && printed.ends_with("= 1"),
            "{printed}"
        );
        assert_eq!(fs::read_to_string(folder.path().join(mine)).expect("there"), "mine");
        fs::remove_file(folder.path().join(mine)).expect("there");
    }
}

/// The value, its uncertainty and its unit in the row of a figure.
fn figure(printed: &str, name: &str) -> [String; 3] {
    let row =
        printed.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{name}: {printed}"));
    let cells: Vec<&str> = row[name.len()..].split_whitespace().collect();
    cells.try_into().map(|cells: [&str; 3]| cells.map(str::to_owned)).unwrap_or_else(|_| panic!("{row}"))
}

/// An oscillator of 100 Hz, damped by 0.4 of the critical, answers most at 82.5 Hz, by 2.69 dB; 3 dB down it is at 137.4 Hz.
#[test]
fn the_frequency_response_tells_resonance_bandwidth_and_quarter_turn_to_the_digits_that_are_known() {
    let folder = folder();
    let linear = "--set operator.model=\"solenoid-empirical\" --set operator.hysteresis_percent=0 \
        --set operator.stiffness_per_mass_per_s2=394784.176 --set operator.damping_per_s=502.6548";
    let printed = ok(folder.path(), &format!("characterise servo-b frequency-response {linear} --out ."));
    for (name, expected, unit) in [
        ("largest gain at 0.400 mm", 2.6945, "dB"),
        ("its frequency at 0.400 mm", 82.46, "Hz"),
        ("-3 dB of the gain at 2 Hz, at 0.400 mm", 137.4, "Hz"),
        ("-90 degrees at 0.400 mm", 100.0, "Hz"),
    ] {
        let [value, within, of] = figure(&printed, name);
        let decimals = |text: &str| text.split('.').nth(1).map_or(0, str::len);
        assert_eq!((of.as_str(), decimals(&value)), (unit, decimals(&within)), "{printed}");
        let [value, within]: [f64; 2] = [value, within].map(|text| text.parse().expect("a number"));
        assert!((value - expected).abs() <= within && within < 0.01 * expected.abs(), "{name}: {printed}");
    }
    let slow = linear.replace("394784.176", "20").replace("502.6548", "15");
    let printed = ok(folder.path(), &format!("characterise servo-b frequency-response {slow} --out ."));
    let outside = "-90 degrees at 0.400 mm                 not seen, frequency 2.00 to 300 Hz";
    assert!(printed.contains(outside), "{printed}");
}

#[test]
fn the_hysteresis_is_told_of_the_range_of_the_rig() {
    let folder = folder();
    let still = "--set operator.static_friction_n=0 --set operator.coulomb_friction_n=0";
    let printed = ok(
        folder.path(),
        &format!("characterise servo-b hysteresis {still} --set valve.spool_travel_mm=0.5 --out ."),
    );
    let [value, within, unit] = figure(&printed, "width at mid-travel, without dither, of the range of 1 mm");
    assert_eq!((value.as_str(), within.as_str(), unit.as_str()), ("5.00", "0.02", "%"), "{printed}");
}

/// A valve by its data sheet: C of 1.375 dm3/(s bar) and b of 0.3 make 349.6 l/min, linear over the command.
const DATA_SHEET: &str = "--set valve.model=iso-6358 --set valve.characteristic=linear --set valve.sonic_conductance_m3_per_s_pa=1.375e-8 --set valve.critical_ratio=0.3";

#[test]
fn the_flow_curve_of_a_data_sheet_is_reproduced_within_1_percent_and_laid_over_measured_points() {
    let folder = folder();
    let points = (-10..=10).map(|i| {
        let off = if i % 2 == 0 { 1.0 } else { -1.0 };
        format!("{},{},1.5\n", 10 * i, 34.96 * f64::from(i).abs() + off)
    });
    let table = format!("command_percent,flow_l_min,spread\n{}", points.collect::<String>());
    fs::write(folder.path().join("bench.csv"), table).expect("written");
    let printed = ok(
        folder.path(),
        &format!("characterise servo-b nominal-flow {DATA_SHEET} --points bench.csv --out ."),
    );
    let line =
        |name: &str| printed.lines().find(|line| line.contains(name)).unwrap_or_else(|| panic!("{printed}"));
    assert!(line("nominal flow Qn from the supply to port 1").contains("349.6"), "{printed}");
    assert!(line("conductance C from the supply to port 2").contains("1.375"), "{printed}");
    assert!(line("largest, at command").contains("0.29 % of the largest"), "{printed}");
    assert!(line("points within two").contains("21 of 21"), "{printed}");
    let csv = fs::read_to_string(folder.path().join("nominal-flow.csv")).expect("written");
    assert!(csv.starts_with("graph,curve,command_percent,value\nflow_l_min,the open path,-100"), "{csv}");
}

#[test]
fn points_of_another_test_are_refused_with_the_columns_that_are_needed() {
    let folder = folder();
    fs::write(folder.path().join("bench.csv"), "spool,flow\n1,2\n").expect("written");
    let printed = transcript(
        folder.path(),
        &format!("characterise servo-b nominal-flow {DATA_SHEET} --points bench.csv --out ."),
    );
    assert!(printed.contains("command_percent, flow_l_min"), "{printed}");
}

/// A drive by its data sheets, held by its friction and by air, the load above and below.
#[test]
fn each_curve_of_a_drive_of_ones_own_is_measured_level_inclined_and_vertical() {
    let folder = folder();
    let drive =
        "--cylinder iso-15552-32 --stroke 250mm --mass 8kg --valve proportional-5-3-350 --no-questions";
    for incline in ["0", "30", "90", "-90"] {
        let rig = format!("at{incline}.toml");
        ok(folder.path(), &format!("rig new {rig} {drive} --incline {incline}deg"));
        let printed = ok(folder.path(), &format!("characterise {rig} all --out at{incline}"));
        let skipped: Vec<&str> = printed.lines().filter(|line| line.contains(": skipped, as ")).collect();
        let has_not = ["pressure-drop", "flow-force", "leakage", "drift", "land-area", "valve-models"];
        assert!(skipped.iter().all(|line| has_not.iter().any(|name| line.starts_with(name))), "{skipped:?}");
        let figure = |name: &str| -> f64 { figure(&printed, name)[0].parse().expect("a number") };
        for way in ["extending", "retracting"] {
            let friction = figure(&format!("static friction, {way}"));
            assert!((friction / 49.0 - 1.0).abs() < 0.05, "{incline} degrees, {way}: {friction} N");
        }
    }
}
