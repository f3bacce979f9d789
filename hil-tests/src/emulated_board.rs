//! The emulated board: an image of the firmware on a Cortex-M4 in QEMU, with its plant simulated here.
//!
//! QEMU connects the image's plant bus ([`pneudrive_app::plant_bus`]) to two pipes in a folder of its own, and its UART0
//! to a TCP port. The processor halts while it waits for the plant, and the plant while it waits for the processor, so
//! they run in lock step, however fast each is. The flash is served in the same way ([`pneudrive_app::flash_bus`]) and
//! outlives the emulator. One program can use the port at a time, as with a serial port.

mod bridge;
mod flash;
mod pipes;
mod stall;

use std::fs::File;
use std::io::ErrorKind;
use std::net::TcpListener;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail};
use pneudrive_rigs::persistent_flash::PersistentFlash;
use pneudrive_rigs::timing::LateSample;
use pneudrive_sim::Rig;
use tempfile::TempDir;

use crate::plant_server::{PlantServer, Time};
use crate::sample_cost::ICOUNT_SHIFT;
pub use crate::sample_cost::{Figures, Spread};
use pipes::Pipes;

/// The emulator.
const QEMU: &str = "qemu-system-arm";

/// How long the image may take to send its hello.
const HELLO_WAIT: Duration = Duration::from_secs(20);

/// Pipes of the plant bus and of the flash bus, to the board and from it, as the image opens them.
const PLANT_BUS: [&str; 2] = ["inputs", "outputs"];
const FLASH_BUS: [&str; 2] = ["flash-answers", "flash-requests"];

/// The port of the emulator's debugger.
const DEBUGGER: &str = "debugger";

/// The output of the emulator.
const LOG: &str = "qemu.log";

/// An emulated board. It is switched off when dropped.
pub struct EmulatedBoard {
    image: PathBuf,
    listener: TcpListener,
    port: String,
    plant: PlantSide,
    figures: Arc<Mutex<Figures>>,
    late: LateSample,
    flash: PersistentFlash,
    power: Powered,
}

/// The other end of the plant bus.
enum PlantSide {
    /// The plant of a rig, simulated here, optionally in step with the wall clock.
    Simulated { rig: Box<Rig>, seed: u64, in_step: bool },
    /// A program that connects to this port.
    Port(TcpListener),
}

impl EmulatedBoard {
    /// Starts an image whose plant has the true parameters of `rig`, with a blank flash. `seed` is for
    /// sensor noise. The image has its own parameters: download those of the rig.
    ///
    /// # Errors
    /// When QEMU is missing, or the image is invalid or of another version.
    pub fn start(rig: &Rig, image: &Path, seed: u64) -> Result<EmulatedBoard> {
        let plant = PlantSide::Simulated { rig: Box::new(rig.clone()), seed, in_step: false };
        EmulatedBoard::switched_on(image, plant, free_port()?)
    }

    /// The same, with its plant in step with the wall clock: the timeout for host silence is active.
    ///
    /// # Errors
    /// As [`EmulatedBoard::start`].
    pub fn start_in_step(rig: &Rig, image: &Path, seed: u64) -> Result<EmulatedBoard> {
        EmulatedBoard::serve(rig, image, seed, free_port()?)
    }

    /// The same at a port that the caller has chosen.
    ///
    /// # Errors
    /// As [`EmulatedBoard::start`].
    pub fn serve(rig: &Rig, image: &Path, seed: u64, listener: TcpListener) -> Result<EmulatedBoard> {
        let plant = PlantSide::Simulated { rig: Box::new(rig.clone()), seed, in_step: true };
        EmulatedBoard::switched_on(image, plant, listener)
    }

    /// Starts an image whose plant is at a separate port, as with a real board; also returns the name of that port. A plant
    /// can connect there once.
    ///
    /// # Errors
    /// As [`EmulatedBoard::start`].
    pub fn start_without_plant(image: &Path) -> Result<(EmulatedBoard, String)> {
        let listener = TcpListener::bind("127.0.0.1:0").context("no port for the plant bus")?;
        let port = format!("tcp://{}", listener.local_addr()?);
        Ok((EmulatedBoard::switched_on(image, PlantSide::Port(listener), free_port()?)?, port))
    }

