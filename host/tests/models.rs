//! The commands that need a model and no rig: `rig` and `simulate`, and what `eval` tells of their runs.

use std::fs;

use crate::program::{exists, folder, ok, transcript};

#[test]
fn rig_check_names_file_line_and_key() {
    let folder = folder();
    for (name, text, expected) in [
        (
            "key.toml",
            "[load]\nmass_kgs = 2\n",
            "! error: key.toml:2: load.mass_kgs: unknown key; did you mean mass_kg?\n= 1",
        ),
        (
            "unit.toml",
            "\n[actuator]\nbore_mm = 50\n",
            "! error: unit.toml:3: actuator.bore_mm: wrong unit: this key is bore_m, so give it in m instead of mm\n= 1",
        ),
        (
            "negative.toml",
            "[actuator]\nbore_m = -0.05\n",
            "! error: negative.toml:2: actuator.bore_m: must be between 0.001 m and 2 m, is -0.05\n= 1",
        ),
        (
            "bracket.toml",
            "[test]\nmoves = [[0.0, 8192]\n",
            "! error: bracket.toml:2: test.moves: a bracket is opened here and not closed\n= 1",
        ),
        (
            "good.toml",
            "[operator]\nmax_steps = 40\n",
            "good.toml: operator.max_steps has no effect here\ngood.toml: a valid rig (rig)\ngood.toml: moves: at 0 s 98.714 mm (8192 counts), at 0.3 s 197.427 mm (16384 counts), at 1.72 s 98.714 mm (8192 counts)\n= 0",
        ),
        (
            "idle.toml",
            "[operator]\nmax_steps = 3\n",
            "! error: idle.toml:2: operator.max_steps: has no effect with operator.model = \"solenoid\": leave it out\n= 1",
        ),
    ] {
        fs::write(folder.path().join(name), text).expect("written");
        assert_eq!(transcript(folder.path(), &format!("rig check --quick {name}")), expected);
    }
}

#[cfg(unix)]
#[test]
fn a_rig_without_an_end_is_refused() {
    let printed = transcript(folder().path(), "rig check /dev/zero");
    assert!(printed.contains("cannot read /dev/zero: it is longer than 1048576 bytes"), "{printed}");
}

#[test]
fn rig_list_show_and_explain_tell_what_there_is() {
    let folder = folder();
    let list = ok(folder.path(), "rig list");
    assert!(list.contains("servo-b ") && list.contains("servo-b-tuned"), "{list}");
    assert_eq!(list.lines().find(|line| !line.ends_with('.')), None, "each rig has a whole sentence");
    let shown = ok(folder.path(), "rig show servo-b");
    fs::write(folder.path().join("copy.toml"), &shown).expect("written");
    assert!(ok(folder.path(), "rig check copy.toml").contains("a valid rig (servo-b)"));
    assert_eq!(
        transcript(folder.path(), "rig explain load.mass_kg"),
        "load.mass_kg\n  Moving mass.\n  unit       kg\n  range      0.001 to 100000\n  default    1.6\n  thesis     C(17)\n= 0"
    );
    let number = ok(folder.path(), "rig explain C(46)");
    assert!(
        number.starts_with(
            "C(46): Static friction (extending) (N), 70.0 in the thesis\nload.static_extend_n\n"
        ),
        "{number}"
    );
    assert!(
        ok(folder.path(), "rig explain L(14)")
            .contains("no key     not defined: Appendix VII alone names the mode")
    );
    assert_eq!(ok(folder.path(), "rig explain C").lines().count(), 69);
    assert_eq!(ok(folder.path(), "rig explain L").lines().count(), 22);
    assert!(transcript(folder.path(), "rig explain nonsense").ends_with("= 1"));
    assert!(
        transcript(folder.path(), "rig show nonsense").contains("built in: servo-a, servo-a-tuned, servo-b,")
    );
}

#[test]
fn simulate_leaves_a_trace_with_the_fixed_columns_a_row_a_sample() {
    let folder = folder();
    ok(folder.path(), "simulate servo-b --set test.duration_s=0.1 --out run");
    exists(&folder.path().join("run"), &["trace.csv", "run.json", "report.html"]);
    let trace = fs::read_to_string(folder.path().join("run/trace.csv")).expect("written");
    let lines: Vec<&str> = trace.lines().collect();
    assert_eq!(
        lines[0],
        "time_s,setpoint_counts,position_counts,error_counts,command_counts,position_m,velocity_m_s,\
         acceleration_m_s2,pressure_1_pa,pressure_2_pa,temperature_1_k,temperature_2_k,spool_mm,\
         spool_command_mm,mass_flow_1_kg_s,mass_flow_2_kg_s,actuator_force_n,friction_n"
    );
    assert_eq!(lines.len(), 1 + 77, "samples 0 to 76 lie within 0.1 s");
    assert!(lines[1].starts_with("0,8192,8192,0,0,0.098719625,0,0,325325,"), "{}", lines[1]);
    assert!(lines[2].starts_with("0.0013,"), "{}", lines[2]);
    assert!(trace.ends_with('\n') && !trace.contains('\r'));
    let description = fs::read_to_string(folder.path().join("run/run.json")).expect("written");
    assert!(description.contains("\"format\": \"pneudrive-run 1\""), "{description}");
}

