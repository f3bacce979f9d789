//! The gain profile of the thesis (6.3.3, Appendix IX): high gains on small errors.
//!
//! ```text
//! i      = min(|n_p| / span, 255)
//! n_DAC1 = Kp[i] n_p - Kv n_v - Ka n_a - k5 n_q + n_f
//! demand = n_DAC1 / scale + null offset                 toward zero
//! ```
//!
//! In the position dead band the demand is the null offset alone.

use core::num::NonZeroU32;

use super::feedback::{Feedback, from_null, sum};
use super::{ControlLaw, LawConfig, Measured, Reference};
use crate::parameters::{PROFILE_LEN, Parameters, id};

/// The profile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// `Kp[i]`; entry i holds for errors from i to i + 1 spans, the last one beyond.
    pub gains: [u16; PROFILE_LEN],
    /// Counts of error that one entry covers.
    pub span: NonZeroU32,
}

impl Settings {
    pub(crate) fn of(parameters: &Parameters) -> Settings {
        let span = parameters.scalar(id::PROFILE_SPAN_COUNTS).unsigned_abs();
        Settings { gains: parameters.gain_profile, span: NonZeroU32::new(span).unwrap_or(NonZeroU32::MIN) }
    }

    /// `Kp[i]` for this error.
    fn gain(&self, error: i32) -> u16 {
        let index = (error.unsigned_abs() / self.span).min(PROFILE_LEN as u32 - 1);
        self.gains[index as usize]
    }

    /// The demand without pressures.
    #[inline(always)]
    pub(crate) fn demand(&self, config: &LawConfig, measured: Measured, reference: Reference) -> i32 {
        from_null(config, sum(config, |error| self.gain(error), measured, reference), measured)
    }
}

/// What it remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GainProfile(Feedback);

impl ControlLaw for GainProfile {
    type Settings = Settings;

    fn demand(
        &mut self,
        config: &LawConfig,
        settings: &Settings,
        measured: Measured,
        reference: Reference,
    ) -> i32 {
        let sum = self.0.damped_sum(config, |error| settings.gain(error), measured, reference);
        from_null(config, sum, measured)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Settings as Chosen;
    use super::*;
    use crate::Config;
    use crate::estimator::Motion;

    /// The thesis's law with its profile changed, from the null of the valve, for a motion and an error.
    fn demand(
        change: impl FnOnce(&mut LawConfig, &mut Settings),
        motion: &Motion,
        reference: Reference,
    ) -> i32 {
        let mut law = Config::default().law;
        let Chosen::GainProfile(mut settings) = law.settings.clone() else { panic!("the thesis's law") };
        change(&mut law, &mut settings);
        let measured = Measured { motion, pressures: [0; 2], spool: 0, learned: 0 };
        GainProfile::default().demand(&law, &settings, measured, reference)
    }

    fn at(error: i32) -> Reference {
        Reference { error, ..Reference::default() }
    }

    /// Two dead bands of a gain (6.3.3): one asks for nothing inside it, the other goes on braking.
    #[test]
    fn a_profile_that_begins_with_zeros_brakes_inside_its_dead_band() {
        let moving = Motion { velocity: 10, ..Motion::default() };
        let by_profile = |error| {
            let zeros = |law: &mut LawConfig, settings: &mut Settings| {
                law.velocity_gain = 512;
                settings.gains[..2].fill(0);
            };
            demand(zeros, &moving, at(error))
        };
        let by_band = |error| {
            let band = |law: &mut LawConfig, _: &mut Settings| (law.velocity_gain, law.dead_band) = (512, 8);
            demand(band, &moving, at(error))
        };
        for error in [-7, 0, 7] {
            assert_eq!((by_profile(error), by_band(error)), (-20, 0), "error {error}");
        }
        assert_eq!((by_profile(8), by_band(8)), (8 * 16 - 20, 8 * 16 - 20));
    }

    #[test]
    fn a_moving_setpoint_asks_for_its_feed_forward_in_the_dead_band_too() {
        let fed_forward = |feed_forward| {
            let reference = Reference { error: 3, feed_forward, point: None };
            demand(|law, _| law.dead_band = 8, &Motion::default(), reference)
        };
        assert_eq!([256 * 50, 0].map(fed_forward), [(3 * 8192 + 256 * 50) / 256, 0]);
    }

    #[test]
    fn the_largest_feed_forward_is_saturated_once_with_the_rest() {
        for (sign, expected) in [(1, i32::MAX), (-1, i32::MIN)] {
            let reference =
                Reference { error: sign as i32 * i32::MAX, feed_forward: sign << 48, point: None };
            let whole = |law: &mut LawConfig, _: &mut Settings| law.scale = NonZeroU32::MIN;
            assert_eq!(demand(whole, &Motion::default(), reference), expected);
        }
    }

    /// (8192 3 - 1000 10) / 256 = 56.9 and (8192 3 + 1000 9) / 256 = 131.2, as -10 / 64 is rounded to -1. In the dead band a law
    /// asks for nothing, whatever the pressures do.
    #[test]
    fn a_rising_pressure_difference_is_subtracted_outside_of_the_dead_band() {
        let law = LawConfig { pressure_gain: 1000, ..Config::default().law };
        let banded = LawConfig { dead_band: 8, ..law.clone() };
        let after_a_step_of = |raw: i16, law: &LawConfig| {
            let Chosen::GainProfile(settings) = &law.settings else { panic!("the thesis's law") };
            let mut profile = GainProfile::default();
            let mut demand = |pressure_1| {
                let measured =
                    Measured { motion: &Motion::default(), pressures: [pressure_1, 0], spool: 0, learned: 0 };
                profile.demand(law, settings, measured, at(3))
            };
            demand(0);
            demand(raw)
        };
        assert_eq!([10, -10].map(|raw| after_a_step_of(raw, &law)), [56, 131]);
        assert_eq!([10, -10].map(|raw| after_a_step_of(raw, &banded)), [0, 0]);
    }
}
