//! What the board is made of.

use pneudrive_app::fault_log::Memory;
use pneudrive_app::store::FlashStore;
use pneudrive_interfaces::chip::mcp3208::Mcp3208;
use pneudrive_interfaces::chip::mcp4922::Mcp4922;
use pneudrive_interfaces::digital_pins::DigitalPins;
use pneudrive_interfaces::step_pins::StepPins;
use pneudrive_interfaces::wired_board::{Parts, WiredBoard};
use rp235x_hal::gpio::bank0::{Gpio4, Gpio6, Gpio7, Gpio8};
use rp235x_hal::gpio::{DynPinId, FunctionSio, Pin, PullDown, PullNone, PullUp, SioInput, SioOutput};

use crate::clock::{ControlTimer, Wait};
use crate::encoder::Encoder;
use crate::flash::KeptFlash;
use crate::scratch::KeptSpool;
use crate::spi::{SensorBus, ValveBus};

/// An output that an external resistor holds low until it is driven.
pub type Output<I> = Pin<I, FunctionSio<SioOutput>, PullNone>;

/// Configuration and fault log.
pub type Store = FlashStore<KeptFlash, &'static mut Memory>;

/// The parts of a Pico 2.
pub struct Pico2;

impl Parts for Pico2 {
    type Encoder = Encoder;
    type Pressures = Mcp3208<SensorBus, Wait>;
    type Valve = Mcp4922<ValveBus, Wait>;
    type Steps = StepPins<Output<Gpio6>, Output<Gpio7>, Wait>;
    type Enable = Output<Gpio8>;
    type HomeSwitch = Pin<Gpio4, FunctionSio<SioInput>, PullUp>;
    type Terminals = DigitalPins<Pin<DynPinId, FunctionSio<SioInput>, PullDown>, Output<DynPinId>>;
    type Timer = ControlTimer;
    type SpoolMemory = KeptSpool;
    type Store = Store;
}

/// The Pico 2.
pub type Pico2Board = WiredBoard<Pico2>;
