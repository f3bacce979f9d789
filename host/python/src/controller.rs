//! The controller alone, for a loop of one's own.

use pneudrive_controller::{
    self as controller, Config, Fault, Mode, Parameters, Refusal, Sequence, State, output, sample,
};
use pneudrive_protocol::RequestRefusal;
use pneudrive_records::words;
use pneudrive_sim::component::controller::ControllerKind;
use pneudrive_sim::keys;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::Refused;
use crate::rig::RigOrSource;

/// One reading of the sensors, in the raw units of the hardware.
#[pyclass(frozen, get_all, eq, from_py_object, module = "pneudrive")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// The encoder's position, counts; positive means extension.
    position: i32,
    /// The raw pressure of chamber 1 (blind side), 0 to 2^bits - 1.
    pressure_1: i16,
    /// The raw pressure of chamber 2 (rod side), 0 to 2^bits - 1.
    pressure_2: i16,
    /// The raw spool displacement, 0 to 2^bits - 1.
    spool: i16,
    /// Whether the homing switch is closed; False without a switch.
    home_switch: bool,
}

#[pymethods]
impl Sample {
    #[new]
    #[pyo3(signature = (position, pressure_1=0, pressure_2=0, spool=0, home_switch=false))]
    fn new(position: i32, pressure_1: i16, pressure_2: i16, spool: i16, home_switch: bool) -> Sample {
        Sample { position, pressure_1, pressure_2, spool, home_switch }
    }

    /// For pickle.
    fn __getnewargs__(&self) -> (i32, i16, i16, i16, bool) {
        (self.position, self.pressure_1, self.pressure_2, self.spool, self.home_switch)
    }

    fn __repr__(&self) -> String {
        let Sample { position, pressure_1, pressure_2, spool, .. } = self;
        format!(
            "Sample(position={position}, pressure_1={pressure_1}, pressure_2={pressure_2}, spool={spool})"
        )
    }
}

impl From<controller::Sample> for Sample {
    fn from(of: controller::Sample) -> Sample {
        let controller::Sample { position, pressure_1, pressure_2, spool, home_switch } = of;
        Sample { position, pressure_1, pressure_2, spool, home_switch }
    }
}

impl From<Sample> for controller::Sample {
    fn from(of: Sample) -> controller::Sample {
        let Sample { position, pressure_1, pressure_2, spool, home_switch } = of;
        controller::Sample { position, pressure_1, pressure_2, spool, home_switch }
    }
}

/// The command to the drive stage, in force from the output on.
#[pyclass(frozen, get_all, eq, from_py_object, module = "pneudrive")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Command {
    /// The valve command; positive means extension, 0 is the valve's null. DAC: -2048 to 2048 counts; stepper: the spool
    /// location asked for, steps.
    counts: i16,
    /// The stepper's pulse at this output: -1, 0 or 1; 0 with a DAC.
    step: i8,
    /// Whether the drive's enable line is on.
    drive_enable: bool,
}

#[pymethods]
impl Command {
    #[new]
    #[pyo3(signature = (counts, step=0, drive_enable=true))]
    pub fn new(counts: i16, step: i8, drive_enable: bool) -> PyResult<Command> {
        if !(-2048..=2048).contains(&counts) || !(-1..=1).contains(&step) {
            let text =
                format!("counts must be between -2048 and 2048, and step -1, 0 or 1; is {counts}, {step}");
            return Err(PyValueError::new_err(text));
        }
        Ok(Command { counts, step, drive_enable })
    }

    /// For pickle.
    fn __getnewargs__(&self) -> (i16, i8, bool) {
        (self.counts, self.step, self.drive_enable)
    }

    fn __repr__(&self) -> String {
        let Command { counts, step, drive_enable } = self;
        let enable = if *drive_enable { "True" } else { "False" };
        format!("Command(counts={counts}, step={step}, drive_enable={enable})")
    }
}

impl From<controller::Command> for Command {
    fn from(of: controller::Command) -> Command {
        let controller::Command { counts, step, drive_enable } = of;
        Command { counts, step, drive_enable }
    }
}

impl From<Command> for controller::Command {
    fn from(of: Command) -> controller::Command {
        let Command { counts, step, drive_enable } = of;
        controller::Command { counts, step, drive_enable }
    }
}

