//! The emulated board: the image that is flashed, on a Cortex-M4 in QEMU, with its plant simulated here.
//!
//! QEMU takes the image's plant bus ([`pneudrive_app::plant_bus`]) from two pipes in a folder of its
//! own, and gives its UART0 as a TCP port to talk to. The processor stands still while it waits for the
//! plant, and the plant while it waits for the processor: the two are in lock step, however fast each is.
//! One program can talk to the port at a time, as to a serial port.

mod figures;
mod plant;

use std::fs::{File, OpenOptions};
use std::io::ErrorKind;
use std::net::TcpListener;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow, bail};
use nix::sys::stat::Mode;
use pneudrive_sim::Rig;
use tempfile::TempDir;

pub use figures::{Figures, Spread};
use plant::PlantServer;

/// The emulator.
const QEMU: &str = "qemu-system-arm";

/// Nanoseconds of virtual time an instruction takes, as a power of two. Each of the counter's ticks
/// (25 MHz) is less than that, so that ticks tell the number of instructions exactly.
const ICOUNT_SHIFT: u32 = 7;

/// How long the image may take to say hello.
const HELLO_WAIT: Duration = Duration::from_secs(20);

/// Pipes of the plant bus, as the image opens them.
const INPUTS: &str = "inputs";
const OUTPUTS: &str = "outputs";

/// What the emulator had to say.
const LOG: &str = "qemu.log";

/// An emulated board. It is switched off when dropped.
pub struct EmulatedBoard {
    qemu: Child,
    plant: Option<JoinHandle<Result<()>>>,
    figures: Arc<Mutex<Figures>>,
    port: String,
    folder: TempDir,
}

impl EmulatedBoard {
    /// Starts an image whose plant has the true parameters of `rig`. `seed` is for sensor noise. The
    /// image has its own parameters: download those of the rig.
    ///
    /// # Errors
    /// When QEMU is missing, or the image is none or of another version.
    pub fn start(rig: &Rig, image: &Path, seed: u64) -> Result<EmulatedBoard> {
        let folder = tempfile::tempdir().context("no folder for the pipes of the plant bus")?;
        let pipes = Pipes::make(folder.path()).context("no pipes for the plant bus")?;
        let listener = TcpListener::bind("127.0.0.1:0").context("no port for the emulated board")?;
        let port = format!("tcp://{}", listener.local_addr()?);
        let qemu = start_qemu(QEMU, image, folder.path(), listener)?;

        let figures = Arc::new(Mutex::new(Figures::default()));
        let server = PlantServer::new(rig.clone(), seed, Arc::clone(&figures));
        let (greet, greeted) = channel();
        let Pipes { inputs, outputs, held } = pipes;
        let plant = std::thread::spawn(move || server.serve(outputs, inputs, &greet));
        let mut board = EmulatedBoard { qemu, plant: Some(plant), figures, port, folder };
        let result = board.wait_for_hello(&greeted);
        // From here on the pipe ends with the emulator.
        drop(held);
        result.map_err(|error| board.explain(error))?;
        Ok(board)
    }

    /// The port's name for a client.
    #[must_use]
    pub fn port(&self) -> &str {
        &self.port
    }

    /// What the runs so far have cost.
    #[must_use]
    pub fn figures(&self) -> Figures {
        self.figures.lock().map_or_else(|poisoned| *poisoned.into_inner(), |figures| *figures)
    }

    /// Switches the board off.
    ///
    /// # Errors
    /// When it has ended by itself, or the simulation could not go on.
    pub fn stop(mut self) -> Result<()> {
        let ended = self.qemu.try_wait()?;
        self.kill();
        self.plant_result()?;
        match ended {
            Some(status) => Err(self.explain(anyhow!("{QEMU} ended by itself with {status}"))),
            None => Ok(()),
        }
    }

    fn wait_for_hello(&mut self, greeted: &Receiver<()>) -> Result<()> {
        let deadline = Instant::now() + HELLO_WAIT;
        loop {
            match greeted.recv_timeout(Duration::from_millis(50)) {
                Ok(()) => return Ok(()),
                Err(RecvTimeoutError::Disconnected) => return self.plant_result(),
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Some(status) = self.qemu.try_wait()? {
                bail!("{QEMU} ended with {status}");
            }
            if Instant::now() > deadline {
                bail!("the image did not say hello on the plant bus within {} s", HELLO_WAIT.as_secs());
            }
        }
    }

    /// An error with what the emulator or its image said of it. A processor's registers may follow there.
    fn explain(&self, error: anyhow::Error) -> anyhow::Error {
        let log = std::fs::read_to_string(self.folder.path().join(LOG)).unwrap_or_default();
        match log.lines().find(|line| !line.contains("warning:") && !line.trim().is_empty()) {
            Some(line) => error.context(line.to_owned()),
            None => error,
        }
    }

    fn kill(&mut self) {
        // It may have ended by itself.
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
    }

    fn plant_result(&mut self) -> Result<()> {
        match self.plant.take().map(JoinHandle::join) {
            Some(Err(_)) => Err(anyhow!("the plant of the emulated board broke down")),
            Some(Ok(result)) => result,
            None => Ok(()),
        }
    }
}

impl Drop for EmulatedBoard {
    fn drop(&mut self) {
        self.kill();
        let _ = self.plant_result();
    }
}

/// The host's ends of the plant bus.
struct Pipes {
    inputs: File,
    outputs: File,
    /// Writes nothing; keeps `outputs` from waiting for the emulator, or from ending before it has come.
    held: File,
}

impl Pipes {
    fn make(folder: &Path) -> Result<Pipes> {
        let both = |name: &str| OpenOptions::new().read(true).write(true).open(folder.join(name));
        for name in [INPUTS, OUTPUTS] {
            nix::unistd::mkfifo(&folder.join(name), Mode::S_IRUSR | Mode::S_IWUSR)?;
        }
        let held = both(OUTPUTS)?;
        Ok(Pipes { inputs: both(INPUTS)?, outputs: File::open(folder.join(OUTPUTS))?, held })
    }
}

/// Starts the emulator. It finds the listener as its standard input.
fn start_qemu(program: &str, image: &Path, folder: &Path, listener: TcpListener) -> Result<Child> {
    let image = std::path::absolute(image)?;
    let icount = format!("shift={ICOUNT_SHIFT}");
    let mut command = Command::new(program);
    command
        .current_dir(folder)
        .args(["-machine", "mps2-an386", "-nodefaults", "-display", "none", "-icount", &icount])
        .args(["-semihosting-config", "enable=on,target=native"])
        .args(["-chardev", "socket,id=uart0,fd=0,server=on,wait=off,nodelay=on"])
        .args(["-serial", "chardev:uart0", "-kernel"])
        .arg(image)
        .stdin(Stdio::from(OwnedFd::from(listener)))
        .stdout(Stdio::null())
        .stderr(File::create(folder.join(LOG))?);
    command.spawn().map_err(|error| match error.kind() {
        ErrorKind::NotFound => {
            anyhow!("{program} is not found; install {QEMU}: apt-get install {QEMU}")
        }
        _ => anyhow::Error::new(error).context(format!("{program} can't be started")),
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
