//! The supervisor decides when the cylinder may move: modes, limits and the fault latch.
//!
//! ```text
//! disarmed --arm--> armed --start--> running --end of the moves--> done
//!                   armed --home--> homing --stop or switch found--> armed, referenced
//!
//! disarm: from every mode but fault to disarmed
//! trip:   from every mode to fault (a stop, a limit, the board); arm: from fault to armed
//! ```
//!
//! The supervisor has the last word on every command. `permit` is the only way from the law to the drive stage, and
//! `output` asks it again. A trip acts at the output of the same sample. Only an explicit re-arm leaves the fault mode.
//!
//! This is not a safety-rated function: a machine needs a hardware emergency stop.

use crate::fault::Fault;
use crate::law::{LawConfig, Loop};
use crate::limits::{Evidence, Limits, Watch};

/// The mode of the drive. One byte holds the mode, in the order of what it permits, and one holds the fault. So the
/// comparisons of modes at every sample are comparisons of numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Mode {
    /// Drive disabled, valve at null. The mode after a reset.
    #[default]
    Disarmed,
    /// Tripped: drive disabled, valve at null, until re-armed.
    Fault(Fault),
    /// Drive enabled, valve at null, ready to start.
    Armed,
    /// The moves are over: a closed loop holds the last setpoint, an open loop is at null.
    Done,
    /// The law drives the valve.
    Running,
    /// On the way to the stop or the switch that references the axis.
    Homing,
}

/// Why a request was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    /// Start: the drive is not armed.
    NotArmed = 1,
    /// The request must wait for the end of the run (or a stop).
    Running = 2,
    /// Closed loop: the axis has not been referenced.
    NotReferenced = 3,
    /// Only while disarmed: configuration and moves stay as they are under power.
    NotDisarmed = 4,
    /// There is no move to run.
    NoMoves = 5,
    /// The spool of a stepper valve is still on its way to mid-travel.
    ValveNotAtNull = 6,
    /// A setpoint lies beyond a soft limit.
    BeyondSoftLimit = 7,
    /// The stored configuration is damaged: load or save one first.
    NoConfiguration = 8,
    /// Since a reset the spool of a stepper valve may be one step away from its assumed location.
    SpoolInDoubt = 9,
    /// Since a reset the spool location of a stepper valve is not known.
    SpoolLost = 10,
    /// Arm: the board's converter has no code for the largest command.
    NoCode = 11,
}

impl Refusal {
    /// Every refusal, in the order of the codes.
    pub const ALL: [Refusal; 11] = [
        Refusal::NotArmed,
        Refusal::Running,
        Refusal::NotReferenced,
        Refusal::NotDisarmed,
        Refusal::NoMoves,
        Refusal::ValveNotAtNull,
        Refusal::BeyondSoftLimit,
        Refusal::NoConfiguration,
        Refusal::SpoolInDoubt,
        Refusal::SpoolLost,
        Refusal::NoCode,
    ];

    /// The sent code.
    #[must_use]
    pub fn code(self) -> u8 {
        self as u8
    }

    /// The refusal with this code.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Refusal> {
        Refusal::ALL.into_iter().find(|refusal| refusal.code() == code)
    }
}

/// The mode, the reference flag and the fault latch.
///
/// ```
/// use pneudrive_controller::{Fault, Mode};
/// use pneudrive_controller::supervisor::Supervisor;
///
/// let mut supervisor = Supervisor::default();
/// supervisor.arm()?;
/// supervisor.trip(Fault::LateSample);
/// supervisor.trip(Fault::Stop);
/// supervisor.disarm();
/// assert_eq!(supervisor.mode(), Mode::Fault(Fault::LateSample), "the first fault stays");
/// supervisor.arm()?;
/// assert_eq!(supervisor.mode(), Mode::Armed);
/// # Ok::<(), pneudrive_controller::Refusal>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Supervisor {
    mode: Mode,
    referenced: bool,
    watch: Watch,
}

impl Supervisor {
    /// The present mode.
    #[must_use]
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether the axis is referenced.
    #[must_use]
    pub fn is_referenced(&self) -> bool {
        self.referenced
    }

    /// References the axis (a reference run, or a simulated rig).
    pub fn set_referenced(&mut self) {
        self.referenced = true;
    }

    /// Takes the reference away, until the next one.
    pub fn clear_referenced(&mut self) {
        self.referenced = false;
    }

    /// Whether the drive is enabled.
    #[must_use]
    pub fn drives(&self) -> bool {
        matches!(self.mode, Mode::Armed | Mode::Running | Mode::Done | Mode::Homing)
    }

