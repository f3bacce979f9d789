//! The parts of a drive as an importer runs them: step by step, what may be tuned, and what must not be.

mod refused;
mod tuned;

use pneudrive_fmu::signal::{Kind, Value};
use pneudrive_fmu::variable::variables;
use pneudrive_fmu::{Instance, Part};
use pneudrive_sim::trace::Extra;
use pneudrive_sim::{Accuracy, Rig, Run, run};

/// An instance with the names of its variables.
struct Fmu {
    instance: Instance,
    names: Vec<(&'static str, u32, Kind)>,
}

impl Fmu {
    fn new(part: Part, rig: &Rig, parameters: &[(&str, Value)]) -> Fmu {
        let mut fmu = Fmu::instantiated(part, rig);
        parameters.iter().for_each(|(name, value)| fmu.set(name, *value).expect("a parameter"));
        fmu.instance.enter_initialisation(0.0).expect("instantiated");
        fmu.instance.exit_initialisation().expect("initialised");
        fmu
    }

    fn instantiated(part: Part, rig: &Rig) -> Fmu {
        let all = variables(part, rig);
        let names = all.iter().map(|variable| (variable.name, variable.reference, variable.kind)).collect();
        Fmu { instance: Instance::new(part, rig.clone()).expect("such a part"), names }
    }

    fn of(&self, name: &str) -> (u32, Kind) {
        let found = self.names.iter().find(|(of, ..)| *of == name);
        let (_, reference, kind) = found.unwrap_or_else(|| panic!("there is no {name}"));
        (*reference, *kind)
    }

    fn set(&mut self, name: &str, value: Value) -> anyhow::Result<()> {
        let (reference, kind) = self.of(name);
        self.instance.set(reference, kind, value)
    }

    fn get(&mut self, name: &str) -> Value {
        let (reference, kind) = self.of(name);
        self.instance.get(reference, kind).expect("a value")
    }

    fn integer(&mut self, name: &str) -> i64 {
        match self.get(name) {
            Value::Integer(value) => value,
            other => panic!("{name} is {other:?}"),
        }
    }

