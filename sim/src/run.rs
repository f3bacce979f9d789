//! One run: the real controller on the simulated plant, as fast as it goes.

use crate::keys;
use pneudrive_controller::{Command, Config, Fault, Mode, Observation, State, output, sample};

use crate::follow::Reading;
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
    let config = Config::new(&rig.parameters()).expect("a checked rig has a consistent controller");
    let sequence = rig.sequence();
    let mut state = State::default();
    state.supervisor.set_referenced();
    state.supervisor.arm().expect("a new drive does not run");
    state.start(&config, &sequence).expect("a checked rig has moves that may be run");

    let period = u64::from(rig.period_us().get());
    let row_period = rig.get(&keys::test::TRACE_PERIOD_S).and_then(whole_microseconds);
    let (row_period, end_us) = (row_period.unwrap_or(period), rig.microseconds(&keys::test::DURATION_S));
    let rows = Vec::with_capacity(room_for(end_us / row_period));
    let mut rows = Rows { period_us: row_period, next_us: 0, end_us, recording, rows };
    let mut plant = Plant::new(rig, accuracy, 0);
    let samples = room_for(u64::from(rig.last_sample()));
    let mut observations = Vec::with_capacity(samples);
    let (mut readings, mut commands) = (Vec::with_capacity(samples), Vec::with_capacity(samples));
    let mut fault = None;
    let mut target = None;
    let mut bug = PositiveGain::of(rig, &config);
    let last = rig.last_sample();
    for k in 0..=u64::from(last) {
        let reading = plant.reading()?;
        readings.push(reading);
        sample(&config, &sequence, &mut state, &plant.sample_of(&reading));
        let mut command = output(&config, &mut state);
        let mut seen = *state.observation();
        if let Mode::Fault(kind) = state.supervisor.mode() {
            fault = fault.or(Some((kind, seen.index)));
        } else if let Some(command) = continuous(&mut plant, &mut target, seen.setpoint) {
            seen.command = command;
        }
        if let Some(bug) = &bug {
            seen = bug.spoil(state.supervisor.mode(), seen);
        }
        observations.push(seen);
        // The supervisor has the last word on the simulator's own controller, too: it ends the run.
        if target.is_some() && fault.is_some() {
            break;
        }
        progress(seen.index, last);
        if let Some(bug) = &mut bug {
            command = bug.output(&seen, command);
        }
        commands.push(command);
        if target.is_none() {
            plant.command(command);
        }
        // A row at an instant with an output shows the state after it.
        rows.catch_up(&mut plant, &seen, (k + 1) * period)?;
        if k < u64::from(last) {
            plant.next_sample()?;
        }
    }
    Ok(Run { rows: rows.rows, observations, readings, commands, fault, work: plant.work() })
}

/// Room for entries 0 to `last`, as far as it is wise to take it beforehand.
fn room_for(last: u64) -> usize {
    last.min(1 << 14) as usize + 1
}

/// Gives a continuous controller its target where it changes, and tells its command, rounded to counts;
/// None for a sampled one.
fn continuous(plant: &mut Plant, target: &mut Option<i32>, setpoint: i32) -> Option<i16> {
    plant.continuous_command()?;
    if *target != Some(setpoint) {
        *target = Some(setpoint);
        plant.set_target(setpoint);
    }
    plant.continuous_command().map(|command| command.round() as i16)
}
