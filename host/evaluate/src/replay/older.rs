//! Rules of older firmware: its records are replayed by the rules with which they were made.
//!
//! A header names every parameter that its firmware had. What is missing tells which rules it is older than:
//!
//! | rule | older firmware | lacks |
//! |---|---|---|
//! | no motion ([`pneudrive_controller::limits`]) | noticed only while the command was more than half of the largest one, whatever the null offset | `late_output_us` |
//! | exits ([`pneudrive_controller::sequencer`]) | a command was given at them, too | `homing_back_off_counts` |
//! | end positions | none | the end position |

use pneudrive_controller::law::Loop;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Config, Parameters};
use pneudrive_records::target::TargetFile;

/// Whether the firmware that recorded a file had the older watch for a valve that moves nothing.
pub(super) fn has_older_watch(file: &TargetFile) -> bool {
    file.get("param.late_output_us").is_none()
}

/// Whether the firmware that recorded a file gave a command at an exit.
pub(super) fn commands_at_exit(file: &TargetFile) -> bool {
    file.get("param.homing_back_off_counts").is_none()
}

/// What a parameter is that the header does not name.
pub(super) fn unnamed() -> Parameters {
    let mut parameters = Parameters::default();
    for (id, none) in [(id::END_MIN_COUNTS, -i32::MAX), (id::END_MAX_COUNTS, i32::MAX)] {
        parameters.set(id, none).unwrap_or_else(|error| panic!("an end of the table: {error:?}"));
    }
    parameters
}

/// The older watch for a valve that moves nothing.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    /// Samples that a wide open valve may move nothing; 0: any number.
    samples: u32,
    /// So far from where it stood is motion, counts.
    tolerance: u32,
    at: i32,
    stood: u32,
}

impl Watch {
    /// The watch of these parameters, which takes the place of the controller's own.
    pub fn instead(config: &mut Config, parameters: &Parameters) -> Watch {
        config.limits.no_motion.most = u32::MAX;
        let time_ms = parameters.get(id::NO_MOTION_MS).unwrap_or(0).unsigned_abs();
        let samples = time_ms.saturating_mul(1000) / config.timing.period_us;
        Watch {
            samples: samples.max(u32::from(time_ms > 0)),
            tolerance: config.limits.no_motion_counts,
            at: 0,
            stood: 0,
        }
    }

    /// Whether it trips at a sample of a run; `command` was in force before.
    pub fn trips(&mut self, config: &Config, command: i16, position: i32) -> bool {
        let largest = i32::from(config.drive.largest());
        let pushes = config.law.control_loop == Loop::Closed && 2 * i32::from(command).abs() > largest;
        if pushes && position.abs_diff(self.at) <= self.tolerance {
            self.stood = self.stood.saturating_add(1);
        } else {
            (self.at, self.stood) = (position, 0);
        }
        self.samples > 0 && self.stood >= self.samples
    }
}
