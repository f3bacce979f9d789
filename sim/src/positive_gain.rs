//! The historical bug of the gain routine (thesis 8.2.5, L(19); EQUATIONS section 9): it could give
//! positive gains only. The thesis has no more of it, so there are two readings:
//!
//! ```text
//! positive_gain_only               n_pg = Kp[i] |n_p|       instead of Kp[i] n_p
//! last_gain_for_negative_errors    n_pg = Kp[last] n_p      for n_p < 0
//! demand = (n_pg - Kv n_v - Ka n_a) / scale + null offset
//! ```
//!
//! The second is "min(n_p/4, 255)" of Appendix IX (a) to the letter: n_p/4 of a negative n_p is a large number without
//! its sign.
//!
//! All else is as in the gain-profile and proportional laws: exact sums, one saturation, division toward
//! zero, dead bands, limits. It is a component of the simulator alone, for a repetition of the thesis's
//! figures: no firmware has it. After an overshoot the first pushes on in the direction of the error.

use std::num::NonZeroU32;

use pneudrive_controller::drive::DriveConfig;
use pneudrive_controller::law::{LawConfig, LawKind};
use pneudrive_controller::{Command, Config, Mode, Observation};

use crate::component::controller::{self, Law, Loop};
use crate::key::{Typed, keys};
use crate::values::{Findings, Rig};

/// The readings of the bug.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reading {
    /// The error counts as positive.
    PositiveError,
    /// Negative errors have the last gain of the profile.
    LastGain,
}

/// The faulty law, in place of the controller's between its sample and its output.
#[derive(Clone, Debug)]
pub struct PositiveGain {
    reading: Reading,
    law: LawConfig,
    drive: DriveConfig,
    /// Where the spool of a stepper is, steps.
    location: i16,
}

keys! {
    LAST_GAIN_FOR_NEGATIVE_ERRORS: bool = switch("faults.last_gain_for_negative_errors", false, "L(19)", "The same bug in another reading: a negative error has the last gain of the profile; in the simulator only.");
    POSITIVE_GAIN_ONLY: bool = switch("faults.positive_gain_only", false, "L(19)", "The controller's historical bug (thesis 8.2.5): the error always counts as positive; in the simulator only.");
}

/// The keys that ask for it, the first one before the second.
pub static SWITCHES: [&Typed<bool>; 2] = [&keys::POSITIVE_GAIN_ONLY, &keys::LAST_GAIN_FOR_NEGATIVE_ERRORS];

/// The constraints on a rig with the bug.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let [positive, last] = SWITCHES.map(|switch| rig.get(switch));
    if positive && let Some(refused) = refused(rig, false) {
        findings.note(SWITCHES[0], refused);
    }
    if last {
        let refused =
            if positive { Some("there is one bug: take one of its readings") } else { refused(rig, true) };
        if let Some(refused) = refused {
            findings.note(SWITCHES[1], refused);
        }
    }
}

/// Why a controller cannot have the bug, in the reading of a profile's last gain or the other one.
fn refused(rig: &Rig, last_gain: bool) -> Option<&'static str> {
    if rig.get(&controller::keys::MODEL) != controller::Model::Sampled {
        return Some("it is a bug of the sampled controller");
    }
    if rig.get(&controller::keys::LOOP) != Loop::Closed {
        return Some("an open loop has no gain");
    }
    let feed_forward =
        [&controller::keys::VELOCITY_FEED_FORWARD, &controller::keys::ACCELERATION_FEED_FORWARD];
    if feed_forward.iter().any(|gain| rig.get(gain) != 0) {
        return Some("it is a bug of the thesis's controller, which feeds nothing forward");
    }
    match rig.get(&controller::keys::LAW) {
        Law::GainProfile => None,
        _ if last_gain => Some("it is for the law gain-profile"),
        Law::Proportional => None,
        _ => Some("it is for the laws gain-profile and proportional"),
    }
}

impl PositiveGain {
    /// The bug, if a rig has it.
    #[must_use]
    pub fn of(rig: &Rig, config: &Config) -> Option<PositiveGain> {
        let reading = match SWITCHES.map(|switch| rig.get(switch)) {
            [true, _] => Reading::PositiveError,
            [false, true] => Reading::LastGain,
            [false, false] => return None,
        };
        Some(PositiveGain { reading, law: config.law.clone(), drive: config.drive, location: 0 })
    }

    /// What the faulty law makes of a sample: the same with another command, which is null where the
    /// supervisor lets none through.
    #[must_use]
    pub fn corrupt(&self, mode: Mode, seen: Observation) -> Observation {
        let command = match mode {
            Mode::Running | Mode::Done => self.limited(self.demand(&seen)),
            _ => 0,
        };
        let spool = match self.drive {
            DriveConfig::Dac(_) => seen.spool,
            DriveConfig::Stepper { .. } => self.location,
        };
        Observation { command, spool, ..seen }
    }

    /// What goes out for a spoilt sample.
    pub fn output(&mut self, seen: &Observation, command: Command) -> Command {
        let step = match self.drive {
            DriveConfig::Dac(_) => 0,
            DriveConfig::Stepper { .. } => (seen.command - self.location).signum(),
        };
        self.location += step;
        Command { counts: seen.command, step: step as i8, ..command }
    }

