//! The control laws (thesis 6.3.3, Appendix IX): error, velocity and acceleration to a demand.
//!
//! ```text
//! n_p    = setpoint - position
//! i      = min(|n_p| / span, 255)                       gain-profile index (Appendix IX a)
//! n_DAC1 = Kp[i] n_p - Kv n_v - Ka n_a - k5 n_q + n_f   exact in i64, saturated once to i32
//! demand = n_DAC1 / scale + null offset                 toward zero
//! ```
//!
//! - **Gain profile**: as above. k5 is 0 unless pressures are fed back for damping (9.1.2, [`crate::pressure`]).
//! - **Proportional**: the same with one gain for `Kp[i]`.
//! - **Moore's proportional** (L(22) = 13; the thesis has no equation of it): the proportional law, and
//!   in the direction of the error the command that takes the spool across the dead zone of the valve,
//!   `demand = n_DAC1 / scale + sign(n_p) dead zone + null offset`. The profile's high gains on small
//!   errors, "based on the findings of Moore" (Appendix IX), do the same.
//! - **On-off** (L(22) = 2): Burrows' relay with a dead zone and hysteresis, on position, velocity and
//!   quasi-transient pressure (gain k5 = C(68)). The relay switches on
//!   `s = (Kp n_p - Kv n_v - Ka n_a - k5 n_q) / scale`; its demand is the full range to either side, or 0.
//!
//! **Feed-forward** (not in the thesis) is of the setpoint's own motion while a profile moves it, with windows of Wv and
//! Wa samples:
//!
//! ```text
//! n_f = Fv Wv v + Fa Wv Wa a        v, a: first and second difference of the setpoint, counts a sample (and sample)
//! ```
//!
//! so that Fv = Kv and Fa = Ka feed back the deviation from the setpoint's motion. It is 0 while the setpoint stands and
//! where it jumps; the on-off law has none.
//!
//! Inside the position dead band the demand is the null offset alone, unless something is fed forward; inside the velocity
//! dead band n_v counts as 0. What was learned of the null ([`crate::learning`]) is added to the null offset. For the on-off
//! law the position dead band is the relay's dead zone, and there is no null offset: a closed valve has none. Open loop: the
//! demand is the setpoint.

use core::num::NonZeroU32;

pub use crate::choice::{Law, Loop};
use crate::drive::MAX_COUNTS;
use crate::estimator::Motion;
use crate::fixed::{divide_toward_zero, saturate};
use crate::learning::NullOffset;
use crate::parameters::PROFILE_LEN;
use crate::pressure::Mean;
use crate::signal::Sample;

/// The law's constants. Gains are plain numbers; `scale` makes the demand valve counts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LawConfig {
    /// Open or closed loop.
    pub control_loop: Loop,
    /// Which gain is used on the error.
    pub kind: Law,
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
    /// |n_v| below this counts as standing still.
    pub velocity_dead_band: Option<NonZeroU32>,
    /// |n_p| below this asks for nothing; 0 switches it off.
    pub dead_band: u32,
    /// Moore's proportional law: the command that takes the spool across the dead zone, counts.
    pub dead_zone: u16,
    /// On-off law: the relay drops out this much below its dead zone, counts of error.
    pub relay_hysteresis: u32,
    /// k5, on the raw quasi-transient pressure difference; 0: pressures are not fed back.
    pub pressure_gain: u16,
    /// Whether the law looks at the pressures: the on-off one, and one that damps by them.
    pub by_pressures: bool,
    /// L_DAC: 256 for the solenoid, 65536 for the stepper.
    pub scale: NonZeroU32,
    /// Added to the demand: the command at which the valve is at its null, counts.
    pub null_offset: i16,
    /// How much of the error at rest goes into the null offset; 0: nothing is learned.
    pub learning_gain: u16,
}

/// n_p, saturated to 32 bits; 0 in open loop.
pub(crate) fn error(config: &LawConfig, setpoint: i32, position: i32) -> i32 {
    match config.control_loop {
        Loop::Closed => setpoint.saturating_sub(position),
        Loop::Open => 0,
    }
}

/// The relay of the on-off law, and which way it is switched: -1, 0 or 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Relay(i8);

impl Relay {
    /// Picks up where |s| reaches the dead zone, drops out where it is `hysteresis` below.
    fn switch(&mut self, s: i32, dead_zone: u32, hysteresis: u32) -> i8 {
        let side = s.signum() as i8;
        let picks_up = s.unsigned_abs() >= dead_zone;
        let holds = side == self.0 && s.unsigned_abs() >= dead_zone.saturating_sub(hysteresis);
        self.0 = if picks_up || holds { side } else { 0 };
        self.0
    }
}

