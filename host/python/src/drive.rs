//! `Drive`: a drive at a port. As a context manager it is disarmed at the end, whatever happens.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use anyhow::{Context, Result, bail};
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_link::test_run;
use pneudrive_protocol::{Mode, Status, StreamedSample, UNTIL_STOPPED};
use pneudrive_records::rig_info::{Info, RigParameters};
use pneudrive_records::stream_file::StreamFile;
use pneudrive_records::target::TargetFile;
use pneudrive_records::units::Units;
use pneudrive_records::words;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::rig::{Rig, RigOrSource};
use crate::target::{Target, name_of};
use crate::{bench, progress, work};

/// A drive at a port.
#[pyclass(frozen, module = "pneudrive")]
pub struct Drive {
    port: String,
    /// None once it was closed.
    client: Mutex<Option<Client>>,
}

impl Drive {
    /// Does something with the drive, without the interpreter's lock.
    fn act<T: Send>(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        act: impl FnOnce(&mut Client, &work::Meter) -> Result<T> + Send,
    ) -> PyResult<T> {
        let mut client = self.client()?;
        let client = client.as_mut().ok_or_else(|| self.closed())?;
        work::run(py, progress, |meter| act(client, meter))
    }

    /// The client, unless another thread is using it.
    fn client(&self) -> PyResult<MutexGuard<'_, Option<Client>>> {
        match self.client.try_lock() {
            Ok(client) => Ok(client),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                let text = format!(
                    "{}: another thread is using this drive; wait for it, or open a second Drive",
                    self.port
                );
                Err(PyRuntimeError::new_err(text))
            }
        }
    }

    fn closed(&self) -> PyErr {
        PyValueError::new_err(format!("{} was closed; open it again with Drive(\"{0}\")", self.port))
    }
}

/// How a test is run.
struct Order {
    rig: pneudrive_sim::Rig,
    last_sample: u32,
    with_parameters: bool,
    stream: Option<(PathBuf, u16)>,
}

impl Order {
    fn of(
        rig: RigOrSource,
        config: bool,
        duration_s: Option<f64>,
        stream: Option<(PathBuf, u16)>,
    ) -> PyResult<Order> {
        let rig = rig.0.rig;
        let period_us = f64::from(rig.period_us().get());
        let last_sample = match duration_s {
            None => rig.last_sample(),
            Some(seconds) if seconds > 0.0 && 1e6 * seconds / period_us < f64::from(UNTIL_STOPPED) => {
                (1e6 * seconds / period_us) as u32
            }
            Some(other) => {
                let most = f64::from(UNTIL_STOPPED) * period_us / 1e6;
                let text = format!("duration_s must be more than 0 and at most {most:.0}, is {other}");
                return Err(PyValueError::new_err(text));
            }
        };
        Ok(Order { rig, last_sample, with_parameters: config, stream })
    }

    /// Runs it to its end; what was streamed is in a file.
    fn carry_out(&self, client: &mut Client, meter: &work::Meter) -> Result<()> {
        let streams = self.stream.is_some();
        if let Some((path, _)) = &self.stream {
            client.needs_streams()?;
            if path.exists() {
                bail!("{} exists already; choose another file", path.display());
            }
        }
        let parameters =
            test_run::prepare(client, &self.rig, self.last_sample, self.with_parameters, streams)?;
        let mut file = self.begin_stream(client, &parameters)?;
        let started = test_run::start(client, &self.rig, &mut || meter.check());
        let progressed = |status: &Status| meter.note(status.index.into(), status.duration_samples.into());
        let followed = started.and_then(|()| match &mut file {
            None => client.follow(meter.ends(), progressed).map(drop),
            Some(file) => {
                let take = |row: &StreamedSample| file.add(row);
                client.follow_streamed(meter.ends(), progressed, take).map(drop)
            }
        });
        let ended = file.map_or(Ok(()), |file| end_stream(client, file));
        followed.and(ended)
    }

