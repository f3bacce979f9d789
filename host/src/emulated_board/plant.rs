//! The plant's end of the plant bus.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::path::PathBuf;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use pneudrive_app::plant_bus::{HELLO, Inputs, Next, Outputs, Tempo, VERSION};
use pneudrive_sim::{Accuracy, IntegrationError, Plant, Rig};

use super::figures::Figures;
use super::pipes::drain;
use crate::punctuality::LateSample;

/// A plant that answers a board's outputs with the inputs of the next sample.
pub(super) struct PlantServer {
    rig: Rig,
    seed: u64,
    plant: Plant,
    time: Time,
    figures: Arc<Mutex<Figures>>,
}

/// How the plant's time goes on.
pub(super) struct Time {
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
    pub(super) fn new(late: LateSample, in_step: bool) -> Time {
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
    /// The plant of a rig in the initial state of its test.
    pub(super) fn new(rig: Rig, seed: u64, time: Time, figures: Arc<Mutex<Figures>>) -> PlantServer {
        let plant = Plant::new(&rig, Accuracy::default(), seed);
        PlantServer { rig, seed, plant, time, figures }
    }

    /// Serves the bus until the board has gone. Tells `greet` once the hellos are exchanged.
    /// A board that was reset says hello again.
    pub(super) fn serve(
        mut self,
        mut outputs: File,
        mut inputs: File,
        pipe: &PathBuf,
        greet: &Sender<()>,
    ) -> Result<()> {
        let hello = read(&mut outputs)?.context("the image ended before its hello")?;
        exchange_hellos(hello, &mut inputs)?;
        // Nobody may be waiting any more.
        let _ = greet.send(());
        while let Some(first) = read(&mut outputs)? {
            if first == HELLO {
                drain(pipe)?;
                exchange_hellos(first, &mut inputs)?;
                continue;
            }
            let Some(rest) = read(&mut outputs)? else { break };
            let bytes = together(first, rest);
            let Some(from_board) = Outputs::from_bytes(bytes) else {
                bail!("the board said something that is not of version {VERSION} of the plant bus: {bytes:?}")
            };
            let begun = Instant::now();
            let answer = self.answer(from_board).context("the plant of the emulated board stopped")?;
            self.note(from_board, begun);
            let mut answer = answer.to_bytes();
            self.time.tempo(from_board.next != Next::Stay).mark(&mut answer);
            inputs.write_all(&answer)?;
        }
        Ok(())
    }

    fn answer(&mut self, outputs: Outputs) -> Result<Inputs, IntegrationError> {
        match outputs.next {
            Next::Stay => {}
            Next::Advance => {
                self.plant.command(outputs.command);
                self.plant.next_sample()?;
                self.time.advance();
            }
            Next::Begin { period_us, delay_us } => {
                self.plant = Plant::new(&self.rig, Accuracy::default(), self.seed)
                    .with_timing(u64::from(period_us), u64::from(delay_us));
                self.time.begin(period_us);
            }
        }
        Ok(Inputs { sample: self.plant.sample(), frozen: outputs.next == Next::Stay })
    }

    fn note(&self, outputs: Outputs, begun: Instant) {
        if let Ok(mut figures) = self.figures.lock() {
            figures.add(outputs, begun, Instant::now());
        }
    }
}

fn exchange_hellos(hello: [u8; HELLO.len()], inputs: &mut File) -> Result<()> {
    inputs.write_all(&HELLO)?;
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

/// Bytes of outputs that follow the first ones, which no command looks like a hello in.
const REST: usize = Outputs::BYTES - HELLO.len();

fn together(first: [u8; HELLO.len()], rest: [u8; REST]) -> [u8; Outputs::BYTES] {
    let mut bytes = [0; Outputs::BYTES];
    bytes[..HELLO.len()].copy_from_slice(&first);
    bytes[HELLO.len()..].copy_from_slice(&rest);
    bytes
}

/// The bytes that the board says next; None once it has gone.
fn read<const N: usize>(outputs: &mut File) -> Result<Option<[u8; N]>> {
    let mut bytes = [0; N];
    match outputs.read_exact(&mut bytes) {
        Ok(()) => Ok(Some(bytes)),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error).context("the plant bus broke"),
    }
}
