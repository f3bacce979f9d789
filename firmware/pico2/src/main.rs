//! The firmware on an RP2350 (Raspberry Pi Pico 2): a real valve and a real cylinder.
//!
//! | task | priority | does |
//! |---|---|---|
//! | `sample` and `output`, bound to the alarms of TIMER0 | highest | sample and output at their instants |
//! | `idle` | lowest | serves the port and the stream, stores what waits for a disabled drive, feeds the watchdog |
//!
//! What runs on any board is in [`pneudrive_app::runtime`] and `pneudrive-interfaces`; here is what the chip needs.
//!
//! | module | holds |
//! |---|---|
//! | [`board`] | the parts of its [`pneudrive_app::Board`] |
//! | [`clock`] | TIMER0: microseconds of the processor's clock, with an alarm for samples and one for outputs |
//! | [`encoder`] | PIO0: the encoder |
//! | [`flash`] | configuration and fault log, written by the boot ROM |
//! | [`log`] | with the feature `log`: what a debug probe is told |
//! | [`oscillators`] | the crystal's clock for the control, the ring oscillator's for the watchdog |
//! | [`port`] | UART0: the protocol |
//! | [`reset`] | what happens at a breakdown, and what is known of it after the reset |
//! | [`spi`] | the buses of the converters |
//! | [`start`] | clocks, pins and parts |
//! | [`scratch`] | the watchdog's registers, and its memory that a reset leaves as it is |
//! | [`watchdog`] | the watchdog |
//!
//! What is computed for the chip stands in `pneudrive-plan`, which the PC tests.
#![no_std]
#![no_main]

#[cfg(all(feature = "debug", not(debug_assertions)))]
compile_error!(
    "never in a release image: with the feature debug an open valve stays open while the processor is halted"
);

mod board;
mod clock;
mod encoder;
mod flash;
mod oscillators;
mod port;
mod reset;
mod scratch;
mod spi;
mod start;
mod watchdog;

#[cfg(feature = "log")]
use defmt_rtt as _;

use board::Pico2Board;
use pneudrive_app::Recorder;
use port::Port;
use rp235x_hal::block::ImageDef;
use watchdog::Watchdog;

/// The half with a deadline, with a recorder that stands in zeroed memory.
type Control = pneudrive_app::Control<&'static mut Recorder>;

/// The control and its board: what the tasks share.
type Drive = pneudrive_app::runtime::drive::Drive<Pico2Board, &'static mut Recorder>;

/// The half that talks, and what it needs.
type Talk = pneudrive_app::runtime::talk::Talk<Port, Watchdog>;

/// Tells the boot ROM what the image is.
#[unsafe(link_section = ".start_block")]
#[used]
static IMAGE: ImageDef = ImageDef::secure_exe();

#[rtic::app(device = rp235x_hal::pac, peripherals = true)]
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
        let (drive, talk) = crate::start::start(context.device, context.local.recorder);
        (Shared { drive }, Local { talk })
    }

    #[task(binds = TIMER0_IRQ_0, priority = 15, shared = [drive])]
    fn sample(mut context: sample::Context) {
        context.shared.drive.lock(Drive::tick);
    }

    #[task(binds = TIMER0_IRQ_1, priority = 15, shared = [drive])]
    fn output(mut context: output::Context) {
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
