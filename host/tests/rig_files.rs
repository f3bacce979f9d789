//! `pneudrive rig show`, `diff` and values with units, as at the terminal.

use std::fs;
use std::process::{Command, Output};

fn pneudrive(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pneudrive")).args(arguments).output().expect("pneudrive")
}

fn said(output: &Output) -> String {
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
    let text = said(&shown);
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
    assert_eq!(said(&difference), "", "the resolved file is the same rig");
}

#[test]
fn json_of_a_rig_is_read_by_key() {
    let shown = pneudrive(&["rig", "show", "servo-b", "--json", "--set", "load.mass=\"2 kg\""]);
    let json: serde_json::Value = serde_json::from_str(&said(&shown)).expect("JSON");
    assert_eq!(json["load.mass_kg"]["value"], 2.0);
    assert_eq!(json["load.mass_kg"]["unit"], "kg");
    assert_eq!(json["load.mass_kg"]["origin"], "given");
}

#[test]
fn two_rigs_differ_key_by_key() {
    let text = said(&pneudrive(&["rig", "diff", "servo-b", "servo-b-tuned"]));
    assert!(text.contains("controller.velocity_gain "), "{text}");
    assert!(text.lines().all(|line| line.contains(" -> ")), "{text}");
}
