//! What the law that knows its drive shows: in traces, of records, and of a drive at a port.

use std::fs;

use pneudrive_sim::Rig;

use crate::program::{folder, ok, transcript, virtual_rig, virtual_rig_of};

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

#[test]
fn a_drive_that_friction_holds_off_its_target_says_that_it_rests_outside() {
    let folder = folder();
    let settings =
        ["controller.tolerance_counts=2", "test.moves=[[0.0, 6250], [0.05, 6265]]", "test.duration_s=1.2"];
    let known = Rig::builtin("press")
        .expect("a built-in rig")
        .with_settings(&settings.map(str::to_owned))
        .expect("valid");
    let number = |key: &str| known.number_at(key).expect("a number");
    let of_friction = ["static_extend_n", "coulomb_extend_n", "static_retract_n", "coulomb_retract_n"];
    let stiff = of_friction.map(|key| format!("load.{key}={}", 3.0 * number(&format!("load.{key}"))));
    let rig = virtual_rig_of(known.with_plant(&stiff).expect("valid"));
    let set = settings.map(|setting| format!(" --set {}", setting.replace(' ', ""))).concat();
    ok(folder.path(), &format!("run press{set} --config --port {}", rig.port()));
    let status = ok(folder.path(), &format!("device --port {} status", rig.port()));
    assert!(status.contains("moves       number 2 rests outside its tolerance, "), "{status}");
}
