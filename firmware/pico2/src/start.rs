//! Clocks, pins and parts. Runs once, with interrupts disabled; what goes wrong here breaks down.

use pneudrive_app::Recorder;
use pneudrive_app::fault_log::{Recovery, Restored};
use pneudrive_app::runtime::clock::Clock;
use pneudrive_app::store::FlashStore;
use pneudrive_interfaces::chip::mcp3208::Mcp3208;
use pneudrive_interfaces::chip::mcp4922::{Channel, Mcp4922};
use pneudrive_interfaces::digital_pins::DigitalPins;
use pneudrive_interfaces::step_pins::StepPins;
use pneudrive_interfaces::wired_board::Stages;
use pneudrive_plan::pico2::flash::layout;
use rp235x_hal::Sio;
use rp235x_hal::gpio::{PinState, Pins, PullNone};
use rp235x_hal::pac::Peripherals;

use crate::board::{Pico2Board, Store};
use crate::clock::{ControlTimer, Wait};
use crate::encoder::Encoder;
use crate::flash::KeptFlash;
use crate::oscillators::Sources;
use crate::port::Port;
use crate::scratch::KeptSpool;
use crate::watchdog::Watchdog;
use crate::{Control, Drive, Talk, oscillators, reset, spi};
use pneudrive_app::log;

/// The longest piece of a request to an enabled drive, microseconds: the 2,400 instructions of docs/reference/firmware-figures.md at
/// six cycles each and 128 MHz. Not measured on this board.
const PIECE_US: u32 = 113;

/// Starts everything.
pub fn start(mut device: Peripherals, recorder: &'static mut Recorder) -> (Drive, Talk) {
    let sio = Sio::new(device.SIO);
    let pins = Pins::new(device.IO_BANK0, device.PADS_BANK0, sio.gpio_bank0, &mut device.RESETS);
    // First of all the line that must be low.
    let enable = pins.gpio8.into_pull_type::<PullNone>().into_push_pull_output_in_state(PinState::Low);
    let reset = reset::reason(&device.POWMAN);
    let mut watchdog = Watchdog::new(&device.WATCHDOG, &device.PSM);
    let sources = Sources {
        crystal: device.XOSC,
        ring: device.ROSC,
        pll: device.PLL_SYS,
        clocks: device.CLOCKS,
        ticks: device.TICKS,
    };
    let peripheral_clock = oscillators::start(sources, &mut device.RESETS)
        .unwrap_or_else(|| panic!("crystal and ring oscillator are what they can be"));
    let timer = ControlTimer::start(device.TIMER0, &device.RESETS);

    let valve = spi::valve(
        device.SPI1,
        (pins.gpio11.reconfigure(), pins.gpio10.reconfigure()),
        pins.gpio13.into_pull_type::<PullNone>().into_push_pull_output_in_state(PinState::High),
        &mut device.RESETS,
        peripheral_clock,
    );
    let sensors = spi::sensors(
        device.SPI0,
        (pins.gpio19.reconfigure(), pins.gpio16.reconfigure(), pins.gpio18.reconfigure()),
        pins.gpio17.into_pull_type::<PullNone>().into_push_pull_output_in_state(PinState::High),
        &mut device.RESETS,
        peripheral_clock,
    );
    let step = pins.gpio6.into_pull_type::<PullNone>().into_push_pull_output_in_state(PinState::Low);
    let direction = pins.gpio7.into_pull_type::<PullNone>().into_push_pull_output_in_state(PinState::Low);
    let Ok(steps) = StepPins::new(step, direction, Wait);
    let tracks = (pins.gpio2.reconfigure(), pins.gpio3.reconfigure());
    let encoder = Encoder::start(device.PIO0, tracks, &mut device.RESETS);

    let mut control = Control::with_recorder(recorder);
    let mut board = Pico2Board {
        name: "Raspberry Pi Pico 2",
        encoder: encoder.unwrap_or_else(|_| panic!("the program fits its state machine")),
        pressures: Mcp3208::new(sensors, Wait, [0, 1, 2]),
        home_switch: pins.gpio4.into_pull_up_input(),
        terminals: DigitalPins::new(
            [
                pins.gpio12.into_pull_down_input().into_dyn_pin(),
                pins.gpio14.into_pull_down_input().into_dyn_pin(),
                pins.gpio15.into_pull_down_input().into_dyn_pin(),
                pins.gpio20.into_pull_down_input().into_dyn_pin(),
                pins.gpio21.into_pull_down_input().into_dyn_pin(),
                pins.gpio22.into_pull_down_input().into_dyn_pin(),
                pins.gpio26.into_pull_down_input().into_dyn_pin(),
                pins.gpio27.into_pull_down_input().into_dyn_pin(),
            ],
            [
                pins.gpio5
                    .into_pull_type::<PullNone>()
                    .into_push_pull_output_in_state(PinState::Low)
                    .into_dyn_pin(),
                pins.gpio9
                    .into_pull_type::<PullNone>()
                    .into_push_pull_output_in_state(PinState::Low)
                    .into_dyn_pin(),
                pins.gpio28
                    .into_pull_type::<PullNone>()
                    .into_push_pull_output_in_state(PinState::Low)
                    .into_dyn_pin(),
                pins.gpio25
                    .into_pull_type::<PullNone>()
                    .into_push_pull_output_in_state(PinState::Low)
                    .into_dyn_pin(),
            ],
        ),
        stages: Stages::new(Mcp4922::new(valve, Wait, Channel::A), steps, enable),
        clock: Clock::start(timer, control.config().timing),
        spool: KeptSpool,
        store: store(watchdog),
        position: 0,
        enabled_us: 0,
    };
    if let Some(fault) = reset.fault() {
        log!(error, "reset by fault {=u8}", fault.code());
        control.trip(fault);
    }
    control.take_up(&mut board);
    board.clock.keep(control.config().timing);
    let lines = (pins.gpio0.reconfigure(), pins.gpio1.reconfigure());
    let port = Port::open(device.UART0, device.DMA, lines, &mut device.RESETS, peripheral_clock);
    let port = port.unwrap_or_else(|_| panic!("128 MHz has this baud rate"));
    watchdog.start();
    (Drive::new(control, board, PIECE_US), Talk::new(port, watchdog))
}

/// What is kept in flash, and in memory through a reset.
fn store(watchdog: Watchdog) -> Store {
    // SAFETY: once after a reset, since there is one start.
    let memory = unsafe { reset::fault_memory() };
    let taken_up = FlashStore::take_up(KeptFlash::new(watchdog), layout(), memory);
    let (store, recovery, restored) =
        taken_up.unwrap_or_else(|_| panic!("the plan's layout is that of this flash"));
    match recovery {
        Recovery::Lost => log!(info, "fault log: none in memory"),
        Recovery::Kept { events, damaged } => {
            log!(info, "fault log: {=usize} events in memory, {=usize} damaged", events, damaged);
        }
    }
    if let Restored::Events(events) = restored {
        log!(info, "fault log: {=usize} events from flash", events);
    }
    store
}
