//! The wiring of the board: the plant of a rig, and faults of the wires.
//!
//! ```text
//! encoder             A and B to PA0, PA1: one edge per count
//! pressures, spool    to PC0, PC1, PB0: the middle of the voltages that a code of 12 bits stands for
//! DAC on PA4          counts = U / U(ref) * 4096 - 2048, which the amplifier holds at null while it is disabled
//! step, direction     PB6, PC7: a rising edge is a step
//! drive_enable        PB10
//! ```
//!
//! The plant lives from the beginning of a run until the drive is disabled, and stands frozen otherwise. Its signals
//! change at the instants at which channel 1 of TIM5 matches, and not in between: so they do not depend on how long the
//! processor takes to read them, and a record is that of the simulation. How long it takes is measured beside.

use pneudrive_controller::{Command, Sample};
use pneudrive_hil_tests::converter::{code_centre_v, command_of};
use pneudrive_sim::{Accuracy, Plant, Rig};

use crate::tap::Begun;

/// What may be wrong with the wires.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wiring {
    /// A track of the encoder is off: its line stays low.
    pub tracks_off: [bool; 2],
    /// Pressure 1, pressure 2 or spool is open: the resistor to ground makes it 0 V.
    pub sensors_open: [bool; 3],
}

/// What the board drives, at a sample instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven {
    /// The amplifier is enabled.
    pub enabled: bool,
    /// At the DAC's pin; None where nothing is.
    pub volts: Option<f64>,
    /// Steps since the last sample instant, positive ones extending.
    pub steps: i8,
}

/// The plant and its wires.
pub struct PinBench {
    rig: Rig,
    plant: Plant,
    /// The plant lives.
    lives: bool,
    /// The count of TIM5 at the run's first sample and at its last one so far; None: the first one is to come.
    samples: Option<(u64, u64)>,
    period_us: Option<u64>,
    /// Location of a stepper's spool, steps.
    spool_steps: i16,
    runs: u64,
    /// What the sensors show.
    pub sample: Sample,
    /// What is wrong with the wires.
    pub wiring: Wiring,
    /// Samples of all runs.
    pub sampled: u64,
}

/// Why the plant cannot go on.
pub type Broken = String;

impl PinBench {
    /// The plant of a rig, in the initial state of its test.
    ///
    /// # Errors
    /// When the plant cannot be simulated.
    pub fn new(rig: &Rig) -> Result<PinBench, Broken> {
        let mut plant = Plant::new(rig, Accuracy::of(rig), 0);
        let sample = plant.sample().map_err(|error| error.to_string())?;
        Ok(PinBench {
            rig: rig.clone(),
            plant,
            lives: false,
            samples: None,
            period_us: None,
            spool_steps: 0,
            runs: 0,
            sample,
            wiring: Wiring::default(),
            sampled: 0,
        })
    }

    /// Whether the plant lives.
    #[must_use]
    pub fn lives(&self) -> bool {
        self.lives
    }

    /// A run begins with the plant in its initial state; a homing run with the plant as it stands.
    pub fn begin(&mut self, what: Begun) {
        if what == Begun::Run {
            self.plant = Plant::new(&self.rig, Accuracy::of(&self.rig), self.runs);
            self.runs += 1;
            self.spool_steps = 0;
        }
        self.lives = true;
        (self.samples, self.period_us) = (None, None);
    }

    /// A sample is due at a count of TIM5, after an output at another one: what the sensors show from now on.
    ///
    /// # Errors
    /// When the plant cannot be simulated.
    pub fn sample_due(&mut self, at: u64, output_at: Option<u64>, driven: Driven) -> Result<(), Broken> {
        if !self.lives {
            return Ok(());
        }
        let (first, last) = self.samples.unwrap_or((at, at));
        if at > last {
            self.take_timing(
                at - last,
                output_at.filter(|output| *output > last).map(|output| output - last),
            );
            self.advance(at - last, driven).map_err(|error| error.to_string())?;
        }
        self.samples = Some((first, at));
        self.sample = self.plant.sample().map_err(|error| error.to_string())?;
        self.sampled += 1;
        // After this sample: the trip of a run still moves the plant to it.
        self.lives = driven.enabled || at == first;
        Ok(())
    }

    /// The plant's clock is that of the board, which shows at the second sample.
    fn take_timing(&mut self, period_us: u64, delay_us: Option<u64>) {
        if self.period_us.is_none() {
            self.period_us = Some(period_us);
            let delay_us = delay_us.unwrap_or(period_us / 2);
            self.plant = self.plant.clone().with_timing(period_us, delay_us);
        }
    }

    fn advance(&mut self, by_us: u64, driven: Driven) -> Result<(), pneudrive_sim::IntegrationError> {
        let periods = by_us / self.period_us.unwrap_or(by_us).max(1);
        for period in 0..periods.max(1) {
            let steps = if period == 0 { driven.steps } else { 0 };
            let command = self.command(Driven { steps, ..driven });
            self.plant.command(command);
            self.plant.next_sample()?;
        }
        Ok(())
    }

    /// What amplifier or translator make of the board's lines.
    fn command(&mut self, driven: Driven) -> Command {
        self.spool_steps += i16::from(driven.steps);
        let counts = match driven.volts {
            Some(volts) if driven.enabled && self.spool_steps == 0 => command_of(volts),
            _ => self.spool_steps,
        };
        Command { counts, step: driven.steps, drive_enable: driven.enabled }
    }

    /// Voltages of pressure 1, pressure 2 and spool.
    #[must_use]
    pub fn volts(&self) -> [f64; 3] {
        let Sample { pressure_1, pressure_2, spool, .. } = self.sample;
        let mut volts = [pressure_1, pressure_2, spool].map(code_centre_v);
        for (volts, open) in volts.iter_mut().zip(self.wiring.sensors_open) {
            *volts = if open { 0.0 } else { *volts };
        }
        volts
    }
}
