//! Replay of the recorded inputs of a TARGET file through the controller on the PC: it proves with a real cylinder that
//! board and PC compute the same.
//!
//! Position and pressures of each sample go in; command, error and, for a stepper, SPLLOC come out and
//! are compared with the recorded ones, bit for bit. Recorded positions count from the reference, so the
//! replay runs with the origin 0. Facts that are not in the file are found as follows:
//!
//! - **Moves** ([`moves`]). The header has them with their profiles, and the controller makes the setpoints of them again.
//!   A file may lack them. Closed loop: setpoint = position + error. Open loop: the
//!   moves are the commands themselves, so such a record proves the limits and the stepper, not the law.
//! - **Arrival.** A move begins at its recorded sample and, with `on_arrival`, also waits for the end of the one
//!   before, as on the board. So arrival and learning are the same as on the board.
//! - **The end of the run.** A trip of the controller is reproduced; the recorder stores no sample after it.
//!   External causes (a stop, a late sample, a silent host) are in no sample: the record ends before them.
//! - **Two things are tried both ways**: whether an open loop was referenced, and, where the null offset is
//!   learned, whether a run that begins with a setpoint that is held anyway began with a move to it.
//!
//! Not in a file without moves, and so no part of its replay: a move to the setpoint that holds already (it matters to
//! what is learned of the null, and where it ends at once: its exit keeps the command). Not in any file: pressures that
//! were bad in the last samples before the start.

pub mod moves;
pub mod parameters;

use std::cmp::Reverse;

use pneudrive_app::recorder::recorded;
use pneudrive_controller::config::ConfigError;
use pneudrive_controller::drive::DriveConfig;
use pneudrive_controller::law::Loop;
use pneudrive_controller::{Config, Fault, Mode, Observation, Refusal, Sample, State, output, sample};
use pneudrive_protocol::{RecordedSample, RequestRefusal};
use pneudrive_records::target::{IMPORTED, TargetFile};
use pneudrive_records::{test_lines, words};
use pneudrive_sim::known::{Known, Units};

use moves::Plan;
use parameters::Header;

/// The output of the controller on the PC for a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Whether the run was on. The recorder stores such samples only.
    pub running: bool,
    /// The command.
    pub command: i16,
    /// Setpoint less position, saturated to 16 bits.
    pub error: i16,
    /// SPLLOC; for a DAC the recorded spool sensor.
    pub spool: i16,
}

impl Output {
    fn of(seen: &Observation) -> Output {
        let RecordedSample { command, error, spool, .. } = recorded(seen);
        Output { running: seen.running, command, error, spool }
    }
}

/// The compared quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparedQuantity {
    /// The sample itself: it was recorded after the run had ended on the PC.
    Sample,
    /// `dac_counts`.
    Command,
    /// `spool_raw` of a stepper.
    SpoolLocation,
    /// `error_counts`.
    Error,
}

impl ComparedQuantity {
    /// How to read a pair of numbers.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ComparedQuantity::Sample => "sample of the run",
            ComparedQuantity::Command => "command",
            ComparedQuantity::SpoolLocation => "spool location",
            ComparedQuantity::Error => "error",
        }
    }
}

/// Where record and replay part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// k of the sample.
    pub index: i32,
    /// The quantity that differs.
    pub what: ComparedQuantity,
    /// The record's side; for [`ComparedQuantity::Sample`] 1.
    pub recorded: i16,
    /// The replay's side; for [`ComparedQuantity::Sample`] 0.
    pub replayed: i16,
    /// Whether the setpoint was taken from another sample, because the recorded error is at the limit of
    /// its 16 bits.
    pub inferred: bool,
}

/// A replayed record.
#[derive(Clone, Debug)]
pub struct Replay {
    /// The recorded samples from k = 0 on; the place of a sample is its k.
    pub recorded: Vec<RecordedSample>,
    /// The output of the controller on the PC for each.
    pub replayed: Vec<Output>,
    /// What the law knew at each; nothing without the rig of the record ([`crate::known`]).
    pub known: Vec<Option<Known>>,
    /// The first difference.
    pub first: Option<Difference>,
    /// Samples that are different.
    pub differences: usize,
    /// The fault that ended the run on the PC, and its sample.
    pub tripped: Option<(Fault, i32)>,
    /// Whether a stepper drives the valve: then the spool location is computed and compared.
    pub stepper: bool,
    /// Whether the moves are the commands.
    pub open_loop: bool,
    /// Whether the record has no pressures, because the rig had no sensors.
    pub no_pressures: bool,
    /// Remarks on the file's header: parameters that only one side has.
    pub notes: Vec<String>,
}