    fn switched_on(image: &Path, plant: PlantSide, listener: TcpListener) -> Result<EmulatedBoard> {
        let port = format!("tcp://{}", listener.local_addr()?);
        let (figures, flash) = (Arc::new(Mutex::new(Figures::default())), PersistentFlash::default());
        let late = LateSample::default();
        let serve = plant.server(&late, &figures)?;
        let power = Powered::on(image, &listener, serve, flash.clone())?;
        let image = image.to_owned();
        Ok(EmulatedBoard { image, listener, port, plant, figures, late, flash, power })
    }

    /// The port's name for a client.
    #[must_use]
    pub fn port(&self) -> &str {
        &self.port
    }

    /// The cost of the runs so far.
    #[must_use]
    pub fn figures(&self) -> Figures {
        *self.figures.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The cost of the longest part of a request since the last call, instructions.
    #[must_use]
    pub fn take_request_instructions(&self) -> u64 {
        std::mem::take(&mut self.figures.lock().unwrap_or_else(PoisonError::into_inner).request_instructions)
    }

    /// The board's flash.
    #[must_use]
    pub fn flash(&self) -> &PersistentFlash {
        &self.flash
    }

    /// The sample of each run that comes late.
    #[must_use]
    pub fn late_sample(&self) -> &LateSample {
        &self.late
    }

    /// Cuts the power, if it is still on, and restores it: memory is lost, the flash is kept, the plant is in its initial
    /// state, and the port is the same.
    ///
    /// # Errors
    /// When the board does not boot again, or its simulation had failed before.
    pub fn power_up(&mut self) -> Result<()> {
        self.power.off()?;
        self.flash.switch_on();
        let serve = self.plant.server(&self.late, &self.figures)?;
        self.power = Powered::on(&self.image, &self.listener, serve, self.flash.clone())?;
        Ok(())
    }

    /// Puts the processor into an endless loop, as a fault of the program would.
    ///
    /// # Errors
    /// When the emulator does not allow it.
    pub fn stall(&self) -> Result<()> {
        stall::stall(&self.power.folder.path().join(DEBUGGER))
    }

    /// Whether the emulator still runs.
    ///
    /// # Errors
    /// When the system does not tell.
    pub fn is_on(&self) -> Result<bool> {
        Ok(lock(&self.power.qemu).try_wait()?.is_none())
    }

    /// Switches the board off.
    ///
    /// # Errors
    /// When it had ended by itself, or the simulation had failed.
    pub fn stop(mut self) -> Result<()> {
        match self.power.off()? {
            Some(status) => Err(self.power.explain(anyhow!("{QEMU} ended by itself with {status}"))),
            None => Ok(()),
        }
    }
}

/// A port of this machine that nobody else has.
fn free_port() -> Result<TcpListener> {
    TcpListener::bind("127.0.0.1:0").context("no port for the emulated board")
}

/// Serves the plant bus until the board has gone; signals when the board has sent its hello.
type Serve = Box<dyn FnOnce(Pipes, &Sender<()>) -> Result<()> + Send>;

impl PlantSide {
    fn server(&self, late: &LateSample, figures: &Arc<Mutex<Figures>>) -> Result<Serve> {
        Ok(match self {
            PlantSide::Simulated { rig, seed, in_step } => {
                let time = Time::new(late.clone(), *in_step);
                let rig = Arc::new(Mutex::new(Rig::clone(rig)));
                let server = PlantServer::new(rig, *seed, time, Arc::clone(figures));
                Box::new(move |pipes, greet| server.serve(pipes, greet))
            }
            PlantSide::Port(listener) => {
                let listener = listener.try_clone()?;
                Box::new(move |pipes, greet| bridge::carry(pipes, &listener, greet))
            }
        })
    }
}

/// A board under power: the emulator, and the threads that serve its two buses.
struct Powered {
    qemu: Arc<Mutex<Child>>,
    plant: Option<JoinHandle<Result<()>>>,
    flash: Option<JoinHandle<Result<()>>>,
    folder: TempDir,
}

impl Powered {
    fn on(image: &Path, listener: &TcpListener, serve: Serve, mut flash: PersistentFlash) -> Result<Powered> {
        let folder = tempfile::tempdir().context("no folder for the pipes of the emulated board")?;
        let pipes = |[to_board, from_board]: [&str; 2]| {
            Pipes::make(folder.path(), to_board, from_board).context("no pipes for the emulated board")
        };
        let ((plant_bus, plant_held), (flash_bus, flash_held)) = (pipes(PLANT_BUS)?, pipes(FLASH_BUS)?);
        let qemu = start_qemu(QEMU, image, folder.path(), listener.try_clone()?)?;
        let qemu = Arc::new(Mutex::new(qemu));

        let (greet, greeted) = channel();
        let plant = std::thread::spawn(move || serve(plant_bus, &greet));
        let supply = Arc::clone(&qemu);
        let flash = std::thread::spawn(move || {
            if flash::serve(&mut flash, flash_bus)? {
                kill(&supply);
            }
            Ok(())
        });
        let mut board = Powered { qemu, plant: Some(plant), flash: Some(flash), folder };
        let result = board.wait_for_hello(&greeted);
        // From here on the pipes end with the emulator.
        drop((plant_held, flash_held));
        result.map_err(|error| board.explain(error))?;
        Ok(board)
    }

