//! What the plant tells the integrator of its states and guards.

use super::*;
use crate::assembly::{GUARDS, STATES};
use crate::rigfile::BUILTIN;

/// Every built-in rig with commands to and fro, held, flying, in its stops, on dry friction and on bristles, behind tubes and
/// sensors that lag or not: `System::n_moving` leaves what rests out of the sums of a step, and `System::n_guards` what stays
/// out of the search for its first event.
#[test]
fn states_that_are_said_to_rest_have_no_derivative_and_guards_that_are_said_to_stay_do() {
    let (mut samples, mut with_guards) = ([0; STATES + 1], [0; GUARDS + 1]);
    let others = ["load.friction=lugre", "tubing.lag_s=0.002", "sensors.pressure_lag_s=0.005"];
    for (name, _) in BUILTIN {
        let rig = Rig::builtin(name).expect("a built-in rig");
        let others = others.map(|setting| rig.with_settings(&[setting.to_owned()]));
        for rig in std::iter::once(Ok(rig)).chain(others).flatten() {
            let mut plant = Plant::new(&rig, Accuracy::of_motion(&rig), 0);
            for k in 0..400_i16 {
                let counts = [0, 700, -1500, 2048][usize::from(k.unsigned_abs() / 25 % 4)];
                plant.command(Command { counts, step: counts.signum() as i8, drive_enable: true });
                plant.next_sample().expect("a sample");
                let t = plant.sample_time;
                let x = plant.integrator.state(t);
                let n_moving = plant.assembly.n_moving();
                samples[n_moving] += 1;
                let slope = plant.assembly.derivative(t, x);
                assert!(slope[n_moving..].iter().all(|rate| *rate == 0.0), "{name} at {t} s");
                let n_guards = plant.assembly.n_guards();
                with_guards[n_guards] += 1;
                let guards = plant.assembly.guards(t, x);
                assert!(guards[n_guards..].iter().all(|guard| *guard == 1.0), "{name} at {t} s");
            }
        }
    }
    assert_eq!(samples.iter().filter(|count| **count > 100).count(), 5, "{samples:?}");
    assert_eq!(with_guards.iter().filter(|count| **count > 100).count(), 2, "{with_guards:?}");
}
