//! The plant's end of the plant bus, over any transport.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use pneudrive_app::plant_bus::{HELLO, Inputs, Next, Outputs, Tempo, VERSION, request_ticks};
use pneudrive_rigs::noise::RunSeeds;
use pneudrive_rigs::timing::LateSample;
use pneudrive_sim::{Accuracy, IntegrationError, Plant, Rig};

use crate::sample_cost::Figures;

/// The first bytes from a board.
pub(crate) type Hello = [u8; HELLO.len()];

/// The transport of the bus.
pub(crate) trait Bus {
    /// The board's hello, or the bytes that it sends instead; None once it has gone.
    fn hello(&mut self) -> Result<Option<Hello>>;

    /// The next bytes from the board; None once it has gone.
    fn read<const N: usize>(&mut self) -> Result<Option<[u8; N]>>;

    /// Sends bytes to the board.
    fn write(&mut self, bytes: &[u8]) -> Result<()>;

    /// Discards the bytes that were in transit when the board was reset.
    fn forget(&mut self) -> Result<()>;
}

/// The rig whose plant is simulated; a new one takes effect when a run begins.
pub(crate) type SharedRig = Arc<Mutex<Rig>>;

fn current(rig: &SharedRig) -> Rig {
    rig.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

fn plant_of(rig: &Rig, seed: u64) -> Plant {
    Plant::new(rig, Accuracy::of(rig), seed)
}

/// A plant that answers a board's outputs with the inputs of the next sample.
pub(crate) struct PlantServer {
    rig: SharedRig,
    seeds: RunSeeds,
    plant: Plant,
    time: Time,
    figures: Arc<Mutex<Figures>>,
}

/// The time of the plant.
pub(crate) struct Time {
    /// A sample that comes late.
    pub late: LateSample,
    /// Whether it keeps step with the wall clock.
    pub in_step: bool,
    /// Number of samples in the present run.
    k: u64,
    period_us: u64,
    begun: Instant,
}

impl Time {
    /// The time before any run.
    pub(crate) fn new(late: LateSample, in_step: bool) -> Time {
        Time { late, in_step, k: 0, period_us: 0, begun: Instant::now() }
    }

    fn begin(&mut self, period_us: u32) {
        (self.k, self.period_us, self.begun) = (0, u64::from(period_us), Instant::now());
    }

    /// Advances to the next sample of the run; in step with the wall clock, waits for its instant.
    fn advance(&mut self) {
        self.k += 1;
        let due = Duration::from_micros(self.k * self.period_us);
        if self.in_step {
            std::thread::sleep(due.saturating_sub(self.begun.elapsed()));
        }
    }

    fn tempo(&self, runs: bool) -> Tempo {
        let late_us = if runs { self.late.lateness_of(self.k) } else { 0 };
        Tempo { late_us, in_step: self.in_step }
    }
}

impl PlantServer {
    /// The plant of a rig in the initial state of its test. `seed` fixes the sensor noise of all its runs.
    pub(crate) fn new(rig: SharedRig, seed: u64, time: Time, figures: Arc<Mutex<Figures>>) -> PlantServer {
        let plant = plant_of(&current(&rig), seed);
        PlantServer { rig, seeds: RunSeeds::new(seed), plant, time, figures }
    }

    /// Serves the bus until the board has gone. Signals `greet` when the hellos are exchanged. A board that was reset sends
    /// its hello again.
    pub(crate) fn serve(mut self, mut bus: impl Bus, greet: &Sender<()>) -> Result<()> {
        let hello = bus.hello()?.context("the board ended before its hello")?;
        exchange_hellos(hello, &mut bus)?;
        // Nobody may be waiting any more.
        let _ = greet.send(());
        while let Some(first) = bus.read()? {
            if first == HELLO {
                bus.forget()?;
                exchange_hellos(first, &mut bus)?;
                continue;
            }
            let Some(rest) = bus.read()? else { break };
            let bytes = together(first, rest);
            let Some(from_board) = Outputs::from_bytes(bytes) else {
                bail!("the board sent bytes that are not of version {VERSION} of the plant bus: {bytes:?}")
            };
            let begun = Instant::now();
            let answer = self.answer(from_board).context("the plant of the board stopped")?;
            self.note(from_board, request_ticks(&bytes), begun);
            let mut answer = answer.to_bytes();
            self.time.tempo(from_board.next != Next::Stay).mark(&mut answer);
            bus.write(&answer)?;
        }
        Ok(())
    }

    fn answer(&mut self, outputs: Outputs) -> Result<Inputs, IntegrationError> {
        match outputs.next {
            Next::Stay => {}
            Next::Advance | Next::Hold => {
                self.plant.command(outputs.command);
                self.plant.next_sample()?;
                self.time.advance();
            }
            Next::Begin { period_us, delay_us } => {
                self.plant = plant_of(&current(&self.rig), self.seeds.begin())
                    .with_timing(u64::from(period_us), u64::from(delay_us));
                self.time.begin(period_us);
            }
        }
        Ok(Inputs { sample: self.plant.sample()?, frozen: outputs.next == Next::Stay })
    }

    fn note(&self, outputs: Outputs, request: u32, begun: Instant) {
        if let Ok(mut figures) = self.figures.lock() {
            figures.add_request(request);
            figures.add(outputs, begun, Instant::now());
        }
    }
}

fn exchange_hellos(hello: Hello, bus: &mut impl Bus) -> Result<()> {
    bus.write(&HELLO)?;
    match hello {
        HELLO => Ok(()),
        [b'P', b'N', b'B', version] => {
            bail!(
                "the image speaks version {version} of the plant bus, this program {VERSION}: rebuild the image"
            )
        }
        other => bail!("the image does not speak the plant bus: it sent {other:?}"),
    }
}

/// Bytes of outputs after the length of a hello. No outputs begin like a hello.
const REST: usize = Outputs::BYTES - HELLO.len();

fn together(first: Hello, rest: [u8; REST]) -> [u8; Outputs::BYTES] {
    let mut bytes = [0; Outputs::BYTES];
    bytes[..HELLO.len()].copy_from_slice(&first);
    bytes[HELLO.len()..].copy_from_slice(&rest);
    bytes
}

#[cfg(test)]
mod tests {
    use pneudrive_controller::Command;

    use super::*;

    /// Pressure 1 at the samples of a run of a drive at rest.
    fn run(server: &mut PlantServer) -> Vec<i16> {
        let command = Command { counts: 0, step: 0, drive_enable: true };
        let mut next = Next::Begin { period_us: 1300, delay_us: 500 };
        let mut pressures = Vec::new();
        for _ in 0..20 {
            let answer = server.answer(Outputs { command, next, ..Outputs::OFF }).expect("a plant");
            pressures.push(answer.sample.pressure_1);
            next = Next::Advance;
        }
        pressures
    }

    #[test]
    fn every_run_of_a_simulated_plant_has_its_own_noise_and_a_seed_repeats_the_sequence() {
        let rig = Rig::read("noisy", "[sensors]\nnoise_counts = 2.0\n").expect("valid");
        let server = || {
            let time = Time::new(LateSample::default(), false);
            PlantServer::new(Arc::new(Mutex::new(rig.clone())), 7, time, Arc::default())
        };
        let (mut one, mut other) = (server(), server());
        let (first, second) = (run(&mut one), run(&mut one));
        assert_ne!(first, second);
        assert_eq!([run(&mut other), run(&mut other)], [first, second]);
    }
}
