//! Which imperfection of the rig limits the result: the search continues, each time on a rig without one of them.

use anyhow::Result;
use pneudrive_sim::Rig;
use pneudrive_sim::component::{encoder, operator};
use pneudrive_sim::keys;

use super::drive::{Meter, Stage, TunedDrive};
use super::search::Budget;
use super::spread::FRICTION;
use super::{Found, Task, Variant};

/// The search on each of them continues from the better half of the last generation, for a third of the time.
#[must_use]
pub fn budget(of_search: &Budget) -> Budget {
    Budget {
        population: of_search.population.div_ceil(2).max(2),
        generations: of_search.generations.div_ceil(3),
        ..*of_search
    }
}

/// The best gains on the rig without each of its imperfections.
///
/// # Errors
/// When there is no such rig.
pub(super) fn search(
    task: &Task,
    drive: &TunedDrive<'_>,
    start: &[Vec<f64>],
    [tuned_on, fresh]: [&[Variant]; 2],
    meter: &mut Meter,
) -> Result<Vec<LimitingImperfection>> {
    let (suspects, budget) = (suspects(&drive.trial.rig), budget(&task.budget));
    let each = budget.runs(tuned_on.len()) + tuned_on.len() + fresh.len();
    meter.begin(Stage::Obstacles, suspects.len() * each);
    let found = |suspect: Suspect| {
        let without = TunedDrive::of(task, &suspect.settings, drive.with)?;
        let outcome = without.search(&budget, start, tuned_on, meter);
        let settings = without.space.settings(&outcome.population[0]);
        let places = without.space.places(&outcome.population[0]);
        let tuned_on = without.judged(&settings, tuned_on, meter);
        let fresh = without.judged(&settings, fresh, meter);
        Ok(LimitingImperfection {
            suspect,
            found: Found { settings, places, tuned_on, members: Vec::new(), fresh },
        })
    };
    suspects.into_iter().map(found).collect()
}

/// An imperfection, and the keys of a rig without it.
#[derive(Clone, Debug, PartialEq)]
pub struct Suspect {
    /// The removed imperfection.
    pub what: &'static str,
    /// The settings that remove it, as `key=value`.
    pub settings: Vec<String>,
}

/// A suspect, and the best gains without it.
#[derive(Clone, Debug)]
pub struct LimitingImperfection {
    /// The suspect.
    pub suspect: Suspect,
    /// The trials on the variants of a rig without it.
    pub found: Found,
}

/// The possible causes on a rig.
#[must_use]
pub(crate) fn suspects(rig: &Rig) -> Vec<Suspect> {
    [of_operator(rig), of_valve(rig), of_load(rig), of_sampling(rig)].concat()
}

fn suspect(what: &'static str, settings: Vec<String>) -> Suspect {
    Suspect { what, settings }
}

fn set(key: &str, value: f64) -> String {
    format!("{key}={value:?}")
}

/// A key with a multiple of its value in the rig.
fn times(rig: &Rig, key: &str, factor: f64) -> String {
    set(key, factor * rig.number_at(key).unwrap_or(0.0))
}

fn of_operator(rig: &Rig) -> Vec<Suspect> {
    let mut all = Vec::new();
    let model = rig.get(&keys::operator::MODEL);
    let solenoid = model == operator::OperatorKind::Solenoid;
    if solenoid && rig.get(&keys::solenoid::STATIC_FRICTION_N) > 0.0 {
        let friction = [keys::solenoid::COULOMB_FRICTION_N.path, keys::solenoid::STATIC_FRICTION_N.path];
        all.push(suspect("no friction on the spool", friction.map(|key| set(key, 0.0)).to_vec()));
    }
    if solenoid && rig.get(&keys::hysteresis::HYSTERESIS_PERCENT) > 0.0 {
        let hysteresis = set(keys::hysteresis::HYSTERESIS_PERCENT.path, 0.0);
        all.push(suspect("no magnetic hysteresis in the operator", vec![hysteresis]));
    }
    if solenoid {
        let [mass, damping] =
            [(keys::solenoid::SPOOL_MASS_KG.path, 0.25), (keys::solenoid::DAMPING_N_S_PER_M.path, 0.5)]
                .map(|(key, factor)| times(rig, key, factor));
        all.push(suspect("an operator twice as fast", vec![mass, damping]));
    }
    if model == operator::OperatorKind::Stepper {
        let length = times(rig, keys::stepper::MM_PER_STEP.path, 0.25);
        let steps = keys::stepper::MAX_STEPS.setting(4 * rig.get(&keys::stepper::MAX_STEPS));
        all.push(suspect("spool steps a quarter as long", vec![length, steps]));
    }
    all
}

fn of_valve(rig: &Rig) -> Vec<Suspect> {
    let overlaps = rig.get(&keys::valve::UNDERLAP_MM) > 0.0;
    let without = || suspect("a valve without overlap", vec![set(keys::valve::UNDERLAP_MM.path, 0.0)]);
    overlaps.then(without).into_iter().collect()
}

fn of_load(rig: &Rig) -> Vec<Suspect> {
    let no_stiction = vec![
        set(keys::friction::STATIC_EXTEND_N.path, rig.get(&keys::friction::COULOMB_EXTEND_N)),
        set(keys::friction::STATIC_RETRACT_N.path, rig.get(&keys::friction::COULOMB_RETRACT_N)),
    ];
    let no_friction = FRICTION[..4].iter().rev().map(|key| set(key, 0.0)).collect();
    vec![
        suspect("static friction of the load no larger than its Coulomb friction", no_stiction),
        suspect("no dry friction of the load", no_friction),
    ]
}

fn of_sampling(rig: &Rig) -> Vec<Suspect> {
    let periods =
        [keys::controller::DELAY_S.path, keys::controller::PERIOD_S.path].map(|key| times(rig, key, 0.25));
    let finer = finer_encoder(rig).map(|settings| suspect("an encoder four times as fine", settings));
    finer.into_iter().chain([suspect("four times as many samples", periods.to_vec())]).collect()
}

/// The keys of an encoder four times as fine; None where its word would have more bits than there are.
fn finer_encoder(rig: &Rig) -> Option<Vec<String>> {
    let bits = encoder::bits(rig) + 2;
    let wider = (bits <= encoder::MAX_BITS).then(|| keys::encoder::BITS.setting(bits));
    let shorter = times(rig, keys::encoder::MM_PER_COUNT.path, 0.25);
    match rig.get(&keys::encoder::MODEL) {
        encoder::EncoderKind::Quadrature => Some(vec![shorter]),
        encoder::EncoderKind::Potentiometer => Some(vec![wider?]),
        encoder::EncoderKind::Ssi => Some(vec![shorter, wider?]),
    }
}
