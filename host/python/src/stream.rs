//! `Stream`: the samples of a run while it lasts.
//!
//! A drive must hear of its host all the time, whatever the program does with the rows. A thread of its own therefore has
//! the client until the run is over; rows that have come wait for the program. Who leaves the loop ends the run.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, JoinHandle};
use std::time::Duration;

use anyhow::{Result, bail};
use pneudrive_link::client::Client;
use pneudrive_link::failure::Failure;
use pneudrive_protocol::StreamedSample;
use pneudrive_records::units::Units;
use pyo3::PyErr;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::channels::{Channels, Column, Columns};
use crate::errors;

/// Time between two looks at signals.
const TICK: Duration = Duration::from_millis(50);

/// Rows that may wait for the program: some 20 minutes of every sample.
const MAX_WAITING: usize = 1_000_000;

/// What has come of a run.
#[derive(Default)]
struct Come {
    /// Rows that wait for the program.
    rows: Vec<StreamedSample>,
    /// Rows that the link has lost for good.
    lost: u64,
    /// The run is over; why, if it failed.
    is_over: bool,
    failure: Option<PyErr>,
    /// The client, once the run is over.
    client: Option<Box<Client>>,
}

/// A run that is followed by a thread.
#[derive(Default)]
pub struct Live {
    come: Mutex<Come>,
    /// Something has come.
    news: Condvar,
    /// The run is to end.
    ends: AtomicBool,
    thread: Mutex<Option<JoinHandle<()>>>,
}

impl Live {
    /// Follows a run that has just been started with a stream.
    ///
    /// # Errors
    /// When the system has no room for a thread; the rig then trips, as its host is silent.
    pub fn follow(client: Box<Client>) -> Result<Arc<Live>> {
        let live = Arc::new(Live::default());
        let own = Arc::clone(&live);
        let thread = Builder::new().name("pneudrive stream".to_owned()).spawn(move || own.keep_on(client))?;
        *lock(&live.thread) = Some(thread);
        Ok(live)
    }

    /// The thread: follows the run to its end.
    fn keep_on(&self, mut client: Box<Client>) {
        let followed = catch_unwind(AssertUnwindSafe(|| {
            let followed = client.follow_streamed(&self.ends, |_| {}, |row| self.take(*row));
            let ended = client.stream_end();
            followed.and_then(|(_, lost)| ended.map(|()| lost))
        }));
        let mut come = lock(&self.come);
        match followed {
            Ok(Ok(lost)) => come.lost = lost,
            // The caller requested it.
            Ok(Err(error)) if self.ends.load(Ordering::Relaxed) && is_interruption(&error) => {}
            Ok(Err(error)) => come.failure = Some(errors::of(&error)),
            Err(panic) => come.failure = Some(errors::of_panic(&*panic)),
        }
        (come.is_over, come.client) = (true, Some(client));
        self.news.notify_all();
    }

    fn take(&self, row: StreamedSample) -> Result<()> {
        let mut come = lock(&self.come);
        if come.rows.len() >= MAX_WAITING {
            bail!("the program is {MAX_WAITING} rows behind its stream; take them faster, or a larger every");
        }
        come.rows.push(row);
        self.news.notify_all();
        Ok(())
    }

    /// Ends the run, unless it is over, and waits until it has ended. To be called without the interpreter's lock.
    pub fn end(&self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = lock(&self.thread).take() {
            // A panic of the thread counts as its failure.
            let _ = thread.join();
        }
    }

    /// The same from a destructor, which may or may not have the lock that the thread may need for a note.
    pub fn end_anyway(&self) {
        if Python::try_attach(|py| py.detach(|| self.end())).is_none() {
            self.end();
        }
    }

    /// The client, once the run is over.
    pub fn client(&self) -> Option<Box<Client>> {
        lock(&self.come).client.take()
    }

    /// Waits a moment for rows. To be called without the interpreter's lock.
    fn wait(&self) -> Waited {
        let come = lock(&self.come);
        let nothing = |come: &mut Come| come.rows.is_empty() && !come.is_over;
        let waited = self.news.wait_timeout_while(come, TICK, nothing);
        let (mut come, _) = waited.unwrap_or_else(PoisonError::into_inner);
        match (std::mem::take(&mut come.rows), come.is_over) {
            (rows, _) if !rows.is_empty() => Waited::Rows(rows),
            (_, true) => Waited::Over(come.failure.take()),
            _ => Waited::Nothing,
        }
    }
}

