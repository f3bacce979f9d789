//! One run: the real controller on the simulated plant, as fast as it goes.

use pneudrive_controller::law::cascade::kept::Kept;
use pneudrive_controller::{Command, Config, Fault, Mode, Observation, Sequence, State, output, sample};

use crate::component::sensors::calibration::Reading;
use crate::gain_bug::GainBug;
use crate::keys;
use crate::known::{Known, Units};
use crate::plant::{Accuracy, Plant, PlantWork};
use crate::trace::{MotionRow, Row};
use crate::values::{Rig, seconds, whole_microseconds};
use pneudrive_solver::IntegrationError;

/// The result of a run, with rows of some kind.
#[derive(Clone, Debug)]
pub struct Run<R = Row> {
    /// The transient.
    pub rows: Vec<R>,
    /// The controller's result for each sample: the integers that every execution level must repeat.
    pub observations: Vec<Observation>,
    /// The inputs of the sensors at each sample.
    pub readings: Vec<Reading>,
    /// The command from each sample's output on.
    pub commands: Vec<Command>,
    /// The fault that ended the control, if any, and the sample at which it tripped.
    pub fault: Option<(Fault, u32)>,
    /// What the next run of a drive begins with that keeps what it has learned (`controller.adapt`); None: nothing is kept.
    pub kept: Option<Kept>,
    /// The work of the run.
    pub work: PlantWork,
}

impl Run {
    /// A hash (FNV-1a, words of 64 bits) over every bit of the rows, the readings and the commands. Two runs with the
    /// same hash are the same run, whatever the program and the processor.
    #[must_use]
    pub fn bits(&self) -> u64 {
        let rows = self.rows.iter().flat_map(|row| row.values().map(f64::to_bits));
        let readings = self.readings.iter().flat_map(|reading| {
            let [one, two] = reading.pressures;
            [reading.position, one, two, reading.spool].map(f64::to_bits)
        });
        let commands = self.commands.iter().map(|command| command.counts as u64);
        let words = rows.chain(readings).chain(commands);
        words.fold(0xcbf2_9ce4_8422_2325, |hash, word| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3))
    }
}

/// Additional contents of the rows. They do not change the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recording {
    /// The air inside the valve.
    pub valve: bool,
}

/// The row type of a run. It does not change the run.
pub trait Record: Sized {
    /// The row at `time` (s), to which the plant has come, while the controller acts on its last sample.
    fn of(plant: &mut Plant, time: f64, seen: &Observation) -> Self;

    /// Adds the air inside the valve at the row's time, if the row has room for it.
    fn add_valve(&mut self, _plant: &mut Plant) {}

    /// Adds what the law knows, if the row has room for it.
    fn add_known(&mut self, _known: impl FnOnce() -> Option<Known>) {}
}

impl Record for Row {
    #[inline]
    fn of(plant: &mut Plant, time: f64, seen: &Observation) -> Row {
        let (snapshot, receiver) = (plant.snapshot(time), plant.receiver_state(time));
        Row { time, observation: *seen, plant: snapshot, valve: None, receiver, known: None }
    }

    fn add_valve(&mut self, plant: &mut Plant) {
        self.valve = Some(plant.valve_state(self.time));
    }

    fn add_known(&mut self, known: impl FnOnce() -> Option<Known>) {
        self.known = known();
    }
}

impl Record for MotionRow {
    #[inline]
    fn of(plant: &mut Plant, time: f64, _: &Observation) -> MotionRow {
        let (position, velocity, pressures) = plant.motion(time);
        MotionRow { time, position, velocity, pressures }
    }
}

/// Runs the test of a rig. The drive starts referenced, armed and at rest.
///
/// # Errors
/// When the integration fails.
pub fn run(rig: &Rig, accuracy: Accuracy) -> Result<Run, IntegrationError> {
    run_keeping(rig, accuracy, &Kept::default())
}

/// The same with what else to record; `progress` is given the number of samples done and of all samples.
///
/// # Errors
/// When the integration fails.
pub fn run_recorded(
    rig: &Rig,
    accuracy: Accuracy,
    recording: Recording,
    progress: impl FnMut(u32, u32),
) -> Result<Run, IntegrationError> {
    let mut runner = Runner::in_memory_of(Run::new(), rig, accuracy, recording, &Kept::default());
    runner.run_watched(progress, |_, _| {})?;
    Ok(runner.run)
}

/// The test of a rig whose drive has kept something of the runs before; it counts with `controller.adapt = "kept"` alone.
///
/// # Errors
/// When the integration fails.
pub fn run_keeping(rig: &Rig, accuracy: Accuracy, kept: &Kept) -> Result<Run, IntegrationError> {
    run_changing(rig, accuracy, kept, |_, _| {})
}

