//! The flashed image as an execution level of the tests.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use anyhow::{Context, Result, anyhow};
use pneudrive_controller::parameters::id;
use pneudrive_hil_tests::{Supplied, Target};
use pneudrive_link::client::Client;
use pneudrive_plan::nucleo::flash::layout;
use pneudrive_sim::{Accuracy, Plant, Rig};

use crate::image::Image;
use crate::line::Line;
use crate::machine::{Job, Machine};
use crate::peripheral::flash::Cut;
use crate::time::Corner;

/// The variable that names an image that is there already; without it, one is built.
pub const IMAGE: &str = "PNEUDRIVE_FLASHED_IMAGE";

/// A board that runs on a thread of its own. It is switched off when dropped.
pub struct FlashedTarget {
    name: String,
    port: String,
    /// The count at which the plant stands at the beginning of its test.
    beginning: i32,
    jobs: Option<Sender<Job>>,
    thread: Option<JoinHandle<()>>,
}

impl FlashedTarget {
    /// A board whose plant has the true parameters of a rig, put into service as a new board is: the parameters of
    /// the rig downloaded, the axis referenced where it stands, a stepper's spool stated to be at its null.
    ///
    /// # Errors
    /// When the image cannot be built, or does not answer.
    pub fn start(rig: &Rig, corner: Corner) -> Result<FlashedTarget> {
        FlashedTarget::start_image(rig, corner, image()?)
    }

    /// The same with another image.
    ///
    /// # Errors
    /// When there is none, or it does not answer.
    pub fn start_image(rig: &Rig, corner: Corner, image: &Path) -> Result<FlashedTarget> {
        let target = FlashedTarget::switched_on(rig, corner, image)?;
        let mut client = target.connect()?;
        let parameters = rig.parameters();
        client.import_parameters(&parameters)?;
        client.reference(target.beginning)?;
        if parameters.get(id::STEPPER) == Some(1) {
            client.at_null()?;
        }
        Ok(target)
    }

    /// A board as it is delivered.
    ///
    /// # Errors
    /// When there is no such image.
    pub fn switched_on(rig: &Rig, corner: Corner, image: &Path) -> Result<FlashedTarget> {
        let (image, line) = (Image::read(image)?, Line::open()?);
        let port = line.port()?;
        let beginning = Plant::new(rig, Accuracy::of(rig), 0).sample()?.position;
        let (jobs, work) = channel();
        let rig = rig.clone();
        let thread = std::thread::spawn(move || {
            // A machine that ends early hangs up: whoever talks to it notices.
            if let Err(error) =
                Machine::new(image, &rig, corner, line).and_then(|machine| serve(machine, &work))
            {
                eprintln!("the board with the flashed image: {error:#}");
            }
        });
        let name = format!("flashed image, {} cycles an instruction", corner.cycles_per_instruction);
        Ok(FlashedTarget { name, port, beginning, jobs: Some(jobs), thread: Some(thread) })
    }

    /// Does something to the machine, between two of its turns.
    ///
    /// # Errors
    /// When the machine has ended.
    pub fn with<T: Send + 'static>(&self, job: impl FnOnce(&mut Machine) -> T + Send + 'static) -> Result<T> {
        let (tell, told) = channel();
        let job: Job = Box::new(move |machine| drop(tell.send(job(machine))));
        let ended = || anyhow!("the board with the flashed image has ended");
        self.jobs.as_ref().and_then(|jobs| jobs.send(job).ok()).ok_or_else(ended)?;
        told.recv().map_err(|_| ended())
    }

    /// The axis stands where its test begins, and counts mean positions.
    ///
    /// # Errors
    /// When the board does not answer, or the drive is enabled.
    pub fn reference(&self) -> Result<Client> {
        let mut client = self.connect()?;
        client.reference(self.beginning)?;
        Ok(client)
    }
}

/// Runs the machine until nobody can want anything of it.
fn serve(mut machine: Machine, jobs: &Receiver<Job>) -> Result<()> {
    loop {
        loop {
            match jobs.try_recv() {
                Ok(job) => job(&mut machine),
                Err(std::sync::mpsc::TryRecvError::Empty) => break,
                Err(std::sync::mpsc::TryRecvError::Disconnected) => return Ok(()),
            }
        }
        machine.turn()?;
    }
}

impl Target for FlashedTarget {
    fn name(&self) -> &str {
        &self.name
    }

    fn port(&self) -> &str {
        &self.port
    }

    fn set_inputs(&self, _: &mut Client, inputs: u8) -> Result<()> {
        self.with(move |machine| machine.board().set_inputs(inputs))
    }

    fn cost(&self) -> Option<String> {
        let cost = self.with(|machine| machine.cost).ok()?;
        let a_second = cost.samples as f64 / cost.took.as_secs_f64().max(1e-9);
        Some(format!("{} samples, {a_second:.0} a second", cost.samples))
    }
}

impl Supplied for FlashedTarget {
    /// An operation goes from unlocking the flash to locking it.
    fn cut_power_at(&self, nth: u64) {
        // Anywhere in it: 37 is prime to 100.
        let cut = Cut { operation: nth, percent: (nth * 37 % 100) as usize };
        self.with(move |machine| machine.board().flash.cut_power(cut)).expect("a board that runs");
    }

    fn damage_configuration(&self) {
        let slots = layout().config;
        let damage = move |machine: &mut Machine| {
            slots.into_iter().for_each(|slot| machine.board().flash.clear(slot.start as usize, 64));
        };
        self.with(damage).expect("a board that runs");
    }

    /// Counts mean nothing after a power cut, so the axis is referenced again.
    fn power_up(&mut self) -> Result<()> {
        self.with(Machine::power_up)??;
        self.reference().map(drop)
    }
}

impl Drop for FlashedTarget {
    fn drop(&mut self) {
        self.jobs = None;
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// The image of the Nucleo board: the one that [`IMAGE`] names, or built from the sources as they are.
///
/// # Errors
/// When it cannot be built.
pub fn image() -> Result<&'static PathBuf> {
    static BUILT: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let built = BUILT.get_or_init(|| {
        if let Some(named) = std::env::var_os(IMAGE) {
            return Ok(PathBuf::from(named));
        }
        let folder = pneudrive_build::cargo::image_folder().and_then(|folder| build(&folder));
        folder.map_err(|error| format!("{error:#}"))
    });
    built.as_ref().map_err(|error| anyhow!("{error}"))
}

/// The image of the Nucleo board, with the cylinder at its pins.
pub const NUCLEO: &str = "nucleo-f446";

fn build(folder: &Path) -> Result<PathBuf> {
    pneudrive_build::firmware::build(folder, NUCLEO, &[]).context("the image that is flashed")
}