/// The controller of a rig with the moves of its test, bit for bit that of the firmware.
#[pyclass(module = "pneudrive")]
pub struct Controller {
    config: Config,
    sequence: Sequence,
    state: State,
}

fn refused(refusal: Refusal) -> PyErr {
    Refused::new_err(words::refusal(&RequestRefusal::NotNow(refusal.code())))
}

#[pymethods]
impl Controller {
    /// Makes the controller of a rig, referenced, armed and started: the next sample is k = 0 of the test. Without
    /// `start` it is disarmed and not referenced.
    #[new]
    #[pyo3(signature = (rig, /, *, start=true))]
    fn new(rig: RigOrSource, start: bool) -> PyResult<Controller> {
        let rig = rig.0.rig;
        if rig.get(&keys::controller::MODEL) == ControllerKind::Continuous {
            let text =
                "the continuous controller is the simulator's own; write controller.model = \"sampled\"";
            return Err(PyValueError::new_err(text));
        }
        let parameters: Parameters = rig.parameters();
        let config = Config::new(&parameters).map_err(|error| PyValueError::new_err(error.advice()))?;
        let mut controller = Controller { config, sequence: rig.sequence(), state: State::default() };
        if start {
            controller.state.locate(parameters.absolute_zero().unwrap_or(0));
            controller.arm()?;
            controller.start()?;
        }
        Ok(controller)
    }

    /// Takes a sample and returns the command to output `controller.delay_s` later: `sample`, then
    /// `output`.
    fn step(&mut self, sample: Sample) -> Command {
        self.sample(sample);
        self.output()
    }

    /// Runs the first interrupt on a sample: estimator, error, law, supervisor.
    fn sample(&mut self, sample: Sample) {
        self::sample(&self.config, &self.sequence, &mut self.state, &sample.into());
    }

    /// Runs the second interrupt and returns the command to the drive stage.
    fn output(&mut self) -> Command {
        output(&self.config, &mut self.state).into()
    }

    /// Enables the drive with the valve at null, and clears a fault.
    fn arm(&mut self) -> PyResult<()> {
        self.state.arm(&self.config).map_err(refused)
    }

    /// Starts the test: the next sample is k = 0.
    fn start(&mut self) -> PyResult<()> {
        self.state.start(&self.config, &self.sequence).map_err(refused)
    }

    /// Disables the drive.
    fn disarm(&mut self) {
        self.state.supervisor.disarm();
    }

    /// Trips the drive at once, as a stop request does.
    fn stop(&mut self) {
        self.state.supervisor.trip(Fault::Stop);
    }

    /// References the axis at its present position, counts. The drive must be disabled.
    fn reference(&mut self, position: i32) -> PyResult<()> {
        if self.state.supervisor.drives() {
            return Err(Refused::new_err(
                "the axis is referenced while the drive is disarmed; disarm it first",
            ));
        }
        self.state.reference(position);
        Ok(())
    }

    /// The mode: "disarmed", "armed", "running", "homing", "done" or "fault".
    #[getter]
    fn mode(&self) -> &'static str {
        match self.state.supervisor.mode() {
            Mode::Disarmed => "disarmed",
            Mode::Armed => "armed",
            Mode::Running => "running",
            Mode::Homing => "homing",
            Mode::Done => "done",
            Mode::Fault(_) => "fault",
        }
    }

    /// The fault that tripped the drive; None without one.
    #[getter]
    fn fault(&self) -> Option<&'static str> {
        match self.state.supervisor.mode() {
            Mode::Fault(fault) => Some(words::fault_name(fault)),
            _ => None,
        }
    }

    /// The controller's signals at the last sample, counts.
    #[getter]
    fn observation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seen = self.state.observation();
        let dict = PyDict::new(py);
        dict.set_item("running", seen.running)?;
        dict.set_item("index", seen.index)?;
        dict.set_item("setpoint_counts", seen.setpoint)?;
        dict.set_item("position_counts", seen.position)?;
        dict.set_item("error_counts", seen.error)?;
        dict.set_item("command_counts", seen.command)?;
        dict.set_item("velocity", seen.velocity)?;
        dict.set_item("acceleration", seen.acceleration)?;
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        format!("<Controller {}, sample {}>", self.mode(), self.state.observation().index)
    }
}