/// The same on a plant that changes in between: `change` is given each sample's number, and the plant at it, before that is read.
///
/// # Errors
/// When the integration fails.
pub fn run_changing(
    rig: &Rig,
    accuracy: Accuracy,
    kept: &Kept,
    change: impl FnMut(u64, &mut Plant),
) -> Result<Run, IntegrationError> {
    let mut runner = Runner::in_memory_of(Run::new(), rig, accuracy, Recording::default(), kept);
    runner.run_watched(|_, _| {}, change)?;
    Ok(runner.run)
}

/// Runs of one rig, one after another, with rows of some kind. The rig's keys are read and its plant is built once,
/// and each run reuses the memory of the one before.
#[derive(Clone, Debug)]
pub struct Runner<R = Row> {
    /// The drive at the start of the test.
    start: SimulatedDrive,
    period_us: u64,
    last_sample: u32,
    row_period_us: u64,
    end_us: u64,
    recording: Recording,
    run: Run<R>,
}

impl<R: Record> Runner<R> {
    /// A runner for the test of a rig.
    #[must_use]
    pub fn new(rig: &Rig, accuracy: Accuracy) -> Runner<R> {
        Runner::in_memory_of(Run::new(), rig, accuracy, Recording::default(), &Kept::default())
    }

    /// Prepares for runs of another rig.
    pub fn take(&mut self, rig: &Rig, accuracy: Accuracy) {
        let run = std::mem::replace(&mut self.run, Run::new());
        *self = Runner::in_memory_of(run, rig, accuracy, self.recording, &Kept::default());
    }

    fn in_memory_of(
        mut run: Run<R>,
        rig: &Rig,
        accuracy: Accuracy,
        recording: Recording,
        kept: &Kept,
    ) -> Runner<R> {
        let (period_us, last_sample) = (u64::from(rig.period_us().get()), rig.last_sample());
        let row_period = rig.get(&keys::test::TRACE_PERIOD_S).and_then(whole_microseconds);
        let row_period_us = row_period.unwrap_or(period_us);
        let end_us = rig.microseconds(&keys::test::DURATION_S);
        run.make_room(room_for(end_us / row_period_us), room_for(u64::from(last_sample)));
        let start = SimulatedDrive::of(rig, accuracy, kept);
        Runner { start, period_us, last_sample, row_period_us, end_us, recording, run }
    }

    /// Runs the test, from its start.
    ///
    /// # Errors
    /// When the integration fails.
    pub fn run(&mut self) -> Result<&Run<R>, IntegrationError> {
        self.run_watched(|_, _| {}, |_, _| {})
    }

    fn run_watched(
        &mut self,
        mut progress: impl FnMut(u32, u32),
        mut change: impl FnMut(u64, &mut Plant),
    ) -> Result<&Run<R>, IntegrationError> {
        self.run.clear();
        let mut drive = self.start.clone();
        let mut next_row_us = 0;
        for k in 0..=u64::from(self.last_sample) {
            change(k, &mut drive.plant);
            let reading = drive.plant.reading()?;
            self.run.readings.push(reading);
            let command = drive.control(&reading);
            // The supervisor has the last word on the simulator's own controller, too: it ends the run.
            if drive.target.is_some() && drive.fault.is_some() {
                self.run.observations.push(*drive.seen());
                break;
            }
            progress(drive.seen().index, self.last_sample);
            self.run.commands.push(drive.output(command));
            // A row at an instant with an output shows the state after it.
            let until_us = ((k + 1) * self.period_us).min(self.end_us + 1);
            while next_row_us < until_us {
                self.add_row(&mut drive, seconds(next_row_us))?;
                next_row_us += self.row_period_us;
            }
            self.run.observations.push(*drive.seen());
            if k < u64::from(self.last_sample) {
                drive.plant.next_sample()?;
            }
        }
        (self.run.fault, self.run.work) = (drive.fault, drive.plant.work());
        self.run.kept = drive.state.kept(&drive.config);
        Ok(&self.run)
    }

    /// Adds the row at `time`, s. The air inside the valve comes last, so that the others need no copy of it.
    #[inline]
    fn add_row(&mut self, drive: &mut SimulatedDrive, time: f64) -> Result<(), IntegrationError> {
        let (seen, plant) = drive.seen_and_plant();
        plant.come_to(time)?;
        let mut row = R::of(plant, time, seen);
        if self.recording.valve {
            row.add_valve(plant);
        }
        if let Some(units) = &drive.units {
            row.add_known(|| units.known(&drive.state));
        }
        self.run.rows.push(row);
        Ok(())
    }
}

