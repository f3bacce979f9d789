//! The stages of a sample in their order: estimate, setpoint, watch, law, supervise; then, `delay` later, the drive stage.

use crate::config::Config;
use crate::drive::DriveConfig;
use crate::estimator::Motion;
use crate::fault::Fault;
use crate::homing::Progress;
use crate::law::{self, Loop, Measured, Reference, Settings};
use crate::limits::Evidence;
use crate::sequence::Sequence;
use crate::signal::{Command, Observation, Sample};
use crate::state::State;
use crate::supervisor::Mode;

/// The first interrupt: takes the sensor sample of instant k and decides the command that
/// [`output`] will drive `delay` later.
///
/// Before the first sample after a start the drive stood where that one found it: velocity and
/// acceleration of a drive at rest are zero from the first sample on.
pub fn sample(config: &Config, sequence: &Sequence, state: &mut State, input: &Sample) {
    let motion = state.estimate(config, input);
    state.target(config, sequence, motion.position);
    state.watch(config, input, &motion);
    let demand = state.demand(config, &motion, input);
    state.observation.command = state.supervisor.permit(&config.law, config.limits.command(demand));
}

/// The stages of [`sample`], in their order. What was seen goes into the observation at once; what the
/// sample before was made into stands there until it is replaced.
impl State {
    fn estimate(&mut self, config: &Config, input: &Sample) -> Motion {
        self.encoder = input.position;
        let position = input.position.wrapping_sub(self.origin);
        let motion = self.estimator.update(&config.estimator, position);
        self.observation = Observation {
            position,
            velocity: motion.velocity,
            acceleration: motion.acceleration,
            pressure_1: input.pressure_1,
            pressure_2: input.pressure_2,
            spool: match config.drive {
                DriveConfig::Dac(_) => input.spool,
                DriveConfig::Stepper { .. } => self.spool.counted().steps(),
            },
            ..self.observation
        };
        motion
    }

    fn target(&mut self, config: &Config, sequence: &Sequence, position: i32) {
        let was_running = self.supervisor.mode() == Mode::Running;
        let over = was_running && self.sequencer.is_over(&config.motion, sequence);
        let running = was_running && !over;
        let rested = if over {
            self.supervisor.finish();
            self.sequencer.stand();
            self.sequencer.close()
        } else if running {
            self.observation.index = self.sequencer.taken();
            self.sequencer.advance(&config.motion, sequence, position)
        } else {
            false
        };
        if rested {
            self.learn_null(&config.law);
        }
        let setpoint = self.sequencer.setpoint();
        let error = law::error(&config.law, setpoint, position);
        if running {
            self.sequencer.judge(&config.motion, error);
        }
        self.observation = Observation { running, setpoint, error, ..self.observation };
    }

    fn watch(&mut self, config: &Config, input: &Sample, motion: &Motion) {
        let holds_or_runs = matches!(self.supervisor.mode(), Mode::Running | Mode::Done);
        let from_null = match &config.law.settings {
            _ if !(holds_or_runs && config.law.control_loop == Loop::Closed) => 0,
            // The thesis's law costs no call.
            Settings::GainProfile(_) => self.command_from_null(config),
            settings => self.effort_of_any_law(config, settings),
        };
        let evidence = Evidence { motion, input, referenced: self.supervisor.is_referenced(), from_null };
        self.supervisor.watch(&config.limits, &evidence);
    }

    fn command_from_null(&self, config: &Config) -> u32 {
        i32::from(self.observation.command).abs_diff(i32::from(config.law.null_offset))
    }

    /// The effort of a law as a distance of the command from null: that of a valve that is open, where the law pushes anyway.
    #[cold]
    #[inline(never)]
    fn effort_of_any_law(&self, config: &Config, settings: &Settings) -> u32 {
        if self.observation.error.unsigned_abs() > settings.pushes_beyond() {
            config.limits.stall_detector.full
        } else {
            self.command_from_null(config)
        }
    }

    fn demand(&mut self, config: &Config, motion: &Motion, input: &Sample) -> i32 {
        if !matches!(self.supervisor.mode(), Mode::Running | Mode::Done) {
            return self.demand_without_moves(config, motion.position, input.home_switch);
        }
        if config.law.control_loop == Loop::Open {
            return self.demand_in_open_loop(config, motion.position);
        }
        let demand = self.demand_of_law(config, motion);
        if config.motion.on_arrival && self.observation.running && self.sequencer.is_at_exit() {
            self.demand_at_exit(config)
        } else {
            demand
        }
    }

