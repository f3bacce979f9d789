//! PI-D on the position: a proportional and an integral part of the error, and a derivative of what is measured alone, so that a
//! jump of the setpoint is no kick. The integrator has anti-windup by clamping.
//!
//! ```text
//! n[k]   = Kp n_p - Kv n_v - Ka n_a - k5 n_q + n_f          (the sum that laws share; Ka = 0 is PI-D)
//! I[k]   = clamp(I[k-1] + Ki n_p[k], +-2^8 min(scale largest, 2^31 - 1))   in 256ths of n
//! demand = (n[k] + I[k] / 2^8) / scale + null offset        toward zero
//! ```
//!
//! I stays as it is
//!
//! - while the demand is beyond the largest command in the direction of the error (the integrator is clamped),
//! - while the error is beyond the integral band, if there is one, and
//! - inside the position dead band, where the demand is that of I alone: friction would make it hunt.
//!
//! | quantity | format | range |
//! |---|---|---|
//! | Kp, Kv, Ka, k5 | whole numbers | 16 bits |
//! | Ki | 256ths a sample (Q8) | 16 bits; integral time `256 Kp T / Ki`: at Kp = 1000 and 1.3 ms, Ki = 665 is 0.5 s |
//! | n_p | counts | 32 bits |
//! | I | 256ths of n (Q8), exact in `i64` | 2^39 |
//! | n + I / 2^8 | exact in `i64` | saturated once to 32 bits |

use super::feedback::{Feedback, scaled};
use super::{ControlLaw, LawConfig, Measured, Reference};
use crate::parameters::{Parameters, id};

/// 1 of the law's sum in the integrator.
const ONE: i64 = 256;

/// Its gains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Kp.
    pub gain: u16,
    /// Ki, 256ths a sample.
    pub integral_gain: u16,
    /// Errors above this are not integrated, counts; 0: all are.
    pub integral_band: u32,
}

impl Settings {
    pub(crate) fn of(parameters: &Parameters) -> Settings {
        Settings {
            gain: parameters.scalar(id::PROPORTIONAL_GAIN) as u16,
            integral_gain: parameters.scalar(id::INTEGRAL_GAIN) as u16,
            integral_band: parameters.scalar(id::INTEGRAL_BAND_COUNTS).unsigned_abs(),
        }
    }
}

/// What it remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pid {
    feedback: Feedback,
    integral: i64,
}

impl Pid {
    /// I, in 256ths of the law's sum.
    #[must_use]
    pub fn integral(&self) -> i64 {
        self.integral
    }

    /// I after a sample with this error.
    fn integrated(&self, config: &LawConfig, settings: &Settings, error: i32) -> i64 {
        // n is saturated to 32 bits: more could not be commanded, and would only have to unwind.
        let end = ONE * (i64::from(config.scale.get()) * i64::from(config.largest)).min(i64::from(i32::MAX));
        let next = self.integral + i64::from(settings.integral_gain) * i64::from(error);
        next.min(end).max(-end)
    }
}

impl ControlLaw for Pid {
    type Settings = Settings;

    #[inline(never)]
    fn demand(
        &mut self,
        config: &LawConfig,
        settings: &Settings,
        measured: Measured,
        reference: Reference,
    ) -> i32 {
        let sum = self.feedback.damped_sum(config, |_| settings.gain, measured, reference);
        let demand = |integral: i64| {
            scaled(config, sum.unwrap_or(0) + integral / ONE).saturating_add(measured.null(config))
        };
        let is_near = settings.integral_band == 0 || reference.error.unsigned_abs() <= settings.integral_band;
        if sum.is_some() && is_near {
            let next = self.integrated(config, settings, reference.error);
            let asked = demand(next);
            let winds_up = asked.unsigned_abs() > u32::from(config.largest.unsigned_abs())
                && asked.signum() == reference.error.signum();
            self.integral = if winds_up { self.integral } else { next };
        }
        demand(self.integral)
    }
}
