//! A translator of step pulses on two output pins.
//!
//! The processor waits while the direction stands and the pulse lasts: with the usual 10 microseconds each, 20 of the
//! time between the output and the next sample. Where that is too long, a one-pulse timer does it
//! ([`pneudrive_app::runtime::pulse`]). A PWM channel of `embedded-hal` cannot: it has no way to give one pulse.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use pneudrive_controller::drive::Translator;

use crate::{Direction, StepDirection};

/// Why there was no step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinError<S, D> {
    /// The step line cannot be driven.
    Step(S),
    /// The direction line cannot be driven; there was no pulse.
    Direction(D),
}

/// The translator's lines.
#[derive(Debug)]
pub struct StepPins<S, D, W> {
    step: S,
    direction: D,
    delay: W,
}

impl<S: OutputPin, D: OutputPin, W: DelayNs> StepPins<S, D, W> {
    /// A translator whose step line rests low.
    ///
    /// # Errors
    /// When the step line cannot be driven.
    pub fn new(mut step: S, direction: D, delay: W) -> Result<StepPins<S, D, W>, S::Error> {
        step.set_low()?;
        Ok(StepPins { step, direction, delay })
    }

    /// Gives pins and delay back.
    pub fn release(self) -> (S, D, W) {
        (self.step, self.direction, self.delay)
    }
}

impl<S: OutputPin, D: OutputPin, W: DelayNs> StepDirection for StepPins<S, D, W> {
    type Error = PinError<S::Error, D::Error>;

    fn step(&mut self, translator: &Translator, direction: Direction) -> Result<(), Self::Error> {
        let turned = match direction {
            Direction::Extend => self.direction.set_high(),
            Direction::Retract => self.direction.set_low(),
        };
        turned.map_err(PinError::Direction)?;
        self.delay.delay_us(translator.direction_setup_us);
        self.step.set_high().map_err(PinError::Step)?;
        self.delay.delay_us(translator.pulse_width_us);
        self.step.set_low().map_err(PinError::Step)
    }
}