    /// The thesis's law has nothing to remember unless it damps by pressures, and costs no call.
    fn demand_of_law(&mut self, config: &Config, motion: &Motion) -> i32 {
        match &config.law.settings {
            Settings::GainProfile(profile) if config.law.pressure_gain == 0 => {
                // No pressure is looked at with this gain at 0.
                let measured =
                    Measured { motion, pressures: [0; 2], spool: 0, learned: self.null_offset.counts() };
                profile.demand(&config.law, measured, self.reference_of_law())
            }
            _ => self.demand_of_any_law(config),
        }
    }

    /// Without the course of a profile, which few laws follow.
    fn reference_of_law(&self) -> Reference {
        Reference { error: self.observation.error, feed_forward: self.sequencer.feed_forward(), point: None }
    }

    /// Takes what is measured from the observation, so that nothing is kept for it where it is not called.
    #[cold]
    #[inline(never)]
    fn demand_of_any_law(&mut self, config: &Config) -> i32 {
        let Observation { position, velocity, acceleration, pressure_1, pressure_2, spool, .. } =
            self.observation;
        let motion = Motion { position, step: 0, velocity, acceleration };
        let pressures = [pressure_1, pressure_2];
        let measured = Measured { motion: &motion, pressures, spool, learned: self.null_offset.counts() };
        let reference = Reference { point: self.sequencer.point(), ..self.reference_of_law() };
        let demand = self.law.demand(&config.law, measured, reference);
        if let Some(fault) = self.law.fault() {
            self.supervisor.trip(fault);
        }
        demand
    }

    /// Without moves the valve is at its null, but for a homing run.
    #[cold]
    #[inline(never)]
    fn demand_without_moves(&mut self, config: &Config, position: i32, home_switch: bool) -> i32 {
        match self.supervisor.mode() {
            Mode::Homing => self.seek(config, position, home_switch),
            Mode::Armed => self.stand(config, position),
            _ => 0,
        }
    }

    /// An enabled drive whose valve is at its null.
    fn stand(&mut self, config: &Config, position: i32) -> i32 {
        self.supervisor.watch_null(&config.limits, position, self.spool_is_open(config));
        0
    }

    fn demand_in_open_loop(&mut self, config: &Config, position: i32) -> i32 {
        let demand = self.observation.setpoint;
        match self.supervisor.mode() {
            Mode::Done => self.stand(config, position),
            _ if self.supervisor.is_referenced() => config.limits.hold_back(demand, position),
            _ => demand,
        }
    }

    /// At an exit (thesis 6.3.2) the valve of a closed loop stays as it is, and a stepper gets no pulse.
    #[cold]
    fn demand_at_exit(&self, config: &Config) -> i32 {
        i32::from(match config.drive {
            DriveConfig::Dac(_) => self.observation.command,
            DriveConfig::Stepper { .. } => self.spool.counted().steps(),
        })
    }

    /// A sample of the homing run.
    fn seek(&mut self, config: &Config, position: i32, home_switch: bool) -> i32 {
        let from_null = i32::from(self.observation.command).abs_diff(i32::from(config.law.null_offset));
        let effort = config.limits.stall_detector.effort(from_null).unwrap_or(0);
        if self.homing.pushed_for(&config.homing, position, effort) > config.limits.stall_detector.most {
            self.supervisor.trip(Fault::NoMotion);
            return 0;
        }
        match self.homing.advance(&config.homing, position, home_switch) {
            Progress::Seeking(command) => return i32::from(command),
            Progress::Found => {
                self.set_origin(config.homing.position);
                self.supervisor.homed();
            }
            Progress::TimedOut => self.supervisor.trip(Fault::HomingFailed),
        }
        0
    }
}

/// The second interrupt: what the drive stage does now, `delay` after the sample.
///
/// The supervisor is asked again, since requests come between the two calls: after a stop the output
/// is disabled, after an arming it is null, whatever the sample was made into. A stepper then walks to
/// mid-travel one pulse a sample; its translator stays enabled until the spool is there, for a spool
/// left open would go on moving the cylinder. A spool whose location is in doubt gets no pulse.
#[must_use]
pub fn output(config: &Config, state: &mut State) -> Command {
    let drives = state.supervisor.drives();
    let counts = state.supervisor.permit(&config.law, state.observation.command);
    match config.drive {
        DriveConfig::Dac(_) => Command { counts, step: 0, drive_enable: drives },
        DriveConfig::Stepper { .. } => {
            let drive_enable = drives || state.spool.walks();
            Command { counts, step: state.spool.step_toward(counts), drive_enable }
        }
    }
}