    fn wait_for_hello(&mut self, greeted: &Receiver<()>) -> Result<()> {
        let deadline = Instant::now() + HELLO_WAIT;
        loop {
            match greeted.recv_timeout(Duration::from_millis(50)) {
                Ok(()) => return Ok(()),
                Err(RecvTimeoutError::Disconnected) => return result_of(self.plant.take()),
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Some(status) = lock(&self.qemu).try_wait()? {
                bail!("{QEMU} ended with {status}");
            }
            if Instant::now() > deadline {
                bail!("the image did not send a hello on the plant bus within {} s", HELLO_WAIT.as_secs());
            }
        }
    }

    /// An error with the first line that the emulator or its image wrote about it. A register dump may follow in the log.
    fn explain(&self, error: anyhow::Error) -> anyhow::Error {
        let log = std::fs::read_to_string(self.folder.path().join(LOG)).unwrap_or_default();
        match log.lines().find(|line| !line.contains("warning:") && !line.trim().is_empty()) {
            Some(line) => error.context(line.to_owned()),
            None => error,
        }
    }

    /// Cuts the power; returns the exit status of the emulator if it had already ended.
    fn off(&mut self) -> Result<Option<ExitStatus>> {
        let ended = lock(&self.qemu).try_wait()?;
        kill(&self.qemu);
        result_of(self.plant.take())?;
        result_of(self.flash.take())?;
        Ok(ended)
    }
}

impl Drop for Powered {
    fn drop(&mut self) {
        let _ = self.off();
    }
}

fn lock(qemu: &Mutex<Child>) -> MutexGuard<'_, Child> {
    qemu.lock().unwrap_or_else(PoisonError::into_inner)
}

fn kill(qemu: &Mutex<Child>) {
    let mut qemu = lock(qemu);
    // It may have ended by itself.
    let _ = qemu.kill();
    let _ = qemu.wait();
}

fn result_of(thread: Option<JoinHandle<Result<()>>>) -> Result<()> {
    match thread.map(JoinHandle::join) {
        Some(Err(_)) => Err(anyhow!("the plant or the flash of the emulated board panicked")),
        Some(Ok(result)) => result,
        None => Ok(()),
    }
}

/// Starts the emulator. It inherits the listener as its standard input.
fn start_qemu(program: &str, image: &Path, folder: &Path, listener: TcpListener) -> Result<Child> {
    let image = std::path::absolute(image)?;
    let icount = format!("shift={ICOUNT_SHIFT}");
    let mut command = Command::new(program);
    command
        .current_dir(folder)
        .args(["-machine", "mps2-an386", "-nodefaults", "-display", "none", "-icount", &icount])
        .args(["-semihosting-config", "enable=on,target=native"])
        .args(["-chardev", "socket,id=uart0,fd=0,server=on,wait=off,nodelay=on"])
        .args(["-chardev", &format!("socket,id=debugger,path={DEBUGGER},server=on,wait=off")])
        .args(["-gdb", "chardev:debugger", "-serial", "chardev:uart0", "-kernel"])
        .arg(image)
        .stdin(Stdio::from(OwnedFd::from(listener)))
        .stdout(Stdio::null())
        .stderr(File::create(folder.join(LOG))?);
    command.spawn().map_err(|error| match error.kind() {
        ErrorKind::NotFound => {
            anyhow!("{program} is not found; install {QEMU}: apt-get install {QEMU}")
        }
        _ => anyhow::Error::new(error).context(format!("{program} cannot be started")),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_emulator_one_line_says_what_to_install() {
        let folder = tempfile::tempdir().expect("a folder");
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let started = start_qemu("no-such-emulator", Path::new("image"), folder.path(), listener);
        assert_eq!(
            started.expect_err("there is none").to_string(),
            "no-such-emulator is not found; install qemu-system-arm: apt-get install qemu-system-arm"
        );
    }
}
