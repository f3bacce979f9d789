//! Rigs drawn at random, that nobody tuned anything to: built-in ones with their physical values, dimensions of the
//! test, gains and models drawn.

use pneudrive_sim::Rig;
use pneudrive_sim::keys;
use pneudrive_sim::rig::unit_interval;
use pneudrive_sim::rigfile::{BUILTIN, builtin};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// A rig and what was drawn.
pub struct Drawn {
    pub name: String,
    pub rig: Rig,
}

/// Settings that exchange a model, or nothing.
const MODELS: [&[&str]; 6] = [
    &["valve.model=multiple-flow-node"],
    &["valve.model=single-restriction"],
    &["tubing.model=analytical"],
    &["tubing.lag_s=0.002"],
    &["actuator.model=symmetric"],
    &["operator.dither_mm=0"],
];

/// Two steps of a closed loop from anywhere to anywhere in the inner 70 % of the stroke.
pub fn closed_loop(seed: u64) -> Drawn {
    // A draw that is refused is drawn again.
    (0..20).find_map(|again| drawn(seed + 1_000_000 * again)).expect("most draws are valid rigs")
}

/// Rigs that were added later: they would change all draws, and with them the figures of docs/explanation/agreement.md.
const LATER: [&str; 2] = ["servo-b-thesis", "press"];

fn drawn(seed: u64) -> Option<Drawn> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || unit_interval(&mut random);
    let rigs: Vec<&str> =
        BUILTIN.iter().map(|(name, _)| *name).filter(|name| !LATER.contains(name)).collect();
    let name = rigs[(draw() * rigs.len() as f64) as usize];
    let text = builtin(name)?;
    let base = Rig::read(name, text).ok()?;
    let (stroke, pulse) =
        (base.get(&keys::actuator::STROKE_M), base.get(&keys::encoder::MM_PER_COUNT) * 1e-3);
    let [start, there, back] = [(); 3].map(|()| stroke * (0.15 + 0.7 * draw()));
    let counts = |place: f64| (place / pulse) as i64;
    let mut settings = vec![
        "controller.loop=closed".to_owned(),
        format!("test.position_m={start:?}"),
        format!("test.moves=[[0.0, {}], [0.1, {}], [1.1, {}]]", counts(start), counts(there), counts(back)),
        "test.duration_s=2.1".to_owned(),
    ];
    for gain in ["velocity_gain", "acceleration_gain"] {
        let drawn = (3000.0 * draw() * draw()) as i64;
        if draw() < 0.5 {
            settings.push(format!("controller.{gain}={drawn}"));
        }
    }
    for model in MODELS {
        if draw() < 0.15 {
            settings.extend(model.iter().map(|setting| (*setting).to_owned()));
        }
    }
    let rig = Rig::read_with(name, text, &settings).ok()?.spread(0.3, seed).ok()?;
    let rig = rig.with_numbers(&[("sensors.noise_counts", 0.0)]).ok()?;
    Some(Drawn { name: format!("draw {seed}, {name} with {}", settings.join(" ")), rig })
}