/// What the laws remember from sample to sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Memory {
    pub relay: Relay,
    pub pressure: Mean,
    pub null_offset: NullOffset,
}

/// What the law is to achieve at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Aim {
    /// Counts (open loop: command).
    pub setpoint: i32,
    /// n_p, counts.
    pub error: i32,
    /// n_f.
    pub feed_forward: i64,
}

/// The demand in valve counts, before the limits of the drive stage.
pub(crate) fn demand(
    config: &LawConfig,
    memory: &mut Memory,
    aim: &Aim,
    motion: &Motion,
    input: &Sample,
) -> i32 {
    match config.control_loop {
        Loop::Open => aim.setpoint,
        Loop::Closed if config.by_pressures => by_pressures(config, memory, aim, motion, input),
        Loop::Closed => {
            let null = i32::from(config.null_offset).saturating_add(memory.null_offset.counts());
            from_null(config, aim, motion).saturating_add(null)
        }
    }
}

/// The demand of a law that looks at the pressures: of the on-off one, and of one that damps by them. In its dead band the
/// latter asks for nothing, whatever the pressures do. Apart from the usual path, which it would lengthen.
#[cold]
#[inline(never)]
fn by_pressures(config: &LawConfig, memory: &mut Memory, aim: &Aim, motion: &Motion, input: &Sample) -> i32 {
    let pressure = i64::from(config.pressure_gain) * i64::from(memory.pressure.transient(input));
    let (gain, fed_forward) = match config.kind {
        Law::OnOff => (config.proportional_gain, 0),
        Law::GainProfile => (profile_gain(config, aim.error), aim.feed_forward),
        Law::Proportional | Law::MooreProportional => (config.proportional_gain, aim.feed_forward),
    };
    let sum = scaled(config, weighed(config, gain, aim.error, motion) + fed_forward - pressure);
    let null = i32::from(config.null_offset).saturating_add(memory.null_offset.counts());
    match config.kind {
        Law::OnOff => {
            let side = memory.relay.switch(sum, config.dead_band, config.relay_hysteresis);
            i32::from(side) * i32::from(MAX_COUNTS)
        }
        _ if is_idle(config, aim) => null,
        Law::MooreProportional => across_dead_zone(config, aim.error, sum).saturating_add(null),
        Law::GainProfile | Law::Proportional => sum.saturating_add(null),
    }
}

/// Whether the error is in the dead band and nothing is fed forward.
fn is_idle(config: &LawConfig, aim: &Aim) -> bool {
    aim.error.unsigned_abs() < config.dead_band && aim.feed_forward == 0
}

/// The demand as the valve's null has it.
fn from_null(config: &LawConfig, aim: &Aim, motion: &Motion) -> i32 {
    let error = aim.error;
    let by_gain = |gain| scaled(config, weighed(config, gain, error, motion) + aim.feed_forward);
    match config.kind {
        _ if is_idle(config, aim) => 0,
        Law::GainProfile => by_gain(profile_gain(config, error)),
        Law::MooreProportional => across_dead_zone(config, error, by_gain(config.proportional_gain)),
        Law::Proportional | Law::OnOff => by_gain(config.proportional_gain),
    }
}

/// Moore's step: in the direction of the error, across the dead zone of the valve.
fn across_dead_zone(config: &LawConfig, error: i32, demand: i32) -> i32 {
    demand.saturating_add(error.signum() * i32::from(config.dead_zone))
}

/// Kp n_p - Kv n_v - Ka n_a: 16 + 32, 16 + 33 and 16 + 34 bits, so the sum is exact in 64, also with the 16 + 17
/// bits of k5 n_q, or the 48 bits of n_f.
fn weighed(config: &LawConfig, gain: u16, error: i32, motion: &Motion) -> i64 {
    let velocity = match config.velocity_dead_band {
        Some(band) if motion.velocity.unsigned_abs() < u64::from(band.get()) => 0,
        _ => motion.velocity,
    };
    i64::from(gain) * i64::from(error)
        - i64::from(config.velocity_gain) * velocity
        - i64::from(config.acceleration_gain) * motion.acceleration
}

/// Saturated once, and divided toward zero.
fn scaled(config: &LawConfig, sum: i64) -> i32 {
    divide_toward_zero(saturate(sum), config.scale)
}

