//! Work that takes a while: it runs without the interpreter's lock, tells how far it is, and ends at Ctrl-C.
//!
//! Python delivers signals to its main thread alone. Work on several threads therefore has a thread of its own, while the
//! thread that called waits for it, gives signals to the interpreter and calls the progress function; work on one thread
//! does so itself, now and then. Work that is to end is unwound at the next place where it tells how far it is.

use std::any::Any;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

use anyhow::Context;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::{self, OrRaise};

/// Time between two looks at signals and progress.
const TICK: Duration = Duration::from_millis(50);

/// How far some work is.
#[derive(Debug, Default)]
pub struct Meter {
    done: AtomicU64,
    all: AtomicU64,
    ends: AtomicBool,
}

/// What unwinds work that is to end.
struct Cancelled;

impl Meter {
    /// So much is done; unwinds if the work is to end.
    pub fn at(&self, done: u64, all: u64) {
        self.note(done, all);
        if self.is_ending() {
            resume_unwind(Box::new(Cancelled));
        }
    }

    /// So much is done, of work that looks itself whether it is to end.
    pub fn note(&self, done: u64, all: u64) {
        self.done.store(done, Ordering::Relaxed);
        self.all.store(all, Ordering::Relaxed);
    }

    /// Goes on unless the work is to end, of work that must not be unwound.
    ///
    /// # Errors
    /// When the work is to end.
    pub fn check(&self) -> anyhow::Result<()> {
        if self.is_ending() { anyhow::bail!("stopped by the caller") } else { Ok(()) }
    }

    fn is_ending(&self) -> bool {
        self.ends.load(Ordering::Relaxed)
    }

    /// Is set when the work is to end.
    pub fn ends(&self) -> &AtomicBool {
        &self.ends
    }

    /// Gives signals to the interpreter, and tells how far the work is.
    fn look(&self, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        let [done, all] = [&self.done, &self.all].map(|count| count.load(Ordering::Relaxed));
        look(progress, done, all)
    }
}

/// Gives signals to the interpreter, and tells how far some work is.
fn look(progress: Option<&Py<PyAny>>, done: u64, all: u64) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        match progress {
            Some(progress) if all > 0 => progress.call1(py, (done, all)).map(drop),
            _ => Ok(()),
        }
    })
}

/// Says that a thread is done when it goes, and wakes who waits for it.
struct Wake<'a> {
    is_done: &'a AtomicBool,
    caller: Thread,
}

impl Drop for Wake<'_> {
    fn drop(&mut self) {
        self.is_done.store(true, Ordering::Release);
        self.caller.unpark();
    }
}

/// Does work without the interpreter's lock. `progress` is called with what is done and what is to do, now and then
/// and at the end.
///
/// # Errors
/// The exception of the work, of a signal, or of `progress`; a panic is an `InternalError`.
pub fn run<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Meter) -> anyhow::Result<T> + Send,
) -> PyResult<T> {
    let meter = Meter::default();
    let (outcome, stopped) = py.detach(|| wait_for(&meter, progress.as_ref(), work));
    settled(outcome, stopped)
}

type Outcome<T> = Result<anyhow::Result<T>, Box<dyn Any + Send>>;

/// What became of the work, and the exception that ended it.
fn wait_for<T: Send>(
    meter: &Meter,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Meter) -> anyhow::Result<T> + Send,
) -> (Outcome<T>, Option<PyErr>) {
    let (is_done, caller) = (AtomicBool::new(false), thread::current());
    thread::scope(|scope| {
        let wake = Wake { is_done: &is_done, caller };
        let worker = scope.spawn(move || {
            let _wake = wake;
            catch_unwind(AssertUnwindSafe(|| work(meter)))
        });
        let mut stopped = None;
        let is_done = || is_done.load(Ordering::Acquire);
        while !is_done() {
            thread::park_timeout(TICK);
            if stopped.is_none() && !is_done() {
                stopped = meter.look(progress).err();
                meter.ends.store(stopped.is_some(), Ordering::Relaxed);
            }
        }
        let outcome = worker.join().and_then(|outcome| outcome);
        if stopped.is_none() && outcome.is_ok() && progress.is_some() {
            stopped = meter.look(progress).err();
        }
        (outcome, stopped)
    })
}

/// Does work of one thread on the thread that called: a short run costs no other thread. The work is given a function
/// that it tells how far it is.
///
/// # Errors
/// As [`run`].
pub fn run_here<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&mut dyn FnMut(u64, u64)) -> anyhow::Result<T> + Send,
) -> PyResult<T> {
    let (outcome, stopped) = py.detach(|| {
        let (mut stopped, mut last, mut due) = (None, (0, 0), Instant::now() + TICK);
        let mut tell = |done, all| {
            last = (done, all);
            if Instant::now() >= due {
                due = Instant::now() + TICK;
                stopped = look(progress.as_ref(), done, all).err();
                if stopped.is_some() {
                    resume_unwind(Box::new(Cancelled));
                }
            }
        };
        let outcome = catch_unwind(AssertUnwindSafe(|| work(&mut tell)));
        if stopped.is_none() && outcome.is_ok() && progress.is_some() {
            stopped = look(progress.as_ref(), last.0, last.1).err();
        }
        (outcome, stopped)
    });
    settled(outcome, stopped)
}

/// What came of some work, or the exception that ended it.
fn settled<T>(outcome: Outcome<T>, stopped: Option<PyErr>) -> PyResult<T> {
    match (outcome, stopped) {
        (_, Some(exception)) => Err(exception),
        (Ok(done), None) => done.or_raise(),
        (Err(panic), None) => Err(errors::of_panic(&*panic)),
    }
}

/// Does what takes a moment, and turns a panic into an exception.
///
/// # Errors
/// As [`run`].
pub fn at_once<T>(work: impl FnOnce() -> anyhow::Result<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| errors::of_panic(&*panic))?.or_raise()
}

/// The threads for what runs side by side: as many as are asked for, else one for each processor. A process that was
/// forked does not have the threads of its parent, and gets its own.
///
/// # Errors
/// When the system has no room for them.
pub fn pool(threads: Option<NonZeroUsize>) -> anyhow::Result<Arc<ThreadPool>> {
    static SHARED: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);
    if let Some(threads) = threads {
        let pool = ThreadPoolBuilder::new().num_threads(threads.get()).build();
        return pool.map(Arc::new).with_context(|| format!("cannot run on {threads} threads"));
    }
    let mut shared = SHARED.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    match &*shared {
        Some((owner, pool)) if *owner == process => Ok(Arc::clone(pool)),
        _ => {
            let pool = Arc::new(ThreadPoolBuilder::new().build().context("cannot start threads")?);
            // The threads of the parent do not exist here, so there is nothing to end.
            std::mem::forget(shared.replace((process, Arc::clone(&pool))));
            Ok(pool)
        }
    }
}

/// Panics behind the border: for the test that nothing else does.
#[pyfunction]
pub fn _panic(py: Python<'_>) -> PyResult<()> {
    run(py, None, |_| panic!("on purpose"))
}
