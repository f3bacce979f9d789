//! What an importer must not ask for.

use super::*;

#[test]
fn what_is_no_step_is_refused() {
    let rig = rig("servo-b-tuned", &[]);
    let mut plant = Fmu::new(Part::Plant, &rig, &[]);
    for step in [0.0, -0.0013, f64::NAN, f64::INFINITY, 1e300] {
        let refused = plant.instance.step(0.0, step).expect_err("no step").to_string();
        assert!(refused.contains("a step must last more than 0 s"), "{refused}");
    }
    for time in [0.0013, f64::NAN, -1.0] {
        let refused = plant.instance.step(time, 0.0013).expect_err("another time").to_string();
        assert!(refused.contains("the FMU is at 0 s"), "{refused}");
    }
    plant.instance.step(0.0, 0.0026).expect("two samples, after all of these");
    assert_eq!(plant.instance.time(), 0.0026);
}

/// Seconds since 1970, of which a double holds a quarter of a microsecond: steps are differences of such times.
#[test]
fn values_that_cannot_be_are_refused_by_name() {
    let rig = rig("servo-b-tuned", &[]);
    let mut drive = Fmu::instantiated(Part::Drive, &rig);
    for (name, value, says) in [
        ("setpoint_m", Value::Float(f64::NAN), "setpoint_m must be a finite number"),
        ("load.mass_kg", Value::Float(f64::INFINITY), "load.mass_kg must be a finite number"),
        ("load.mass_kg", Value::Float(-1.0), "load.mass_kg must be between"),
        ("controller.velocity_gain", Value::Integer(70_000), "controller.velocity_gain must be between"),
        ("seed", Value::Integer(-1), "seed must be between"),
    ] {
        let refused = drive.set(name, value).expect_err("no such value").to_string();
        assert!(refused.contains(says), "{refused}");
    }
    assert!(drive.instance.set(99_999, Kind::Float64, Value::Float(1.0)).is_err(), "unknown reference");
    assert!(drive.instance.set(drive.of("load.mass_kg").0, Kind::Int32, Value::Integer(1)).is_err());
    assert!(drive.instance.set(0, Kind::Float64, Value::Float(1.0)).is_err(), "time");
}

#[test]
fn what_does_not_go_together_is_said_when_the_initialisation_ends() {
    let mut plant = Fmu::instantiated(Part::Plant, &rig("servo-b-tuned", &[]));
    plant.set("test.position_m", Value::Float(15.0)).expect("within the range of the key");
    plant.instance.enter_initialisation(0.0).expect("instantiated");
    let refused = format!("{:#}", plant.instance.exit_initialisation().expect_err("beyond the stroke"));
    assert!(refused.contains("test.position_m") && refused.contains("stroke"), "{refused}");
}

#[test]
fn a_setpoint_beyond_the_stroke_fails_the_step_and_says_where_the_end_is_given() {
    let rig = rig("servo-b-tuned", &[]);
    let mut drive = Fmu::new(Part::Drive, &rig, &[]);
    drive.step(period(&rig));
    let state = drive.instance.keep();
    for metres in [-0.01, 5.0, 1e300] {
        drive.set("setpoint_m", Value::Float(metres)).expect("a number");
        let failed = drive.instance.step(drive.instance.time(), period(&rig)).expect_err("beyond");
        assert!(format!("{failed:#}").contains("beyond a soft limit"), "{failed:#}");
        assert!(drive.instance.step(drive.instance.time(), period(&rig)).is_err(), "it has failed");
        drive.instance.restore(state).expect("kept");
    }
    drive.step(period(&rig));
}

#[test]
fn nothing_is_told_before_the_initialisation_and_nothing_runs_after_the_end() {
    let rig = rig("servo-b-tuned", &[]);
    let mut plant = Fmu::instantiated(Part::Plant, &rig);
    let (reference, kind) = plant.of("position_m");
    assert!(plant.instance.get(reference, kind).is_err());
    assert!(plant.instance.step(0.0, 0.0013).is_err());
    assert!(plant.instance.exit_initialisation().is_err() && plant.instance.terminate().is_err());
    assert!(plant.instance.enter_initialisation(f64::NAN).is_err());
    plant.instance.enter_initialisation(2.0).expect("instantiated");
    assert!(plant.instance.enter_initialisation(2.0).is_err(), "twice");
    assert_eq!(plant.get("position_m"), Value::Float(rig.number_at("test.position_m").expect("given")));
    plant.instance.exit_initialisation().expect("initialised");
    plant.instance.step(2.0, 0.0013).expect("from the start time on");
    plant.instance.terminate().expect("running");
    assert!(plant.instance.step(2.0013, 0.0013).is_err());
    plant.get("position_m");
    plant.instance.reset();
    plant.instance.enter_initialisation(0.0).expect("as new");
}

#[test]
fn there_is_no_fmu_of_what_no_firmware_has() {
    let continuous = rig("servo-b", &["controller.model=continuous", "controller.law=proportional"]);
    let refused = Instance::new(Part::Plant, continuous).expect_err("no samples").to_string();
    assert!(refused.contains("controller.model = \"sampled\""), "{refused}");
    let bug = rig("servo-b", &["faults.gain_bug=positive-error"]);
    let refused = Instance::new(Part::Drive, bug.clone()).expect_err("the simulator's bug").to_string();
    assert!(refused.contains("faults.gain_bug"), "{refused}");
    Instance::new(Part::Plant, bug).expect("it is no matter to the plant");
}
