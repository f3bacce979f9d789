//! The interface that the application needs from a board.

use pneudrive_controller::drive::SpoolLocation;
use pneudrive_controller::{Command, Config, Sample};

use crate::store::Store;

/// A board: sensors, drive stage, clocks and its store. Pins, buses and interrupts stay inside it.
pub trait Board {
    /// The type of its store.
    type Store: Store;

    /// The data that it keeps through a reset.
    fn store(&mut self) -> &mut Self::Store;

    /// Kind of board, at most 32 bytes.
    fn name(&self) -> &str;

    /// The build and its sources, at most 32 bytes.
    fn build(&self) -> &'static str;

    /// Latches the encoder, then converts pressures and spool. Positive position means extension:
    /// an inverted encoder is turned here. A pressure without a sensor is 0 (`pressure_mask`).
    fn read_sensors(&mut self, config: &Config) -> Sample;

    /// Drives the valve and gates the amplifier. The board forms the converter's code
    /// ([`pneudrive_controller::drive::DacConfig::code`]).
    fn drive(&mut self, config: &Config, command: Command);

    /// Whether commands go to a converter of 12 bits, so that the largest one must have a code there. A simulated plant
    /// takes them in counts.
    fn has_converter(&self) -> bool {
        false
    }

    /// Microseconds since the reset, by the clock that lateness is judged by.
    fn now_us(&self) -> u64;

    /// Milliseconds of wall time by which the silence of the host is judged. None where silence
    /// means nothing: in runs that prove two execution levels equal, and in rigs faster than the clock.
    fn host_clock_ms(&self) -> Option<u64>;

    /// The digital inputs, as [`pneudrive_protocol::io::input`] has their bits; all off on a board without any.
    fn inputs(&mut self) -> u8 {
        0
    }

    /// Drives the digital outputs and the lamp, as [`pneudrive_protocol::io::output`] has their bits.
    fn show(&mut self, _: u8) {}

    /// Sets the inputs of a board that emulates them. False where they are pins.
    fn emulate_inputs(&mut self, _: u8) -> bool {
        false
    }

    /// Whether a watchdog resets it that the idle task feeds.
    fn has_watchdog(&self) -> bool {
        false
    }

    /// A run begins with the next sample. A simulated plant goes back to its initial state and takes
    /// over the timing; a real board does nothing.
    fn run_begins(&mut self, _: &Config) {}

    /// Whether the axis is referenced after a reset: a simulated one is.
    fn starts_referenced(&self) -> bool {
        false
    }

    /// Whether its encoder may be absolute, as `encoder_model` of the configuration says. Where edges are counted, no
    /// configuration makes the axis known.
    fn may_know_position(&self) -> bool {
        self.starts_referenced()
    }

    /// Keeps the spool location of a stepper valve in memory that a reset leaves as it is. The control interrupt
    /// calls this before each pulse, and while there is none.
    fn keep_spool(&mut self, _: SpoolLocation) {}

    /// The spool location kept before the reset; None if there is none, or it cannot be read. The spool of a
    /// simulated valve is at mid-travel after a reset.
    fn kept_spool(&self) -> Option<SpoolLocation> {
        self.starts_referenced().then(SpoolLocation::default)
    }
}
