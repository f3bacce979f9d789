//! The rigs that a drive may turn out to be: corners of the stated spread, and draws within it.

use pneudrive_sim::Rig;
use pneudrive_sim::rig::unit_interval;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// By how much a rig may differ, as a fraction of what its file says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relative {
    /// The mass.
    pub load: f64,
    /// All friction of the load.
    pub friction: f64,
    /// The supply pressure.
    pub supply: f64,
}

/// Draws within the spread that gains are judged on beside its corners.
const DRAWS: usize = 16;

/// A rig of the spread: factors on what the file says.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// On the mass.
    pub load: f64,
    /// On all friction of the load.
    pub friction: f64,
    /// On the supply pressure.
    pub supply: f64,
}

/// What is friction of the load.
pub(super) const FRICTION: [&str; 5] = [
    "load.static_extend_n",
    "load.coulomb_extend_n",
    "load.static_retract_n",
    "load.coulomb_retract_n",
    "load.viscous_n_s_per_m",
];

impl Variant {
    /// The rig of the file.
    pub const NOMINAL: Variant = Variant { load: 1.0, friction: 1.0, supply: 1.0 };

    /// What it makes of a rig, as `key=value`.
    #[must_use]
    pub fn settings(&self, rig: &Rig) -> Vec<String> {
        let factors = [("load.mass_kg", self.load), ("supply.pressure_pa", self.supply)];
        let friction = FRICTION.map(|key| (key, self.friction));
        let scaled = factors.into_iter().chain(friction).filter(|(_, factor)| *factor != 1.0);
        scaled.map(|(key, factor)| format!("{key}={:?}", factor * rig.number(key))).collect()
    }

    /// In words.
    #[must_use]
    pub fn name(&self) -> String {
        let percent = |what: &str, factor: f64| {
            (factor != 1.0).then(|| format!("{what} {:+.0} %", 100.0 * (factor - 1.0)))
        };
        let parts =
            [percent("load", self.load), percent("friction", self.friction), percent("supply", self.supply)];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { "as in the file".to_owned() } else { parts.join(", ") }
    }
}

/// The rig of the file, and every combination of the ends of the spread.
#[must_use]
pub fn corners(spread: &Relative) -> Vec<Variant> {
    let ends = |by: f64| if by == 0.0 { vec![1.0] } else { vec![1.0 - by, 1.0 + by] };
    let mut all = vec![Variant::NOMINAL];
    for &load in &ends(spread.load) {
        for &friction in &ends(spread.friction) {
            for &supply in &ends(spread.supply) {
                all.push(Variant { load, friction, supply });
            }
        }
    }
    all.dedup();
    all
}

/// The corners, and draws between them.
#[must_use]
pub fn all(spread: &Relative, seed: u64) -> Vec<Variant> {
    let mut all = corners(spread);
    if all.len() > 1 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = |by: f64| 1.0 + by * (2.0 * unit_interval(&mut random) - 1.0);
        all.extend((0..DRAWS).map(|_| Variant {
            load: draw(spread.load),
            friction: draw(spread.friction),
            supply: draw(spread.supply),
        }));
    }
    all
}
