//! `pneudrive rig show`, `diff` and values with units, as at the terminal.

use std::fs;
use std::process::{Command, Output};

use pneudrive_sim::Rig;
use pneudrive_sim::rig::{Source, all_keys};

fn pneudrive(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pneudrive")).args(arguments).output().expect("pneudrive")
}

fn printed(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

const OWN: &str = "[supply]\npressure = \"6 bar(g)\"\n\n[actuator]\nbore = { given = \"32 mm\", from = \"data sheet\" }\nrod_diameter = \"12 mm\"\n\n[load]\nmass = { typical = \"8 kg\", low = 6, high = 10, from = \"weighed once\" }\n";

#[test]
fn a_resolved_rig_is_in_si_and_says_where_values_come_from() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("own.toml");
    fs::write(&file, OWN).expect("a file");
    let shown = pneudrive(&["rig", "show", &file.to_string_lossy(), "--resolved"]);
    assert!(shown.status.success());
    let text = printed(&shown);
    for expected in [
        "pressure_pa = 701300.0                       # given\n",
        "bore_m = 0.032                               # given: data sheet\n",
        "mass_kg = 8.0                                # typical, 6 to 10 kg: weighed once\n",
        "viscous_n_s_per_m = 30.0                     # default\n",
    ] {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let resolved = folder.path().join("resolved.toml");
    fs::write(&resolved, &text).expect("a file");
    let difference = pneudrive(&["rig", "diff", &file.to_string_lossy(), &resolved.to_string_lossy()]);
    assert!(difference.status.success());
    assert_eq!(printed(&difference), "", "the resolved file is the same rig");
}

#[test]
fn json_of_a_rig_is_read_by_key() {
    let shown = pneudrive(&["rig", "show", "servo-b", "--json", "--set", "load.mass=\"2 kg\""]);
    let json: serde_json::Value = serde_json::from_str(&printed(&shown)).expect("JSON");
    let mass = &json["result"]["keys"]["load.mass_kg"];
    assert_eq!(mass["value"], 2.0);
    assert_eq!(mass["unit"], "kg");
    assert_eq!(mass["origin"], "given");
}

/// Once such a rig was called valid, and its run ended after minutes of steps.
#[test]
fn a_rig_whose_test_cannot_be_simulated_is_refused_by_the_key_that_causes_it() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../sim/tests/extreme/too_stiff.toml");
    let checked = pneudrive(&["rig", "check", file]);
    assert_eq!(checked.status.code(), Some(1), "{}", printed(&checked));
    let told = String::from_utf8_lossy(&checked.stderr);
    assert!(told.contains("too_stiff.toml: the test of x176 cannot be simulated"), "{told}");
    assert!(told.contains("actuator.residual_volume_2_m3"), "{told}");
    assert!(!printed(&checked).contains("a valid rig"), "{}", printed(&checked));
    let looked = pneudrive(&["rig", "check", "--quick", file]);
    assert!(looked.status.success(), "its values alone are in order");
}

/// Without a spring a single-acting cylinder is a valid rig: a program beside it may move the load.
#[test]
fn a_piston_that_nothing_brings_back_is_remarked() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("single.toml");
    let told = |spring: &str| {
        fs::write(&file, format!("[actuator]\nvented = \"chamber-2\"\n{spring}")).expect("written");
        printed(&pneudrive(&["rig", "check", "--quick", &file.to_string_lossy()]))
    };
    let alone = told("");
    assert!(
        alone.contains("the least force that pushes it back is 0 N") && alone.contains("a valid rig"),
        "{alone}"
    );
    let with = told("return_spring = \"retract\"\n");
    assert!(!with.contains("come back") && with.contains("a valid rig"), "{with}");
}

