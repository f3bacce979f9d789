//! The firmware on an STM32F446RE (Nucleo-F446RE): a real valve and a real cylinder.
//!
//! | task | priority | does |
//! |---|---|---|
//! | `control`, bound to TIM5 | highest | sample and output at their instants |
//! | `idle` | lowest | serves the port and the stream, stores what waits for a disabled drive, feeds the watchdog |
//!
//! A request is carried out in one go with the control locked out: right after an output, when most of the
//! period is left, or whenever there is time enough before the control is due. Nothing else is shared.
//!
//! | module | holds |
//! |---|---|
//! | [`board`] | the [`pneudrive_app::Board`], put together from the parts |
//! | [`clock`] | TIM5: microseconds, and the instants of samples and outputs |
//! | [`encoder`] | TIM2: the encoder |
//! | [`converter`] | ADC1: pressures and spool |
//! | [`valve`] | the DAC; step and direction; `drive_enable` |
//! | [`port`] | USART2: the protocol |
//! | [`flash`] | configuration and fault log |
//! | [`watchdog`] | the independent watchdog |
//! | [`reset`] | what happens at a breakdown, and what is known of it after the reset |
//! | [`start`] | from the peripherals to the parts |
//!
//! What is computed for the hardware stands in `pneudrive-nucleo-plan`, which the PC tests.
#![no_std]
#![no_main]

mod board;
mod clock;
mod converter;
mod encoder;
mod flash;
mod port;
mod reset;
mod start;
mod valve;
mod watchdog;

use defmt_rtt as _;
use pneudrive_app::{Recorder, Server};
use rtic::Mutex;

use board::NucleoBoard;
use port::Port;
use watchdog::Watchdog;

/// The half with a deadline, with a recorder that stands in zeroed memory.
type Control = pneudrive_app::Control<&'static mut Recorder>;

/// The longest request, microseconds: docs/firmware-figures.md tells what they take.
const REQUEST_US: u32 = 450;

/// The control and its board: what the two tasks share.
pub struct Drive {
    control: Control,
    board: NucleoBoard,
    /// The control has run since the watchdog was last fed.
    ran: bool,
}

impl Drive {
    /// The timer's interrupt: whatever is due.
    fn tick(&mut self) {
        if self.board.clock.sample_is_due() {
            self.control.on_sample(&mut self.board);
        }
        if self.board.clock.output_is_due() {
            self.control.on_output(&mut self.board);
            self.ran = true;
        }
    }

    /// Whether the control has run since this was last asked; its times are settled then.
    fn has_run(&mut self) -> bool {
        self.control.settle_timing();
        core::mem::take(&mut self.ran)
    }

    /// Whether a request can be carried out before the control is due.
    fn has_time(&self) -> bool {
        self.board.clock.left_us() > REQUEST_US
    }

    /// What waits for a disabled drive. False when the flash does not take it.
    fn tidy_up(&mut self) -> bool {
        !self.board.rests() || self.control.tidy_up(&mut self.board).is_ok()
    }
}

/// The half that talks, and what it needs.
pub struct Talk {
    server: Server,
    port: Port,
    watchdog: Watchdog,
    /// The flash has refused; it is not worn out by trying again and again.
    flash_refuses: bool,
}

impl Talk {
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

    /// The bytes that have come, up to one that ends a request.
    fn listen(&mut self, drive: &mut impl Mutex<T = Drive>) {
        while !self.port.has_collected()
            && let Some(byte) = self.port.read()
        {
            let Talk { server, port, .. } = self;
            drive.lock(|Drive { control, board, .. }| {
                let Ok(()) = server.receive(&[byte], control, board, port);
                board.clock.keep(control.config().timing);
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

    use crate::{Drive, Talk, start};

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
        let (drive, talk) = start::start(context.device, context.local.recorder);
        (Shared { drive }, Local { talk })
    }

    #[task(binds = TIM5, priority = 15, shared = [drive])]
    fn control(mut context: control::Context) {
        context.shared.drive.lock(Drive::tick);
    }

    #[idle(local = [talk], shared = [drive])]
    fn idle(mut context: idle::Context) -> ! {
        loop {
            context.local.talk.round(&mut context.shared.drive);
        }
    }
}
