//! A controller on the bench: what the tests set up again and again.

use pneudrive_controller::parameters::id;
use pneudrive_controller::{
    Command, Config, Mode, Move, Parameters, Sample, Sequence, State, output, sample,
};

/// A run of six samples toward one target.
pub fn one_move(target: i32) -> Sequence {
    let mut sequence = Sequence::new(5);
    sequence.push(Move::step(0, target)).expect("room");
    sequence
}

/// A drive that runs through these moves from the next sample on.
pub fn running(config: &Config, sequence: &Sequence) -> State {
    let mut state = State::default();
    state.supervisor.set_referenced();
    state.supervisor.arm().expect("referenced");
    state.start(config, sequence).expect("armed");
    state
}

/// Limits that nothing reaches.
pub const WIDE: [(u16, i32); 9] = [
    (id::POSITION_MIN_COUNTS, -i32::MAX),
    (id::POSITION_MAX_COUNTS, i32::MAX),
    (id::ENCODER_STEP_COUNTS, i32::MAX),
    (id::END_MIN_COUNTS, -i32::MAX),
    (id::END_MAX_COUNTS, i32::MAX),
    (id::SENSOR_LOW_RAW, -1),
    (id::NO_MOTION_MS, 0),
    (id::MODEL_BOUND_MS, 0),
    (id::PRESSURE_DOUBT_MS, 0),
];

/// Parameters with limits that nothing reaches.
pub fn wide_open() -> Parameters {
    changed(&WIDE)
}

/// The default parameters with changes.
pub fn changed(changes: &[(u16, i32)]) -> Parameters {
    let mut parameters = Parameters::default();
    for &(id, value) in changes {
        parameters.set(id, value).expect("in range");
    }
    parameters
}

/// A sample at a position, with pressures that a sound sensor reads.
pub fn at(position: i32) -> Sample {
    Sample { position, pressure_1: 2000, pressure_2: 2000, ..Sample::default() }
}

/// A drive with a configuration and moves, and the samples it is given.
pub struct ControllerBench {
    pub config: Config,
    pub sequence: Sequence,
    pub state: State,
}

impl ControllerBench {
    /// An armed drive with these changes to the defaults; its moves: (sample, target).
    pub fn armed(changes: &[(u16, i32)], moves: &[(u32, i32)]) -> ControllerBench {
        let mut sequence = Sequence::new(10_000);
        for &(at_sample, target) in moves {
            sequence.push(Move::step(at_sample, target)).expect("room");
        }
        let mut state = State::default();
        state.supervisor.set_referenced();
        state.supervisor.arm().expect("not running");
        let config = Config::new(&changed(changes)).expect("they go together");
        ControllerBench { config, sequence, state }
    }

    /// The same, running.
    pub fn running(changes: &[(u16, i32)], moves: &[(u32, i32)]) -> ControllerBench {
        ControllerBench::running_for(10_000, changes, moves)
    }

    /// The same, with another number of the last sample.
    pub fn running_for(last_sample: u32, changes: &[(u16, i32)], moves: &[(u32, i32)]) -> ControllerBench {
        let mut bench = ControllerBench::armed(changes, moves);
        bench.sequence.duration_samples = last_sample;
        bench.state.start(&bench.config, &bench.sequence).expect("armed");
        bench
    }

    /// One sample and its output.
    pub fn take_whole(&mut self, input: Sample) -> Command {
        sample(&self.config, &self.sequence, &mut self.state, &input);
        output(&self.config, &mut self.state)
    }

    /// One sample and its output: the command.
    pub fn take(&mut self, input: Sample) -> i16 {
        self.take_whole(input).counts
    }

    /// Many samples of the same input: the last command.
    pub fn hold(&mut self, input: Sample, samples: u32) -> i16 {
        (0..samples).map(|_| self.take(input)).last().expect("samples")
    }

    /// The mode.
    pub fn mode(&self) -> Mode {
        self.state.supervisor.mode()
    }
}