#[test]
fn a_move_that_ends_in_a_cushion_is_remarked() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("cushioned.toml");
    let told = |mm: f64| {
        let text = format!("[actuator]\ncushion = \"adjustable\"\n[test]\nmoves_mm = [[0.0, {mm:?}]]\n");
        fs::write(&file, text).expect("written");
        printed(&pneudrive(&["rig", "check", "--quick", &file.to_string_lossy()]))
    };
    let inside = told(290.0);
    assert!(
        inside.contains("289.995 mm ends in an end cushion") && inside.contains("a valid rig"),
        "{inside}"
    );
    assert!(inside.contains("from 20.000 to 280.000 mm"), "{inside}");
    let in_front = told(270.0);
    assert!(!in_front.contains("cushion, ") && in_front.contains("a valid rig"), "{in_front}");
}

#[test]
fn two_rigs_differ_key_by_key() {
    let text = printed(&pneudrive(&["rig", "diff", "servo-b", "servo-b-tuned"]));
    assert!(text.contains("controller.velocity_gain "), "{text}");
    assert!(text.lines().all(|line| line.contains(" -> ")), "{text}");
}

#[test]
fn a_drive_of_ones_own_is_made_simulated_and_explained() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("press.toml");
    let name = file.to_string_lossy();
    let made = pneudrive(&[
        "rig",
        "new",
        &name,
        "--cylinder",
        "iso-15552-32",
        "--stroke",
        "250 mm",
        "--valve",
        "proportional-5-3-350",
        "--mass",
        "8 kg",
        "--no-questions",
    ]);
    assert!(made.status.success(), "{made:?}");
    assert!(printed(&made).contains("press.toml: a rig of "), "{}", printed(&made));
    assert!(printed(&pneudrive(&["rig", "check", &name])).contains("a valid rig (press)"));
    let sim = folder.path().join("sim");
    let run = pneudrive(&["simulate", &name, "--out", &sim.to_string_lossy(), "--ensemble", "1"]);
    assert!(run.status.success(), "{run:?}");
    let again = pneudrive(&["rig", "new", &name, "--no-questions"]);
    assert!(!again.status.success(), "what is there is not written over");
}

#[test]
fn what_a_data_sheet_cannot_mean_is_named_with_its_option() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("own.toml");
    let refused = pneudrive(&[
        "rig",
        "new",
        &file.to_string_lossy(),
        "--bore",
        "12 mm",
        "--rod",
        "32 mm",
        "--stroke",
        "250 mm",
        "--mass",
        "8 kg",
        "--flow",
        "350",
        "--supply",
        "6 bar",
        "--no-questions",
    ]);
    assert_eq!(refused.status.code(), Some(1));
    let message = String::from_utf8_lossy(&refused.stderr);
    for expected in
        ["--rod: the rod of 32 mm", "--flow: needs a unit", "--supply: \"6 bar\" may be gauge or absolute"]
    {
        assert!(message.contains(expected), "{message}");
    }
    assert!(!file.exists());
}

#[test]
fn a_line_of_the_catalogue_tells_each_figure_once() {
    let listed = printed(&pneudrive(&["rig", "parts"]));
    let line = |name: &str| {
        let found = listed.lines().find(|line| line.split_whitespace().nth(1) == Some(name));
        found.unwrap_or_else(|| panic!("{name}: {listed}")).trim_end()
    };
    assert_eq!(line("proportional-5-3-350").matches("350 l/min").count(), 1);
    assert!(line("ckd-4ga1-5-3").ends_with("; nominal flow 229 l/min, sonic conductance 0.94 dm3/(s bar)"));
    assert!(line("pressure-transmitter-10-bar").ends_with("; range 0 bar(g) to 10 bar(g)"));
    assert!(!listed.lines().any(|line| line.trim_end().ends_with(';')), "{listed}");
}

#[test]
fn the_catalogue_tells_its_sources() {
    let all = printed(&pneudrive(&["rig", "parts"]));
    assert!(all.contains("iso-15552-32") && all.contains("proportional-5-3-350"), "{all}");
    let one = printed(&pneudrive(&["rig", "parts", "iso-15552-32"]));
    assert!(one.contains("rod") && one.contains("12 mm") && one.contains("(vendor)"), "{one}");
}

