//! The controller, bit for bit the firmware's: referenced, armed and running from sample 0 on, as in
//! `pneudrive simulate`.
//!
//! It runs the moves of the rig's test, or follows its input: a setpoint that differs from the one before is a step that
//! begins with its sample.

use anyhow::{Result, anyhow};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{
    Command, Config, Fault, Mode, Move, Observation, Parameters, Refusal, Sample, Sequence, State, output,
    sample,
};
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::known::Units;
use pneudrive_sim::trace::Extra;
use pneudrive_sim::{Rig, keys};

use super::taken::{integer, switch};
use crate::signal::{Kind, Signal, Value};

/// The controller behind a sample.
#[derive(Clone, Debug)]
pub struct Controller {
    config: Config,
    state: State,
    /// The moves of the test, or the first setpoint that came in.
    sequence: Sequence,
    /// The setpoint that is followed; None with moves of its own, and before the first one.
    followed: Option<i32>,
    run_test: bool,
    command: Command,
    /// The units of what its law knows; None if it has no model of the drive.
    units: Option<Units>,
    /// The outputs of what its law knows.
    known: Vec<&'static Extra>,
}

/// Whether the position is fed back: setpoints are positions.
pub fn is_closed(rig: &Rig) -> bool {
    rig.get(&keys::controller::LOOP) == Loop::Closed
}

const fn signal(name: &'static str, kind: Kind, meaning: &'static str) -> Signal {
    Signal { name, kind, meaning, range: None }
}

/// Trips the drive.
pub const STOP: Signal = signal(
    "stop",
    Kind::Boolean,
    "Trips the controller, as a stop request does: the valve goes to its null. It stays tripped until the FMU is reset.",
);

/// Where the drive shall be.
pub fn setpoint_counts() -> Signal {
    let ends = [i64::from(i32::MIN), i64::from(i32::MAX)];
    Signal {
        range: Some(ends),
        ..signal(
            "setpoint_counts",
            Kind::Int32,
            "Where the drive shall be, encoder counts; in open loop the valve command. Followed unless run_test is set.",
        )
    }
}

/// Its inputs, in their order.
pub fn inputs(rig: &Rig) -> Vec<Signal> {
    let raw = |name, meaning| Signal {
        range: Some([0, (1 << rig.get(&keys::sensors::BITS)) - 1]),
        ..signal(name, Kind::Int32, meaning)
    };
    vec![
        setpoint_counts(),
        signal("position_counts", Kind::Int32, "What the encoder counts; positive means extension."),
        raw("pressure_1_raw", "Pressure in chamber 1 as converted."),
        raw("pressure_2_raw", "Pressure in chamber 2 as converted."),
        raw("spool_raw", "Spool displacement as converted."),
        signal("home_switch", Kind::Boolean, "Whether the homing switch is closed."),
        STOP,
    ]
}

/// Its outputs, in their order: those of every law, then what a law with a model knows, named as the columns of a trace.
pub fn outputs(rig: &Rig) -> Vec<Signal> {
    let known = |extra: &Extra| signal(extra.name, Kind::Float64, extra.help);
    OUTPUTS.into_iter().chain(Extra::of_law(rig).into_iter().map(known)).collect()
}

const OUTPUTS: [Signal; 12] = [
    signal(
        "command_counts",
        Kind::Int32,
        "Valve command of the last sample; positive means extension, 0 is the null. DAC: counts; stepper: the spool location asked for.",
    ),
    signal("step", Kind::Int32, "Stepper: the pulse of the last sample, -1, 0 or 1. DAC: 0."),
    signal("drive_enable", Kind::Boolean, "The drive's enable line, which gates the valve amplifier."),
    signal(
        "setpoint_in_force_counts",
        Kind::Int32,
        "Setpoint at the last sample; in open loop the valve command.",
    ),
    signal("error_counts", Kind::Int32, "Setpoint less position at the last sample; 0 in open loop."),
    signal("velocity_estimate", Kind::Int64, "Velocity at the last sample, counts per velocity window."),
    signal(
        "acceleration_estimate",
        Kind::Int64,
        "Acceleration at the last sample, counts per velocity and acceleration window.",
    ),
    signal("running", Kind::Boolean, "Whether the last sample belongs to a run."),
    signal("index", Kind::Int64, "Number of the last sample, from the start of the run."),
    signal("mode", Kind::Int32, "0 disarmed, 1 armed, 2 running, 3 homing, 4 done, 5 tripped."),
    signal(
        "fault",
        Kind::Int32,
        "Code of the fault that it tripped with (`pneudrive device faults`); 0: none.",
    ),
    signal("learned_null_counts", Kind::Int32, "What it has learned of the valve's null in this run."),
];

fn parameters_of(rig: &Rig, run_test: bool) -> Result<Parameters> {
    let mut parameters = rig.parameters();
    if !run_test {
        // A setpoint takes effect when it arrives: none waits for the one before, and none ends the run.
        parameters.set(id::ON_ARRIVAL, 0).map_err(|_| anyhow!("on_arrival takes 0"))?;
    }
    Ok(parameters)
}

