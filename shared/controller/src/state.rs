//! What changes while the controller runs, and the requests to it: arm, start, redirect, home, reference.

use crate::config::Config;
use crate::drive::SpoolLocation;
use crate::estimator::Estimator;
use crate::homing::Homing;
use crate::law::cascade::kept::Kept;
use crate::law::{LawConfig, Loop, Running, Settings};
use crate::learning::NullOffset;
use crate::sequence::Sequence;
use crate::sequencer::Sequencer;
use crate::signal::{Command, Observation};
use crate::spool::Spool;
use crate::supervisor::{Mode, Refusal, Supervisor};

/// Everything that changes while the controller runs. [`Config`] and [`Sequence`] do not.
///
/// The law, which may be large, stands last: instructions reach what stands before it without computing an address.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct State {
    pub(crate) estimator: Estimator,
    pub(crate) sequencer: Sequencer,
    pub(crate) homing: Homing,
    /// Modes, faults and the reference flag; requests go to it directly (`arm`, `disarm`, `trip`).
    pub supervisor: Supervisor,
    pub(crate) null_offset: NullOffset,
    pub(crate) observation: Observation,
    pub(crate) spool: Spool,
    /// The encoder's own count, and what is taken off it to make a position.
    pub(crate) encoder: i32,
    pub(crate) origin: i32,
    /// None before the first run.
    pub(crate) law: Running,
}

impl State {
    /// What the last sample was made into: the record of the six channels is taken from it.
    #[must_use]
    pub fn observation(&self) -> &Observation {
        &self.observation
    }

    /// SPLLOC: where the pulses have taken the spool of a stepper valve since mid-travel.
    #[must_use]
    pub fn spool_location(&self) -> SpoolLocation {
        self.spool.counted()
    }

    /// What a board keeps of a stepper's spool through a reset, once the pulse of this command has begun; None where
    /// nothing is known that it does not keep already. A spool that arrives counts as open until its last pulse is over.
    #[must_use]
    pub fn spool_to_keep(&self, config: &Config, command: &Command) -> Option<SpoolLocation> {
        let now = self.spool.sure().filter(|_| config.drive.is_stepper())?;
        let arrives = command.step != 0 && now == SpoolLocation::default();
        Some(if arrives { SpoolLocation::at(-i16::from(command.step)) } else { now })
    }

    /// Whether the valve has a stepper whose spool is known to be away from mid-travel.
    #[must_use]
    pub fn spool_is_open(&self, config: &Config) -> bool {
        config.drive.is_stepper() && self.spool.is_open()
    }

    /// After a reset: where the spool was before it, if the board has kept that.
    pub fn take_up_spool(&mut self, kept: Option<SpoolLocation>) {
        self.spool = Spool::after_reset(kept);
    }

    /// Enables the drive with the valve at null; leaves the fault mode.
    ///
    /// # Errors
    /// While a run is on, and when it is not known where a stepper's spool is.
    pub fn arm(&mut self, config: &Config) -> Result<(), Refusal> {
        self.check_spool(config)?;
        self.supervisor.arm()
    }

    /// Whether it is known where a stepper's spool is.
    ///
    /// # Errors
    /// When it is not since a reset.
    pub fn check_spool(&self, config: &Config) -> Result<(), Refusal> {
        if config.drive.is_stepper() { self.spool.check() } else { Ok(()) }
    }

    /// Walks a stepper's spool back from where it was before a reset, one pulse a sample; its translator is enabled
    /// until it is at mid-travel. The drive must be disabled; who calls this sees to it.
    ///
    /// # Errors
    /// When it is not known where it was.
    pub fn seek_null(&mut self) -> Result<(), Refusal> {
        self.spool.seek()
    }

    /// A stepper's spool is at mid-travel. The drive must be disabled; who calls this sees to it.
    ///
    /// # Errors
    /// While it is on its way there.
    pub fn at_null(&mut self) -> Result<(), Refusal> {
        self.spool.at_null()
    }

    /// Which move of the run is in force, and how it stands.
    #[must_use]
    pub fn sequencer(&self) -> &Sequencer {
        &self.sequencer
    }

    /// What this run has learned of the valve's null, counts: the next run starts with the null offset
    /// of the parameters, so it is to be added there.
    #[must_use]
    pub fn learned_null_offset(&self) -> i32 {
        self.null_offset.counts()
    }

    /// Forgets the learned offset, which has become part of the parameters.
    pub fn forget_null_offset(&mut self) {
        self.null_offset = NullOffset::default();
    }

