//! The firmware on QEMU's mps2-an386: the application that a real board flashes, on an emulated
//! Cortex-M4.
//!
//! The real protocol goes over UART0. The plant is simulated on the PC: inputs and outputs of every
//! sample go over the plant bus, two pipes that the emulator opens for the image. Waiting for the plant
//! stops the virtual processor, so the two run in lock step and a sample can't come late.
//!
//! What a run records does not depend on when the bytes of the protocol arrive: between runs the plant
//! stands frozen, or is held where it is, and the first sample after a start is k = 0 from the initial state.
//!
//! | module | holds |
//! |---|---|
//! | [`board`] | the [`pneudrive_app::Board`], in lock step with the plant, and what it keeps |
//! | [`bus`] | the two pipes of the plant bus |
//! | [`flash`] | the pipes of the flash, which the PC keeps |
//! | [`watchdog`] | ends a loop that has stalled; the reason of a reset |
//! | [`clock`] | ticks that the control takes, and rest between runs |
//! | [`uart`] | the protocol's serial port |
//! | [`hardware`] | all that needs `unsafe`: registers and the fault handlers |
//!
//! The image ends with exit code 0 when the plant has gone, 1 after a panic or a broken bus, 2 after a
//! fault of the processor. A bite of the watchdog resets the board into a fault.
#![no_std]
#![no_main]
#![deny(unsafe_code)]

mod board;
mod bus;
mod clock;
mod flash;
mod hardware;
mod uart;
mod watchdog;

use core::panic::PanicInfo;

use pneudrive_app::fault_log::Memory;
use pneudrive_app::lock_step::{Stopwatch, run_control};
use pneudrive_app::plant_bus::{Next, Outputs};
use pneudrive_app::{Board, Recorder, Server, SharedDrive, inputs};
use pneudrive_protocol::MAX_FRAME;
use semihosting::{eprintln, process};

use board::EmulatedBoard;
use bus::PlantBus;
use clock::Clock;
use hardware::Hardware;
use uart::Uart;
use watchdog::{Watchdog, fault_before_reset};

/// The half with a deadline, with a recorder that stands in zeroed memory.
type Control = pneudrive_app::Control<&'static mut Recorder>;

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut RECORDER: Recorder = Recorder::new();
    // Nothing is done in interrupts: a pending one only ends a rest.
    cortex_m::interrupt::disable();
    let devices = Devices::start(Hardware::take().expect("main runs once"));
    let mut control = Control::with_recorder(RECORDER);
    let code = match serve(&mut control, devices) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("plant bus: {error}");
            1
        }
    };
    process::exit(code)
}

/// The hardware, started.
struct Devices {
    uart: Uart,
    clock: Clock,
    watchdog: Watchdog,
    fault_memory: &'static mut Memory,
}

impl Devices {
    fn start(hardware: Hardware) -> Devices {
        let Hardware { uart, syst, watchdog, fault_memory } = hardware;
        let (uart, watchdog) = (Uart::start(uart), Watchdog::start(watchdog));
        Devices { uart, clock: Clock::start(syst), watchdog, fault_memory }
    }
}

/// Samples, outputs and requests, until the plant has gone.
fn serve(control: &mut Control, devices: Devices) -> Result<(), bus::Error> {
    let Devices { mut uart, mut clock, mut watchdog, fault_memory } = devices;
    let mut board = board::take_up(fault_memory)?;
    let mut server = Server::default();
    if board.starts_referenced() {
        control.set_referenced().expect("a new drive is disarmed");
    }
    if let Some(fault) = fault_before_reset() {
        control.trip(fault);
    }
    control.take_up(&mut board);
    let mut bus = PlantBus::open()?;
    let (mut outputs, mut request) = (Outputs::OFF, 0);
    while let Some((inputs, tempo)) = bus.exchange(outputs, request)? {
        board.latch(&inputs, tempo);
        let ticks = run_control(control, &mut board, &clock);
        let next = EmulatedBoard::next(control.state().supervisor.mode());
        let frozen = inputs.frozen && next == Next::Stay;
        request = listen(&mut server, control, &mut board, &mut uart, &mut clock, frozen);
        server.attend(control);
        let Ok(()) = server.speak(&mut uart);
        inputs::attend(&mut (&mut *control, &mut board));
        let _ = control.tidy_up(&mut board);
        outputs = board.outputs(control, next, ticks);
        // Nobody waits for a drive that holds; one that keeps step with the wall clock is waited for by its plant.
        if frozen || (outputs.next == Next::Hold && !tempo.in_step) {
            clock.rest(control.config().timing.period_us.get());
        }
        if control.feeds_watchdog() {
            watchdog.feed();
        }
    }
    Ok(())
}

/// Requests whose bytes are there; the ticks of the longest piece that a board with an interrupt would lock it out for. The
/// emulator hands over bytes one by one: while the plant is frozen, it need not be asked between those of one request.
fn listen(
    server: &mut Server,
    control: &mut Control,
    board: &mut EmulatedBoard,
    uart: &mut Uart,
    clock: &mut Clock,
    frozen: bool,
) -> u32 {
    let mut longest = 0;
    for _ in 0..MAX_FRAME {
        let mut drive = Timed { control, board, clock, longest };
        let mut heard = false;
        while let Some(byte) = uart.read() {
            heard = true;
            let Ok(()) = server.receive_beside(&[byte], &mut drive, uart);
        }
        longest = drive.longest;
        if !(frozen && heard) {
            break;
        }
        clock.rest(control.config().timing.period_us.get());
    }
    longest
}

/// The drive, with the ticks of the longest piece of work that was done while it was locked.
struct Timed<'a> {
    control: &'a mut Control,
    board: &'a mut EmulatedBoard,
    clock: &'a Clock,
    longest: u32,
}

impl SharedDrive for Timed<'_> {
    type Recorder = &'static mut Recorder;
    type Board = EmulatedBoard;

    fn lock<T>(&mut self, work: impl FnOnce(&mut Control, &mut EmulatedBoard) -> T) -> T {
        let begun = self.clock.now();
        let done = work(self.control, self.board);
        self.longest = self.longest.max(self.clock.since(begun));
        done
    }
}

/// The plant is told that the valve is at null and the drive disabled; then the emulator ends.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    bus::switch_off();
    eprintln!("{info}");
    process::exit(1)
}
