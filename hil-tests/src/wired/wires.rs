//! The lines between chips, microcontroller and plant, and the microcontroller's own end of them: pins and timer.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use pneudrive_app::runtime::clock::{Mark, Timer};
use pneudrive_app::runtime::spool::SpoolMemory;

use super::Chip;

/// Levels and voltages.
#[derive(Debug, Default)]
pub struct Lines {
    /// The tracks of the encoder, A and B.
    pub tracks: [bool; 2],
    /// Pressure 1, pressure 2 and spool, V.
    pub sensors_v: [f64; 3],
    /// The command of the amplifier, V; None while the converter does not drive it.
    pub command_v: Option<f64>,
    /// Amplifier and translator are enabled.
    pub enable: bool,
    /// The translator extends.
    pub direction: bool,
    /// The translator's pulse.
    pub step: bool,
    /// Steps since this was last taken, positive ones extending.
    pub steps: i8,
    /// The microcontroller's counter, microseconds.
    pub now_us: u32,
    /// What has passed at the chips, ns: waits and clocks alone, so no frame leans on the time between two interrupts.
    pub passed_ns: u64,
    /// The instants that its channels are set to, and whether they were reached.
    pub instants: [(u32, bool); 2],
    /// A chip that has lost its supply: its output is pulled up by the resistor of the bus.
    pub without_supply: Option<Chip>,
}

impl Lines {
    /// The timer reaches an instant, and the processor comes to it `late_us` later.
    pub fn reach(&mut self, mark: Mark, late_us: u16) {
        let (instant, reached) = &mut self.instants[mark as usize];
        *reached = true;
        self.now_us = instant.wrapping_add(u32::from(late_us));
    }
}

/// The lines, for everyone who is at them.
pub type Wires = Rc<RefCell<Lines>>;

/// An output of the microcontroller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    Enable,
    Direction,
    Step,
}

/// A pin that drives a line.
pub struct OutputLine(pub Wires, pub Output);

impl ErrorType for OutputLine {
    type Error = Infallible;
}

impl OutputLine {
    fn set(&mut self, high: bool) {
        let lines = &mut *self.0.borrow_mut();
        match self.1 {
            Output::Enable => lines.enable = high,
            Output::Direction => lines.direction = high,
            Output::Step => {
                let rises = high && !lines.step;
                lines.step = high;
                // A translator that is not enabled takes no step.
                if rises && lines.enable {
                    lines.steps += if lines.direction { 1 } else { -1 };
                }
            }
        }
    }
}

impl OutputPin for OutputLine {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}

/// A homing switch that is not there: its pull-up holds the line high.
pub struct NoSwitch;

/// Digital inputs, which a request sets, and outputs at which nobody looks but by requests.
#[derive(Default)]
pub struct Terminals {
    pub inputs: u8,
}

impl pneudrive_interfaces::Terminals for Terminals {
    fn read(&mut self) -> u8 {
        self.inputs
    }

    fn write(&mut self, _: u8) {}
}

impl ErrorType for NoSwitch {
    type Error = Infallible;
}

impl InputPin for NoSwitch {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(true)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(false)
    }
}

/// The microcontroller's timer; waiting lets the time of the chips pass.
pub struct Microseconds(pub Wires);

impl DelayNs for Microseconds {
    fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().passed_ns += u64::from(ns);
    }
}

impl Timer for Microseconds {
    fn counter(&self) -> u32 {
        self.0.borrow().now_us
    }

    fn instant(&self, mark: Mark) -> u32 {
        self.0.borrow().instants[mark as usize].0
    }

    fn set_instant(&mut self, mark: Mark, instant: u32) {
        self.0.borrow_mut().instants[mark as usize].0 = instant;
    }

    fn is_reached(&self, mark: Mark) -> bool {
        self.0.borrow().instants[mark as usize].1
    }

    fn clear(&mut self, mark: Mark) {
        self.0.borrow_mut().instants[mark as usize].1 = false;
    }
}

/// Two words that a reset would leave as they are.
#[derive(Default)]
pub struct KeptWords([u32; 2]);

impl SpoolMemory for KeptWords {
    fn keep(&mut self, words: [u32; 2]) {
        self.0 = words;
    }

    fn kept(&self) -> [u32; 2] {
        self.0
    }
}
