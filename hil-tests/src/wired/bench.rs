//! The plant of a rig behind the lines.
//!
//! ```text
//! encoder           one edge of A or B per count, walked through one after the other
//! pressures, spool  the middle of the voltages that a code of 12 bits stands for
//! amplifier         counts = U / U(ref) * 4096 - 2048; it holds the valve at its null while it is disabled
//! translator        a rising edge is a step
//! ```
//!
//! The plant lives from the beginning of a run until the drive is disabled, and stands frozen otherwise, as on every
//! simulated execution level.

use std::cell::RefCell;
use std::rc::Rc;

use pneudrive_controller::config::Timing;
use pneudrive_controller::{Command, Mode, Sample};
use pneudrive_sim::{Accuracy, IntegrationError, Plant, Rig};

use super::chips::Ls7366r;
use super::wires::Wires;
use crate::converter::{code_centre_v, command_of};

/// The plant, and what it is wired to.
pub struct ChipBench {
    rig: Rig,
    plant: Plant,
    wires: Wires,
    /// The counter that sees the encoder's edges.
    pub encoder: Rc<RefCell<Ls7366r>>,
    /// Where the encoder's edges have led to, counts.
    walked: i32,
    /// Location of a stepper's spool, steps.
    spool_steps: i16,
    mode: Mode,
    runs: u64,
    /// Samples of the run so far.
    pub k: u64,
}

impl ChipBench {
    /// The plant of a rig in the initial state of its test.
    pub fn new(rig: &Rig, wires: Wires, encoder: Rc<RefCell<Ls7366r>>) -> ChipBench {
        let plant = Plant::new(rig, Accuracy::of(rig), 0);
        let mode = Mode::Disarmed;
        ChipBench { rig: rig.clone(), plant, wires, encoder, walked: 0, spool_steps: 0, mode, runs: 0, k: 0 }
    }

    /// A run begins with the plant in its initial state.
    pub fn begin(&mut self, timing: &Timing) {
        let (period_us, delay_us) = (timing.period_us.get(), timing.delay_us.get());
        self.plant = Plant::new(&self.rig, Accuracy::of(&self.rig), self.runs)
            .with_timing(u64::from(period_us), u64::from(delay_us));
        (self.mode, self.spool_steps, self.k) = (Mode::Running, 0, 0);
        self.runs += 1;
    }

    /// Whether a run or a homing run is on its way.
    pub fn is_on_its_way(&self) -> bool {
        matches!(self.mode, Mode::Running | Mode::Homing)
    }

    fn lives(&self) -> bool {
        self.is_on_its_way() || self.mode == Mode::Done
    }

    /// A sample instant: the lines show what the plant does.
    ///
    /// # Errors
    /// When the plant cannot be simulated.
    pub fn sample(&mut self) -> Result<(), IntegrationError> {
        let Sample { position, pressure_1, pressure_2, spool, .. } = self.plant.sample()?;
        self.wires.borrow_mut().sensors_v = [pressure_1, pressure_2, spool].map(code_centre_v);
        self.walk_to(position);
        self.k += 1;
        Ok(())
    }

    /// Edge by edge, as an encoder moves.
    fn walk_to(&mut self, position: i32) {
        while self.walked != position {
            self.walked += (position - self.walked).signum();
            // A quarter of the period per count: B follows A.
            let tracks = [matches!(self.walked & 3, 1 | 2), matches!(self.walked & 3, 2 | 3)];
            self.wires.borrow_mut().tracks = tracks;
            self.encoder.borrow_mut().see(tracks);
        }
    }

    /// An output instant: the plant takes what the lines say, and goes on to the next sample in the mode that this
    /// one has led to.
    ///
    /// # Errors
    /// When the plant cannot be simulated.
    pub fn output(&mut self, mode: Mode) -> Result<(), IntegrationError> {
        let command = self.command();
        if self.lives() {
            self.plant.command(command);
        }
        self.mode = mode;
        if self.lives() { self.plant.next_sample() } else { Ok(()) }
    }

    /// What amplifier or translator make of the lines.
    fn command(&mut self) -> Command {
        let lines = &mut *self.wires.borrow_mut();
        let step = std::mem::take(&mut lines.steps);
        self.spool_steps += i16::from(step);
        let counts = match lines.command_v {
            Some(volts) if lines.enable && self.spool_steps == 0 => command_of(volts),
            _ => self.spool_steps,
        };
        Command { counts, step, drive_enable: lines.enable }
    }
}
