//! The virtual rig: the firmware's application on the simulated plant, behind a port.
//!
//! It behaves like the board, over the same protocol. After the moves of a run the drive holds and the plant keeps
//! running. While the drive is disabled or armed, the plant is frozen, first in the initial state of its test and then
//! where the last run left it; a start resets it. A live plant is never frozen. Over TCP, several programs may talk to it
//! at once, so that a `stop` reaches it while a run is followed.

mod caller;
mod gate;
#[cfg(test)]
mod gate_tests;
#[cfg(test)]
mod leaving_tests;
mod listener;
mod reset;
mod serving;
#[cfg(test)]
mod serving_tests;
#[cfg(test)]
mod test_line;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Instant;

use anyhow::{Result, bail};
use pneudrive_app::fault_log::Memory;
use pneudrive_app::store::FlashStore;
use pneudrive_app::{Board, Control};
use pneudrive_controller::{Command, Config, Mode, Sample};
use pneudrive_sim::component::controller;
use pneudrive_sim::gain_bug;
use pneudrive_sim::keys;
use pneudrive_sim::{Accuracy, IntegrationError, Plant, Rig};

use crate::noise::RunSeeds;
use crate::persistent_flash::PersistentFlash;
use crate::timing::LateSample;
use crate::wiring::{Signals, Wiring, WiringFault};

pub use caller::Token;
pub use listener::Listener;
use reset::{Watchdog, booted, without_power};

/// How the time of a virtual rig advances.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    /// As fast as possible, instead of in real time.
    pub fast: bool,
    /// The plant keeps running between runs.
    pub live: bool,
}

/// Kind of board.
const NAME: &str = "virtual rig";

/// The fault of the plant that swaps the tubes for good.
const SWAPPED_TUBES: &str = "{ kind = \"swapped-tubes\", at_s = 0.0 }";

/// The longest name of a board, bytes.
const LONGEST_NAME: usize = 32;

/// The board of a virtual rig.
struct VirtualBoard {
    rig: Rig,
    seeds: RunSeeds,
    /// Called with the number of a run that begins.
    on_run: Box<dyn FnMut(u64) + Send>,
    name: String,
    pace: Pace,
    plant: Plant,
    mode: Mode,
    period_us: u64,
    time_us: u64,
    /// Time since the sample's instant.
    since_sample_us: u64,
    /// Number of samples in the present run.
    k: u64,
    late: LateSample,
    /// The wires between board and drive.
    signals: Signals,
    /// The digital inputs, which a request sets.
    inputs: u8,
    since: Instant,
    failed: Option<IntegrationError>,
    /// Its non-volatile memory.
    store: FlashStore<PersistentFlash, Box<Memory>>,
}

impl VirtualBoard {
    fn new(rig: Rig, seed: u64, pace: Pace, flash: PersistentFlash) -> VirtualBoard {
        let plant = Plant::new(&rig, Accuracy::of(&rig), seed);
        VirtualBoard {
            period_us: u64::from(rig.period_us().get()),
            name: name_of(&rig, seed),
            signals: Signals::of(&rig),
            rig,
            seeds: RunSeeds::new(seed),
            on_run: Box::new(|_| {}),
            pace,
            plant,
            mode: Mode::Disarmed,
            time_us: 0,
            since_sample_us: 0,
            k: 0,
            late: LateSample::default(),
            inputs: 0,
            since: Instant::now(),
            failed: None,
            store: without_power(flash),
        }
    }

    fn is_on_its_way(&self) -> bool {
        matches!(self.mode, Mode::Running | Mode::Homing)
    }

    fn moves(&self) -> bool {
        self.mode == Mode::Done || self.is_on_its_way() || self.pace.live
    }

    /// Advances to the next sample instant; a frozen plant stays as it is.
    fn next_sample(&mut self) {
        if self.moves()
            && let Err(error) = self.plant.next_sample()
        {
            self.failed = Some(error);
        }
        self.time_us += self.period_us;
        self.k += 1;
    }