#[test]
fn simulate_without_its_report_leaves_the_same_trace() {
    let folder = folder();
    let run = "simulate servo-b --set test.duration_s=0.05";
    ok(folder.path(), &format!("{run} --out with"));
    ok(folder.path(), &format!("{run} --out without --no-report"));
    assert!(!folder.path().join("without/report.html").exists());
    let [with, without] = ["with", "without"].map(|run| fs::read(folder.path().join(run).join("trace.csv")));
    assert_eq!(with.expect("written"), without.expect("written"));
}

#[test]
fn simulate_takes_the_test_of_another_file_and_rows_at_a_period() {
    let folder = folder();
    let test =
        "[test]\nmoves = [[0.0, 9000]]\nduration_s = 0.05\ntrace_period_s = 0.001\n[load]\nmass_kg = 99\n";
    fs::write(folder.path().join("step.toml"), test).expect("written");
    ok(folder.path(), "simulate servo-b --test step.toml --out run --method merson --tolerance 1e-8");
    let trace = fs::read_to_string(folder.path().join("run/trace.csv")).expect("written");
    assert_eq!(trace.lines().count(), 1 + 51);
    assert!(trace.lines().nth(1).expect("a row").starts_with("0,9000,8192,808,"), "{trace}");
    let description = fs::read_to_string(folder.path().join("run/run.json")).expect("written");
    assert!(description.contains("\"load.mass_kg\": 1.6"), "only [test] is taken");
}

#[test]
fn a_foreign_run_json_is_not_overwritten() {
    let folder = folder();
    fs::write(folder.path().join("run.json"), "{\"mine\": true}").expect("written");
    let printed = transcript(folder.path(), "simulate servo-b --set test.duration_s=0.01 --out .");
    assert!(
        printed.contains("was not written by this program; choose another folder")
            && printed.ends_with("= 1"),
        "{printed}"
    );
    assert_eq!(fs::read_to_string(folder.path().join("run.json")).expect("there"), "{\"mine\": true}");
}

/// Once the page of another run stayed beside the new trace.
#[test]
fn a_run_without_a_page_takes_the_page_of_the_run_before_away() {
    let folder = folder();
    ok(folder.path(), "simulate servo-a --out out");
    assert!(folder.path().join("out/report.html").exists());
    ok(folder.path(), "simulate servo-c --out out --no-report --overwrite");
    assert!(!folder.path().join("out/report.html").exists());
}

/// The rows of the second move of a table of moves: the run itself, the least and the most of its perturbed runs.
fn second_move(printed: &str) -> Vec<&str> {
    printed.lines().skip_while(|line| !line.starts_with("2 ")).take(3).collect()
}

#[test]
fn the_figures_of_a_simulation_are_ranges_that_its_folder_tells_again() {
    let folder = folder();
    let run = "simulate servo-b-tuned --set test.duration_s=0.6 --no-report --out run";
    let simulated = ok(folder.path(), run);
    let again = ok(folder.path(), "eval run");
    let [own, least, most] = second_move(&simulated)[..] else { panic!("{simulated}") };
    assert!(least.starts_with("  least") && most.starts_with("  most"), "{simulated}");
    assert_eq!(second_move(&again), [own, least, most], "{again}");
    assert!(again.contains("Least and most are over 8 runs"), "{again}");
    let run_json = fs::read_to_string(folder.path().join("run/run.json")).expect("written");
    let run_json: serde_json::Value = serde_json::from_str(&run_json).expect("JSON");
    assert_eq!(run_json["moves"].as_array().map(Vec::len), Some(2), "{run_json}");
    assert_eq!(run_json["moves"][1]["ends_at_mm"]["runs_without"], 0);
    let alone = ok(folder.path(), "eval run --ensemble 1");
    assert!(alone.contains("figures of a single run") && !alone.contains("least"), "{alone}");
}

#[test]
fn a_run_that_comes_out_otherwise_today_is_told_by_its_trace_alone() {
    let folder = folder();
    ok(folder.path(), "simulate servo-b-tuned --set test.duration_s=0.4 --no-report --out run");
    let path = folder.path().join("run/run.json");
    let text = fs::read_to_string(&path).expect("written");
    let mass = text.lines().find(|line| line.contains("\"load.mass_kg\"")).expect("a key").to_owned();
    fs::write(&path, text.replace(&mass, "    \"load.mass_kg\": 12.3,")).expect("written");
    let printed = ok(folder.path(), "eval run");
    assert!(
        printed.contains("The figures are of the stored trace alone") && !printed.contains("least"),
        "{printed}"
    );
    let refused = transcript(folder.path(), "eval run/run.json --ensemble 4");
    assert!(refused.ends_with("= 1"), "{refused}");
}
