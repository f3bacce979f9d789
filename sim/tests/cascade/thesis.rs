//! The thesis's servo-drives: a stepper moves the spool of A, and the spools of B and C on their springs are measured: the law
//! positions them each 0.5 ms without dither, and is refused otherwise. `docs/explanation/control.md` has 120 draws of each.

use pneudrive_sim::{Accuracy, Rig, run};

use super::settings;

/// What the law needs of all of them, and of a coil.
const LAW: [&str; 3] = ["controller.law=cascade", "controller.period_s=0.0005", "controller.delay_s=0.0002"];
const COIL: [&str; 1] = ["operator.dither_mm=0"];

fn under(name: &str, also: &[&str]) -> Result<Rig, String> {
    let rig = Rig::builtin(name).expect("there");
    let of_coil: &[&str] = if name == "servo-a" { &[] } else { &COIL };
    rig.with_settings(&settings(&[LAW.as_slice(), of_coil, also].concat()))
        .map_err(|problems| problems.to_string())
}

/// A step of 60 mm, extending or retracting, on plants that are not what the file says.
#[test]
fn a_servo_drive_of_the_thesis_positions_within_a_fifth_of_a_millimetre() {
    const UNLIKE: [[&str; 2]; 3] = [
        ["load.mass_kg=2.08", "supply.pressure_pa=560000.0"],
        ["load.mass_kg=1.12", "supply.pressure_pa=618000.0"],
        ["load.coulomb_extend_n=30.0", "load.coulomb_retract_n=14.0"],
    ];
    for name in ["servo-a", "servo-b", "servo-c"] {
        for (plant, extends) in UNLIKE.into_iter().flat_map(|plant| [(plant, true), (plant, false)]) {
            let [from, to] = if extends { [8192, 13_171] } else { [13_171, 8192] };
            let position = format!("test.position_m={:.9}", (f64::from(from) + 0.5) * 12.05e-6);
            let moves = format!("test.moves=[[0.0, {from}], [0.05, {to}]]");
            let rig = under(name, &[&position, &moves, "test.duration_s=1.4"]).expect("a rig of its own");
            let rig = rig
                .with_plant(&settings(&[plant[0], plant[1], "sensors.noise_counts=1.0"]))
                .expect("a plant");
            let seen = run(&rig, Accuracy::of(&rig)).expect("a run");
            assert_eq!(seen.fault, None, "{name}, {plant:?}");
            let target = (f64::from(to) + 0.5) * 12.05e-6;
            let late = seen.rows.iter().filter(|row| row.time > 0.8);
            let worst = late.map(|row| (row.plant.position - target).abs()).fold(0.0, f64::max);
            assert!(worst < 0.2e-3, "{name}, {plant:?}, extends {extends}: {:.3} mm", 1e3 * worst);
        }
    }
}

/// What was not measured to work is refused, by the key that would have to change.
#[test]
fn what_the_law_does_not_know_of_such_a_valve_is_refused_by_name() {
    assert!(under("servo-b", &[]).is_ok());
    for (setting, named) in [
        ("controller.period_s=0.0013", "controller.period_s"),
        ("operator.dither_mm=0.2", "operator.dither_mm"),
        ("sensors.pressure=false", "sensors.pressure"),
        ("valve.model=single-restriction", "valve.model"),
        ("valve.underlap_mm=-0.02", "valve.underlap_mm"),
        ("valve.underlap_mm=0.02", "valve.underlap_mm"),
        ("valve.discharge_exhaust=0.7", "valve.discharge_exhaust"),
        ("valve.discharge_model=perry", "valve.discharge_model"),
        ("tubing.model=none", "tubing.model"),
        ("tubing.lag_s=0.003", "tubing.lag_s"),
        ("operator.saturation_mm=0.8", "operator.saturation_mm"),
    ] {
        let refused = under("servo-b", &[setting]).expect_err(setting);
        let names = |line: &str| line.contains("\"cascade\" needs") && line.contains(named);
        assert!(refused.lines().any(names), "{setting}: {refused}");
    }
}

/// The same of a stepper; what moves a coil does not concern it.
#[test]
fn what_the_law_does_not_know_of_a_stepper_is_refused_by_name() {
    assert!(under("servo-a", &["operator.max_steps=80"]).is_ok(), "the whole travel");
    for (setting, named) in [
        ("controller.period_s=0.0013", "controller.period_s"),
        ("operator.max_steps=81", "operator.max_steps"),
        ("sensors.pressure=false", "sensors.pressure"),
        ("valve.underlap_mm=0.02", "valve.underlap_mm"),
        ("tubing.model=none", "tubing.model"),
    ] {
        let refused = under("servo-a", &[setting]).expect_err(setting);
        let names = |line: &str| line.contains("\"cascade\" needs") && line.contains(named);
        assert!(refused.lines().any(names), "{setting}: {refused}");
    }
}
