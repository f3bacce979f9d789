//! Runs of one rig, one after another.

use pneudrive_sim::trace::MotionRow;
use pneudrive_sim::{Accuracy, Rig, Runner, run};

/// The rigs that differ most in what a run leaves behind: learned offsets, noise, hysteresis.
const RIGS: [&str; 4] = ["servo-a", "servo-b-tuned", "lut-solenoid", "bang-bang"];

fn short(name: &str) -> Rig {
    let text = pneudrive_sim::rigfile::builtin(name).expect("a built-in rig");
    let settings = ["test.duration_s=0.8", "sensors.noise_counts=0.4"].map(str::to_owned);
    Rig::read_with(name, text, &settings).expect("a valid rig")
}

#[test]
fn each_run_of_a_rig_begins_anew_and_is_the_same_to_the_last_bit() {
    for name in RIGS {
        let rig = short(name);
        let accuracy = Accuracy::of_motion(&rig);
        let alone = run(&rig, accuracy).expect("a transient");
        let mut runner = Runner::new(&rig, accuracy);
        for _ in 0..3 {
            let again = runner.run().expect("a transient");
            let bits = |row: &pneudrive_sim::trace::Row| row.values().map(f64::to_bits);
            assert!(again.rows.iter().map(bits).eq(alone.rows.iter().map(bits)), "{name}");
            assert_eq!(again.observations, alone.observations, "{name}");
            assert_eq!((&again.readings, &again.commands), (&alone.readings, &alone.commands), "{name}");
            assert_eq!((again.fault, again.work), (alone.fault, alone.work), "{name}");
        }
    }
}

#[test]
fn rows_of_the_motion_alone_are_columns_of_the_trace_and_change_nothing() {
    for name in RIGS {
        let rig = short(name);
        let accuracy = Accuracy::of_motion(&rig);
        let whole = run(&rig, accuracy).expect("a transient");
        let mut runner = Runner::<MotionRow>::new(&rig, accuracy);
        let motion = runner.run().expect("a transient");
        assert_eq!((&motion.observations, motion.work), (&whole.observations, whole.work), "{name}");
        assert_eq!(motion.rows.len(), whole.rows.len(), "{name}");
        for (row, of_trace) in motion.rows.iter().zip(&whole.rows) {
            let plant = of_trace.plant;
            let expected = MotionRow {
                time: of_trace.time,
                position: plant.position,
                velocity: plant.velocity,
                pressures: plant.pressures,
            };
            assert_eq!(*row, expected, "{name}");
        }
    }
}