impl<R> Run<R> {
    /// The state before the first run.
    fn new() -> Run<R> {
        Run {
            rows: Vec::new(),
            observations: Vec::new(),
            readings: Vec::new(),
            commands: Vec::new(),
            fault: None,
            kept: None,
            work: PlantWork::default(),
        }
    }

    /// Reserves room for the rows and samples of another run.
    fn make_room(&mut self, rows: usize, samples: usize) {
        self.clear();
        self.rows.reserve_exact(rows);
        self.observations.reserve_exact(samples);
        self.readings.reserve_exact(samples);
        self.commands.reserve_exact(samples);
    }

    /// Drops everything but the memory.
    fn clear(&mut self) {
        self.rows.clear();
        self.observations.clear();
        self.readings.clear();
        self.commands.clear();
        (self.fault, self.kept, self.work) = (None, None, PlantWork::default());
    }
}

/// The controller, and the plant that it drives.
#[derive(Clone, Debug)]
struct SimulatedDrive {
    config: Config,
    sequence: Sequence,
    state: State,
    plant: Plant,
    /// Of what its law knows, if it does.
    units: Option<Units>,
    bug: Option<GainBug>,
    /// The record of a sample if it differs from the controller's observation.
    seen: Option<Observation>,
    /// The present target of a continuous controller.
    target: Option<i32>,
    fault: Option<(Fault, u32)>,
}

impl SimulatedDrive {
    /// The drive of a rig at the start of its test, referenced, armed and at rest.
    fn of(rig: &Rig, accuracy: Accuracy, kept: &Kept) -> SimulatedDrive {
        let mut parameters = rig.parameters();
        for (id, value) in kept.values() {
            parameters.set(id, value).expect("what is kept is within its ranges");
        }
        let config = Config::new(&parameters).expect("a checked rig has a consistent controller");
        let sequence = rig.sequence();
        let mut state = State::default();
        state.locate(parameters.absolute_zero().unwrap_or(0));
        state.supervisor.arm().expect("a new drive does not run");
        state.start(&config, &sequence).expect("a checked rig has moves that may be run");
        let (plant, bug) = (Plant::new(rig, accuracy, 0), GainBug::of(rig, &config));
        SimulatedDrive {
            units: Units::of(rig),
            config,
            sequence,
            state,
            plant,
            bug,
            seen: None,
            target: None,
            fault: None,
        }
    }

    /// The record of the present sample.
    #[inline]
    fn seen(&self) -> &Observation {
        seen(&self.seen, &self.state)
    }

    /// The same, and the plant.
    #[inline]
    fn seen_and_plant(&mut self) -> (&Observation, &mut Plant) {
        (seen(&self.seen, &self.state), &mut self.plant)
    }

    /// Runs the controller on a sample and returns its command.
    #[inline]
    fn control(&mut self, reading: &Reading) -> Command {
        let taken = self.plant.sample_of(reading);
        sample(&self.config, &self.sequence, &mut self.state, &taken);
        let command = output(&self.config, &mut self.state);
        if let Mode::Fault(kind) = self.state.supervisor.mode() {
            self.fault = self.fault.or(Some((kind, self.state.observation().index)));
        }
        self.seen = self.seen_otherwise();
        command
    }

    /// The record of a continuous controller, and of one with the historical bug.
    #[inline]
    fn seen_otherwise(&mut self) -> Option<Observation> {
        let (mode, setpoint) = (self.state.supervisor.mode(), self.state.observation().setpoint);
        let command = if let Mode::Fault(_) = mode { None } else { self.continuous(setpoint) };
        if command.is_none() && self.bug.is_none() {
            return None;
        }
        let mut seen = *self.state.observation();
        seen.command = command.unwrap_or(seen.command);
        Some(self.bug.as_ref().map_or(seen, |bug| bug.corrupt(mode, seen)))
    }

    /// Gives the plant the command of the present sample, and returns it.
    #[inline]
    fn output(&mut self, command: Command) -> Command {
        let seen = seen(&self.seen, &self.state);
        let command = match &mut self.bug {
            Some(bug) => bug.output(seen, command),
            None => command,
        };
        if self.target.is_none() {
            self.plant.command(command);
        }
        command
    }

    /// Gives a continuous controller its target when it changes, and returns its command, rounded to counts; None for
    /// a sampled one.
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

/// The record of a sample: another observation, or the controller's.
#[inline]
fn seen<'a>(otherwise: &'a Option<Observation>, state: &'a State) -> &'a Observation {
    otherwise.as_ref().unwrap_or(state.observation())
}

/// Room for entries 0 to `last`, as far as it is wise to reserve it beforehand.
fn room_for(last: u64) -> usize {
    last.min(1 << 14) as usize + 1
}
