//! Values that an importer gives: parameters before the start, loads and gains while the drive runs.

use super::*;

#[test]
fn a_parameter_makes_the_rig_that_the_key_makes() {
    let mut heavy = Fmu::new(
        Part::Drive,
        &rig("servo-b-tuned", &[]),
        &[
            ("load.mass_kg", Value::Float(8.0)),
            ("controller.velocity_gain", Value::Integer(900)),
            ("run_test", Value::Switch(true)),
        ],
    );
    let run = simulated(&rig("servo-b-tuned", &["load.mass_kg=8.0", "controller.velocity_gain=900"]));
    for k in 0..400 {
        heavy.step(period(&rig("servo-b-tuned", &[])));
        assert_eq!(shown(&mut heavy), expected(&run, k), "sample {k}");
    }
}

#[test]
fn the_supply_pressure_may_change_while_the_drive_runs_and_a_length_may_not() {
    let rig = rig("servo-b-tuned", &[]);
    let mut plant = Fmu::new(Part::Plant, &rig, &[]);
    plant.set("command_counts", Value::Integer(600)).expect("a command");
    plant.step(20.0 * period(&rig));
    let state = plant.instance.keep();
    plant.step(40.0 * period(&rig));
    let usual = plant.get("pressure_1_pa");
    plant.instance.restore(state).expect("kept");
    plant.set("supply.pressure_pa", Value::Float(480e3)).expect("tunable");
    plant.step(40.0 * period(&rig));
    let (Value::Float(usual), Value::Float(lower)) = (usual, plant.get("pressure_1_pa")) else {
        panic!("pressures")
    };
    assert!(lower < usual - 1e3, "{lower} after {usual}");
    let refused = plant.set("actuator.bore_m", Value::Float(0.05)).expect_err("fixed");
    assert!(refused.to_string().contains("actuator.bore_m is fixed"), "{refused}");
}

#[test]
fn a_load_that_changes_in_motion_obeys_the_second_law() {
    let rig = rig("servo-b-tuned", &[]);
    let mut plant = Fmu::new(Part::Plant, &rig, &[]);
    plant.set("command_counts", Value::Integer(600)).expect("a command");
    plant.step(60.0 * period(&rig));
    let float = |plant: &mut Fmu, name: &str| match plant.get(name) {
        Value::Float(value) => value,
        other => panic!("{name} is {other:?}"),
    };
    let (velocity, before) = (float(&mut plant, "velocity_m_s"), float(&mut plant, "acceleration_m_s2"));
    assert!(velocity > 0.05, "it moves, {velocity} m/s");
    let (mass, viscous) = (float(&mut plant, "load.mass_kg"), float(&mut plant, "load.viscous_n_s_per_m"));
    plant.set("load.mass_kg", Value::Float(3.0 * mass)).expect("tunable");
    let slower = float(&mut plant, "acceleration_m_s2");
    // Small differences of large forces.
    let alike = |one: f64, other: f64| (one / other - 1.0).abs() < 1e-9;
    assert!(alike(3.0 * slower, before), "three times the mass: {slower} after {before}");
    plant.set("load.constant_force_n", Value::Float(-40.0)).expect("tunable");
    plant.set("load.viscous_n_s_per_m", Value::Float(2.0 * viscous)).expect("tunable");
    let force = 3.0 * mass * float(&mut plant, "acceleration_m_s2");
    let wanted = mass * before - 40.0 - viscous * velocity;
    assert!(alike(force, wanted), "{force} N, not {wanted}");
    plant.set("load.mass_kg", Value::Float(mass)).expect("tunable");
    plant.set("load.constant_force_n", Value::Float(0.0)).expect("tunable");
    plant.set("load.viscous_n_s_per_m", Value::Float(viscous)).expect("tunable");
    assert!(alike(float(&mut plant, "acceleration_m_s2"), before), "as it was");
}

