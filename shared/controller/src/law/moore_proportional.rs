//! Moore's proportional law (L(22) = 13; the thesis has no equation of it): the proportional law, and in the direction of the
//! error the command that takes the spool across the dead zone of the valve.
//!
//! ```text
//! demand = (Kp n_p - Kv n_v - Ka n_a - k5 n_q + n_f) / scale + sign(n_p) dead zone + null offset
//! ```
//!
//! The profile's high gains on small errors, "based on the findings of Moore" (Appendix IX), do the same.

use super::feedback::{Feedback, scaled};
use super::{ControlLaw, LawConfig, Measured, Reference};
use crate::parameters::{Parameters, id};

/// Its gain and its step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Kp.
    pub gain: u16,
    /// The command that takes the spool across the dead zone, counts.
    pub dead_zone: u16,
}

impl Settings {
    pub(crate) fn of(parameters: &Parameters) -> Settings {
        Settings {
            gain: parameters.scalar(id::PROPORTIONAL_GAIN) as u16,
            dead_zone: parameters.scalar(id::DEAD_ZONE_COUNTS) as u16,
        }
    }
}

/// What it remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MooreProportional(Feedback);

impl ControlLaw for MooreProportional {
    type Settings = Settings;

    fn demand(
        &mut self,
        config: &LawConfig,
        settings: &Settings,
        measured: Measured,
        reference: Reference,
    ) -> i32 {
        let across = reference.error.signum() * i32::from(settings.dead_zone);
        let sum = self.0.damped_sum(config, |_| settings.gain, measured, reference);
        sum.map_or(0, |sum| scaled(config, sum).saturating_add(across)).saturating_add(measured.null(config))
    }
}