/// What a moment has brought.
enum Waited {
    Rows(Vec<StreamedSample>),
    Over(Option<PyErr>),
    Nothing,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn is_interruption(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| matches!(Failure::of_cause(cause), Some(Failure::Interrupted)))
}

/// The columns of rows: as they were sent, and with the scales of the rig. What has no scale is NaN, and
/// so is a pressure that is not measured.
fn columns(rows: &[StreamedSample], units: &Units) -> Columns {
    let int = |name: &str, of: &dyn Fn(&StreamedSample) -> i32| {
        (name.to_owned(), Column::Int(rows.iter().map(of).collect()))
    };
    let float = |name: &str, of: &dyn Fn(&StreamedSample) -> Option<f64>| {
        let values = rows.iter().map(|row| of(row).unwrap_or(f64::NAN));
        (name.to_owned(), Column::Float(values.collect()))
    };
    let raw_pressure = |name: &str, of: &dyn Fn(&StreamedSample) -> i16| match units.raw_pressure(0) {
        Some(_) => int(name, &|row| of(row).into()),
        None => float(name, &|_| None),
    };
    let index = rows.iter().map(|row| row.index.into()).collect();
    vec![
        ("index".to_owned(), Column::Long(index)),
        float("time_s", &|row| units.seconds(row.index)),
        float("position_mm", &|row| units.millimetres(row.sample.position)),
        float("pressure_1_kpa", &|row| units.kilopascals(row.sample.pressure_1)),
        float("pressure_2_kpa", &|row| units.kilopascals(row.sample.pressure_2)),
        float("spool_mm", &|row| units.spool_millimetres(row.sample.spool)),
        int("position_counts", &|row| row.sample.position),
        raw_pressure("pressure_1_raw", &|row| row.sample.pressure_1),
        raw_pressure("pressure_2_raw", &|row| row.sample.pressure_2),
        int("command_counts", &|row| row.sample.command.into()),
        int("error_counts", &|row| row.sample.error.into()),
        int("spool_raw", &|row| row.sample.spool.into()),
    ]
}

/// The samples of a run in progress: each iteration yields those that have arrived since the last one, as columns.
/// Leaving the loop ends the run.
#[pyclass(frozen, module = "pneudrive")]
pub struct Stream {
    /// The run.
    pub live: Arc<Live>,
    /// The scales of the rig.
    pub units: Units,
}

#[pymethods]
impl Stream {
    fn __iter__(slf: Py<Stream>) -> Py<Stream> {
        slf
    }

    /// What has come; waits for it.
    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Channels>> {
        loop {
            match py.detach(|| self.live.wait()) {
                Waited::Rows(rows) => {
                    let units = self.units;
                    return Ok(Some(Channels::new(move || columns(&rows, &units))));
                }
                Waited::Over(failure) => return failure.map_or(Ok(None), Err),
                // The drive does not go on after Ctrl-C.
                Waited::Nothing => py.check_signals().inspect_err(|_| self.close(py))?,
            }
        }
    }

    fn __enter__(slf: Py<Stream>) -> Py<Stream> {
        slf
    }

    #[pyo3(signature = (*_rest))]
    fn __exit__(&self, py: Python<'_>, _rest: &Bound<'_, PyTuple>) -> bool {
        self.close(py);
        false
    }

    /// Stops the run, unless it is over. Rows that have arrived can still be read.
    fn close(&self, py: Python<'_>) {
        py.detach(|| self.live.end());
    }

    /// The number of rows lost on the link; None while the run lasts.
    #[getter]
    fn lost(&self) -> Option<u64> {
        let come = lock(&self.live.come);
        come.is_over.then_some(come.lost)
    }

    fn __repr__(&self) -> &'static str {
        if lock(&self.live.come).is_over { "<Stream of a run that is over>" } else { "<Stream of a run>" }
    }
}

impl Drop for Stream {
    /// Nobody follows the run any more.
    fn drop(&mut self) {
        self.live.end_anyway();
    }
}

/// What a drive says to who wants something else of it while it streams.
pub fn is_streaming(port: &str) -> PyErr {
    PyRuntimeError::new_err(format!(
        "{port}: a run is streamed from this drive; leave its loop, or close() the stream, first"
    ))
}
