//! The homing run: slowly against a stop, or over the edge of a switch, to give counts their meaning.
//!
//! - **Stop**: the valve is held a little open until the encoder has stood still for a time that is longer
//!   than the cylinder takes to start.
//! - **Switch**: towards the switch until it closes. A run that begins on it goes back until it opens:
//!   the edge is the same.

use crate::estimator::Motion;
use crate::standstill::Standstill;

/// Where the homing run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomingKind {
    /// At a mechanical stop.
    Stop,
    /// At the edge of a switch.
    Switch,
}

/// The homing run's settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomingConfig {
    /// Where it ends.
    pub kind: HomingKind,
    /// Valve command towards the stop or the switch, counts; its sign is the direction.
    pub command: i16,
    /// The position there, counts.
    pub position: i32,
    /// Standing still for so long is being at the stop, samples.
    pub still_samples: u32,
    /// Within this distance, counts.
    pub still_counts: u32,
    /// Longest run, samples.
    pub timeout_samples: u32,
}

/// How a homing run stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// Drive on, with this command.
    Seeking(i16),
    /// The stop or the edge is here.
    Found,
    /// It has taken too long.
    TimedOut,
}

/// A homing run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Homing {
    taken: u32,
    standstill: Standstill,
    /// What the switch was when the run began.
    began_on: Option<bool>,
}

impl Homing {
    /// Takes a sample of the run.
    pub fn advance(&mut self, config: &HomingConfig, motion: &Motion, on: bool) -> Progress {
        let began_on = *self.began_on.get_or_insert(on);
        if self.taken == 0 {
            self.standstill.restart(motion.position);
        }
        let stood = self.standstill.at(motion.position, config.still_counts);
        self.taken = self.taken.saturating_add(1);
        let (found, command) = match config.kind {
            HomingKind::Stop => (stood >= config.still_samples, config.command),
            HomingKind::Switch if began_on => (!on, config.command.saturating_neg()),
            HomingKind::Switch => (on, config.command),
        };
        if found {
            Progress::Found
        } else if self.taken >= config.timeout_samples {
            Progress::TimedOut
        } else {
            Progress::Seeking(command)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOP: HomingConfig = HomingConfig {
        kind: HomingKind::Stop,
        command: -200,
        position: 0,
        still_samples: 3,
        still_counts: 4,
        timeout_samples: 10,
    };
    const SWITCH: HomingConfig = HomingConfig { kind: HomingKind::Switch, ..STOP };

    fn at(position: i32) -> Motion {
        Motion { position, ..Motion::default() }
    }

    #[test]
    fn a_stop_is_where_the_encoder_has_stood_still_long_enough() {
        let mut homing = Homing::default();
        let seeking = Progress::Seeking(-200);
        let seen = [90, 88, 80, 79, 78, 76].map(|position| homing.advance(&STOP, &at(position), false));
        assert_eq!(seen, [seeking, seeking, seeking, seeking, seeking, Progress::Found]);
    }

    #[test]
    fn a_switch_is_found_at_its_edge_from_either_side() {
        let mut towards = Homing::default();
        assert_eq!(towards.advance(&SWITCH, &at(0), false), Progress::Seeking(-200));
        assert_eq!(towards.advance(&SWITCH, &at(-3), true), Progress::Found);
        let mut off = Homing::default();
        assert_eq!(off.advance(&SWITCH, &at(0), true), Progress::Seeking(200));
        assert_eq!(off.advance(&SWITCH, &at(3), true), Progress::Seeking(200));
        assert_eq!(off.advance(&SWITCH, &at(3), false), Progress::Found);
    }

    #[test]
    fn a_run_that_finds_nothing_ends() {
        let mut homing = Homing::default();
        let seen: [Progress; 10] = core::array::from_fn(|_| homing.advance(&SWITCH, &at(-9), false));
        assert_eq!(seen[8], Progress::Seeking(-200));
        assert_eq!(seen[9], Progress::TimedOut);
    }
}
