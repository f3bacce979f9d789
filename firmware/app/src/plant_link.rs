//! The board's end of the plant bus on a line that may have no other end, such as a second serial port.
//!
//! | the board | until | then |
//! |---|---|---|
//! | greets: says hello every [`PATIENCE_MS`] | it is answered | says the safe outputs and waits |
//! | waits for inputs | they come | samples, drives, says the outputs and waits |
//! | | [`PATIENCE_MS`] have passed | trips, if the drive is enabled, and greets |
//!
//! So the plant's frame triggers the sample. Requests are carried out while the board waits. A start makes the inputs
//! in transit obsolete: they are skipped, the plant is told to begin, and its next answer is k = 0.

use core::borrow::BorrowMut;

use pneudrive_controller::Fault;

use crate::control::Control;
use crate::lock_step::{LockStep, Stopwatch, run_control};
use crate::plant_bus::{HELLO, Inputs, Outputs, Tempo};
use crate::recorder::Recorder;
use crate::store::Store;

/// How long an answer may take, milliseconds.
pub const PATIENCE_MS: u32 = 200;

/// The line of the bus: the board sends a message and gets an answer of a known length.
pub trait Line {
    /// Sends a message, and forgets everything received before. The answer will have this many bytes.
    fn ask<const N: usize>(&mut self, bytes: [u8; N], answer_bytes: usize);

    /// The answer, once it has come whole and without an error on the line.
    fn answer<const N: usize>(&mut self) -> Option<[u8; N]>;
}

/// The state of the board's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Awaited {
    Hello,
    Inputs,
}

/// The board's end.
#[derive(Debug)]
pub struct PlantLink<L> {
    line: L,
    awaited: Awaited,
    asked: u32,
    patience: u32,
}

impl<L: Line> PlantLink<L> {
    /// Begins to send greetings. The stopwatch counts this many ticks a millisecond.
    pub fn new(line: L, ticks_per_ms: u32, stopwatch: &impl Stopwatch) -> PlantLink<L> {
        let patience = ticks_per_ms.saturating_mul(PATIENCE_MS);
        let mut link = PlantLink { line, awaited: Awaited::Hello, asked: 0, patience };
        link.greet(stopwatch);
        link
    }

    /// Takes the plant's answer, if it has come. The line's interrupt calls this.
    pub fn attend<S: Store>(
        &mut self,
        control: &mut Control<impl BorrowMut<Recorder>>,
        board: &mut LockStep<S>,
        stopwatch: &impl Stopwatch,
    ) {
        let outputs = match self.awaited {
            Awaited::Hello if self.line.answer() == Some(HELLO) => board.begins().unwrap_or(Outputs::OFF),
            Awaited::Hello => return,
            Awaited::Inputs => {
                let Some(bytes) = self.line.answer() else { return };
                board.begins().unwrap_or_else(|| sampled(bytes, control, board, stopwatch))
            }
        };
        self.ask(Awaited::Inputs, outputs.to_bytes(), Inputs::BYTES, stopwatch);
    }

    /// Checks whether the plant has fallen silent. The idle task calls this repeatedly.
    pub fn watch<S: Store>(
        &mut self,
        control: &mut Control<impl BorrowMut<Recorder>>,
        board: &mut LockStep<S>,
        stopwatch: &impl Stopwatch,
    ) {
        if stopwatch.since(self.asked) < self.patience {
            return;
        }
        if control.state().supervisor.drives() {
            control.trip(Fault::LateSample);
            // Null to the drive stage, the fault to the log: no sample will do it.
            control.on_output(board);
        }
        self.greet(stopwatch);
    }

    fn greet(&mut self, stopwatch: &impl Stopwatch) {
        self.ask(Awaited::Hello, HELLO, HELLO.len(), stopwatch);
    }

    fn ask<const N: usize>(
        &mut self,
        awaited: Awaited,
        bytes: [u8; N],
        answer_bytes: usize,
        stopwatch: &impl Stopwatch,
    ) {
        (self.awaited, self.asked) = (awaited, stopwatch.now());
        self.line.ask(bytes, answer_bytes);
    }
}

/// The sample that has come, and its consequences.
fn sampled<S: Store>(
    bytes: [u8; Inputs::BYTES],
    control: &mut Control<impl BorrowMut<Recorder>>,
    board: &mut LockStep<S>,
    stopwatch: &impl Stopwatch,
) -> Outputs {
    board.latch(&Inputs::from_bytes(bytes), Tempo::of(&bytes));
    let ticks = run_control(control, board, stopwatch);
    let next = LockStep::<S>::next(control.state().supervisor.mode());
    board.outputs(control, next, ticks)
}
