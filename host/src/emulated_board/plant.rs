//! The plant's end of the plant bus.

use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use pneudrive_app::plant_bus::{HELLO, Inputs, Next, Outputs, VERSION};
use pneudrive_sim::{Accuracy, IntegrationError, Plant, Rig};

use super::figures::Figures;

/// A plant that answers a board's outputs with the inputs of the next sample.
pub(super) struct PlantServer {
    rig: Rig,
    seed: u64,
    plant: Plant,
    figures: Arc<Mutex<Figures>>,
}

impl PlantServer {
    /// The plant of a rig in the initial state of its test.
    pub(super) fn new(rig: Rig, seed: u64, figures: Arc<Mutex<Figures>>) -> PlantServer {
        let plant = Plant::new(&rig, Accuracy::default(), seed);
        PlantServer { rig, seed, plant, figures }
    }

    /// Serves the bus until the board has gone. Tells `greet` once the hellos are exchanged.
    pub(super) fn serve(mut self, mut outputs: File, mut inputs: File, greet: &Sender<()>) -> Result<()> {
        exchange_hellos(&mut outputs, &mut inputs)?;
        // Nobody may be waiting any more.
        let _ = greet.send(());
        while let Some(bytes) = read_outputs(&mut outputs)? {
            let Some(from_board) = Outputs::from_bytes(bytes) else {
                bail!("the board said something that is not of version {VERSION} of the plant bus: {bytes:?}")
            };
            let begun = Instant::now();
            let answer = self.answer(from_board).context("the plant of the emulated board stopped")?;
            self.note(from_board, begun);
            inputs.write_all(&answer.to_bytes())?;
        }
        Ok(())
    }

    fn answer(&mut self, outputs: Outputs) -> Result<Inputs, IntegrationError> {
        match outputs.next {
            Next::Stay => {}
            Next::Advance => {
                self.plant.command(outputs.command);
                self.plant.next_sample()?;
            }
            Next::Begin { period_us, delay_us } => {
                self.plant = Plant::new(&self.rig, Accuracy::default(), self.seed)
                    .with_timing(u64::from(period_us), u64::from(delay_us));
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

fn exchange_hellos(outputs: &mut File, inputs: &mut File) -> Result<()> {
    let mut hello = [0; HELLO.len()];
    outputs.read_exact(&mut hello).context("the image ended before its hello")?;
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

/// The board's turn; None once it has gone.
fn read_outputs(outputs: &mut File) -> Result<Option<[u8; Outputs::BYTES]>> {
    let mut bytes = [0; Outputs::BYTES];
    match outputs.read_exact(&mut bytes) {
        Ok(()) => Ok(Some(bytes)),
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error).context("the plant bus broke"),
    }
}
