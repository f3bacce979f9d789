//! The application's [`Board`], put together from encoder, pressure sensors, valve, translator, clock and memory.
//!
//! A failed part must trip the drive, and must not give a figure:
//!
//! | failure | becomes | the supervisor trips with |
//! |---|---|---|
//! | no count | a count half of all counts away from the one before, at every sample without one | `EncoderStep`, at that sample; the axis loses its reference |
//! | no conversion | [`NO_CONVERSION`] for both pressures and the spool | `SensorRange`, after `sensor_samples`; nothing without pressure sensors |
//! | the valve or the translator takes no command | `drive_enable` low until the drive is disabled | `NoMotion`, as the valve should have moved it |

use embedded_hal::digital::{InputPin, OutputPin};
use pneudrive_app::runtime::clock::{Clock, Timer};
use pneudrive_app::runtime::drive::ClockedBoard;
use pneudrive_app::runtime::spool::{SpoolMemory, location, words};
use pneudrive_app::{Board, Store};
use pneudrive_controller::drive::{DacCode, DriveConfig, SpoolLocation};
use pneudrive_controller::{Command, Config, Sample};

use crate::{Conversions, Direction, EncoderCounter, PressureInput, StepDirection, Terminals, ValveOutput};

/// The value of a failed conversion: below every range, so it trips as an open sensor does.
pub const NO_CONVERSION: i16 = -1;

/// The kinds of parts that a board is made of.
pub trait Parts {
    /// The rod's position.
    type Encoder: EncoderCounter;
    /// Pressures and spool.
    type Pressures: PressureInput;
    /// The amplifier of a solenoid valve.
    type Valve: ValveOutput;
    /// The translator of a stepper valve.
    type Steps: StepDirection;
    /// Gates amplifier, translator and dump valve.
    type Enable: OutputPin;
    /// The homing switch: closed to ground.
    type HomeSwitch: InputPin;
    /// The digital inputs and outputs.
    type Terminals: Terminals;
    /// The timer of the control.
    type Timer: Timer;
    /// Where the spool of a stepper valve is kept.
    type SpoolMemory: SpoolMemory;
    /// Configuration and fault log.
    type Store: Store;
}

/// A count that no axis reaches.
const FAR: i32 = 1 << 30;

/// A board.
pub struct WiredBoard<P: Parts> {
    /// Kind of board, at most 32 bytes.
    pub name: &'static str,
    /// The rod's position.
    pub encoder: P::Encoder,
    /// Pressures and spool.
    pub pressures: P::Pressures,
    /// The homing switch; a pull-up makes an open one high.
    pub home_switch: P::HomeSwitch,
    /// The digital inputs and outputs.
    pub terminals: P::Terminals,
    /// The drive stages.
    pub stages: Stages<P>,
    /// When samples and outputs are due.
    pub clock: Clock<P::Timer>,
    /// Where the spool of a stepper valve is kept.
    pub spool: P::SpoolMemory,
    /// Configuration and fault log.
    pub store: P::Store,
    /// The count that was handed out last.
    pub position: i32,
    /// When the drive was last seen enabled, microseconds since the reset.
    pub enabled_us: u64,
}

/// The two drive stages and the line that enables them. Which of them drives, the configuration says.
pub struct Stages<P: Parts> {
    valve: P::Valve,
    steps: P::Steps,
    enable: P::Enable,
    /// A command was not taken since the drive was last disabled.
    failed: bool,
}

impl<P: Parts> Stages<P> {
    /// Disabled, with the converter at the middle of its range. Whether it takes that shows at the first command.
    pub fn new(valve: P::Valve, steps: P::Steps, enable: P::Enable) -> Stages<P> {
        let mut stages: Stages<P> = Stages { valve, steps, enable, failed: false };
        stages.disable();
        stages.failed |= stages.valve.set_code(DacCode::MIDDLE).is_err();
        stages
    }

