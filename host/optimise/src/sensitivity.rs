//! Which unmeasured values affect the transient most.
//!
//! Each value that is a default, typical or unknown is set to either end of its range, or 10 % below and above if it has
//! none, and the rig's test is run. The effect is the largest deviation of the piston from its position with the file's
//! value, at any sample. It must exceed the deviation of members of the ensemble of the run: a closed loop that is sensitive
//! to tiny changes is so for every value.

use pneudrive_records::judged::Spacing;
use pneudrive_sim::rig::{Key, Kind, Origin, Problems, Source, Value};
use pneudrive_sim::{Accuracy, IntegrationError, Rig, Run, run};

use crate::ensemble::members;
use pneudrive_evaluate::parallel;

/// Relative change of a value that has no range.
const CHANGE: f64 = 0.1;

/// Tables of values that are physics, not choices.
pub(crate) const PHYSICAL: [&str; 7] =
    ["supply", "exhaust", "operator", "valve", "tubing", "actuator", "load"];

/// The effect of a value on the transient of the test.
#[derive(Clone, Debug)]
pub struct Effect {
    /// The key of the value.
    pub key: &'static Key,
    /// The origin of the value.
    pub origin: Origin,
    /// The values that were tried, in the unit of the key.
    pub ends: [f64; 2],
    /// How far the piston is from where it is with the value of the file, at most, m; None where a run ended in an error.
    pub moves_m: Option<f64>,
}

/// The effects of unmeasured values, the largest first.
#[derive(Clone, Debug)]
pub struct Sensitivity {
    /// The effects.
    pub effects: Vec<Effect>,
    /// How far members of the ensemble of the run are from it, m: a smaller effect is not significant.
    pub floor_m: f64,
}

/// The runs.
struct Trial {
    rig: Result<Rig, Problems>,
    /// Of which effect; None for a perturbed run.
    effect: Option<usize>,
}

/// Tries all unmeasured values. `progress` is given the number of runs done and of all runs.
///
/// # Errors
/// When the rig itself cannot be simulated.
pub fn sensitivity(
    rig: &Rig,
    mut progress: impl FnMut(usize, usize) + Send,
) -> Result<Sensitivity, IntegrationError> {
    let nominal = run(rig, Accuracy::of(rig))?;
    let mut effects: Vec<Effect> = open_values(rig);
    let mut trials: Vec<Trial> =
        members(rig, Spacing::default()).into_iter().map(|rig| Trial { rig, effect: None }).collect();
    for (i, effect) in effects.iter().enumerate() {
        let changed = effect.ends.map(|end| rig.with_numbers(&[(effect.key.path, end)]));
        trials.extend(changed.map(|rig| Trial { rig, effect: Some(i) }));
    }
    let all = trials.len();
    let distances = parallel::map(&trials, |trial| distance_of(trial, &nominal), |done| progress(done, all));
    let mut floor_m = 0.0_f64;
    for (trial, distance) in trials.iter().zip(distances) {
        match (trial.effect, distance) {
            (None, distance) => floor_m = floor_m.max(distance.unwrap_or(0.0)),
            (Some(i), Some(distance)) => {
                effects[i].moves_m = effects[i].moves_m.map(|largest| largest.max(distance));
            }
            (Some(i), None) => effects[i].moves_m = None,
        }
    }
    effects.sort_by(|a, b| b.moves_m.unwrap_or(f64::MAX).total_cmp(&a.moves_m.unwrap_or(f64::MAX)));
    Ok(Sensitivity { effects, floor_m })
}

/// The unmeasured values, and the values tried instead.
fn open_values(rig: &Rig) -> Vec<Effect> {
    let open = |(key, value): (&'static Key, &Value)| {
        let origin = rig.origin(key);
        let measured = matches!(origin.source, Source::Given | Source::Computed) && origin.range.is_none();
        let (Value::Number(value), Kind::Number { min, max }) = (value, key.kind) else { return None };
        if measured || !rig.uses(key) || !PHYSICAL.contains(&key.table()) {
            return None;
        }
        let ends = origin.range.unwrap_or([value * (1.0 - CHANGE), value * (1.0 + CHANGE)]);
        let ends = ends.map(|end| allowed(rig, key, *value, end.clamp(min, max)));
        (ends != [*value; 2]).then_some(Effect { key, origin, ends, moves_m: Some(0.0) })
    };
    rig.entries().filter_map(open).collect()
}

/// The end of a range, or as far towards it as the other values allow: Coulomb friction is not above stiction.
fn allowed(rig: &Rig, key: &'static Key, value: f64, end: f64) -> f64 {
    let towards = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01].map(|part| value + part * (end - value));
    let allows = |changed: &f64| rig.with_numbers(&[(key.path, *changed)]).is_ok();
    towards.into_iter().find(allows).unwrap_or(value)
}

/// How far the piston is from where it is in the nominal run, at most, m.
fn distance_of(trial: &Trial, nominal: &Run) -> Option<f64> {
    let rig = trial.rig.as_ref().ok()?;
    let run = run(rig, Accuracy::of(rig)).ok()?;
    let rows = run.rows.iter().zip(&nominal.rows);
    Some(rows.map(|(a, b)| (a.plant.position - b.plant.position).abs()).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig(text: &str) -> Rig {
        Rig::read("rig.toml", text).unwrap_or_else(|problems| panic!("{problems}"))
    }

    const OPEN: &str =
        "[controller]\nloop = \"open\"\n[test]\nmoves = [[0.0, 0], [0.05, 1024]]\nduration_s = 0.4\n";

    #[test]
    fn a_wide_range_that_matters_comes_before_a_narrow_one() {
        let rig = rig(&format!(
            "{OPEN}[load]\nmass_kg = {{ unknown = 5.0, low = 1.0, high = 20.0 }}\nviscous_n_s_per_m = {{ typical = 30.0, low = 29.9, high = 30.1 }}\n"
        ));
        let found = sensitivity(&rig, |_, _| {}).expect("it runs");
        let place =
            |path: &str| found.effects.iter().position(|effect| effect.key.path == path).expect("tried");
        assert!(place("load.mass_kg") < place("load.viscous_n_s_per_m"));
    }

    #[test]
    fn what_is_given_is_not_tried() {
        let rig = rig(&format!("{OPEN}[load]\nmass_kg = 5.0\n"));
        let found = sensitivity(&rig, |_, _| {}).expect("it runs");
        assert!(found.effects.iter().all(|effect| effect.key.path != "load.mass_kg"));
        assert!(found.effects.iter().any(|effect| effect.key.path == "load.viscous_n_s_per_m"));
    }

    /// A cylinder that fills without friction: the distance between two runs, sample by sample.
    #[test]
    fn an_effect_is_the_largest_distance_of_either_end() {
        let rig = rig(&format!("{OPEN}[load]\nmass_kg = {{ unknown = 5.0, low = 4.0, high = 5.0 }}\n"));
        let found = sensitivity(&rig, |_, _| {}).expect("it runs");
        let effect = found.effects.iter().find(|effect| effect.key.path == "load.mass_kg").expect("tried");
        let lighter = run(&rig.with_numbers(&[("load.mass_kg", 4.0)]).expect("a rig"), Accuracy::of(&rig))
            .expect("it runs");
        let nominal = run(&rig, Accuracy::of(&rig)).expect("it runs");
        let rows = lighter.rows.iter().zip(&nominal.rows);
        let expected = rows.map(|(a, b)| (a.plant.position - b.plant.position).abs()).fold(0.0, f64::max);
        assert_eq!(effect.moves_m, Some(expected));
        assert!(expected > 1e-4, "{expected}");
    }
}