/// Kp[i] for this error.
fn profile_gain(config: &LawConfig, error: i32) -> u16 {
    let index = (error.unsigned_abs() / config.profile_span).min(PROFILE_LEN as u32 - 1);
    config.gain_profile[index as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_relay_picks_up_at_its_dead_zone_and_drops_out_below_it_by_the_hysteresis() {
        let mut relay = Relay::default();
        let inputs = [9, 10, 8, 7, 6, 9, -9, -10, -7, -6];
        let states = inputs.map(|s| relay.switch(s, 10, 3));
        assert_eq!(states, [0, 1, 1, 1, 0, 0, 0, -1, -1, 0]);
    }

    #[test]
    fn a_relay_that_is_thrown_over_does_not_hold_on_the_other_side() {
        let mut relay = Relay(1);
        assert_eq!(relay.switch(-8, 10, 3), 0);
        assert_eq!(relay.switch(-10, 10, 3), -1);
    }

    #[test]
    fn a_relay_without_a_dead_zone_follows_the_sign() {
        let mut relay = Relay::default();
        assert_eq!([5, 1, 0, -1, i32::MIN, i32::MAX].map(|s| relay.switch(s, 0, 9)), [1, 1, 0, -1, -1, 1]);
    }

    /// Two dead bands of a gain (6.3.3): one asks for nothing inside it, the other goes on braking.
    #[test]
    fn a_profile_that_begins_with_zeros_brakes_inside_its_dead_band() {
        let thesis = crate::Config::default().law;
        let mut gain_profile = thesis.gain_profile;
        gain_profile[..2].fill(0);
        let by_profile = LawConfig { gain_profile, velocity_gain: 512, ..thesis.clone() };
        let by_band = LawConfig { dead_band: 8, velocity_gain: 512, ..thesis };
        let moving = Motion { velocity: 10, ..Motion::default() };
        for error in [-7, 0, 7] {
            assert_eq!(from_null(&by_profile, &at(error), &moving), -20, "error {error}");
            assert_eq!(from_null(&by_band, &at(error), &moving), 0, "error {error}");
        }
        assert_eq!(from_null(&by_profile, &at(8), &moving), 8 * 16 - 20);
        assert_eq!(from_null(&by_band, &at(8), &moving), 8 * 16 - 20);
    }

    fn at(error: i32) -> Aim {
        Aim { error, ..Aim::default() }
    }

    #[test]
    fn a_moving_setpoint_asks_for_its_feed_forward_in_the_dead_band_too() {
        let law = LawConfig { dead_band: 8, ..crate::Config::default().law };
        let aim = Aim { error: 3, feed_forward: 256 * 50, ..Aim::default() };
        let by_error = 3 * i32::from(profile_gain(&law, 3));
        assert_eq!(from_null(&law, &aim, &Motion::default()), (by_error + 256 * 50) / 256);
        assert_eq!(from_null(&law, &Aim { feed_forward: 0, ..aim }, &Motion::default()), 0);
    }

    /// (8192 3 - 1000 10) / 256 = 56.9 and (8192 3 + 1000 9) / 256 = 131.2, as -10 / 64 is rounded to -1. In the dead band a law
    /// asks for nothing, whatever the pressures do.
    #[test]
    fn a_rising_pressure_difference_is_subtracted_outside_of_the_dead_band() {
        let law = LawConfig { pressure_gain: 1000, by_pressures: true, ..crate::Config::default().law };
        let banded = LawConfig { dead_band: 8, ..law };
        let after_a_step_of = |raw: i16, law: &LawConfig| {
            let mut memory = Memory::default();
            let mut demand = |pressure_1| {
                let input = Sample { pressure_1, ..Sample::default() };
                super::demand(law, &mut memory, &at(3), &Motion::default(), &input)
            };
            demand(0);
            demand(raw)
        };
        assert_eq!([10, -10].map(|raw| after_a_step_of(raw, &law)), [56, 131]);
        assert_eq!([10, -10].map(|raw| after_a_step_of(raw, &banded)), [0, 0]);
    }

    #[test]
    fn the_largest_feed_forward_is_saturated_once_with_the_rest() {
        let law = LawConfig { scale: NonZeroU32::MIN, ..crate::Config::default().law };
        for (sign, expected) in [(1, i32::MAX), (-1, i32::MIN)] {
            let aim = Aim { error: sign as i32 * i32::MAX, feed_forward: sign << 48, setpoint: 0 };
            assert_eq!(from_null(&law, &aim, &Motion::default()), expected);
        }
    }
}