/// From an empty folder to a tuned step and a report, a command each.
#[test]
fn a_machine_builder_comes_from_data_sheets_to_a_tuned_step_and_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let run = |arguments: &[&str]| {
        let output = pneudrive(arguments);
        assert!(output.status.success(), "{arguments:?}: {output:?}");
        printed(&output)
    };
    let (file, folder_of_gains, tuned) = (at("press.toml"), at("tuned"), at("tuned/tuned.toml"));
    let catalogue = ["--cylinder", "iso-15552-32", "--stroke", "250 mm", "--valve", "proportional-5-3-350"];
    let law = ["--law", "gain-profile"];
    let new = [&["rig", "new", &file, "--mass", "8 kg", "--no-questions"][..], &catalogue, &law].concat();
    assert!(run(&new).contains(&format!("pneudrive tune {file}")), "it says what comes next");
    let rig = Rig::read("press", &std::fs::read_to_string(&file).expect("written")).expect("valid");
    let own = all_keys().filter(|key| rig.is_set(key)).count();
    assert!(own > 35, "{own}");
    for key in all_keys().filter(|key| rig.is_set(key)) {
        assert_ne!(rig.origin(key).source, Source::Default, "{}", key.path);
    }
    let search =
        ["--settled", "1", "--population", "6", "--generations", "4", "--draws", "10", "--seed", "2"];
    let told = run(&[&["tune", &file, "--out", &folder_of_gains][..], &search].concat());
    assert!(told.contains("The goal is met in "), "{told}");
    assert!(told.contains("the step along the stroke"), "{told}");
    let tuned_rig = Rig::read("press", &std::fs::read_to_string(&tuned).expect("written")).expect("valid");
    assert!(all_keys().filter(|key| rig.is_set(key)).all(|key| tuned_rig.is_set(key)), "no origin is lost");
    run(&["simulate", &tuned, "--out", &at("step"), "--ensemble", "1"]);
    assert!(folder.path().join("step/report.html").is_file());
}

/// The law by a model has nothing to tune: its first step is where it should be.
#[test]
fn a_machine_builder_comes_from_data_sheets_to_a_step_within_a_twentieth_of_a_millimetre() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (file, step) = (at("press.toml"), at("step"));
    let run = |command: &str, more: &[&str]| {
        let arguments: Vec<&str> = command.split(' ').chain(more.iter().copied()).collect();
        let output = pneudrive(&arguments);
        assert!(output.status.success(), "{arguments:?}: {output:?}");
        printed(&output)
    };
    let drive = ["--stroke", "250 mm", "--mass", "8 kg"];
    let told = run(
        "rig new --no-questions --cylinder iso-15552-32 --valve proportional-5-3-350",
        &[&[&*file][..], &drive].concat(),
    );
    assert!(!told.contains("pneudrive tune"), "{told}");
    run("simulate", &[&file, "--out", &step]);
    let told = run("eval --json", &[&step, "--out", &at("eval.html")]);
    let figures: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    let last = figures["result"]["moves"].as_array().and_then(|moves| moves.last()).expect("moves");
    assert!(last["settled_s"]["value"].as_f64().is_some(), "{last}");
}

#[test]
fn a_new_rig_is_tuned_at_once_where_that_is_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (file, tuned) = (at("own.toml"), at("tuned"));
    let made = pneudrive(&[
        "rig",
        "new",
        &file,
        "--cylinder",
        "iso-15552-32",
        "--stroke",
        "100 mm",
        "--valve",
        "proportional-5-3-100",
        "--mass",
        "3 kg",
        "--friction",
        "5 N",
        "--no-questions",
        "--tune",
        &tuned,
        "--generations",
        "0",
    ]);
    assert!(made.status.success(), "{made:?}");
    let told = printed(&made);
    assert!(told.contains("The goal is met in ") && told.contains("next: pneudrive simulate"), "{told}");
    assert!(
        String::from_utf8_lossy(&made.stderr).contains("--step 40 --tolerance-mm 1"),
        "the command is shown"
    );
    for name in ["tuned/tuned.toml", "tuned/tune.html"] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
}

