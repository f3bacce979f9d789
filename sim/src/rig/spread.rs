//! A rig whose true parameters differ from its file, as a real rig differs from its model.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::check::MOST_DISCHARGE;
use super::keys::{KEYS, Kind};
use super::{Rig, Value};

/// Why a spread was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpreadError {
    /// The fraction is none that can be meant.
    #[error("a spread must lie between 0 and 50 %, is {} %", .0 * 100.0)]
    Fraction(f64),
    /// The rig that was drawn is not valid: the file's values lie too close to a limit.
    #[error("the rig that was drawn is not valid; choose a smaller spread\n{0}")]
    Invalid(#[from] super::Problems),
}

/// ADC noise of a rig with a spread, counts: what a good 12-bit converter shows.
const NOISE_COUNTS: f64 = 1.0;

impl Rig {
    /// The rig with every physical value that is never known exactly drawn evenly from
    /// +-`fraction` around the file's, and with noise on its sensors. Dimensions, the controller and
    /// the test stay as they are. The same seed draws the same rig.
    ///
    /// # Errors
    /// For a fraction outside 0 to 0.5, and when the rig that was drawn is not valid.
    pub fn spread(&self, fraction: f64, seed: u64) -> Result<Rig, SpreadError> {
        if !(0.0..=0.5).contains(&fraction) {
            return Err(SpreadError::Fraction(fraction));
        }
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut rig = self.clone();
        for (index, key) in KEYS.iter().enumerate().filter(|(_, key)| key.spread) {
            let draw = 2.0 * unit_interval(&mut random) - 1.0;
            if let (Some(Value::Number(value)), Kind::Number { min, max }) =
                (&mut rig.values[index], key.kind)
            {
                let most = if key.name().starts_with("discharge") { MOST_DISCHARGE } else { max };
                *value = (*value * (1.0 + fraction * draw)).clamp(min, most);
            }
        }
        rig.keep_coulomb_below_static();
        let noise = Rig::index("sensors.noise_counts");
        rig.values[noise] = Some(Value::Number(self.number("sensors.noise_counts").max(NOISE_COUNTS)));
        Ok(rig.checked("the rig that was drawn")?)
    }

    fn keep_coulomb_below_static(&mut self) {
        for (coulomb, stiction) in [
            ("load.coulomb_extend_n", "load.static_extend_n"),
            ("load.coulomb_retract_n", "load.static_retract_n"),
            ("operator.coulomb_friction_n", "operator.static_friction_n"),
        ] {
            let limited = self.number(coulomb).min(self.number(stiction));
            self.values[Rig::index(coulomb)] = Some(Value::Number(limited));
        }
    }
}

/// An even draw from 0 to 1 with 53 bits.
pub fn unit_interval(random: &mut impl Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}
