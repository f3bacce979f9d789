//! `Drive`: a drive at a port. As a context manager it is disarmed at the end, whatever happens.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

use anyhow::{Context, Result};
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_records::target::TargetFile;
use pneudrive_records::units::Units;
use pneudrive_records::words;
use pneudrive_session::drive;
use pneudrive_session::record::to_memory;
use pneudrive_session::slow_move::{self, JOG_MM_PER_S, Standing};
use pneudrive_session::streaming::ToFile;
use pneudrive_session::test_run::TestRun;
use pneudrive_sim::component::controller::Loop;
use pneudrive_sim::keys;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::errors::OrRaise;
use crate::order::Order;
use crate::parameters::{self, Change};
use crate::rig::RigOrSource;
use crate::stream::{Live, Stream, is_streaming};
use crate::target::{Target, name_of};
use crate::{bench, progress, work};

/// A drive at a port.
#[pyclass(frozen, module = "pneudrive")]
pub struct Drive {
    port: String,
    held: Mutex<Held>,
}

/// Who has the client of a drive.
enum Held {
    /// The drive.
    Open(Box<Client>),
    /// The thread that follows a run.
    Streaming(Arc<Live>),
    /// Nobody any more.
    Closed,
}

impl Held {
    /// The client comes back from a run that is over.
    fn regain(&mut self) {
        if let Held::Streaming(live) = self
            && let Some(client) = live.client()
        {
            *self = Held::Open(client);
        }
    }

    /// Ends a run that is streamed.
    fn end_stream(&mut self) {
        if let Held::Streaming(live) = self {
            live.end();
        }
        self.regain();
    }
}

impl Drive {
    /// Does something with the drive, without the interpreter's lock.
    fn act<T: Send>(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        act: impl FnOnce(&mut Client, &work::Meter) -> Result<T> + Send,
    ) -> PyResult<T> {
        let mut held = self.held()?;
        match &mut *held {
            Held::Open(client) => work::run(py, progress, |meter| act(client, meter)),
            Held::Streaming(_) => Err(is_streaming(&self.port)),
            Held::Closed => Err(self.closed()),
        }
    }

    /// What has the client, unless another thread is using it.
    fn held(&self) -> PyResult<MutexGuard<'_, Held>> {
        match self.held.try_lock() {
            Ok(mut held) => {
                held.regain();
                Ok(held)
            }
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

    /// Runs the slow move that `test` makes of where the drive stands; returns where it is then, mm.
    fn move_slowly(
        &self,
        py: Python<'_>,
        rig: &pneudrive_sim::Rig,
        test: impl FnOnce(&pneudrive_sim::Rig, &Standing) -> Result<pneudrive_sim::Rig> + Send,
    ) -> PyResult<f64> {
        self.act(py, None, |client, meter| {
            let standing = Standing::of(client, rig.name(), rig)?;
            let test = test(rig, &standing)?;
            let prepared = TestRun::of(&test).prepare(client, None)?;
            prepared.run(client, meter.ends(), &mut || meter.check(), |_| {}).ended?;
            let position = client.status()?.position;
            Units::of(&standing.there).millimetres(position).context("the drive has lost its scale")
        })
    }

    /// Starts a run, and hands the client to the thread that follows it.
    fn stream_live(&self, py: Python<'_>, order: &Order, every: u16) -> PyResult<Stream> {
        let units = self.act(py, None, |client, meter| order.start_streamed(client, every, meter))?;
        let mut held = self.held()?;
        let Held::Open(client) = std::mem::replace(&mut *held, Held::Closed) else {
            return Err(self.closed());
        };
        let live = work::at_once(|| Live::follow(client))?;
        *held = Held::Streaming(Arc::clone(&live));
        Ok(Stream { live, units })
    }

    fn closed(&self) -> PyErr {
        PyValueError::new_err(format!("{} was closed; open it again with Drive(\"{0}\")", self.port))
    }
}

/// What a drive is doing, in a word.
fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Disarmed => "disarmed",
        Mode::Armed => "armed",
        Mode::Homing => "homing",
        Mode::Running => "running",
        Mode::Done => "done",
        Mode::Fault => "fault",
    }
}

