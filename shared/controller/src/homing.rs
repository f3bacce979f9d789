//! The homing run: moves slowly against a stop, or over the edge of a switch, to reference the axis.
//!
//! - **Stop**: the valve is held slightly open until the encoder has stood still for longer than the cylinder takes
//!   to start.
//! - **Switch**: towards the switch until it closes.
//!
//! An encoder that does not count stands still anywhere. So a place is accepted only when it has been found twice:
//!
//! ```text
//! approach --there--> back off by `back_off` counts --> approach again --there, at the same place--> found
//!                            ^                                 |
//!                            +--- there, but elsewhere --------+
//! ```
//!
//! A run that begins on its switch backs off first. A pause on the way back to a stop does not count as the stop, because
//! an axis takes a while to reverse. If the same place is never found twice, the run ends after `timeout_samples`.

use crate::choice::HomingKind;
use crate::standstill::Standstill;

/// The homing run's settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HomingConfig {
    /// The place where it ends.
    pub kind: HomingKind,
    /// Valve command towards the stop or the switch, counts; its sign is the direction.
    pub command: i16,
    /// The position of that place, counts.
    pub position: i32,
    /// How far to back off before the second approach, counts.
    pub back_off: u32,
    /// Standing still for this long means being at the stop, samples.
    pub still_samples: u32,
    /// Tolerance of standing still, and of two finds of the same place, counts.
    pub still_counts: u32,
    /// Longest run, samples.
    pub timeout_samples: u32,
}

/// The state of a homing run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Progress {
    /// Continue with this command.
    Seeking(i16),
    /// The stop or the edge is found.
    Found,
    /// The time is over.
    TimedOut,
}

/// The legs of a homing run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Leg {
    /// The first approach.
    #[default]
    Approach,
    /// Back off from where it was found.
    BackOff { place: i32 },
    /// The second approach.
    ApproachAgain { place: i32 },
}

/// A homing run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Homing {
    taken: u32,
    standstill: Standstill,
    /// The stall detector's sum for an axis that must move.
    pushed: Standstill,
    leg: Leg,
}

impl Homing {
    /// Takes one sample of the run.
    pub fn advance(&mut self, config: &HomingConfig, position: i32, on: bool) -> Progress {
        if self.taken == 0 {
            self.standstill.restart(position);
        }
        let there = self.is_there(config, position, on);
        self.taken = self.taken.saturating_add(1);
        if self.turn(config, position, there, on) {
            Progress::Found
        } else if self.taken >= config.timeout_samples {
            Progress::TimedOut
        } else {
            Progress::Seeking(self.command(config))
        }
    }

    /// The sum of `effort` over the samples that an axis has stood although it must move. It is 0 on the way to a
    /// stop, where standing still is the aim.
    pub fn pushed_for(&mut self, config: &HomingConfig, position: i32, effort: u32) -> u32 {
        if config.kind == HomingKind::Switch || matches!(self.leg, Leg::BackOff { .. }) {
            return self.pushed.pushed(position, config.still_counts, effort);
        }
        self.pushed.restart(position);
        0
    }

    fn is_there(&mut self, config: &HomingConfig, position: i32, on: bool) -> bool {
        let stood = self.standstill.at(position, config.still_counts);
        match config.kind {
            HomingKind::Stop => stood >= config.still_samples,
            HomingKind::Switch => on,
        }
    }

    /// Goes on to the next leg where this one ends. Returns whether the place has been found twice.
    fn turn(&mut self, config: &HomingConfig, position: i32, there: bool, on: bool) -> bool {
        match self.leg {
            Leg::Approach if there => self.leg = Leg::BackOff { place: position },
            Leg::BackOff { place } => {
                let is_off = way_back(config, place, position) >= i64::from(config.back_off);
                if is_off && !(config.kind == HomingKind::Switch && on) {
                    self.standstill.restart(position);
                    self.leg = Leg::ApproachAgain { place };
                }
            }
            Leg::ApproachAgain { place } if there => {
                if position.abs_diff(place) <= config.still_counts {
                    return true;
                }
                if config.kind == HomingKind::Switch || way_back(config, place, position) < 0 {
                    self.leg = Leg::BackOff { place: position };
                }
            }
            Leg::Approach | Leg::ApproachAgain { .. } => {}
        }
        false
    }

    fn command(&self, config: &HomingConfig) -> i16 {
        match self.leg {
            Leg::BackOff { .. } => config.command.saturating_neg(),
            Leg::Approach | Leg::ApproachAgain { .. } => config.command,
        }
    }
}