    /// How late the present sample is.
    fn lateness_us(&self) -> u64 {
        if self.is_on_its_way() { u64::from(self.late.lateness_of(self.k)) } else { 0 }
    }
}

/// The name of the board, with the seed of its noise if there is noise and room for the seed.
fn name_of(rig: &Rig, seed: u64) -> String {
    let with_seed = format!("{NAME}, seed {seed}");
    let name_with_seed = rig.get(&keys::sensors::NOISE_COUNTS) > 0.0 && with_seed.len() <= LONGEST_NAME;
    if name_with_seed { with_seed } else { NAME.to_owned() }
}

/// The rig with its tubes on each other's port of the valve.
fn with_swapped_tubes(rig: &Rig) -> Result<Rig> {
    if !rig.fault_events().is_empty() {
        bail!(
            "tubes-swapped: the rig has faults of its own; add {SWAPPED_TUBES} to its faults.event instead"
        );
    }
    Ok(rig.with_settings(&[format!("faults.event=[{SWAPPED_TUBES}]")])?)
}

impl Board for VirtualBoard {
    type Store = FlashStore<PersistentFlash, Box<Memory>>;

    fn store(&mut self) -> &mut Self::Store {
        &mut self.store
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn build(&self) -> &'static str {
        pneudrive_app::BUILD
    }

    fn read_sensors(&mut self, config: &Config) -> Sample {
        // If the sensors cannot be read, the rig stops at the end of this sample.
        let sample = self.plant.sample().unwrap_or_else(|error| {
            self.failed = Some(error);
            Sample::default()
        });
        let disabled = matches!(self.mode, Mode::Disarmed | Mode::Fault(_));
        self.signals.sensed(config, sample, self.time_us, disabled)
    }

    /// The amplifier of a disabled drive holds the valve at its null.
    fn drive(&mut self, config: &Config, command: Command) {
        if self.moves() {
            self.plant.command(self.signals.driven(config, command));
        }
    }

    fn now_us(&self) -> u64 {
        self.time_us + self.since_sample_us + self.lateness_us()
    }

    fn host_clock_ms(&self) -> Option<u64> {
        (!self.pace.fast).then(|| self.since.elapsed().as_millis() as u64)
    }

    fn inputs(&mut self) -> u8 {
        self.inputs
    }

    fn emulate_inputs(&mut self, inputs: u8) -> bool {
        self.inputs = inputs;
        true
    }

    /// The plant takes the timing of the configuration, which may differ from the rig file by now; a live plant keeps its
    /// own.
    fn run_begins(&mut self, config: &Config) {
        self.mode = Mode::Running;
        self.k = 0;
        let seed = self.seeds.begin();
        (self.on_run)(self.seeds.runs());
        if !self.pace.live {
            let timing = &config.timing;
            self.period_us = u64::from(timing.period_us.get());
            self.plant = Plant::new(&self.rig, Accuracy::of(&self.rig), seed)
                .with_timing(self.period_us, u64::from(timing.delay_us.get()));
        }
    }

    fn starts_referenced(&self) -> bool {
        true
    }

    fn has_watchdog(&self) -> bool {
        true
    }
}

/// A virtual rig.
pub struct VirtualRig {
    control: Box<Control>,
    board: VirtualBoard,
    watchdog: Watchdog,
    /// When the port was polled last.
    polled: Instant,
}

impl VirtualRig {
    /// A rig with the true parameters of `rig`, powered on, its flash blank. `seed` fixes the sensor noise of all
    /// its runs; each has its own.
    ///
    /// # Errors
    /// For a rig with the simulator's own controller.
    pub fn new(rig: Rig, seed: u64, pace: Pace) -> Result<VirtualRig> {
        VirtualRig::with_flash(rig, seed, pace, PersistentFlash::default())
    }

