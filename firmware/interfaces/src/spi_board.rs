//! A board of three chips on SPI and a few pins: LS7366R for the encoder, MCP3208 for the sensors, MCP4922 for the
//! valve, two pins for the translator. From a microcontroller it needs SPI, pins, a timer and memory.

use core::marker::PhantomData;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{InputPin, OutputPin};
use embedded_hal::spi::SpiDevice;
use pneudrive_app::Store;
use pneudrive_app::runtime::clock::Timer;
use pneudrive_app::runtime::spool::SpoolMemory;

use crate::Terminals;
use crate::chip::ls7366r::Ls7366r;
use crate::chip::mcp3208::Mcp3208;
use crate::chip::mcp4922::Mcp4922;
use crate::step_pins::StepPins;
use crate::wired_board::{Parts, WiredBoard};

/// The microcontroller's parts for the chips: buses, pins, a timer and memory.
pub trait Lines {
    /// The bus of the LS7366R.
    type Encoder: SpiDevice;
    /// The bus of the MCP3208.
    type Converter: SpiDevice;
    /// The bus of the MCP4922.
    type Valve: SpiDevice;
    /// The translator's pulse.
    type Step: OutputPin;
    /// The translator's direction.
    type Direction: OutputPin;
    /// Waits for the chips and the translator.
    type Delay: DelayNs;
    /// Gates amplifier, translator and dump valve.
    type Enable: OutputPin;
    /// The homing switch.
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

/// The parts of a [`SpiBoard`].
#[derive(Debug)]
pub struct Chips<L>(PhantomData<L>);

impl<L: Lines> Parts for Chips<L> {
    type Encoder = Ls7366r<L::Encoder, L::Delay>;
    type Pressures = Mcp3208<L::Converter, L::Delay>;
    type Valve = Mcp4922<L::Valve, L::Delay>;
    type Steps = StepPins<L::Step, L::Direction, L::Delay>;
    type Enable = L::Enable;
    type HomeSwitch = L::HomeSwitch;
    type Terminals = L::Terminals;
    type Timer = L::Timer;
    type SpoolMemory = L::SpoolMemory;
    type Store = L::Store;
}

/// A board of these chips.
pub type SpiBoard<L> = WiredBoard<Chips<L>>;
