//! The control law (thesis 6.3.3, Appendix IX): error, velocity and acceleration to a demand.
//!
//! ```text
//! n_p    = setpoint - position
//! i      = min(|n_p| / span, 255)                       gain-profile index (Appendix IX a)
//! n_DAC1 = Kp[i] n_p - Kv n_v - Ka n_a                  exact in i64, saturated once to i32
//! demand = n_DAC1 / scale + null offset                 toward zero
//! ```
//!
//! The proportional law is the same with one gain. Inside the position dead band the demand is the
//! null offset alone; inside the velocity dead band n_v counts as 0. Open loop: the demand is the
//! setpoint.

use core::num::NonZeroU32;

use crate::estimator::Motion;
use crate::fixed::{divide_toward_zero, saturate};

/// Entries of the gain profile (thesis 6.3.3).
pub const PROFILE_LEN: usize = 256;

/// Where the command comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// The law closes the loop over the encoder.
    Closed,
    /// Moves are commands; nothing is fed back (thesis L(3) = 0).
    Open,
}

/// How the position error is weighed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawKind {
    /// A gain per range of error (Appendix IX).
    GainProfile,
    /// One gain (thesis C(21)).
    Proportional,
}

/// The law's constants. Gains are plain numbers; `scale` makes the demand valve counts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LawConfig {
    /// Open or closed loop.
    pub control_loop: Loop,
    /// Which gain is used on the error.
    pub kind: LawKind,
    /// `Kp[i]`; entry i holds for errors from i to i + 1 spans, the last one beyond.
    pub gain_profile: [u16; PROFILE_LEN],
    /// Counts of error that one profile entry covers.
    pub profile_span: NonZeroU32,
    /// Kp of the proportional law.
    pub proportional_gain: u16,
    /// Kv, on counts per velocity window.
    pub velocity_gain: u16,
    /// Ka, on counts per velocity window per acceleration window.
    pub acceleration_gain: u16,
    /// |n_v| below this counts as standing still; 0 switches it off.
    pub velocity_dead_band: u32,
    /// |n_p| below this asks for nothing; 0 switches it off.
    pub dead_band: u32,
    /// L_DAC: 256 for the solenoid, 65536 for the stepper.
    pub scale: NonZeroU32,
    /// Added to the demand: the command at which the valve is at its null, counts.
    pub null_offset: i16,
}

/// n_p, saturated to 32 bits; 0 in open loop.
pub(crate) fn error(config: &LawConfig, setpoint: i32, position: i32) -> i32 {
    match config.control_loop {
        Loop::Closed => saturate(i64::from(setpoint) - i64::from(position)),
        Loop::Open => 0,
    }
}

/// The demand in valve counts, before the limits of the drive stage.
pub(crate) fn demand(config: &LawConfig, setpoint: i32, error: i32, motion: &Motion) -> i32 {
    match config.control_loop {
        Loop::Open => setpoint,
        Loop::Closed => closed_loop_demand(config, error, motion),
    }
}

fn closed_loop_demand(config: &LawConfig, error: i32, motion: &Motion) -> i32 {
    let demand = if error.unsigned_abs() < config.dead_band {
        0
    } else {
        let velocity = if motion.velocity.unsigned_abs() < u64::from(config.velocity_dead_band) {
            0
        } else {
            motion.velocity
        };
        // 32 + 16, 33 + 16 and 34 + 16 bits: the sum is exact in 64.
        let sum = i64::from(position_gain(config, error)) * i64::from(error)
            - i64::from(config.velocity_gain) * velocity
            - i64::from(config.acceleration_gain) * motion.acceleration;
        divide_toward_zero(saturate(sum), config.scale)
    };
    demand.saturating_add(i32::from(config.null_offset))
}

/// Kp for this error.
fn position_gain(config: &LawConfig, error: i32) -> u16 {
    match config.kind {
        LawKind::Proportional => config.proportional_gain,
        LawKind::GainProfile => {
            let index = (error.unsigned_abs() / config.profile_span).min(PROFILE_LEN as u32 - 1);
            config.gain_profile[index as usize]
        }
    }
}