#[pymethods]
impl Drive {
    /// Connects to the drive at a port: "tcp://HOST:PORT", "pty:PATH", or a serial device such as "/dev/ttyACM0" or "COM3".
    #[new]
    fn new(py: Python<'_>, port: String) -> PyResult<Drive> {
        let client = work::run(py, None, |_| Client::connect(&port))?;
        Ok(Drive { port, held: Mutex::new(Held::Open(Box::new(client))) })
    }

    /// The port's name.
    #[getter]
    fn port(&self) -> &str {
        &self.port
    }

    /// Whether the port was closed.
    #[getter(closed)]
    fn is_closed(&self) -> PyResult<bool> {
        Ok(matches!(*self.held()?, Held::Closed))
    }

    fn __enter__(slf: Py<Drive>) -> Py<Drive> {
        slf
    }

    /// Disarms the drive and closes the port. An exception of the block takes precedence over one of the disarming.
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

    /// Disarms the drive, if this program commands it, and closes the port; a streamed run ends.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let mut held = self.held()?;
        let held = &mut *held;
        py.detach(|| held.end_stream());
        let Held::Open(mut client) = std::mem::replace(held, Held::Closed) else { return Ok(()) };
        work::run(py, None, |_| match client.status()?.mode {
            Mode::Disarmed | Mode::Fault => Ok(()),
            _ if client.commands() => client.disarm(),
            _ => Ok(()),
        })
    }

    /// The firmware and the board of the drive.
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

    /// The state of the drive: its mode, and its figures as integers.
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (status, measured) =
            self.act(py, None, |client, _| Ok((client.status()?, client.measures_pressures()?)))?;
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
        dict.set_item("pressure_1_raw", measured.then_some(status.pressure_1))?;
        dict.set_item("pressure_2_raw", measured.then_some(status.pressure_2))?;
        dict.set_item("spool_raw", status.spool)?;
        dict.set_item("recorded", status.recorded)?;
        Ok(dict)
    }

    /// Enables the drive with the valve at null, and clears a fault. From now on this program commands it.
    fn arm(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, None, |client, _| drive::arm(client))
    }

    /// Disables the drive.
    fn disarm(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, None, |client, _| client.disarm())
    }

    /// Stops the drive at once, with a fault that `arm` clears. A streamed run ends.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        {
            let held = &mut *self.held()?;
            py.detach(|| held.end_stream());
        }
        self.act(py, None, |client, _| client.stop())
    }

    /// References the axis at its present position: in encoder counts, or in mm.
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
            drive::reference(client, count).map(drop)
        })
    }

    /// The parameters of the controller, by the names of rig-file keys. Values are set first: those of a rig,
    /// or of a dict such as `{"safety.hold_s": 60}`. The drive must be disarmed for that; `save` keeps them over a reset.
    #[pyo3(signature = (values=None, /, *, save=false))]
    fn config<'py>(
        &self,
        py: Python<'py>,
        values: Option<&Bound<'py, PyAny>>,
        save: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let change = values.map(Change::of).transpose()?;
        let parameters = self.act(py, None, |client, _| {
            if let Some(change) = &change {
                change.carry_out(client)?;
            }
            if save {
                client.save_parameters()?;
            }
            Ok(client.parameters()?.values)
        })?;
        parameters::to_python(py, &parameters)
    }

    /// Homes the axis: it moves slowly to its stop or switch, which references the encoder. The drive must be armed, and
    /// stays so. An absolute encoder needs no homing, and nothing moves. Ctrl-C stops the drive.
    fn home(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, None, |client, meter| drive::home(client, &mut || meter.check()).map(drop))
    }

    /// Moves the drive slowly to a position, mm, arming it if necessary, and returns its position then, mm. It holds until it is
    /// disarmed. Ctrl-C stops it.
    #[pyo3(signature = (rig, mm, /))]
    fn go_to(&self, py: Python<'_>, rig: RigOrSource, mm: f64) -> PyResult<f64> {
        self.move_slowly(py, &rig.0.rig, |rig, standing| {
            slow_move::go(rig, &standing.there, standing.from_mm, mm)
        })
    }

    /// Moves the drive slowly by a distance, mm, at most 30 and no farther than its reach, arming it if necessary; negative:
    /// towards the retracted end. Returns its position then, mm. It holds until it is disarmed. Ctrl-C stops it.
    #[pyo3(signature = (rig, mm, /))]
    fn jog(&self, py: Python<'_>, rig: RigOrSource, mm: f64) -> PyResult<f64> {
        self.move_slowly(py, &rig.0.rig, |rig, standing| {
            slow_move::jog(rig, &standing.there, standing.from_mm, mm, JOG_MM_PER_S)
        })
    }

    /// Downloads the test of a rig, arms the drive, runs the test to its end, and returns the record. `config` downloads the
    /// rig's parameters, too; `duration_s` replaces the duration of the test, s. Ctrl-C stops the drive. A closed loop then holds
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
        let order = Order::of(rig, config, duration_s, false)?;
        let bar = progress::of(py, progress, "running")?;
        self.act(py, bar, |client, meter| order.carry_out(client, None, meter))?;
        self.record(py, None)
    }

    /// Runs the test as `run` does, but receives every Nth sample during the run, which may exceed the board's memory. With a file, they go
    /// there, and the streamed record is returned at the end. Without one, a `Stream` yields them while the run lasts, and
    /// leaving its loop ends the run; `duration_s` may then be infinite.
    #[pyo3(signature = (rig, file=None, /, *, every=1, config=false, duration_s=None, progress=None))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn stream(
        &self,
        py: Python<'_>,
        rig: RigOrSource,
        file: Option<PathBuf>,
        every: u16,
        config: bool,
        duration_s: Option<f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        if every == 0 {
            return Err(PyValueError::new_err("every must be 1 or more"));
        }
        let order = Order::of(rig, config, duration_s, file.is_none())?;
        let Some(file) = file else {
            if progress.is_some() {
                return Err(PyTypeError::new_err(
                    "a stream without a file shows how far it is; give it no progress",
                ));
            }
            return Ok(Py::new(py, self.stream_live(py, &order, every)?)?.into_any());
        };
        let bar = progress::of(py, progress, "running")?;
        let to = ToFile { path: file, every };
        self.act(py, bar, |client, meter| order.carry_out(client, Some(&to), meter))?;
        let read = work::at_once(|| TargetFile::read(&to.path))?;
        Ok(Target::of(py, name_of(&to.path), read)?.into_any())
    }

    /// Runs the tests that a fit needs: the drive moves through most of its stroke, also in open loop. Returns the records
    /// for `identify`. The drive is left as it was.
    fn run_identification_tests(&self, py: Python<'_>, rig: RigOrSource) -> PyResult<Vec<Py<Target>>> {
        let with_loop = |control_loop: Loop| {
            rig.0.rig.with_settings(&[keys::controller::LOOP.setting(control_loop.word())]).or_raise()
        };
        let (closed, open) = (with_loop(Loop::Closed)?, with_loop(Loop::Open)?);
        let files = self.act(py, None, |client, meter| bench::records(client, &closed, &open, meter))?;
        files.into_iter().map(|(name, file)| Target::of(py, name, file)).collect()
    }

    /// Downloads the last record; resumes an interrupted download.
    #[pyo3(signature = (*, progress=None))]
    fn record(&self, py: Python<'_>, progress: Option<Py<PyAny>>) -> PyResult<Py<Target>> {
        let bar = progress::of(py, progress, "recording")?;
        let (_, file) = self.act(py, bar, |client, meter| {
            to_memory(client, &mut |done, all| {
                meter.note(done as u64, all as u64);
                meter.check()
            })
        })?;
        Target::of(py, format!("record of {}", self.port), file)
    }

    fn __repr__(&self) -> String {
        let state = match self.held.try_lock().as_deref() {
            Ok(Held::Closed) => "closed",
            Ok(Held::Open(_)) => "open",
            Ok(Held::Streaming(_)) => "streaming",
            Err(_) => "in use",
        };
        format!("<Drive {}, {state}>", self.port)
    }
}

impl Drop for Drive {
    /// A drive that nobody closed is not left enabled.
    fn drop(&mut self) {
        let held = self.held.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Held::Streaming(live) = held {
            live.end_anyway();
        }
        held.regain();
        if let Held::Open(client) = held
            && client.commands()
        {
            let _ = client.disarm();
        }
    }
}
