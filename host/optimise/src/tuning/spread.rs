//! The spread of a drive: the rigs that it may turn out to be, and the positions and directions of its steps.
//!
//! Gains are tuned on some draws from the stated spread, and judged on others that no search has seen.

use anyhow::{Result, ensure};
use pneudrive_sim::Rig;
use pneudrive_sim::keys;
use pneudrive_sim::rig::unit_interval;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Largest deviation of a rig from its file, as a fraction of the file's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relative {
    /// Of the mass.
    pub load: f64,
    /// Of all friction of the load.
    pub friction: f64,
    /// Of the supply pressure.
    pub supply: f64,
    /// Of the conductances of the valve.
    pub valve: f64,
}

/// A rig of the spread, as factors on the file's values, and its step.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Factor on the mass.
    pub load: f64,
    /// Factor on all friction of the load.
    pub friction: f64,
    /// Factor on the supply pressure.
    pub supply: f64,
    /// Factor on the conductances of the valve.
    pub valve: f64,
    /// Where the step lies in the range of the drive: 0 at its retracted end, 1 at its extended end.
    pub place: f64,
    /// Whether the step extends; then it retracts again. False: the other way round.
    pub extends: bool,
}

/// The keys of the load's friction.
pub(super) const FRICTION: [&str; 5] = [
    keys::friction::STATIC_EXTEND_N.key.path,
    keys::friction::COULOMB_EXTEND_N.key.path,
    keys::friction::STATIC_RETRACT_N.key.path,
    keys::friction::COULOMB_RETRACT_N.key.path,
    keys::load::VISCOUS_N_S_PER_M.key.path,
];

/// The keys of the load, and of the supply.
const LOAD: [&str; 1] = [keys::load::MASS_KG.key.path];
const SUPPLY: [&str; 1] = [keys::supply::PRESSURE_PA.key.path];

/// The conductances of a valve.
const VALVE: [&str; 2] = [
    keys::iso6358::SONIC_CONDUCTANCE_M3_PER_S_PA.key.path,
    keys::iso6358::EXHAUST_SONIC_CONDUCTANCE_M3_PER_S_PA.key.path,
];

/// Streams of random numbers: for the draws that gains are tuned on, and for those that they are judged on.
const TUNED_ON: u64 = 0;
const FRESH: u64 = 1;
/// Streams for the valve: the other values are then the same where the valve is known.
const VALVE_TUNED_ON: u64 = 3;
const VALVE_FRESH: u64 = 4;

impl Relative {
    /// Whether a rig has every value that is drawn.
    ///
    /// # Errors
    /// The drawn values that a rig lacks.
    pub fn check(&self, rig: &Rig) -> Result<()> {
        let has_valve = VALVE.iter().any(|key| rig.number_at(key).is_some());
        ensure!(
            self.valve == 0.0 || has_valve,
            "the valve of {} has no conductance to draw: its model takes other figures; leave out --valve",
            rig.name()
        );
        Ok(())
    }

    /// The keys that it draws.
    pub fn keys(&self) -> impl Iterator<Item = &'static str> {
        let drawn = |by: f64, keys: &'static [&'static str]| if by > 0.0 { keys } else { &[] };
        let load = drawn(self.load, &LOAD);
        let supply = drawn(self.supply, &SUPPLY);
        let valve = drawn(self.valve, &VALVE);
        load.iter().chain(drawn(self.friction, &FRICTION)).chain(supply).chain(valve).copied()
    }
}

impl Variant {
    /// The rig of the file, extending about the middle.
    pub const NOMINAL: Variant =
        Variant { load: 1.0, friction: 1.0, supply: 1.0, valve: 1.0, place: 0.5, extends: true };

    /// Its settings for a rig, as `key=value`; without the step.
    #[must_use]
    pub fn settings(&self, rig: &Rig) -> Vec<String> {
        let [load, supply] = [LOAD.map(|key| (key, self.load)), SUPPLY.map(|key| (key, self.supply))];
        let friction = FRICTION.map(|key| (key, self.friction));
        let valve = VALVE.map(|key| (key, self.valve));
        let all = load.into_iter().chain(supply).chain(friction).chain(valve);
        let scaled = all.filter(|(_, factor)| *factor != 1.0);
        // A value that the rig does not have follows another one.
        let set = |(key, factor): (&str, f64)| Some(format!("{key}={:?}", factor * rig.number_at(key)?));
        scaled.filter_map(set).collect()
    }

    /// The rig in words.
    #[must_use]
    pub fn name(&self) -> String {
        let percent = |what: &str, factor: f64| {
            (factor != 1.0).then(|| format!("{what} {:+.0} %", 100.0 * (factor - 1.0)))
        };
        let parts = [
            percent("load", self.load),
            percent("friction", self.friction),
            percent("supply", self.supply),
            percent("valve", self.valve),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { "as in the file".to_owned() } else { parts.join(", ") }
    }
}

/// Draws that gains are tuned on, beside the rig of the file.
const DRAWS: usize = 20;

/// The rigs for the search: the step of the file's rig in mid-stroke, and a Latin hypercube of draws from the whole
/// spread and of places, in alternating directions. Corners alone would be a different drive from the one that the
/// gains are judged on: they are its rarest and worst.
#[must_use]
pub(crate) fn tuned_on(spread: &Relative, seed: u64) -> Vec<Variant> {
    let mut random = stream(seed, TUNED_ON);
    let mut share = || unit_interval(&mut random);
    let [load, friction, supply, place] = [(); 4].map(|()| strata(DRAWS, &mut share));
    let mut of_valve = stream(seed, VALVE_TUNED_ON);
    let valve = strata(DRAWS, &mut || unit_interval(&mut of_valve));
    let one = |n: usize| Variant {
        load: factor(spread.load, load[n]),
        friction: factor(spread.friction, friction[n]),
        supply: factor(spread.supply, supply[n]),
        valve: factor(spread.valve, valve[n]),
        place: place[n],
        extends: n.is_multiple_of(2),
    };
    std::iter::once(Variant::NOMINAL).chain((0..DRAWS).map(one)).collect()
}

/// A share from each `count`th of 0 to 1, shuffled (Fisher and Yates).
fn strata(count: usize, share: &mut impl FnMut() -> f64) -> Vec<f64> {
    let mut all: Vec<f64> = (0..count).map(|n| (n as f64 + share()) / count as f64).collect();
    for last in (1..count).rev() {
        all.swap(last, ((share() * (last + 1) as f64) as usize).min(last));
    }
    all
}

fn factor(by: f64, share: f64) -> f64 {
    1.0 + by * (2.0 * share - 1.0)
}

/// The rigs for the judgement: draws from the whole spread, and of place and direction.
#[must_use]
pub fn fresh(spread: &Relative, seed: u64, count: usize) -> Vec<Variant> {
    let mut random = stream(seed, FRESH);
    let mut share = || unit_interval(&mut random);
    let mut of_valve = stream(seed, VALVE_FRESH);
    let one = |_| Variant {
        load: factor(spread.load, share()),
        friction: factor(spread.friction, share()),
        supply: factor(spread.supply, share()),
        valve: factor(spread.valve, unit_interval(&mut of_valve)),
        place: share(),
        extends: share() < 0.5,
    };
    (0..count).map(one).collect()
}

fn stream(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream);
    random
}