/// Why a file cannot be replayed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplayError {
    /// Another recorder's log.
    #[error("it was imported from {0}: the commands in it are not those of this controller")]
    Imported(String),
    /// Samples are missing.
    #[error(
        "its decimation is {0}: the controller ran on samples that are not in the file; record the run again with test.decimation=1, or stream it with --every 1"
    )]
    Decimation(String),
    /// A line of the header is not there or not readable.
    #[error("its header has no readable line `# {key} = ...`: {found}")]
    Header {
        /// The key.
        key: String,
        /// The text there.
        found: String,
    },
    /// A value is outside the range of its parameter.
    #[error("its header has {name} = {value}, which is out of range: {min} to {max}")]
    OutOfRange {
        /// The parameter.
        name: String,
        /// The value.
        value: i32,
        /// Smallest allowed value.
        min: i32,
        /// Largest allowed value.
        max: i32,
    },
    /// The parameters are not valid for any controller.
    #[error("the parameters in its header are inconsistent: {}", .0.advice())]
    Inconsistent(ConfigError),
    /// There is no sample of a run.
    #[error("it has no sample k = 0: the replay begins with the first sample of a run; record one")]
    NoStart,
    /// A sample is not where it should be.
    #[error(
        "sample {found} is in the place of sample {expected}: a gap. Record the run again, or import the part of the log before or behind it"
    )]
    Gap {
        /// The k that comes next.
        expected: i32,
        /// The k that came.
        found: i32,
    },
    /// No sample of a move shows its setpoint.
    #[error(
        "the setpoint of samples {first} to {last} is not in the file: their error is at the limit of 16 bits, and no sample of the same move is nearer than 32767 counts; record a run that comes nearer to each setpoint"
    )]
    SetpointUnknown {
        /// First sample without a setpoint.
        first: i32,
        /// Last one.
        last: i32,
    },
    /// Position and error do not make a setpoint.
    #[error(
        "position and error of sample {0} give no setpoint of 32 bits; the recorder did not write this file"
    )]
    NoSetpoint(i32),
    /// The setpoint changes more often than a test has moves.
    #[error(
        "the setpoint changes at sample {0} for the 65th time, but a test has at most 64 moves; repeated moves (test.repeat_every_s) are not marked in a file, so cut it to fewer"
    )]
    TooManyMoves(i32),
    /// The lines of its moves are invalid.
    #[error("{0}")]
    Test(String),
    /// The controller would not have run this.
    #[error("the controller refuses to run it: {}", words::refusal(&RequestRefusal::NotNow(.0.code())))]
    Refused(Refusal),
}

/// Replays a file.
///
/// # Errors
/// When the file lacks data that a replay needs.
pub fn replay(file: &TargetFile) -> Result<Replay, ReplayError> {
    replay_watched(file, None)
}

/// The same, with a look at what the law knows, in these units.
pub(crate) fn replay_watched(file: &TargetFile, units: Option<&Units>) -> Result<Replay, ReplayError> {
    if let Some(log) = file.get(IMPORTED) {
        return Err(ReplayError::Imported(log.to_owned()));
    }
    let header = Header::of(file)?;
    let config = Config::new(&header.parameters).map_err(ReplayError::Inconsistent)?;
    let recorded = samples(file)?;
    let mut best: Option<Replay> = None;
    let test = test_lines::sequence(&file.header).map_err(|error| ReplayError::Test(format!("{error:#}")))?;
    let plans = match test {
        Some(test) => moves::of_test(&config, &test, recorded.len()),
        None => moves::plans(&config, &recorded)?,
    };
    for plan in plans {
        let replay = Replay { notes: header.notes.clone(), ..run(&config, &plan, &recorded, units)? };
        if best.as_ref().is_none_or(|best| replay.likeness() > best.likeness()) {
            best = Some(replay);
        }
    }
    best.ok_or(ReplayError::NoStart)
}

