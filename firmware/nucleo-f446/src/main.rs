//! The firmware on an STM32F446RE (Nucleo-F446RE): a real valve and a real cylinder.
//!
//! | task | priority | does |
//! |---|---|---|
//! | `control`, bound to TIM5 | highest | sample and output at their instants |
//! | with the feature `plant-bus` instead: `control_in_step`, bound to DMA1's stream 1 | highest | sample and output as the plant answers |
//! | `idle` | lowest | serves the port and the stream, stores what waits for a disabled drive, feeds the watchdog |
//!
//! A request is carried out in one go with the control locked out: right after an output, when most of the
//! period is left, or whenever there is time enough before the control is due. Nothing else is shared.
//!
//! | module | holds |
//! |---|---|
//! | [`cylinder`] | the control of a real valve and cylinder, and its start |
//! | [`plant`] | with the feature `plant-bus`: the control of a simulated plant at USART3, and its start |
//! | [`board`] | the [`pneudrive_app::Board`], put together from the parts |
//! | [`clock`] | TIM5: microseconds, and the instants of samples and outputs |
//! | [`encoder`] | TIM2: the encoder |
//! | [`converter`] | ADC1: pressures and spool |
//! | [`valve`] | the DAC; step and direction; `drive_enable` |
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
//! What is computed for the hardware stands in `pneudrive-nucleo-plan`, which the PC tests.
#![no_std]
#![no_main]

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
mod valve;
mod watchdog;

use defmt_rtt as _;
use pneudrive_app::{Recorder, Server};
use rtic::Mutex;

#[cfg(not(feature = "plant-bus"))]
use cylinder::{Drive, start};
#[cfg(feature = "plant-bus")]
use plant::{Drive, start, switch_off};
use port::Port;
#[cfg(not(feature = "plant-bus"))]
use valve::switch_off;
use watchdog::Watchdog;

/// The half with a deadline, with a recorder that stands in zeroed memory.
type Control = pneudrive_app::Control<&'static mut Recorder>;

/// Bytes that are looked at in one round: some 10,000 instructions.
const BYTES_A_ROUND: usize = 64;

/// The half that talks, and what it needs.
pub struct Talk {
    server: Server,
    port: Port,
    watchdog: Watchdog,
    /// The flash has refused; it is not worn out by trying again and again.
    flash_refuses: bool,
}

impl Talk {
    /// Who has nothing to say yet.
    pub fn new(port: Port, watchdog: Watchdog) -> Talk {
        Talk { server: Server::default(), port, watchdog, flash_refuses: false }
    }

    /// One round of the idle task.
    fn round(&mut self, drive: &mut impl Mutex<T = Drive>) {
        self.port.clear_errors();
        drive.lock(|drive| self.server.attend(&mut drive.control));
        let (has_run, has_time) = drive.lock(|drive| (drive.has_run(), drive.has_time()));
        if self.port.is_free() && (has_run || has_time) {
            self.listen(drive);
            self.speak();
            self.port.send();
        }
        if has_run {
            self.watchdog.feed();
            self.tidy_up(drive);
        }
    }

    /// The bytes that have come, up to one that ends a request; a few at a time, since what was looked at before
    /// them, the time that is left, goes by.
    fn listen(&mut self, drive: &mut impl Mutex<T = Drive>) {
        for _ in 0..BYTES_A_ROUND {
            if self.port.has_collected() {
                return;
            }
            let Some(byte) = self.port.read() else { return };
            let Talk { server, port, .. } = self;
            drive.lock(|drive| {
                let Ok(()) = server.receive(&[byte], &mut drive.control, &mut drive.board, port);
                drive.keep_timing();
            });
        }
    }

    /// What goes unasked, behind the replies.
    fn speak(&mut self) {
        if !self.port.has_collected() {
            let Ok(()) = self.server.speak(&mut self.port);
        }
    }

    fn tidy_up(&mut self, drive: &mut impl Mutex<T = Drive>) {
        if !self.flash_refuses && !drive.lock(Drive::tidy_up) {
            self.flash_refuses = true;
            defmt::error!("the fault log can't be stored before the next reset");
        }
    }
}

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
            context.local.talk.round(&mut context.shared.drive);
        }
    }
}
