//! The board as the application sees it, put together from its parts.

use pneudrive_app::Board;
use pneudrive_controller::drive::SpoolLocation;
use pneudrive_controller::{Command, Config, Sample};
use pneudrive_nucleo_plan::input;
use stm32f4xx_hal::gpio::{Input, PA9};

use crate::clock::Clock;
use crate::converter::Converter;
use crate::encoder::Encoder;
use crate::spool;
use crate::start::Store;
use crate::valve::Valve;

/// Nothing is stored before the drive has been disabled for so long, microseconds: an erasure stalls the
/// processor, and a host that asks for the reason of a fault gets it first.
const REST_US: u64 = 1_000_000;

/// The Nucleo-F446RE.
pub struct NucleoBoard {
    /// When samples and outputs are due.
    pub clock: Clock,
    /// The rod's position.
    pub encoder: Encoder,
    /// Pressures and spool.
    pub converter: Converter,
    /// Closed to ground.
    pub home_switch: PA9<Input>,
    /// The drive stages.
    pub valve: Valve,
    /// Configuration and fault log.
    pub store: Store,
    /// When the drive was last seen enabled, microseconds since the reset.
    pub enabled_us: u64,
}

impl NucleoBoard {
    /// Whether the drive has been disabled for a while: flash may be written.
    pub fn rests(&self) -> bool {
        self.now_us().saturating_sub(self.enabled_us) > REST_US
    }
}

impl Board for NucleoBoard {
    type Store = Store;

    fn store(&mut self) -> &mut Store {
        &mut self.store
    }

    fn name(&self) -> &'static str {
        "Nucleo-F446RE"
    }

    fn build(&self) -> &'static str {
        pneudrive_app::BUILD
    }

    fn read_sensors(&mut self, config: &Config) -> Sample {
        let counter = self.encoder.counter();
        let converted = self.converter.convert();
        input::sample(counter, config.encoder_inverted, converted, self.home_switch.is_low())
    }

    fn drive(&mut self, config: &Config, command: Command) {
        self.valve.drive(&config.drive, command);
        if command.drive_enable {
            self.enabled_us = self.now_us();
        }
    }

    fn now_us(&self) -> u64 {
        self.clock.now_us()
    }

    fn host_clock_ms(&self) -> Option<u64> {
        Some(self.clock.sampled_ms())
    }

    fn keep_spool(&mut self, location: SpoolLocation) {
        spool::keep(location);
    }

    fn kept_spool(&self) -> Option<SpoolLocation> {
        spool::kept()
    }
}
