//! One run: the real controller on the simulated plant, as fast as it goes.

use pneudrive_controller::{Command, Config, Fault, Mode, Observation, Sequence, State, output, sample};

use crate::component::sensors::Reading;
use crate::keys;
use crate::plant::{Accuracy, Plant, PlantWork};
use crate::positive_gain::PositiveGain;
use crate::trace::Row;
use crate::values::{Rig, seconds, whole_microseconds};
use pneudrive_solver::IntegrationError;

/// What came out of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// The transient.
    pub rows: Vec<Row>,
    /// What the controller made of each sample: the integers that every rung must repeat.
    pub observations: Vec<Observation>,
    /// What the sensors were given at each sample.
    pub readings: Vec<Reading>,
    /// What was driven from each sample's output on.
    pub commands: Vec<Command>,
    /// The fault that ended the control, if one did, and the sample at which it tripped.
    pub fault: Option<(Fault, u32)>,
    /// What it has cost.
    pub work: PlantWork,
}

/// What rows hold besides what every trace has. It does not change the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recording {
    /// The air inside the valve.
    pub valve: bool,
}

/// Where the next row of the trace is due.
struct Rows {
    period_us: u64,
    next_us: u64,
    end_us: u64,
    recording: Recording,
    rows: Vec<Row>,
}

impl Rows {
    /// Those of a rig's test.
    fn of(rig: &Rig, recording: Recording) -> Rows {
        let every = rig.get(&keys::test::TRACE_PERIOD_S).and_then(whole_microseconds);
        let period_us = every.unwrap_or(u64::from(rig.period_us().get()));
        let end_us = rig.microseconds(&keys::test::DURATION_S);
        let rows = Vec::with_capacity(room_for(end_us / period_us));
        Rows { period_us, next_us: 0, end_us, recording, rows }
    }

    /// Rows due before `until_us` and not after the end.
    fn catch_up(
        &mut self,
        plant: &mut Plant,
        seen: &Observation,
        until_us: u64,
    ) -> Result<(), IntegrationError> {
        while self.next_us < until_us && self.next_us <= self.end_us {
            let time = seconds(self.next_us);
            let snapshot = plant.look(time)?;
            let valve = self.recording.valve.then(|| plant.look_into_valve(time));
            self.rows.push(Row { time, observation: *seen, plant: snapshot, valve });
            self.next_us += self.period_us;
        }
        Ok(())
    }
}

/// Runs the test of a rig. The drive starts referenced, armed and at rest.
///
/// # Errors
/// When the integration cannot go on.
pub fn run(rig: &Rig, accuracy: Accuracy) -> Result<Run, IntegrationError> {
    run_watched(rig, accuracy, |_, _| {})
}

/// The same; `progress` is given samples done and samples in all.
///
/// # Errors
/// When the integration cannot go on.
pub fn run_watched(
    rig: &Rig,
    accuracy: Accuracy,
    progress: impl FnMut(u32, u32),
) -> Result<Run, IntegrationError> {
    run_recorded(rig, accuracy, Recording::default(), progress)
}

/// The same with what else to record.
///
/// # Errors
/// When the integration cannot go on.
pub fn run_recorded(
    rig: &Rig,
    accuracy: Accuracy,
    recording: Recording,
    mut progress: impl FnMut(u32, u32),
) -> Result<Run, IntegrationError> {
    let mut rows = Rows::of(rig, recording);
    let mut drive = Drive::of(rig, accuracy);
    let (last, period) = (rig.last_sample(), u64::from(rig.period_us().get()));
    let samples = room_for(u64::from(last));
    let mut observations = Vec::with_capacity(samples);
    let (mut readings, mut commands) = (Vec::with_capacity(samples), Vec::with_capacity(samples));
    for k in 0..=u64::from(last) {
        let reading = drive.plant.reading()?;
        readings.push(reading);
        let (seen, command) = drive.control(&reading);
        observations.push(seen);
        // The supervisor has the last word on the simulator's own controller, too: it ends the run.
        if drive.target.is_some() && drive.fault.is_some() {
            break;
        }
        progress(seen.index, last);
        commands.push(drive.output(&seen, command));
        // A row at an instant with an output shows the state after it.
        rows.catch_up(&mut drive.plant, &seen, (k + 1) * period)?;
        if k < u64::from(last) {
            drive.plant.next_sample()?;
        }
    }
    let (fault, work) = (drive.fault, drive.plant.work());
    Ok(Run { rows: rows.rows, observations, readings, commands, fault, work })
}

/// The controller, and the plant that it drives.
struct Drive {
    config: Config,
    sequence: Sequence,
    state: State,
    plant: Plant,
    bug: Option<PositiveGain>,
    /// The present target of a continuous controller.
    target: Option<i32>,
    fault: Option<(Fault, u32)>,
}

impl Drive {
    /// The drive of a rig at the start of its test, referenced, armed and at rest.
    fn of(rig: &Rig, accuracy: Accuracy) -> Drive {
        let config = Config::new(&rig.parameters()).expect("a checked rig has a consistent controller");
        let sequence = rig.sequence();
        let mut state = State::default();
        state.supervisor.set_referenced();
        state.supervisor.arm().expect("a new drive does not run");
        state.start(&config, &sequence).expect("a checked rig has moves that may be run");
        let (plant, bug) = (Plant::new(rig, accuracy, 0), PositiveGain::of(rig, &config));
        Drive { config, sequence, state, plant, bug, target: None, fault: None }
    }

    /// What the controller makes of a sample: what is recorded of it, and its command.
    #[inline]
    fn control(&mut self, reading: &Reading) -> (Observation, Command) {
        let taken = self.plant.sample_of(reading);
        sample(&self.config, &self.sequence, &mut self.state, &taken);
        let command = output(&self.config, &mut self.state);
        let mut seen = *self.state.observation();
        if let Mode::Fault(kind) = self.state.supervisor.mode() {
            self.fault = self.fault.or(Some((kind, seen.index)));
        } else if let Some(command) = self.continuous(seen.setpoint) {
            seen.command = command;
        }
        if let Some(bug) = &self.bug {
            seen = bug.spoil(self.state.supervisor.mode(), seen);
        }
        (seen, command)
    }

    /// Gives the plant the command of the present sample, and tells what it was.
    #[inline]
    fn output(&mut self, seen: &Observation, command: Command) -> Command {
        let command = match &mut self.bug {
            Some(bug) => bug.output(seen, command),
            None => command,
        };
        if self.target.is_none() {
            self.plant.command(command);
        }
        command
    }

    /// Gives a continuous controller its target where it changes, and tells its command, rounded to counts;
    /// None for a sampled one.
    #[inline]
    fn continuous(&mut self, setpoint: i32) -> Option<i16> {
        self.plant.continuous_command()?;
        if self.target != Some(setpoint) {
            self.target = Some(setpoint);
            self.plant.set_target(setpoint);
        }
        self.plant.continuous_command().map(|command| command.round() as i16)
    }
}

/// Room for entries 0 to `last`, as far as it is wise to take it beforehand.
fn room_for(last: u64) -> usize {
    last.min(1 << 14) as usize + 1
}
