//! The simulated plant of a real board, over the board's second serial port.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_app::plant_bus::HELLO;
use pneudrive_link::port::{self, Link};
use pneudrive_rigs::timing::LateSample;
use pneudrive_sim::Rig;

use crate::plant_server::{Bus, Hello, PlantServer, SharedRig, Time};

/// How long a board may take to send its hello, which it repeats five times a second.
const HELLO_WAIT: Duration = Duration::from_secs(5);

/// After this silence nothing more is on its way.
const QUIET: Duration = Duration::from_millis(30);

/// A plant at a port. It ends when dropped; a running board then trips.
pub struct BoardPlant {
    rig: SharedRig,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<()>>>,
}

impl BoardPlant {
    /// Opens the port and waits for the board's hello. The plant follows the rig.
    ///
    /// # Errors
    /// When the port cannot be opened, or nothing there speaks the plant bus.
    pub fn open(name: &str, rig: &Rig) -> Result<BoardPlant> {
        let link = port::open(name).context("the plant's port")?;
        let stop = Arc::new(AtomicBool::new(false));
        let bus = PortBus { link, stop: Arc::clone(&stop) };
        let rig = Arc::new(Mutex::new(rig.clone()));
        let time = Time::new(LateSample::default(), false);
        let server = PlantServer::new(Arc::clone(&rig), 0, time, Arc::default());
        let (greet, greeted) = channel();
        let thread = std::thread::spawn(move || server.serve(bus, &greet));
        let mut plant = BoardPlant { rig, stop, thread: Some(thread) };
        match greeted.recv_timeout(HELLO_WAIT) {
            Ok(()) => Ok(plant),
            Err(RecvTimeoutError::Disconnected) => match plant.end() {
                Ok(()) => bail!("{name} was closed before the board's hello"),
                Err(error) => Err(error),
            },
            Err(RecvTimeoutError::Timeout) => bail!(
                "no board sent a hello at {name} within {} s; check that its image speaks the plant bus, and that this is its second port",
                HELLO_WAIT.as_secs()
            ),
        }
    }

    /// The plant of another rig, from the next run on.
    pub fn set_rig(&self, rig: &Rig) {
        *self.rig.lock().unwrap_or_else(PoisonError::into_inner) = rig.clone();
    }

    fn end(&mut self) -> Result<()> {
        self.stop.store(true, Ordering::Relaxed);
        match self.thread.take().map(JoinHandle::join) {
            Some(Err(_)) => Err(anyhow!("the plant panicked")),
            Some(Ok(result)) => result,
            None => Ok(()),
        }
    }
}

impl Drop for BoardPlant {
    fn drop(&mut self) {
        let _ = self.end();
    }
}

/// The bus over a port, until the plant ends.
struct PortBus {
    link: Box<dyn Link>,
    stop: Arc<AtomicBool>,
}

impl Bus for PortBus {
    /// Looks for a hello among earlier bytes of the board on the line.
    fn hello(&mut self) -> Result<Option<Hello>> {
        let mut last: Hello = [0; HELLO.len()];
        while last[..3] != HELLO[..3] {
            let Some([next]) = self.read()? else { return Ok(None) };
            last.rotate_left(1);
            last[HELLO.len() - 1] = next;
        }
        self.forget()?;
        Ok(Some(last))
    }

    fn read<const N: usize>(&mut self) -> Result<Option<[u8; N]>> {
        let (mut bytes, mut filled) = ([0; N], 0);
        while filled < N {
            if self.stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            filled += self.link.read(&mut bytes[filled..]).context("the plant's port broke")?;
        }
        Ok(Some(bytes))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.link.write(bytes).context("the plant's port broke")
    }

    /// Reads until the line is quiet.
    fn forget(&mut self) -> Result<()> {
        let (mut since, mut bytes) = (Instant::now(), [0; 64]);
        while since.elapsed() < QUIET {
            if self.link.read(&mut bytes).context("the plant's port broke")? > 0 {
                since = Instant::now();
            }
        }
        Ok(())
    }
}