    /// The same with wires that are not where they belong.
    ///
    /// # Errors
    /// As for [`VirtualRig::new`]; also when tubes are swapped on a rig that has other faults of its own
    /// (`[[faults.event]]`).
    pub fn wired(rig: Rig, seed: u64, pace: Pace, faults: &[WiringFault]) -> Result<VirtualRig> {
        let rig = match faults.contains(&WiringFault::TubesSwapped) {
            true => with_swapped_tubes(&rig)?,
            false => rig,
        };
        let virtual_rig = VirtualRig::new(rig, seed, pace)?;
        faults.iter().for_each(|&fault| virtual_rig.board.signals.wiring.spoil(fault));
        Ok(virtual_rig)
    }

    /// The same with a flash that was used before: the stored configuration is in force.
    ///
    /// # Errors
    /// For a rig with the simulator's own controller.
    pub fn with_flash(rig: Rig, seed: u64, pace: Pace, flash: PersistentFlash) -> Result<VirtualRig> {
        if rig.get(&keys::controller::MODEL) == controller::ControllerKind::Continuous {
            bail!(
                "the continuous controller exists only in the simulator; a virtual rig runs the firmware's controller, so write controller.model = \"sampled\""
            );
        }
        if let Some(bug) = gain_bug::named(&rig) {
            bail!("{bug} is only for the simulator; no firmware has this bug");
        }
        let mut board = VirtualBoard::new(rig, seed, pace, flash);
        let control = booted(&mut board, None)?;
        Ok(VirtualRig { control, board, watchdog: Watchdog::default(), polled: Instant::now() })
    }

    /// Calls `tell` with the number of each run as it begins, from 1 on.
    pub fn on_run(&mut self, tell: impl FnMut(u64) + Send + 'static) {
        self.board.on_run = Box::new(tell);
    }

    /// The wires between its board and its drive, and the hand that pushes its slide.
    #[must_use]
    pub fn wiring(&self) -> &Wiring {
        &self.board.signals.wiring
    }

    /// The sample of each run that comes late.
    #[must_use]
    pub fn late_sample(&self) -> &LateSample {
        &self.board.late
    }
}

/// A virtual rig that serves its port on a separate thread, until it is stopped or dropped.
pub struct Background {
    port: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<()>>>,
}

impl Background {
    /// Serves a rig with the true parameters of `rig`, as fast as it goes, at a free TCP port of this computer.
    ///
    /// ```
    /// use pneudrive_link::client::Client;
    /// use pneudrive_rigs::virtual_rig::Background;
    /// use pneudrive_sim::Rig;
    ///
    /// let rig = Rig::builtin("servo-a").expect("a built-in rig");
    /// let served = Background::of(rig)?;
    /// let mut client = Client::connect(served.port())?;
    /// assert_eq!(client.info()?.board, "virtual rig");
    /// assert_eq!(client.status()?.position, 8192, "counts, where its test begins");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As for [`VirtualRig::new`], and when there is no port.
    pub fn of(rig: Rig) -> Result<Background> {
        let listener = Listener::open("tcp:127.0.0.1:0")?;
        Ok(Background::start(VirtualRig::new(rig, 0, Pace { fast: true, live: false })?, listener))
    }

    /// Starts serving.
    #[must_use]
    pub fn start(mut rig: VirtualRig, mut listener: Listener) -> Background {
        let port = listener.port_name().to_owned();
        let stop = Arc::new(AtomicBool::new(false));
        let watched = Arc::clone(&stop);
        let thread = std::thread::spawn(move || rig.serve(&mut listener, &watched));
        Background { port, stop, thread: Some(thread) }
    }

    /// The port's name for a client.
    #[must_use]
    pub fn port(&self) -> &str {
        &self.port
    }

    /// Ends serving.
    ///
    /// # Errors
    /// When the simulation failed.
    pub fn stop(mut self) -> Result<()> {
        self.stop.store(true, Ordering::Relaxed);
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => bail!("the virtual rig panicked"),
            None => Ok(()),
        }
    }
}

impl Drop for Background {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}