    fn begin_stream(&self, client: &mut Client, parameters: &RigParameters) -> Result<Option<StreamFile>> {
        let Some((path, every)) = &self.stream else { return Ok(None) };
        let info: Info = client.info()?;
        let period_us = parameters.values.get(id::PERIOD_US).unwrap_or(0);
        let moves = client.test()?;
        let file = StreamFile::create(path, self.rig.name(), *every, &info, parameters, moves.as_ref())?;
        client.stream_begin(*every, 1e6 / f64::from(period_us.max(1)))?;
        Ok(Some(file))
    }
}

/// Ends a stream and its file.
fn end_stream(client: &mut Client, mut file: StreamFile) -> Result<()> {
    let samples_of_run = client.status().ok().map(|status| status.index.saturating_add(1));
    let ended = client.stream_end();
    file.end(samples_of_run)?;
    ended
}

/// What a drive is doing, in a word.
fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Disarmed => "disarmed",
        Mode::Armed => "armed",
        Mode::Running => "running",
        Mode::Done => "done",
        Mode::Fault => "fault",
    }
}

#[pymethods]
impl Drive {
    /// Opens a port: "tcp://HOST:PORT", "pty:PATH", or a serial device such as "/dev/ttyACM0" or "COM3".
    #[new]
    fn new(py: Python<'_>, port: String) -> PyResult<Drive> {
        let client = work::run(py, None, |_| Client::connect(&port))?;
        Ok(Drive { port, client: Mutex::new(Some(client)) })
    }

    /// The port.
    #[getter]
    fn port(&self) -> &str {
        &self.port
    }

    /// Whether it was closed.
    #[getter(closed)]
    fn is_closed(&self) -> PyResult<bool> {
        Ok(self.client()?.is_none())
    }

    fn __enter__(slf: Py<Drive>) -> Py<Drive> {
        slf
    }

    /// Disarms the drive and closes the port. An exception of the block is not hidden by one of the disarming.
    #[pyo3(signature = (kind, *_rest))]
    fn __exit__(
        &self,
        py: Python<'_>,
        kind: &Bound<'_, PyAny>,
        _rest: &Bound<'_, PyTuple>,
    ) -> PyResult<bool> {
        let disarmed = self.close(py);
        if kind.is_none() { disarmed.map(|()| false) } else { Ok(false) }
    }