#[test]
fn a_load_at_rest_breaks_away_as_soon_as_less_friction_holds_it() {
    // 20 N pull at a load that 70 N of stiction hold.
    let rig = rig("servo-b-tuned", &["load.constant_force_n=20.0"]);
    let mut plant = Fmu::new(Part::Plant, &rig, &[]);
    plant.step(10.0 * period(&rig));
    let at = plant.get("position_m");
    for (name, value) in [("load.coulomb_extend_n", 1.0), ("load.static_extend_n", 1.0)] {
        plant.step(10.0 * period(&rig));
        assert_eq!(plant.get("position_m"), at, "it is held");
        plant.set(name, Value::Float(value)).expect("tunable");
    }
    plant.step(10.0 * period(&rig));
    let (Value::Float(at), Value::Float(now)) = (at, plant.get("position_m")) else { panic!("positions") };
    assert!(now > at + 1e-5, "from {at} to {now}");
}

#[test]
fn friction_that_sticks_less_than_it_slides_fails_the_next_step_and_says_why() {
    let mut plant = Fmu::new(Part::Plant, &rig("servo-b-tuned", &[]), &[]);
    plant.set("load.static_extend_n", Value::Float(1.0)).expect("a friction in its range");
    let refused = plant.instance.step(0.0, 0.0013).expect_err("less than the friction of motion");
    assert!(format!("{refused:#}").contains("load.coulomb_extend_n"), "{refused:#}");
}

#[test]
fn a_value_that_is_asked_for_under_contradicting_friction_is_refused_and_nothing_is_lost() {
    let rig = rig("servo-b-tuned", &[]);
    let mut plant = Fmu::new(Part::Plant, &rig, &[]);
    plant.set("command_counts", Value::Integer(600)).expect("a command");
    plant.step(60.0 * period(&rig));
    let (before, usual) = (plant.get("position_m"), plant.get("load.static_extend_n"));
    plant.set("load.static_extend_n", Value::Float(1.0)).expect("a friction in its range");
    let (reference, kind) = plant.of("position_m");
    for _ in 0..2 {
        let refused = plant.instance.get(reference, kind).expect_err("less than the friction of motion");
        assert!(format!("{refused:#}").contains("load.coulomb_extend_n"), "{refused:#}");
    }
    plant.set("load.static_extend_n", usual).expect("as it was");
    assert_eq!(plant.get("position_m"), before, "it is where it was");
}

/// A controller that is apart from the plant cannot know that its load has changed.
#[test]
fn a_load_that_changes_is_unknown_to_the_controller_and_a_gain_is_not() {
    for (name, of_plant, of_gain) in [
        ("servo-b-tuned", ("load.mass_kg", 4.0), Some(("controller.velocity_gain", 500))),
        ("press", ("load.mass_kg", 12.0), None),
    ] {
        let rig = rig(name, &[]);
        let run_test = [("run_test", Value::Switch(true))];
        let mut whole = Fmu::new(Part::Drive, &rig, &run_test);
        let (mut controller, mut plant) =
            (Fmu::new(Part::Controller, &rig, &run_test), Fmu::new(Part::Plant, &rig, &[]));
        for k in 0..600 {
            if k == 300 {
                for fmu in [&mut whole, &mut plant] {
                    fmu.set(of_plant.0, Value::Float(of_plant.1)).expect("tunable");
                }
            }
            if let (400, Some((gain, value))) = (k, of_gain) {
                for fmu in [&mut whole, &mut controller] {
                    fmu.set(gain, Value::Integer(value)).expect("tunable");
                }
            }
            for name in ["position_counts", "pressure_1_raw", "pressure_2_raw", "spool_raw"] {
                let value = plant.get(name);
                controller.set(name, value).expect("an input");
            }
            controller.step(period(&rig));
            let command = controller.get("command_counts");
            plant.set("command_counts", command).expect("an input");
            plant.step(period(&rig));
            whole.step(period(&rig));
            assert_eq!(whole.get("command_counts"), command, "{name}, sample {k}");
            assert_eq!(whole.get("position_m"), plant.get("position_m"), "{name}, sample {k}");
        }
    }
}