    /// In valve counts.
    fn demand(&self, seen: &Observation) -> i64 {
        let law = &self.law;
        let null = i64::from(law.null_offset);
        if seen.error.unsigned_abs() < law.dead_band {
            return null;
        }
        let still =
            seen.velocity.unsigned_abs() < u64::from(law.velocity_dead_band.map_or(0, NonZeroU32::get));
        let velocity = if still { 0 } else { seen.velocity };
        let error = match self.reading {
            Reading::PositiveError => i64::from(seen.error).abs(),
            Reading::LastGain => i64::from(seen.error),
        };
        let sum = i64::from(self.gain(seen.error)) * error
            - i64::from(law.velocity_gain) * velocity
            - i64::from(law.acceleration_gain) * seen.acceleration;
        sum.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) / i64::from(law.scale.get()) + null
    }

    /// `Kp[i]`.
    fn gain(&self, error: i32) -> u16 {
        let profile = &self.law.gain_profile;
        match self.law.kind {
            LawKind::GainProfile => {
                let index = (error.unsigned_abs() / self.law.profile_span) as usize;
                let last = profile.len() - 1;
                profile[if self.reading == Reading::LastGain && error < 0 { last } else { index.min(last) }]
            }
            // A checked rig has no other law here.
            _ => self.law.proportional_gain,
        }
    }

    fn limited(&self, demand: i64) -> i16 {
        let largest = i64::from(self.drive.largest());
        demand.clamp(-largest, largest) as i16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faulty(settings: &[&str]) -> PositiveGain {
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        let rig = Rig::read_with("test", "[faults]\npositive_gain_only = true\n", &settings).expect("valid");
        PositiveGain::of(&rig, &Config::new(&rig.parameters()).expect("valid")).expect("asked for")
    }

    fn seen(error: i32, velocity: i64, acceleration: i64) -> Observation {
        Observation { error, velocity, acceleration, ..Observation::default() }
    }

    fn command(law: &PositiveGain, seen: Observation) -> i16 {
        law.corrupt(Mode::Running, seen).command
    }

    /// By hand, with the profile 8192, 6144, 4096, 2048 ... of 4 counts each, gains of 1, scale 256.
    #[test]
    fn the_command_is_that_of_the_positive_error_whatever_its_sign() {
        let law = faulty(&[]);
        for (error, expected) in [(3, 96), (-3, 96), (-7, 168), (-15, 120), (1000, 1000), (-1000, 1000)] {
            assert_eq!(command(&law, seen(error, 0, 0)), expected, "{error}");
        }
        // (8192 * 3 - 1000 - 300) / 256 = 90.9; (8192 * 3 - 40000 + 10) / 256 = -60.2
        assert_eq!(command(&law, seen(-3, 1000, 300)), 90);
        assert_eq!(command(&law, seen(-3, 40_000, -10)), -60);
    }

    /// By hand: 96 and 168 counts of command for errors of 3 and 7, and 256/256 counts to the count of a negative one.
    #[test]
    fn negative_errors_have_the_last_gain_of_the_profile_if_the_index_is_wrong() {
        let law = faulty(&["faults.positive_gain_only=false", "faults.last_gain_for_negative_errors=true"]);
        for (error, expected) in [(3, 96), (7, 168), (-3, -3), (-7, -7), (1000, 1000), (-1000, -1000)] {
            assert_eq!(command(&law, seen(error, 0, 0)), expected, "{error}");
        }
    }

    #[test]
    fn a_proportional_law_has_it_too() {
        let law = faulty(&["controller.law=proportional", "controller.proportional_gain=512"]);
        assert_eq!([20, -20].map(|error| command(&law, seen(error, 0, 0))), [40, 40]);
    }

    #[test]
    fn dead_bands_offset_and_limits_are_those_of_the_law() {
        let law = faulty(&[
            "controller.dead_band_counts=5",
            "controller.velocity_dead_band=300",
            "controller.velocity_gain=256",
            "controller.null_offset_counts=7",
        ]);
        assert_eq!(command(&law, seen(-4, 1000, 0)), 7);
        // 6144 * 5 / 256 = 120
        assert_eq!(command(&law, seen(-5, 299, 0)), 127);
        assert_eq!(command(&law, seen(-5, 300, 0)), 120 - 300 + 7);
        assert_eq!(command(&law, seen(i32::MIN, 0, 0)), 2048);
        assert_eq!(command(&law, seen(9, i64::from(i32::MAX), 0)), -2048);
    }

    #[test]
    fn the_supervisor_keeps_the_last_word() {
        let tripped = Mode::Fault(pneudrive_controller::Fault::Stop);
        assert_eq!(faulty(&[]).corrupt(tripped, seen(3, 0, 0)).command, 0);
    }

    #[test]
    fn a_stepper_walks_to_the_faulty_command_a_pulse_a_sample() {
        let mut law = faulty(&["operator.model=stepper"]);
        // 256 * 600 / 65536 = 2.3
        let pulses: Vec<i8> = (0..4)
            .map(|_| {
                let seen = law.corrupt(Mode::Running, seen(-600, 0, 0));
                assert_eq!(seen.command, 2);
                law.output(&seen, Command::OFF).step
            })
            .collect();
        assert_eq!(pulses, [1, 1, 0, 0]);
        assert_eq!(law.corrupt(Mode::Running, seen(0, 0, 0)).spool, 2);
    }
}