    /// What the next run is to begin with, by what the last one has learned; None: nothing is kept, or none has run since
    /// [`State::forget_run`].
    #[must_use]
    pub fn kept(&self, config: &Config) -> Option<Kept> {
        let fault = match self.supervisor.mode() {
            Mode::Fault(fault) => Some(fault),
            _ => None,
        };
        match (&self.law, &config.law.settings) {
            (Running::Cascade(law), Settings::Cascade(settings)) => law.keep(settings, fault),
            _ => None,
        }
    }

    /// The last run has told what is kept of it.
    pub fn forget_run(&mut self) {
        if let Running::Cascade(law) = &mut self.law {
            law.leave();
        }
    }

    /// The law that runs, or ran last, with what it remembers.
    #[must_use]
    pub fn law(&self) -> &Running {
        &self.law
    }

    /// Whether the axis rests outside the tolerance of its moves, where it is not in position. Only the law that knows its drive
    /// says that it rests.
    #[must_use]
    pub fn rests_outside(&self, config: &Config) -> bool {
        let holds = matches!(self.supervisor.mode(), Mode::Running | Mode::Done);
        let stands = matches!(&self.law, Running::Cascade(law) if law.stands());
        holds && stands && self.observation.error.unsigned_abs() > config.motion.tolerance
    }

    /// Runs from k = 0 at the next sample, or says why not.
    ///
    /// # Errors
    /// The [`Refusal`] that names what forbids the start.
    pub fn start(&mut self, config: &Config, sequence: &Sequence) -> Result<(), Refusal> {
        if self.supervisor.mode() == Mode::Armed {
            sequence.check(&config.limits, config.law.control_loop == Loop::Closed)?;
        }
        self.supervisor.start(config.law.control_loop, self.spool_is_open(config))?;
        self.begin_anew(Sequencer::new(sequence, config.law.control_loop == Loop::Closed));
        self.law = Running::begin(&config.law);
        Ok(())
    }

    /// The moves are over before the end of the run: a closed loop holds the last setpoint.
    pub fn finish(&mut self) {
        self.supervisor.finish();
        self.sequencer.stand();
        self.sequencer.close();
    }

    /// While a run is on: from the next sample on its setpoint is `target`, as if a step of its sequence began there.
    /// Moves of the sequence that become due later still hold. It is for loops whose setpoints are not known
    /// beforehand: counts in closed loop, valve counts in open loop.
    ///
    /// # Errors
    /// When no run is on, or the setpoint of a closed loop lies beyond a soft limit.
    pub fn redirect(&mut self, config: &Config, target: i32) -> Result<(), Refusal> {
        if self.supervisor.mode() != Mode::Running {
            return Err(Refusal::NoMoves);
        }
        if config.law.control_loop == Loop::Closed && !config.limits.allows(target) {
            return Err(Refusal::BeyondSoftLimit);
        }
        if self.sequencer.redirect(target) {
            self.learn_null(&config.law);
        }
        Ok(())
    }

    /// Homes the axis from the next sample on, or says why not.
    ///
    /// # Errors
    /// The [`Refusal`] that names what forbids it.
    pub fn home(&mut self, config: &Config) -> Result<(), Refusal> {
        self.supervisor.home(self.spool_is_open(config))?;
        self.homing = Homing::default();
        self.begin_anew(Sequencer::default());
        Ok(())
    }

    /// Works out the next setpoint of a profile between two samples. Otherwise [`crate::sample`] does so itself, and takes longer.
    pub fn prepare(&mut self, config: &Config, sequence: &Sequence) {
        self.sequencer.prepare(&config.motion, sequence);
    }

    fn begin_anew(&mut self, sequencer: Sequencer) {
        self.sequencer = sequencer;
        self.estimator.forget();
        self.law = Running::default();
        self.null_offset = NullOffset::default();
        self.observation = Observation::default();
    }

    /// The axis stands at `position` now: counts mean positions from here on. The drive must be
    /// disabled; who calls this sees to it.
    pub fn reference(&mut self, position: i32) {
        self.set_origin(position);
        self.supervisor.set_referenced();
    }

    /// The encoder is absolute, and reads 0 at this position: counts mean positions from here on, wherever the axis
    /// stands. A homing run ends before its first sample.
    pub fn locate(&mut self, zero: i32) {
        self.reference(self.encoder.wrapping_add(zero));
        if self.supervisor.mode() == Mode::Homing {
            self.supervisor.homed();
        }
    }

    /// Learns the valve's null from the error that is left at rest.
    pub(crate) fn learn_null(&mut self, law: &LawConfig) {
        self.null_offset.learn(law.learning_gain, self.observation.error, law.scale);
    }

    pub(crate) fn set_origin(&mut self, position: i32) {
        self.origin = self.encoder.wrapping_sub(position);
        self.observation.position = position;
        self.estimator.forget();
    }
}