/// The samples of the run, those from before the start left out.
///
/// # Errors
/// When the file does not hold each sample from the start on.
pub fn samples(file: &TargetFile) -> Result<Vec<RecordedSample>, ReplayError> {
    let decimation = file.get("decimation").unwrap_or("not stated");
    if decimation != "1" {
        return Err(ReplayError::Decimation(decimation.to_owned()));
    }
    let of_the_run = || file.samples.iter().filter(|(index, _)| *index >= 0);
    if of_the_run().next().is_none_or(|(index, _)| *index != 0) {
        return Err(ReplayError::NoStart);
    }
    for (expected, (found, _)) in (0..).zip(of_the_run()) {
        if *found != expected {
            return Err(ReplayError::Gap { expected, found: *found });
        }
    }
    Ok(of_the_run().map(|(_, sample)| *sample).collect())
}

/// The controller on the recorded inputs.
fn run(
    config: &Config,
    plan: &Plan,
    recorded: &[RecordedSample],
    units: Option<&Units>,
) -> Result<Replay, ReplayError> {
    let mut state = started(config, plan)?;
    let mut known = Vec::new();
    let mut replayed = Vec::with_capacity(recorded.len());
    let mut tripped = None;
    for (k, seen) in (0..).zip(recorded) {
        sample(config, &plan.sequence, &mut state, &input(seen));
        replayed.push(Output::of(state.observation()));
        known.extend(units.map(|units| units.known(&state)));
        if let Mode::Fault(fault) = state.supervisor.mode() {
            tripped = tripped.or(Some((fault, k)));
        }
        let _ = output(config, &mut state);
    }
    let stepper = matches!(config.drive, DriveConfig::Stepper { .. });
    let open_loop = config.law.control_loop == Loop::Open;
    let mut replay = Replay {
        recorded: recorded.to_vec(),
        replayed,
        known,
        first: None,
        differences: 0,
        tripped,
        stepper,
        open_loop,
        no_pressures: config.pressure_mask == 0,
        notes: Vec::new(),
    };
    replay.compare(plan);
    Ok(replay)
}

/// A drive that runs the moves from the next sample on.
fn started(config: &Config, plan: &Plan) -> Result<State, ReplayError> {
    let mut state = State::default();
    if plan.referenced {
        state.supervisor.set_referenced();
    }
    state.supervisor.arm().map_err(ReplayError::Refused)?;
    state.start(config, &plan.sequence).map_err(ReplayError::Refused)?;
    Ok(state)
}

fn input(recorded: &RecordedSample) -> Sample {
    Sample {
        position: recorded.position,
        pressure_1: recorded.pressure_1,
        pressure_2: recorded.pressure_2,
        spool: recorded.spool,
        home_switch: false,
    }
}

impl Replay {
    /// Samples before the first difference.
    #[must_use]
    pub fn equal_samples(&self) -> usize {
        self.first.map_or(self.recorded.len(), |first| first.index as usize)
    }

    /// More for a replay that is more like the record.
    fn likeness(&self) -> (usize, Reverse<usize>) {
        (self.equal_samples(), Reverse(self.differences))
    }

    fn compare(&mut self, plan: &Plan) {
        let pairs = self.recorded.iter().zip(&self.replayed);
        let mut found = (0..).zip(pairs).filter_map(|(index, (recorded, replayed))| {
            let (what, recorded, replayed) = difference(recorded, replayed, self.stepper)?;
            let inferred = plan.inferred.get(index as usize).copied().unwrap_or(false);
            Some(Difference { index, what, recorded, replayed, inferred })
        });
        let first = found.next();
        let others = found.count();
        self.first = first;
        self.differences = usize::from(first.is_some()) + others;
    }
}

/// The difference at a sample, and both sides of it.
fn difference(
    recorded: &RecordedSample,
    replayed: &Output,
    stepper: bool,
) -> Option<(ComparedQuantity, i16, i16)> {
    let compared = [
        (ComparedQuantity::Sample, 1, i16::from(replayed.running)),
        (ComparedQuantity::Command, recorded.command, replayed.command),
        (
            ComparedQuantity::SpoolLocation,
            recorded.spool,
            if stepper { replayed.spool } else { recorded.spool },
        ),
        (ComparedQuantity::Error, recorded.error, replayed.error),
    ];
    compared.into_iter().find(|(_, recorded, replayed)| recorded != replayed)
}

#[cfg(test)]
mod tests;
