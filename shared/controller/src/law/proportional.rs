//! The proportional law (thesis C(21)): that of the gain profile with one gain.
//!
//! ```text
//! demand = (Kp n_p - Kv n_v - Ka n_a - k5 n_q + n_f) / scale + null offset          toward zero
//! ```

use super::feedback::{Feedback, from_null};
use super::{ControlLaw, LawConfig, Measured, Reference};
use crate::parameters::{Parameters, id};

/// Its gain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Kp.
    pub gain: u16,
}

impl Settings {
    pub(crate) fn of(parameters: &Parameters) -> Settings {
        Settings { gain: parameters.scalar(id::PROPORTIONAL_GAIN) as u16 }
    }
}

/// What it remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Proportional(Feedback);

impl ControlLaw for Proportional {
    type Settings = Settings;

    fn demand(
        &mut self,
        config: &LawConfig,
        settings: &Settings,
        measured: Measured,
        reference: Reference,
    ) -> i32 {
        let sum = self.0.damped_sum(config, |_| settings.gain, measured, reference);
        from_null(config, sum, measured)
    }
}