    fn step(&mut self, step: f64) {
        self.instance.step(self.instance.time(), step).expect("a step");
    }
}

fn rig(name: &str, settings: &[&str]) -> Rig {
    let text = pneudrive_sim::rigfile::builtin(name).expect("built in");
    let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    Rig::read_with(name, text, &settings).unwrap_or_else(|problems| panic!("{problems}"))
}

fn period(rig: &Rig) -> f64 {
    f64::from(rig.period_us().get()) / 1e6
}

fn simulated(rig: &Rig) -> Run {
    run(rig, Accuracy::of(rig)).expect("simulated")
}

/// Rigs that differ in what is between controller and plant: DAC, stepper, open loop, channels in turn, noise, profiles,
/// waiting for the end of a move, learning, an air supply that is let in first.
fn rigs() -> Vec<Rig> {
    let mut rigs: Vec<Rig> = pneudrive_sim::rigfile::BUILTIN
        .iter()
        .map(|(name, _)| rig(name, &["test.duration_s=0.4"]))
        .filter(|rig| Part::Drive.check(rig).is_ok())
        .collect();
    for settings in [
        &["sensors.noise_counts=2.0", "sensors.channel_skew_s=1e-4"][..],
        &["test.profile=s-curve", "test.moves=[[0.0, 9000]]"],
        &["controller.start_s=0.05"],
        &["controller.learn_null_offset=true", "controller.tolerance_counts=400"],
    ] {
        rigs.push(rig("servo-b-tuned", &[&["test.duration_s=0.4"], settings].concat()));
    }
    rigs
}

const WIRES: [&str; 4] = ["position_counts", "pressure_1_raw", "pressure_2_raw", "spool_raw"];

/// What the controller made of a sample, as an FMU shows it.
fn shown(fmu: &mut Fmu) -> [i64; 6] {
    [
        "index",
        "setpoint_in_force_counts",
        "error_counts",
        "velocity_estimate",
        "acceleration_estimate",
        "command_counts",
    ]
    .map(|name| fmu.integer(name))
}

fn expected(run: &Run, k: usize) -> [i64; 6] {
    let seen = &run.observations[k];
    let (setpoint, error) = (i64::from(seen.setpoint), i64::from(seen.error));
    let command = i64::from(run.commands[k].counts);
    [i64::from(seen.index), setpoint, error, seen.velocity, seen.acceleration, command]
}

#[test]
fn controller_and_plant_in_a_loop_repeat_the_simulation_in_every_integer() {
    for rig in rigs() {
        let run = simulated(&rig);
        let step = period(&rig);
        let mut plant = Fmu::new(Part::Plant, &rig, &[]);
        let mut controller = Fmu::new(Part::Controller, &rig, &[("run_test", Value::Switch(true))]);
        let pulses = plant.names.iter().any(|(name, ..)| *name == "step");
        for k in 0..run.observations.len() {
            assert_eq!(
                plant.integer("position_counts"),
                i64::from(run.observations[k].position),
                "{} {k}",
                rig.name()
            );
            for name in WIRES {
                controller.set(name, plant.get(name)).expect("a reading");
            }
            controller.set("home_switch", plant.get("home_switch")).expect("a reading");
            controller.step(step);
            assert_eq!(shown(&mut controller), expected(&run, k), "{} at sample {k}", rig.name());
            plant.set("command_counts", controller.get("command_counts")).expect("a command");
            if pulses {
                plant.set("step", controller.get("step")).expect("a pulse");
            }
            plant.step(step);
        }
    }
}

#[test]
fn the_drive_repeats_the_simulation_in_integers_and_in_physical_values() {
    for rig in rigs() {
        let run = simulated(&rig);
        let mut drive = Fmu::new(Part::Drive, &rig, &[("run_test", Value::Switch(true))]);
        for k in 0..run.observations.len() {
            let (row, name) = (&run.rows[k], rig.name());
            for (value, is) in [
                ("position_m", row.plant.position),
                ("velocity_m_s", row.plant.velocity),
                ("pressure_1_pa", row.plant.pressures[0]),
                ("mass_flow_2_kg_s", row.plant.mass_flows[1]),
            ] {
                assert_eq!(drive.get(value), Value::Float(is), "{name}: {value} at sample {k}");
            }
            drive.step(period(&rig));
            assert_eq!(shown(&mut drive), expected(&run, k), "{name} at sample {k}");
        }
    }
}

#[test]
fn what_the_law_knows_of_its_drive_is_at_the_outputs_as_in_a_trace() {
    let rig = rig("press", &["test.duration_s=0.5"]);
    let run = simulated(&rig);
    let mut drive = Fmu::new(Part::Drive, &rig, &[("run_test", Value::Switch(true))]);
    let shown = Extra::of_law(&rig);
    assert!(shown.iter().any(|extra| extra.name == "law_mass_kg"), "{shown:?}");
    for (k, row) in run.rows.iter().enumerate() {
        drive.step(period(&rig));
        for extra in &shown {
            let expected = extra.value(row);
            assert_eq!(drive.get(extra.name), Value::Float(expected), "{} at sample {k}", extra.name);
        }
    }
    let mut gain_profile = Fmu::new(Part::Drive, &self::rig("servo-b", &[]), &[]);
    assert!(gain_profile.names.iter().all(|(name, ..)| !name.starts_with("law_")));
    gain_profile.step(1.3e-3);
}

#[test]
fn a_setpoint_at_the_input_is_a_step_that_begins_with_its_sample() {
    for settings in [&[][..], &["controller.learn_null_offset=true", "controller.tolerance_counts=400"]] {
        let moves = "test.moves=[[0.0, 9000], [0.13, 8100], [0.26, 8700]]";
        let rig = rig("servo-b-tuned", &[&["test.duration_s=0.4", moves], settings].concat());
        let run = simulated(&rig);
        let mut drive = Fmu::new(Part::Drive, &rig, &[]);
        for k in 0..run.observations.len() {
            let metres = f64::from(run.observations[k].setpoint)
                * rig.number_at("encoder.mm_per_count").expect("a pulse")
                / 1e3;
            drive.set("setpoint_m", Value::Float(metres)).expect("a setpoint");
            drive.step(period(&rig));
            assert_eq!(shown(&mut drive), expected(&run, k), "sample {k}");
        }
    }
}

#[test]
fn without_a_setpoint_the_drive_stays_where_it_is() {
    let rig = rig("servo-b-tuned", &[]);
    let mut drive = Fmu::new(Part::Drive, &rig, &[]);
    let before = drive.integer("position_counts");
    drive.step(100.0 * period(&rig));
    assert_eq!(drive.integer("setpoint_in_force_counts"), before);
    assert!(drive.integer("position_counts").abs_diff(before) <= 40, "it is held");
}

#[test]
fn stopping_trips_the_controller_for_good() {
    let rig = rig("servo-b-tuned", &[]);
    let mut drive = Fmu::new(Part::Drive, &rig, &[("run_test", Value::Switch(true))]);
    drive.step(50.0 * period(&rig));
    assert_eq!((drive.integer("mode"), drive.integer("fault")), (2, 0));
    for stop in [true, false] {
        drive.set("stop", Value::Switch(stop)).expect("an input");
        drive.step(period(&rig));
        assert_eq!(
            (drive.integer("mode"), drive.integer("fault"), drive.integer("command_counts")),
            (5, 1, 0)
        );
        assert_eq!(drive.get("drive_enable"), Value::Switch(false));
    }
}

#[test]
fn a_state_that_was_kept_comes_back_with_everything_that_follows() {
    let rig = rig("servo-b-tuned", &["sensors.noise_counts=2.0"]);
    let mut drive =
        Fmu::new(Part::Drive, &rig, &[("run_test", Value::Switch(true)), ("seed", Value::Integer(7))]);
    let follow = |drive: &mut Fmu| {
        (0..60)
            .map(|_| {
                drive.step(period(&rig));
                (shown(drive), drive.get("pressure_1_pa"))
            })
            .collect::<Vec<_>>()
    };
    drive.step(250.0 * period(&rig));
    let (state, time) = (drive.instance.keep(), drive.instance.time());
    let first = follow(&mut drive);
    drive.instance.restore(state).expect("kept");
    assert_eq!(drive.instance.time(), time);
    assert_eq!(follow(&mut drive), first);
    drive.instance.forget(state).expect("kept");
    let mut other = Fmu::new(Part::Drive, &rig, &[]);
    let foreign = other.instance.keep();
    for gone in [state, foreign] {
        assert!(drive.instance.restore(gone).is_err() && drive.instance.keep_as(gone).is_err());
    }
}

#[test]
fn steps_of_any_length_pass_the_same_samples_and_hold_between_them() {
    let rig = rig("servo-b-tuned", &["sensors.noise_counts=1.0"]);
    let run_test = [("run_test", Value::Switch(true))];
    let [mut whole, mut parts] = [0, 1].map(|_| Fmu::new(Part::Drive, &rig, &run_test));
    let state = |fmu: &mut Fmu| (shown(fmu), fmu.get("position_m"), fmu.get("pressure_1_pa"));
    let mut sample = 0;
    // 0.7 of a sample, and 1.9 of one.
    for step in [0.000_91, 0.002_47].into_iter().cycle().take(400) {
        parts.step(step);
        let reached = (parts.instance.time() / 0.0013 + 1e-6).floor() as u32;
        while sample < reached {
            whole.step(0.0013);
            sample += 1;
        }
        if sample > 0 {
            assert_eq!(state(&mut parts), state(&mut whole), "at {} s", parts.instance.time());
        }
    }
    assert!((parts.instance.time() - 200.0 * 2.6 * 0.0013).abs() < 1e-9, "{} s", parts.instance.time());
    assert_eq!(sample, 520);
}

#[test]
fn a_run_may_begin_at_the_time_of_day() {
    let rig = rig("servo-b-tuned", &[]);
    let mut drive = Fmu::instantiated(Part::Drive, &rig);
    let start = 1_767_225_600.123;
    drive.instance.enter_initialisation(start).expect("a start time");
    drive.instance.exit_initialisation().expect("a valid rig");
    for k in 0..200 {
        let [now, next] = [k, k + 1].map(|k| start + f64::from(k) * 0.0013);
        drive.instance.step(now, next - now).unwrap_or_else(|refused| panic!("sample {k}: {refused}"));
    }
    let told = drive.instance.step(start, 0.0013).expect_err("another time").to_string();
    assert!(told.contains("but the FMU is at"), "{told}");
    let mut far = Fmu::instantiated(Part::Drive, &rig);
    let told = far.instance.enter_initialisation(1e13).expect_err("too far").to_string();
    assert!(told.contains("too far apart for a sample every 0.0013 s"), "{told}");
}
