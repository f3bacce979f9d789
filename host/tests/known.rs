//! What the law that knows its drive shows, in traces and of records.

use std::fs;

use crate::program::{folder, ok, transcript, virtual_rig};

/// A column of a table by its name.
fn column(table: &str, name: &str) -> Vec<f64> {
    let place = table.lines().next().and_then(|head| head.split(',').position(|other| other == name));
    let place = place.unwrap_or_else(|| panic!("no {name}"));
    let cell = |line: &str| line.split(',').nth(place).expect("a cell").parse().expect("a number");
    table.lines().skip(1).map(cell).collect()
}

#[test]
fn a_simulation_and_the_replay_of_a_record_show_what_the_law_knew() {
    let folder = folder();
    let test = "press --set test.duration_s=0.8";
    let told = ok(folder.path(), &format!("simulate {test} --out sim"));
    assert!(told.contains(" times the bang-bang bound of "), "{told}");
    let rig = virtual_rig("press");
    ok(folder.path(), &format!("run {test} --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    let told = ok(folder.path(), "replay TARGET01.DAT --rig press --out known.csv");
    assert!(told.contains("known.csv: what the law knew at each sample"), "{told}");
    let [simulated, replayed] = ["sim/trace.csv", "known.csv"]
        .map(|name| fs::read_to_string(folder.path().join(name)).expect("written"));
    // The virtual rig is the simulation of the same rig.
    for name in ["law_phase", "law_reference_mm", "law_wanted_force_n", "law_mass_kg", "law_lag_ms"] {
        assert_eq!(column(&replayed, name), column(&simulated, name), "{name}");
    }
    assert!(column(&simulated, "law_phase").contains(&1.0));
}

#[test]
fn a_record_of_another_drive_shows_nothing_of_this_one() {
    let folder = folder();
    let rig = virtual_rig("press");
    ok(folder.path(), &format!("run press --set test.duration_s=0.3 --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    let replay =
        |more: &str| transcript(folder.path(), &format!("replay TARGET01.DAT {more} --out known.csv"));
    let heavier = replay("--rig press --set load.mass_kg=12");
    assert!(heavier.contains("recorded with another cascade_acceleration than press has"), "{heavier}");
    let gains = replay("--rig servo-b");
    assert!(gains.contains("servo-b has no law that knows its drive"), "{gains}");
    assert!(!folder.path().join("known.csv").exists());
}
