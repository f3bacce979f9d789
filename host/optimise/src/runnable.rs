//! Whether the test of a rig can be simulated, and which values keep it from that.
//!
//! The values alone do not show whether a piston that arrives at its speed runs through its end cover, or how stiff
//! the whole is. So the test is run. If it fails, and the error names no value, one physical value after the other is
//! set to a tenth and to ten times its size. The first value with which the test runs is named.

use pneudrive_sim::rig::{Key, Kind};
use pneudrive_sim::{Accuracy, IntegrationError, Rig, run};

use crate::sensitivity::PHYSICAL;
use pneudrive_evaluate::parallel;

/// This many values are tried before the check whether one of them sufficed: the same ones on any number of threads.
const AT_ONCE: usize = 8;

/// By how much a value is changed.
const FACTORS: [f64; 2] = [0.1, 10.0];

/// Why a test cannot be simulated.
#[derive(Clone, Debug)]
pub struct Obstacle {
    /// The reason why the run ended.
    pub cause: IntegrationError,
    /// Some values with which it runs; none where the cause names values itself, or no value alone is enough.
    pub remedies: Vec<Remedy>,
}

/// A value with which the test runs.
#[derive(Clone, Copy, Debug)]
pub struct Remedy {
    /// The key of the value.
    pub key: &'static Key,
    /// The value of the rig, in the unit of the key.
    pub value: f64,
    /// The change with which it runs.
    pub instead: f64,
}

/// Runs the test of a rig; None if it runs to its end. `progress` is given the number of other values tried and of all.
pub fn obstacle(rig: &Rig, mut progress: impl FnMut(usize, usize) + Send) -> Option<Obstacle> {
    let cause = run(rig, Accuracy::of(rig)).err()?;
    if matches!(cause, IntegrationError::BeyondModel { .. }) {
        return Some(Obstacle { cause, remedies: Vec::new() });
    }
    let tried: Vec<Remedy> = rig.entries().filter_map(|(key, _)| values(rig, key)).flatten().collect();
    let found = tried.chunks(AT_ONCE).enumerate().map(|(chunk, some)| {
        let runs = |remedy: &Remedy| lets_it_run(rig, remedy).then_some(*remedy);
        let remedies = parallel::map(some, runs, |done| progress(chunk * AT_ONCE + done, tried.len()));
        remedies.into_iter().flatten().collect::<Vec<Remedy>>()
    });
    let remedies = found.into_iter().find(|remedies| !remedies.is_empty()).unwrap_or_default();
    Some(Obstacle { cause, remedies })
}

/// A tenth and ten times of a value, within its range.
fn values(rig: &Rig, key: &'static Key) -> Option<[Remedy; 2]> {
    let Kind::Number { min, max } = key.kind else { return None };
    let value = rig.number_at(key.path).filter(|value| *value != 0.0)?;
    let physical = rig.uses(key) && PHYSICAL.contains(&key.table());
    physical.then(|| FACTORS.map(|factor| Remedy { key, value, instead: (factor * value).clamp(min, max) }))
}

fn lets_it_run(rig: &Rig, remedy: &Remedy) -> bool {
    let changed = rig.with_numbers(&[(remedy.key.path, remedy.instead)]);
    changed.is_ok_and(|rig| run(&rig, Accuracy::of(&rig)).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: &str = "[controller]\nloop = \"open\"\n[test]\nmoves = [[0.0, 2047]]\nduration_s = 0.4\n";

    fn rig(text: &str) -> Rig {
        Rig::read("rig.toml", &format!("{OPEN}{text}")).unwrap_or_else(|problems| panic!("{problems}"))
    }

    #[test]
    fn a_test_that_runs_has_no_obstacle() {
        assert!(obstacle(&rig(""), |_, _| {}).is_none());
    }

    /// 50 kg at the whole speed of the valve, on a stop that gives way by more than the dead volume is long.
    #[test]
    fn a_piston_that_runs_through_its_end_cover_is_an_obstacle_that_names_its_keys() {
        let soft = "[load]\nmass_kg = 50.0\nstop_stiffness_n_per_m = 1e6\n[supply]\npressure_pa = 589000.0\n[actuator]\nresidual_volume_1_m3 = 5e-6\nresidual_volume_2_m3 = 5e-6\n[valve]\nmodel = \"iso-6358\"\ncharacteristic = \"linear\"\nsonic_conductance_m3_per_s_pa = 1e-7\ncritical_ratio = 0.3\n[tubing]\nmodel = \"none\"\n";
        let found = obstacle(&rig(soft), |_, _| panic!("nothing is to be tried")).expect("an obstacle");
        assert!(found.cause.to_string().contains("actuator.residual_volume_2_m3"), "{}", found.cause);
    }
}
