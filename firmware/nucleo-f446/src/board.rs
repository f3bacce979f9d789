//! What the board is made of.

use pneudrive_interfaces::wired_board::{Parts, WiredBoard};
use stm32f4xx_hal::gpio::{Input, Output, PA9, PB10};

use crate::clock::ControlTimer;
use crate::converter::Converter;
use crate::encoder::Encoder;
use crate::spool::KeptSpool;
use crate::start::Store;
use crate::terminals::Terminals;
use crate::valve::{self, Steps};

/// The parts of a Nucleo-F446RE.
pub struct Nucleo;

impl Parts for Nucleo {
    type Encoder = Encoder;
    type Pressures = Converter;
    type Valve = valve::Converter;
    type Steps = Steps;
    type Enable = PB10<Output>;
    type HomeSwitch = PA9<Input>;
    type Terminals = Terminals;
    type Timer = ControlTimer;
    type SpoolMemory = KeptSpool;
    type Store = Store;
}

/// The Nucleo-F446RE.
pub type NucleoBoard = WiredBoard<Nucleo>;