    /// Disarms the drive, if this program commands it, and closes the port.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let Some(mut client) = self.client()?.take() else { return Ok(()) };
        work::run(py, None, |_| match client.status()?.mode {
            Mode::Disarmed | Mode::Fault => Ok(()),
            _ if client.commands() => client.disarm(),
            _ => Ok(()),
        })
    }

    /// Which firmware it has, and on which board.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let info = self.act(py, None, |client, _| client.info())?;
        let dict = PyDict::new(py);
        dict.set_item("firmware", info.firmware)?;
        dict.set_item("build", info.build)?;
        dict.set_item("board", info.board)?;
        dict.set_item("protocol", info.version)?;
        dict.set_item("record_capacity", info.record_capacity)?;
        Ok(dict)
    }

    /// How it is: its mode, and its figures as integers.
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let status = self.act(py, None, |client, _| client.status())?;
        let dict = PyDict::new(py);
        dict.set_item("mode", mode(status.mode))?;
        let fault = (status.mode == Mode::Fault).then(|| words::fault_code_name(status.fault));
        dict.set_item("fault", fault)?;
        dict.set_item("referenced", status.referenced)?;
        dict.set_item("index", status.index)?;
        dict.set_item("setpoint_counts", status.setpoint)?;
        dict.set_item("position_counts", status.position)?;
        dict.set_item("error_counts", status.error)?;
        dict.set_item("command_counts", status.command)?;
        dict.set_item("pressure_1_raw", status.pressure_1)?;
        dict.set_item("pressure_2_raw", status.pressure_2)?;
        dict.set_item("spool_raw", status.spool)?;
        dict.set_item("recorded", status.recorded)?;
        Ok(dict)
    }

    /// Enables the drive with the valve at null; clears a fault. This program commands it from now on.
    fn arm(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, None, |client, _| client.arm())
    }

    /// Disables the drive.
    fn disarm(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, None, |client, _| client.disarm())
    }

    /// Stops at once: a fault, which `arm` clears.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, None, |client, _| client.stop())
    }

    /// States where the axis stands now: in encoder counts, or in mm.
    #[pyo3(signature = (*, counts=None, mm=None))]
    fn reference(&self, py: Python<'_>, counts: Option<i32>, mm: Option<f64>) -> PyResult<()> {
        if counts.is_some() == mm.is_some() {
            return Err(PyTypeError::new_err("state where the axis stands, either in counts or in mm"));
        }
        self.act(py, None, |client, _| {
            let mut at = |mm: f64| {
                Units::of(&client.parameters()?).count_at(mm).context("mm is no count of its encoder")
            };
            let count = match (counts, mm) {
                (Some(counts), _) => counts,
                (None, mm) => at(mm.unwrap_or(f64::NAN))?,
            };
            client.reference(count)
        })
    }

    /// Downloads the test of a rig, arms, runs it to its end, and returns what was recorded. `config` downloads the
    /// rig's parameters, too; `duration_s` replaces that of the test. Ctrl-C stops the drive. A closed loop then holds
    /// its last setpoint until it is disarmed.
    #[pyo3(signature = (rig, /, *, config=false, duration_s=None, progress=None))]
    fn run(
        &self,
        py: Python<'_>,
        rig: RigOrSource,
        config: bool,
        duration_s: Option<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Py<Target>> {
        let order = Order::of(rig, config, duration_s, None)?;
        let bar = progress::of(py, progress, "running")?;
        self.act(py, bar, |client, meter| order.carry_out(client, meter))?;
        self.record(py, None)
    }

    /// The same, but every Nth sample goes to a file during the run, which may exceed the board's memory; returns what
    /// was streamed.
    #[pyo3(signature = (rig, file, /, *, every=1, config=false, duration_s=None, progress=None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn stream(
        &self,
        py: Python<'_>,
        rig: RigOrSource,
        file: PathBuf,
        every: u16,
        config: bool,
        duration_s: Option<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Py<Target>> {
        if every == 0 {
            return Err(PyValueError::new_err("every must be 1 or more"));
        }
        let order = Order::of(rig, config, duration_s, Some((file.clone(), every)))?;
        let bar = progress::of(py, progress, "running")?;
        self.act(py, bar, |client, meter| order.carry_out(client, meter))?;
        let read = work::at_once(|| TargetFile::read(&file))?;
        Target::of(py, name_of(&file), read)
    }

    /// Runs the tests that a fit needs: the drive moves through most of its stroke, in open loop, too. Returns the records
    /// for `identify`. The drive is left as it was.
    fn run_identification_tests(&self, py: Python<'_>, rig: RigOrSource) -> PyResult<Vec<Py<Target>>> {
        let with_loop = |loop_: &str| {
            let settings = rig.0.settings.iter().cloned().chain([format!("controller.loop=\"{loop_}\"")]);
            Rig::read(rig.0.source.clone(), settings.collect())
        };
        let (closed, open) = (with_loop("closed")?.rig, with_loop("open")?.rig);
        let files = self.act(py, None, |client, meter| bench::records(client, &closed, &open, meter))?;
        files.into_iter().map(|(name, file)| Target::of(py, name, file)).collect()
    }

    /// Downloads what was recorded last.
    #[pyo3(signature = (*, progress=None))]
    fn record(&self, py: Python<'_>, progress: Option<Py<PyAny>>) -> PyResult<Py<Target>> {
        let bar = progress::of(py, progress, "recording")?;
        let file = self.act(py, bar, |client, meter| {
            let (info, parameters) = (client.info()?, client.parameters()?);
            let test = client.test()?;
            let record = client.record(|done, all| meter.at(done as u64, all as u64))?;
            Ok(TargetFile::new(&record, &info, &parameters)?.with_test(test.as_ref()))
        })?;
        Target::of(py, format!("record of {}", self.port), file)
    }

    fn __repr__(&self) -> String {
        let state = match self.client.try_lock() {
            Ok(client) if client.is_none() => "closed",
            Ok(_) => "open",
            Err(_) => "in use",
        };
        format!("<Drive {}, {state}>", self.port)
    }
}

impl Drop for Drive {
    /// A drive that nobody closed is not left enabled.
    fn drop(&mut self) {
        let client = self.client.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(client) = client.as_mut().filter(|client| client.commands()) {
            let _ = client.disarm();
        }
    }
}
