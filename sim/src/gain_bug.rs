//! The historical bug of the gain routine (thesis 8.2.5, L(19); EQUATIONS section 9): it "could only give positive
//! gains". The thesis says no more, so there are three readings:
//!
//! ```text
//! no-negative-gain   n_pg = max(Kp[i] n_p, 0)    to the letter: the positional gain n_pg (6.3.3) is never negative
//! positive-error     n_pg = Kp[i] |n_p|          the error counts as positive
//! last-gain          n_pg = Kp[last] n_p         for n_p < 0
//! demand = (n_pg - Kv n_v - Ka n_a) / scale + null offset
//! ```
//!
//! The last reading takes "min(n_p/4, 255)" of Appendix IX (a) to the letter: n_p/4 of a negative n_p is a large
//! number without its sign.
//!
//! Everything else is as in the gain-profile and proportional laws: exact sums, one saturation, division toward zero,
//! dead bands, limits. The bug exists in the simulator only, to repeat the thesis's figures. After an overshoot the
//! second reading pushes on in the direction of the error, and the first leaves the drive to its velocity feedback.

use std::num::NonZeroU32;

use pneudrive_controller::drive::DriveConfig;
use pneudrive_controller::law::{LawConfig, Settings};
use pneudrive_controller::{Command, Config, Mode, Observation};

use crate::component::controller::{self, Law, Loop};
use crate::key::{Choice, keys, words};
use crate::values::{Findings, Rig};

words! {
    /// The readings of the bug.
    pub enum Reading {
        /// The gain routine is sound.
        None = "none",
        /// The positional gain is never negative.
        NoNegativeGain = "no-negative-gain",
        /// The error counts as positive.
        PositiveError = "positive-error",
        /// Negative errors have the last gain of the profile.
        LastGain = "last-gain",
    }
}

keys! {
    GAIN_BUG: Reading = choice("faults.gain_bug", "L(19)", "The bug of the thesis's gain routine, which \"could only give positive gains\" (8.2.5), in one of three readings: no negative gain, the error counts as positive, negative errors have the last gain of the profile; in the simulator only.");
}

/// The faulty law, in place of the controller's between its sample and its output.
#[derive(Clone, Debug)]
pub struct GainBug {
    reading: Reading,
    law: LawConfig,
    drive: DriveConfig,
    /// Where the spool of a stepper is, steps.
    location: i16,
}

/// The bug that a rig has, named by its key and word.
#[must_use]
pub fn named(rig: &Rig) -> Option<String> {
    match rig.get(&keys::GAIN_BUG) {
        Reading::None => None,
        reading => Some(format!("{} = \"{}\"", keys::GAIN_BUG.path, reading.word())),
    }
}

/// The constraints on a rig with the bug.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let reading = rig.get(&keys::GAIN_BUG);
    if reading != Reading::None
        && let Some(refused) = refused(rig, reading == Reading::LastGain)
    {
        findings.note(&keys::GAIN_BUG, refused);
    }
}

/// Why a controller cannot have the bug, in the reading of a profile's last gain or another one.
fn refused(rig: &Rig, last_gain: bool) -> Option<&'static str> {
    if rig.get(&controller::keys::MODEL) != controller::ControllerKind::Sampled {
        return Some("it is a bug of the sampled controller");
    }
    if rig.get(&controller::keys::LOOP) != Loop::Closed {
        return Some("an open loop has no gain");
    }
    match rig.get(&controller::keys::LAW) {
        Law::GainProfile => {}
        _ if last_gain => return Some("it is for the law gain-profile"),
        Law::Proportional => {}
        _ => return Some("it is for the laws gain-profile and proportional"),
    }
    if rig.get(&controller::keys::PRESSURE_FEEDBACK_GAIN) != 0.0 {
        return Some("it is a bug of the thesis's controller, which feeds no pressures back");
    }
    let feed_forward =
        [&controller::keys::VELOCITY_FEED_FORWARD, &controller::keys::ACCELERATION_FEED_FORWARD];
    let fed_forward = feed_forward.iter().any(|gain| rig.get(gain) != 0);
    fed_forward.then_some("it is a bug of the thesis's controller, which feeds nothing forward")
}

impl GainBug {
    /// The bug, if a rig has it.
    #[must_use]
    pub fn of(rig: &Rig, config: &Config) -> Option<GainBug> {
        let reading = rig.get(&keys::GAIN_BUG);
        if reading == Reading::None {
            return None;
        }
        Some(GainBug { reading, law: config.law.clone(), drive: config.drive, location: 0 })
    }

    /// The faulty law's result for a sample: the same with another command, which is null where the
    /// supervisor lets none through.
    #[must_use]
    pub(crate) fn corrupt(&self, mode: Mode, seen: Observation) -> Observation {
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

    /// The output for a spoilt sample.
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
        let gain = i64::from(self.gain(seen.error)) * i64::from(seen.error);
        let positional = match self.reading {
            Reading::NoNegativeGain => gain.max(0),
            Reading::PositiveError => gain.abs(),
            Reading::LastGain | Reading::None => gain,
        };
        let sum = positional
            - i64::from(law.velocity_gain) * velocity
            - i64::from(law.acceleration_gain) * seen.acceleration;
        sum.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) / i64::from(law.scale.get()) + null
    }

    /// `Kp[i]`.
    fn gain(&self, error: i32) -> u16 {
        match &self.law.settings {
            Settings::GainProfile(profile) => {
                let index = (error.unsigned_abs() / profile.span) as usize;
                let last = profile.gains.len() - 1;
                profile.gains
                    [if self.reading == Reading::LastGain && error < 0 { last } else { index.min(last) }]
            }
            Settings::Proportional(law) => law.gain,
            // A checked rig has no other law here.
            _ => 0,
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

    fn faulty(settings: &[&str]) -> GainBug {
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        let rig =
            Rig::read_with("test", "[faults]\ngain_bug = \"positive-error\"\n", &settings).expect("valid");
        GainBug::of(&rig, &Config::new(&rig.parameters()).expect("valid")).expect("asked for")
    }

    fn seen(error: i32, velocity: i64, acceleration: i64) -> Observation {
        Observation { error, velocity, acceleration, ..Observation::default() }
    }

    fn command(law: &GainBug, seen: Observation) -> i16 {
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
        let law = faulty(&["faults.gain_bug=last-gain"]);
        for (error, expected) in [(3, 96), (7, 168), (-3, -3), (-7, -7), (1000, 1000), (-1000, -1000)] {
            assert_eq!(command(&law, seen(error, 0, 0)), expected, "{error}");
        }
    }

    /// By hand, as above; -1000 - 300 = -1300, and -1300/256 = -5.1.
    #[test]
    fn negative_errors_ask_for_nothing_but_damping_if_no_gain_is_negative() {
        let law = faulty(&["faults.gain_bug=no-negative-gain"]);
        for (error, expected) in [(3, 96), (7, 168), (-3, 0), (-1000, 0)] {
            assert_eq!(command(&law, seen(error, 0, 0)), expected, "{error}");
        }
        assert_eq!(command(&law, seen(-3, 1000, 300)), -5);
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
