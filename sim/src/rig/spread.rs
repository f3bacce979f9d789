//! A rig whose true parameters differ from its file, as a real rig differs from its model.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::table::all_keys;
use crate::component::valve::MAX_DISCHARGE;
use crate::key::{Key, Kind};
use crate::keys;
use crate::random::unit_interval;
use crate::values::{Rig, Value};

/// Why a spread was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpreadError {
    /// The fraction is out of range.
    #[error("a spread must lie between 0 and 50 %, is {} %", .0 * 100.0)]
    Fraction(f64),
    /// The rig that was drawn is not valid: the file's values lie too close to a limit.
    #[error("the rig that was drawn is not valid; choose a smaller spread\n{0}")]
    Invalid(#[from] super::Problems),
}

/// ADC noise of a rig with a spread, counts: as in a good 12-bit converter.
const NOISE_COUNTS: f64 = 1.0;

impl Rig {
    /// The rig with every physical value that is never known exactly drawn evenly from
    /// +-`fraction` around the file's, and with noise on its sensors. Dimensions, the test and the
    /// controller, whatever it knows of the drive, stay as they are. The same seed draws the same rig.
    ///
    /// # Errors
    /// For a fraction outside 0 to 0.5, and when the rig that was drawn is not valid.
    pub fn spread(&self, fraction: f64, seed: u64) -> Result<Rig, SpreadError> {
        if !(0.0..=0.5).contains(&fraction) {
            return Err(SpreadError::Fraction(fraction));
        }
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut rig = self.clone();
        for key in self.uncertain() {
            let draw = 2.0 * unit_interval(&mut random) - 1.0;
            if let (Some(Value::Number(value)), Kind::Number { min, max }) =
                (rig.values.get_mut(key.path), key.kind)
            {
                let max = if key.name().starts_with("discharge") { MAX_DISCHARGE } else { max };
                *value = (*value * (1.0 + fraction * draw)).clamp(min, max);
            }
        }
        rig.keep_coulomb_below_static();
        let noise = &keys::sensors::NOISE_COUNTS;
        rig.put(noise.path, Some(Value::Number(self.get(noise).max(NOISE_COUNTS))));
        rig.keep_nominal_of(self);
        Ok(rig.checked("the rig that was drawn")?)
    }

    /// The keys that are drawn, in order. Those that belong to a choice besides the model of their table come last, and
    /// only where it is made: a model that is added changes no draw of the others.
    fn uncertain(&self) -> impl Iterator<Item = &'static Key> {
        let spread = |of_choice: bool| {
            all_keys().filter(move |key| key.spread && key.chosen_by.is_some() == of_choice)
        };
        spread(false).chain(spread(true).filter(|key| self.uses(key)))
    }

    fn keep_coulomb_below_static(&mut self) {
        for (coulomb, stiction) in [
            (&keys::friction::COULOMB_EXTEND_N, &keys::friction::STATIC_EXTEND_N),
            (&keys::friction::COULOMB_RETRACT_N, &keys::friction::STATIC_RETRACT_N),
            (&keys::solenoid::COULOMB_FRICTION_N, &keys::solenoid::STATIC_FRICTION_N),
        ] {
            let limited = self.get(coulomb).min(self.get(stiction));
            self.put(coulomb.path, Some(Value::Number(limited)));
        }
    }
}