#[test]
fn a_valve_by_its_measured_map_makes_a_rig_that_runs_and_says_how_far_it_rests_on_the_map() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let places = [-10.0, 0.0, 5.0, 20.0, 50.0, 100.0_f64];
    let rows = places.iter().flat_map(|spool| {
        [0.15, 0.4, 0.6, 0.8, 0.95].map(|ratio: f64| {
            let flow =
                840.0 * (spool / 100.0).max(0.01) * (1.0 - ((ratio - 0.3) / 0.7).max(0.0).powi(2)).sqrt();
            format!("{spool},700,{},{flow:.2},{:.2}\n", 700.0 * ratio, 0.02 * flow)
        })
    });
    let table = format!(
        "command_percent,upstream_kpa,downstream_kpa,flow_l_min,spread_l_min\n{}",
        rows.collect::<String>()
    );
    std::fs::write(at("bench.csv"), table).expect("written");
    let (file, bench) = (at("own.toml"), at("bench.csv"));
    let made = pneudrive(&[
        "rig",
        "new",
        &file,
        "--cylinder",
        "iso-15552-32",
        "--stroke",
        "250 mm",
        "--flow-map",
        &bench,
        "--mass",
        "8 kg",
        "--no-questions",
    ]);
    assert!(made.status.success(), "{made:?}");
    let checked = printed(&pneudrive(&["rig", "check", &file]));
    assert!(checked.contains("a valid rig (own)"), "{checked}");
    let shown = printed(&pneudrive(&["rig", "show", &file, "--resolved"]));
    assert!(shown.contains("flow_map_shift = 0.0") && shown.contains("computed, -2 to 2"), "{shown}");
    for of_the_thesis in ["sleeve_diameter_mm", "port_diameter_mm", "discharge_supply"] {
        assert!(!shown.contains(of_the_thesis), "{of_the_thesis}: {shown}");
    }
    let flow = printed(&pneudrive(&["characterise", &file, "nominal-flow", "--out", &at("char")]));
    assert!(flow.contains("conductance C from the supply to port 1") && flow.contains("2.000"), "{flow}");
}

/// As a shell reads it, in the folder of the file.
#[cfg(unix)]
#[test]
fn a_refused_drive_is_told_with_a_command_that_makes_one() {
    let folder = tempfile::tempdir().expect("a folder");
    for (answers, names) in [
        (
            "--cylinder iso-15552-32 --stroke '250 mm' --mass '400 kg' --incline '90 deg' --flow '350 l/min'",
            "--mass",
        ),
        ("--bore '100 mm' --rod '120 mm' --stroke '1 m' --mass 8 --flow '700 l/min' --overwrite", "--rod"),
        ("--stroke '250 mm'", "--bore"),
    ] {
        let shell = |command: &str| {
            let command = command.replacen("pneudrive", env!("CARGO_BIN_EXE_pneudrive"), 1);
            let mut shell = Command::new("sh");
            shell.current_dir(folder.path()).args(["-c", &command]).output().expect("a shell")
        };
        let refused = shell(&format!("pneudrive rig new 'my own.toml' --no-questions {answers}"));
        let told = String::from_utf8(refused.stderr).expect("UTF-8");
        assert!(!refused.status.success() && told.contains(names), "{told}");
        let works =
            told.lines().find_map(|line| line.trim().strip_prefix("this works: ")).expect("a command");
        let made = shell(works);
        assert!(made.status.success(), "{works}: {made:?}");
        std::fs::remove_file(folder.path().join("my own.toml")).expect("it was written");
    }
}