    /// Drives the stage. A drive is disabled before anything else changes, and enabled after.
    #[inline]
    pub fn drive(&mut self, config: &DriveConfig, command: Command) {
        if !command.drive_enable {
            self.failed = false;
            self.disable();
        }
        self.failed |= match config {
            DriveConfig::Dac(dac) => {
                self.valve.note_null(dac.null_code);
                self.valve.set_code(dac.code(command.counts)).is_err()
            }
            DriveConfig::Stepper { translator, .. } => {
                let middle = self.valve.set_code(DacCode::MIDDLE).is_ok();
                let step = direction(command.step);
                !middle || step.is_some_and(|step| self.steps.step(translator, step).is_err())
            }
        };
        if command.drive_enable && !self.failed {
            self.failed |= self.enable.set_high().is_err();
        }
        if self.failed {
            self.disable();
        }
    }

    /// Nothing can be done about a line that cannot be driven.
    #[inline]
    fn disable(&mut self) {
        let _ = self.enable.set_low();
    }
}

/// Where a step goes; None for no step.
fn direction(step: i8) -> Option<Direction> {
    match step {
        0 => None,
        1.. => Some(Direction::Extend),
        _ => Some(Direction::Retract),
    }
}

impl<P: Parts> WiredBoard<P> {
    /// The count, positive toward extension. Without one it is by turns far to either side: a jump at once, and no place to
    /// be armed at.
    #[inline]
    fn latch(&mut self, inverted: bool) -> i32 {
        self.position = match self.encoder.count() {
            Ok(count) if inverted => count.wrapping_neg(),
            Ok(count) => count,
            Err(_) if self.position == FAR => -FAR,
            Err(_) => FAR,
        };
        self.position
    }

    /// Pressure 1, pressure 2 and spool.
    #[inline]
    fn convert(&mut self) -> [i16; 3] {
        match self.pressures.convert() {
            Ok(Conversions { pressure_1, pressure_2, spool }) => {
                [pressure_1, pressure_2, spool].map(u16::cast_signed)
            }
            Err(_) => [NO_CONVERSION; 3],
        }
    }
}

impl<P: Parts> Board for WiredBoard<P> {
    type Store = P::Store;

    fn store(&mut self) -> &mut P::Store {
        &mut self.store
    }

    fn name(&self) -> &str {
        self.name
    }

    fn build(&self) -> &'static str {
        pneudrive_app::BUILD
    }

    #[inline]
    fn read_sensors(&mut self, config: &Config) -> Sample {
        let position = self.latch(config.encoder_inverted);
        let [pressure_1, pressure_2, spool] = self.convert();
        let home_switch = self.home_switch.is_low().unwrap_or(false);
        // Inputs without a sensor float.
        let [pressure_1, pressure_2] = [pressure_1, pressure_2].map(|raw| raw & config.pressure_mask);
        Sample { position, pressure_1, pressure_2, spool, home_switch }
    }

    #[inline]
    fn drive(&mut self, config: &Config, command: Command) {
        self.stages.drive(&config.drive, command);
        if command.drive_enable {
            self.enabled_us = self.clock.now_us();
        }
    }

    fn has_converter(&self) -> bool {
        true
    }

    #[inline]
    fn now_us(&self) -> u64 {
        self.clock.now_us()
    }

    #[inline]
    fn host_clock_ms(&self) -> Option<u64> {
        Some(self.clock.sampled_ms())
    }

    fn inputs(&mut self) -> u8 {
        self.terminals.read()
    }

    fn show(&mut self, outputs: u8) {
        self.terminals.write(outputs);
    }

    fn may_know_position(&self) -> bool {
        P::Encoder::IS_ABSOLUTE
    }

    /// The idle task of every board ([`pneudrive_app::runtime::talk`]) has one.
    fn has_watchdog(&self) -> bool {
        true
    }

    #[inline]
    fn keep_spool(&mut self, location: SpoolLocation) {
        self.spool.keep(words(location));
    }

    fn kept_spool(&self) -> Option<SpoolLocation> {
        location(self.spool.kept())
    }
}

impl<P: Parts> ClockedBoard for WiredBoard<P> {
    type Timer = P::Timer;

    #[inline]
    fn clock(&self) -> &Clock<P::Timer> {
        &self.clock
    }

    #[inline]
    fn clock_mut(&mut self) -> &mut Clock<P::Timer> {
        &mut self.clock
    }

    fn enabled_us(&self) -> u64 {
        self.enabled_us
    }
}
