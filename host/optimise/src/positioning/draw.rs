//! The rigs that a drive may turn out to be, and the places of its steps.
//!
//! | drawn | how |
//! |---|---|
//! | mass, all friction | +-30 %, evenly |
//! | supply pressure | +-5 %, evenly |
//! | place and direction of a step | evenly along the stroke, either way |
//! | with bristles | the LuGre model instead of dry friction |
//! | over the whole range | each value that the rig file gives as unknown, or as computed within a range: evenly in its logarithm, or in itself where the range begins at 0 |
//!
//! Three kinds of values hang together. The running friction is drawn once, and that of each direction within 10 % of it; the
//! break-away friction is 1.25 to 3.3 times the running one, as `rig new` assumes. Its damping ratio stays with the stiffness
//! of a spool. Mass and supply stay within their tolerances: they are known.

use anyhow::{Result, bail};
use pneudrive_sim::rig::{Key, Problems, Source, unit_interval};
use pneudrive_sim::{Rig, keys};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::tuning::spread::{Relative, Variant, fresh};

/// By how much load, friction and supply differ.
pub const TOLERANCE: Relative = Relative { load: 0.3, friction: 0.3, supply: 0.05, valve: 0.0 };

/// The noise on the converters of the sensors, counts.
const NOISE_COUNTS: f64 = 1.0;

/// How far the friction of a direction is from that of both, and break-away over running friction.
const EITHER_WAY: [f64; 2] = [0.9, 1.1];
const BREAKAWAY: [f64; 2] = [1.25, 3.3];

/// The running and the break-away friction of each direction.
const FRICTION: [[&str; 2]; 2] = [
    [keys::friction::COULOMB_EXTEND_N.key.path, keys::friction::STATIC_EXTEND_N.key.path],
    [keys::friction::COULOMB_RETRACT_N.key.path, keys::friction::STATIC_RETRACT_N.key.path],
];

/// Random numbers of the values that a file leaves open; those of load, friction, supply and place have streams of their own.
const OPEN: u64 = 2;

/// What is drawn besides load, friction and supply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spread {
    /// All that the rig file leaves open, over its whole range.
    pub whole_range: bool,
    /// The friction is that of bristles (LuGre).
    pub bristles: bool,
}

/// A rig that a drive may turn out to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// Load, friction and supply as factors on the file's values.
    pub variant: Variant,
    /// Values that the file leaves open, each with its key.
    pub open: Vec<(&'static str, f64)>,
    /// Whether the friction is that of bristles.
    pub bristles: bool,
}

/// The place of a step: where it lies in the range of the drive, from 0 to 1, and whether it extends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// 0 at the retracted end, 1 at the extended one.
    pub along: f64,
    /// Whether the first step extends.
    pub extends: bool,
}

/// The draws of a seed. More draws begin with the fewer ones.
///
/// # Errors
/// When the whole range is asked for, and the rig file leaves nothing open.
pub fn draws(rig: &Rig, spread: Spread, seed: u64, count: usize) -> Result<Vec<Draw>> {
    let ranges = if spread.whole_range { open(rig) } else { Vec::new() };
    if spread.whole_range && ranges.is_empty() {
        bail!(
            "{} gives no value as unknown, or as computed within a range: nothing is open that could be drawn",
            rig.name()
        );
    }
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(OPEN);
    let mut share = || unit_interval(&mut random);
    let draw = |variant| Draw { variant, open: values(rig, &ranges, &mut share), bristles: spread.bristles };
    Ok(fresh(&TOLERANCE, seed, count).into_iter().map(draw).collect())
}

/// Where the steps of the draws of a seed lie.
#[must_use]
pub fn places(seed: u64, count: usize) -> Vec<Place> {
    let place = |variant: Variant| Place { along: variant.place, extends: variant.extends };
    fresh(&TOLERANCE, seed, count).into_iter().map(place).collect()
}

impl Draw {
    /// This rig, around that of the file.
    ///
    /// # Errors
    /// When it is not valid: the file's values lie too close to a limit.
    pub fn rig(&self, file: &Rig) -> Result<Rig, Problems> {
        let mut settings = self.variant.settings(file);
        settings.extend(self.open.iter().map(|(key, value)| format!("{key}={value:?}")));
        let noise = file.get(&keys::sensors::NOISE_COUNTS).max(NOISE_COUNTS);
        settings.push(format!("{}={noise:?}", keys::sensors::NOISE_COUNTS.path));
        if self.bristles {
            settings.push(format!("{}=lugre", keys::friction::FRICTION.path));
        }
        file.with_plant(&settings)
    }
}

/// The keys that a rig file leaves open, with their ranges.
fn open(rig: &Rig) -> Vec<(&'static Key, [f64; 2])> {
    let known = [keys::load::MASS_KG.path, keys::supply::PRESSURE_PA.path];
    let range = |key: &'static Key| {
        let origin = rig.origin(key);
        let is_open = matches!(origin.source, Source::Unknown | Source::Computed)
            && rig.uses(key)
            && key.table() != "test"
            && !known.contains(&key.path);
        origin.range.filter(|_| is_open).map(|range| (key, range))
    };
    rig.entries().filter_map(|(key, _)| range(key)).collect()
}

/// A value for each open key.
fn values(
    rig: &Rig,
    open: &[(&'static Key, [f64; 2])],
    share: &mut impl FnMut() -> f64,
) -> Vec<(&'static str, f64)> {
    let mut values = Vec::new();
    for (key, range) in open {
        let value = between(*range, share());
        if key.path == FRICTION[0][0] {
            values.extend(friction(value, share));
        } else if key.path == keys::empirical::STIFFNESS_PER_MASS_PER_S2.path {
            let damping = &keys::empirical::DAMPING_PER_S;
            values.push((
                damping.path,
                rig.get(damping) * (value / rig.number_at(key.path).unwrap_or(value)).sqrt(),
            ));
            values.push((key.path, value));
        } else if !FRICTION.iter().flatten().any(|path| *path == key.path) {
            values.push((key.path, value));
        }
    }
    values
}

/// Running and break-away friction of both directions.
fn friction(running: f64, share: &mut impl FnMut() -> f64) -> [(&'static str, f64); 4] {
    let ratio = between(BREAKAWAY, share());
    let [[extend, breaks_out], [retract, breaks_in]] = FRICTION;
    let [out, back] = [(); 2].map(|()| running * evenly(EITHER_WAY, share()));
    [(extend, out), (breaks_out, out * ratio), (retract, back), (breaks_in, back * ratio)]
}

/// A value of a range; evenly in its logarithm if that exists.
fn between([low, high]: [f64; 2], share: f64) -> f64 {
    if low > 0.0 { low * libm::pow(high / low, share) } else { evenly([low, high], share) }
}

fn evenly([low, high]: [f64; 2], share: f64) -> f64 {
    low + (high - low) * share
}
