//! The plant's end of the plant bus, whatever carries it.

use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use pneudrive_app::plant_bus::{HELLO, Inputs, Next, Outputs, Tempo, VERSION, request_ticks};
use pneudrive_sim::{Accuracy, IntegrationError, Plant, Rig};

use crate::noise::RunSeeds;
use crate::sample_cost::Figures;
use crate::timing::LateSample;

/// The first bytes of a board.
pub(crate) type Hello = [u8; HELLO.len()];

/// What carries the bus to a board.
pub(crate) trait Bus {
    /// The board's hello, or what it says instead; None once it has gone.
    fn hello(&mut self) -> Result<Option<Hello>>;

    /// The bytes that the board says next; None once it has gone.
    fn read<const N: usize>(&mut self) -> Result<Option<[u8; N]>>;

    /// Says something to the board.
    fn write(&mut self, bytes: &[u8]) -> Result<()>;

    /// Forgets what was on its way when the board was reset.
    fn forget(&mut self) -> Result<()>;
}

/// The rig whose plant is simulated; another one is taken over when a run begins.
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

/// How the plant's time goes on.
pub(crate) struct Time {
    /// A sample that comes late.
    pub late: LateSample,
    /// It keeps step with the wall clock.
    pub in_step: bool,
    /// Samples of the run so far.
    k: u64,
    period_us: u64,
    begun: Instant,
}

impl Time {
    /// Without a run.
    pub(crate) fn new(late: LateSample, in_step: bool) -> Time {
        Time { late, in_step, k: 0, period_us: 0, begun: Instant::now() }
    }

    fn begin(&mut self, period_us: u32) {
        (self.k, self.period_us, self.begun) = (0, u64::from(period_us), Instant::now());
    }

    /// The next sample of the run; waits for its instant where there is one.
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

    /// Serves the bus until the board has gone. Tells `greet` once the hellos are exchanged. A board that was
    /// reset says hello again.
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
                bail!("the board said something that is not of version {VERSION} of the plant bus: {bytes:?}")
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
                "the image speaks version {version} of the plant bus, this program {VERSION}: build it again"
            )
        }
        other => bail!("the image does not speak the plant bus: it said {other:?}"),
    }
}

/// Bytes of outputs after as many as a hello has. No command looks like a hello.
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
