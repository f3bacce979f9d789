//! The firmware on an STM32F446RE (Nucleo-F446RE): a real valve and a real cylinder.
//!
//! | task | priority | does |
//! |---|---|---|
//! | `control`, bound to TIM5 | highest | sample and output at their instants |
//! | with the feature `plant-bus` instead: `control_in_step`, bound to DMA1's stream 1 | highest | sample and output as the plant answers |
//! | `idle` | lowest | serves the port and the stream, stores what waits for a disabled drive, feeds the watchdog |
//!
//! What runs on any board is in [`pneudrive_app::runtime`] and `pneudrive-interfaces`; here is what the chip needs.
//!
//! | module | holds |
//! |---|---|
//! | [`cylinder`] | the start of a board with a real valve and cylinder |
//! | [`plant`] | with the feature `plant-bus`: the control of a simulated plant at USART3, and its start |
//! | [`board`] | the parts of its [`pneudrive_app::Board`] |
//! | [`clock`] | TIM5: microseconds, with a channel for samples and one for outputs |
//! | [`encoder`] | TIM2: the encoder |
//! | [`converter`] | ADC1: pressures and spool |
//! | [`valve`] | the DAC; step and direction; how they are switched off |
//! | [`terminals`] | the digital inputs and outputs |
//! | [`port`] | USART2: the protocol |
//! | [`dma`] | the streams of the serial ports |
//! | [`flash`] | configuration and fault log |
//! | [`watchdog`] | the independent watchdog |
//! | [`oscillator`] | the clock from outside: awaited, and watched |
//! | [`options`] | the supply voltage below which the chip is held in reset |
//! | [`reset`] | what happens at a breakdown, and what is known of it after the reset |
//! | [`spool`] | where a stepper's spool is, through a reset |
//! | [`start`] | what both starts have in common |
//!
//! What is computed for the chip stands in `pneudrive-plan`, which the PC tests.
#![no_std]
#![no_main]

#[cfg(all(feature = "debug", not(debug_assertions)))]
compile_error!(
    "never in a release image: with the feature debug an open valve stays open while the processor is halted"
);

#[cfg(not(feature = "plant-bus"))]
mod board;
#[cfg(not(feature = "plant-bus"))]
mod clock;
#[cfg(not(feature = "plant-bus"))]
mod converter;
#[cfg(not(feature = "plant-bus"))]
mod cylinder;
mod dma;
#[cfg(not(feature = "plant-bus"))]
mod encoder;
mod flash;
mod options;
mod oscillator;
#[cfg(feature = "plant-bus")]
mod plant;
mod port;
mod reset;
#[cfg(not(feature = "plant-bus"))]
mod spool;
mod start;
#[cfg(not(feature = "plant-bus"))]
mod terminals;
#[cfg(not(feature = "plant-bus"))]
mod valve;
mod watchdog;

#[cfg(feature = "log")]
use defmt_rtt as _;
use pneudrive_app::Recorder;

#[cfg(not(feature = "plant-bus"))]
use cylinder::{Drive, start};
#[cfg(feature = "plant-bus")]
use plant::{PlantDrive as Drive, start, switch_off};
use port::Port;
#[cfg(not(feature = "plant-bus"))]
use valve::switch_off;
use watchdog::Watchdog;

/// The half with a deadline, with a recorder that stands in zeroed memory.
type Control = pneudrive_app::Control<&'static mut Recorder>;

/// The half that talks, and what it needs.
type Talk = pneudrive_app::runtime::talk::Talk<Port, Watchdog>;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use pneudrive_app::Recorder;

    use crate::{Drive, Talk};

    #[shared]
    struct Shared {
        drive: Drive,
    }

    #[local]
    struct Local {
        talk: Talk,
    }

    #[init(local = [recorder: Recorder = Recorder::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let (drive, talk) = crate::start(context.core, context.device, context.local.recorder);
        (Shared { drive }, Local { talk })
    }

    #[cfg(not(feature = "plant-bus"))]
    #[task(binds = TIM5, priority = 15, shared = [drive])]
    fn control(mut context: control::Context) {
        context.shared.drive.lock(Drive::tick);
    }

    #[cfg(feature = "plant-bus")]
    #[task(binds = DMA1_STREAM1, priority = 15, shared = [drive])]
    fn control_in_step(mut context: control_in_step::Context) {
        context.shared.drive.lock(Drive::tick);
    }

    #[idle(local = [talk], shared = [drive])]
    fn idle(mut context: idle::Context) -> ! {
        loop {
            if context.local.talk.round(&mut context.shared.drive).is_err() {
                pneudrive_app::log!(error, "the fault log can't be stored before the next reset");
            }
        }
    }
}