fn config_of(parameters: &Parameters) -> Result<Config> {
    Config::new(parameters).map_err(|error| anyhow!(error.advice()))
}

impl Controller {
    /// Before sample 0.
    pub fn new(rig: &Rig, run_test: bool) -> Result<Controller> {
        let parameters = parameters_of(rig, run_test)?;
        let config = config_of(&parameters)?;
        let mut state = State::default();
        state.locate(parameters.absolute_zero().unwrap_or(0));
        state.supervisor.arm().map_err(refused)?;
        let sequence = if run_test { rig.sequence() } else { Sequence::new(u32::MAX) };
        if run_test {
            state.start(&config, &sequence).map_err(refused)?;
        }
        let (units, known) = (Units::of(rig), Extra::of_law(rig));
        Ok(Controller {
            config,
            state,
            sequence,
            followed: None,
            run_test,
            command: Command::OFF,
            units,
            known,
        })
    }

    /// From the next sample on it has the gains of another rig.
    pub fn retune(&mut self, rig: &Rig) -> Result<()> {
        self.config = config_of(&parameters_of(rig, self.run_test)?)?;
        Ok(())
    }

    /// Takes a sample, and returns the command for `controller.delay_s` later. Without moves of its own it follows
    /// `setpoint`.
    pub fn take(&mut self, taken: &Sample, setpoint: i32, stop: bool) -> Result<Command> {
        if !self.run_test {
            self.follow(setpoint)?;
        }
        if stop {
            self.state.supervisor.trip(Fault::Stop);
        }
        sample(&self.config, &self.sequence, &mut self.state, taken);
        self.command = output(&self.config, &mut self.state);
        Ok(self.command)
    }

    fn follow(&mut self, setpoint: i32) -> Result<()> {
        if self.followed == Some(setpoint) {
            return Ok(());
        }
        let accepted = match self.followed {
            None => self.start_at(setpoint),
            // A drive that has tripped follows no setpoint, and its mode says so.
            Some(_) if self.state.supervisor.mode() != Mode::Running => return Ok(()),
            Some(_) => self.state.redirect(&self.config, setpoint),
        };
        accepted.map_err(|refusal| match refusal {
            Refusal::BeyondSoftLimit => {
                anyhow!("the setpoint, {setpoint} counts, lies beyond a soft limit (safety.end_min_mm, safety.end_max_mm; without them the stroke)")
            }
            other => refused(other),
        })?;
        self.followed = Some(setpoint);
        Ok(())
    }

    fn start_at(&mut self, setpoint: i32) -> Result<(), Refusal> {
        let mut sequence = Sequence::new(u32::MAX);
        sequence.push(Move::step(0, setpoint)).expect("an empty sequence takes a move");
        self.state.start(&self.config, &sequence)?;
        self.sequence = sequence;
        Ok(())
    }

    /// A sample at its inputs.
    pub fn step(&mut self, inputs: &[Value]) -> Result<()> {
        let taken = Sample {
            position: integer(inputs, 1),
            pressure_1: integer(inputs, 2),
            pressure_2: integer(inputs, 3),
            spool: integer(inputs, 4),
            home_switch: switch(inputs, 5),
        };
        self.take(&taken, integer(inputs, 0), switch(inputs, 6)).map(drop)
    }

    /// In the order of [`outputs`]. What the law knows is not a number before the first sample of a run.
    pub fn outputs(&self) -> Vec<Value> {
        let Command { counts, step, drive_enable } = self.command;
        let Observation { running, index, setpoint, error, velocity, acceleration, .. } =
            *self.state.observation();
        let (mode, fault) = mode_and_fault(self.state.supervisor.mode());
        let known = self.units.and_then(|units| units.known(&self.state));
        let of_law = |extra: &&Extra| known.and_then(|known| extra.of_known(&known)).unwrap_or(f64::NAN);
        let mut all = vec![
            Value::Integer(counts.into()),
            Value::Integer(step.into()),
            Value::Switch(drive_enable),
            Value::Integer(setpoint.into()),
            Value::Integer(error.into()),
            Value::Integer(velocity),
            Value::Integer(acceleration),
            Value::Switch(running),
            Value::Integer(index.into()),
            Value::Integer(mode),
            Value::Integer(fault),
            Value::Integer(self.state.learned_null_offset().into()),
        ];
        all.extend(self.known.iter().map(of_law).map(Value::Float));
        all
    }
}

/// Their numbers at the outputs.
fn mode_and_fault(mode: Mode) -> (i64, i64) {
    match mode {
        Mode::Disarmed => (0, 0),
        Mode::Armed => (1, 0),
        Mode::Running => (2, 0),
        Mode::Homing => (3, 0),
        Mode::Done => (4, 0),
        Mode::Fault(fault) => (5, fault.code().into()),
    }
}

fn refused(refusal: Refusal) -> anyhow::Error {
    anyhow!("the controller refuses to run: {refusal:?}")
}