/// Distance of the axis from the place, on the side that it comes from, counts.
fn way_back(config: &HomingConfig, place: i32, position: i32) -> i64 {
    let beyond = i64::from(position) - i64::from(place);
    if config.command < 0 { beyond } else { -beyond }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STOP: HomingConfig = HomingConfig {
        kind: HomingKind::Stop,
        command: -200,
        position: 0,
        back_off: 20,
        still_samples: 3,
        still_counts: 4,
        timeout_samples: 30,
    };
    const SWITCH: HomingConfig = HomingConfig { kind: HomingKind::Switch, ..STOP };
    const TOWARDS: Progress = Progress::Seeking(-200);
    const AWAY: Progress = Progress::Seeking(200);

    /// The progress at each of these samples.
    fn course<const N: usize>(config: &HomingConfig, samples: [(i32, bool); N]) -> [Progress; N] {
        let mut homing = Homing::default();
        samples.map(|(position, on)| homing.advance(config, position, on))
    }

    fn without_switch<const N: usize>(positions: [i32; N]) -> [Progress; N] {
        course(&STOP, positions.map(|position| (position, false)))
    }

    #[test]
    fn a_stop_is_where_the_encoder_has_stood_still_long_enough_twice() {
        let seen = without_switch([90, 80, 79, 78, 76, 80, 90, 96, 85, 77, 78, 77, 77]);
        assert_eq!(seen[..4], [TOWARDS; 4]);
        assert_eq!(seen[4..7], [AWAY; 3], "back off");
        assert_eq!(seen[7..12], [TOWARDS; 5], "20 counts from it");
        assert_eq!(seen[12], Progress::Found);
    }

    /// Once the place was found wherever the axis stood, and the drive closed its loop on a dead encoder.
    #[test]
    fn an_encoder_that_counts_nothing_finds_no_stop() {
        let seen = without_switch([90; 30]);
        assert_eq!(seen[2..29], [AWAY; 27]);
        assert_eq!(seen[29], Progress::TimedOut);
    }

    #[test]
    fn one_that_counts_only_away_from_the_stop_finds_none_either() {
        let seen = without_switch([80, 80, 80, 90, 101, 101, 101, 101, 101, 101, 101, 101]);
        assert_eq!(seen[4..], [TOWARDS; 8], "it stands short of where it stood before");
    }

    #[test]
    fn an_axis_that_started_late_comes_to_its_stop_behind_the_place_where_it_stood() {
        let seen = without_switch([90, 90, 90, 112, 70, 50, 50, 50, 50, 71, 60, 51, 51, 51, 51]);
        assert_eq!((seen[2], seen[3]), (AWAY, TOWARDS));
        assert_eq!(seen[8], AWAY, "the stop is further on than 90");
        assert_eq!(seen[14], Progress::Found);
    }

    #[test]
    fn a_switch_is_found_at_its_edge_from_either_side() {
        let outside = [(9, false), (-3, true), (10, false), (18, false), (8, false), (-1, true)];
        assert_eq!(course(&SWITCH, outside), [TOWARDS, AWAY, AWAY, TOWARDS, TOWARDS, Progress::Found]);
        let on_it = [(-40, true), (-9, true), (3, false), (-2, true), (20, false), (-3, true)];
        assert_eq!(course(&SWITCH, on_it), [AWAY, AWAY, TOWARDS, AWAY, TOWARDS, Progress::Found]);
    }

    #[test]
    fn a_switch_that_does_not_open_again_is_not_found() {
        let seen = course(&SWITCH, [(9, false), (-3, true), (40, true), (80, true), (90, true)]);
        assert_eq!(seen, [TOWARDS, AWAY, AWAY, AWAY, AWAY]);
    }

    #[test]
    fn the_other_direction_is_its_mirror() {
        let config = HomingConfig { command: 200, ..STOP };
        let seen = course(&config, [-80, -80, -80, -101, -79, -79, -79, -79].map(|at| (at, false)));
        assert_eq!(seen[2..4], [TOWARDS, AWAY], "commands of the other sign");
        assert_eq!(seen[7], Progress::Found);
    }

    #[test]
    fn a_run_that_finds_nothing_ends() {
        let seen = course(&SWITCH, [(-9, false); 30]);
        assert_eq!(seen[28..], [TOWARDS, Progress::TimedOut]);
    }
}