    /// Whether the cylinder is in motion.
    #[must_use]
    pub fn moves(&self) -> bool {
        matches!(self.mode, Mode::Running | Mode::Homing)
    }

    /// Enables the drive with the valve at null; leaves the fault mode.
    ///
    /// # Errors
    /// While a run is on.
    pub fn arm(&mut self) -> Result<(), Refusal> {
        match self.mode {
            Mode::Running | Mode::Homing => Err(Refusal::Running),
            before => {
                self.mode = Mode::Armed;
                self.watch =
                    if before == Mode::Done { Watch::of_a_coasting_axis() } else { Watch::default() };
                Ok(())
            }
        }
    }

    /// Disables the drive. A fault stays latched.
    pub fn disarm(&mut self) {
        if !matches!(self.mode, Mode::Fault(_)) {
            self.mode = Mode::Disarmed;
        }
    }

    /// Lets the law drive from the next sample on.
    ///
    /// # Errors
    /// When the drive is not armed, or a closed loop has no reference. From the disarmed mode this also trips,
    /// because a program means to move a cylinder that nobody has armed.
    pub(crate) fn start(&mut self, control_loop: Loop, spool_is_open: bool) -> Result<(), Refusal> {
        if self.mode == Mode::Armed && control_loop == Loop::Closed && !self.referenced {
            return Err(Refusal::NotReferenced);
        }
        self.set_off(Mode::Running, spool_is_open)
    }

    /// Lets the homing run drive from the next sample on. The axis has no reference until the run has ended.
    ///
    /// # Errors
    /// As for a start, except for the reference, and without a trip: the request comes from a person who has
    /// forgotten to arm the drive, not from a program that continues a test.
    pub(crate) fn home(&mut self, spool_is_open: bool) -> Result<(), Refusal> {
        if self.mode == Mode::Disarmed {
            return Err(Refusal::NotArmed);
        }
        self.set_off(Mode::Homing, spool_is_open)?;
        self.referenced = false;
        Ok(())
    }

    /// From armed to a mode that moves.
    fn set_off(&mut self, mode: Mode, spool_is_open: bool) -> Result<(), Refusal> {
        match self.mode {
            Mode::Armed if spool_is_open => Err(Refusal::ValveNotAtNull),
            Mode::Armed => {
                self.mode = mode;
                Ok(())
            }
            Mode::Running | Mode::Homing => Err(Refusal::Running),
            Mode::Disarmed => {
                self.trip(Fault::CommandWhileDisarmed);
                Err(Refusal::NotArmed)
            }
            Mode::Done | Mode::Fault(_) => Err(Refusal::NotArmed),
        }
    }

    /// Ends the homing run: the axis is referenced, the valve is at null.
    pub(crate) fn homed(&mut self) {
        self.mode = Mode::Armed;
        self.referenced = true;
        self.watch = Watch::of_a_coasting_axis();
    }

    /// Disables the drive and latches the fault. An earlier fault stays.
    pub fn trip(&mut self, fault: Fault) {
        if !matches!(self.mode, Mode::Fault(_)) {
            self.mode = Mode::Fault(fault);
        }
    }

    /// Ends the moves.
    pub(crate) fn finish(&mut self) {
        if self.mode == Mode::Running {
            self.mode = Mode::Done;
            self.watch.coasts();
        }
    }

    /// Trips an enabled drive that is beyond its limits. A disarmed axis may be pushed by hand.
    pub(crate) fn watch(&mut self, limits: &Limits, seen: &Evidence) {
        if !self.drives() {
            return;
        }
        if let Some(fault) = self.watch.judge(limits, seen) {
            self.trip_beyond(fault);
        }
    }

    #[cold]
    #[inline(never)]
    fn trip_beyond(&mut self, fault: Fault) {
        self.trip(fault);
        // Nobody knows how many counts an encoder has lost or made up.
        self.referenced &= fault != Fault::EncoderStep;
    }

    /// Trips a drive that moves although its command is null. `spool_is_open`: a stepper's spool is still on its way
    /// to null.
    #[cold]
    #[inline(never)]
    pub(crate) fn watch_null(&mut self, limits: &Limits, position: i32, spool_is_open: bool) {
        if self.watch.runs_away(limits, position, spool_is_open) {
            self.trip(Fault::MotionAtNull);
        }
    }

    /// The command that may go to the drive stage: the law's while running or holding in closed loop, the homing
    /// run's, else null.
    pub(crate) fn permit(&self, law: &LawConfig, command: i16) -> i16 {
        match (self.mode, law.control_loop) {
            (Mode::Running | Mode::Homing, _) | (Mode::Done, Loop::Closed) => command,
            _ => 0,
        }
    }
}
