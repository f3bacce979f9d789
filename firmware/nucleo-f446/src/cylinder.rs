//! The start of a board with a real valve and cylinder: TIM5 says when.

use pneudrive_app::Recorder;
use pneudrive_app::runtime::clock::Clock;
use pneudrive_interfaces::wired_board::Stages;
use stm32f4xx_hal::gpio::{GpioExt, PinState};
use stm32f4xx_hal::pac::{CorePeripherals, Peripherals};

use crate::board::NucleoBoard;
use crate::clock::ControlTimer;
use crate::converter::Converter;
use crate::dma::streams;
use crate::encoder::Encoder;
use crate::port::Port;
use crate::spool::KeptSpool;
use crate::start::{clocks, store, take_up};
use crate::valve::{self, Steps};
use crate::watchdog::Watchdog;
use crate::{Control, Talk, reset, terminals};

/// The longest piece of a request to an enabled drive, microseconds at six cycles an instruction: docs/reference/firmware-figures.md
/// tells what they take.
const PIECE_US: u32 = 80;

/// The control and its board: what the two tasks share.
pub type Drive = pneudrive_app::runtime::drive::Drive<NucleoBoard, &'static mut Recorder>;

/// Starts everything. Runs once, with interrupts disabled; a failure here is a breakdown.
pub fn start(_: CorePeripherals, device: Peripherals, recorder: &'static mut Recorder) -> (Drive, Talk) {
    let reset = reset::reason(&device.RCC);
    let mut watchdog = Watchdog::new(device.IWDG, &device.DBGMCU);
    let mut rcc = clocks(device.RCC, &device.GPIOA);
    let (a, b, c) =
        (device.GPIOA.split(&mut rcc), device.GPIOB.split(&mut rcc), device.GPIOC.split(&mut rcc));

    // First of all the line that must be low.
    let enable = b.pb10.into_push_pull_output_in_state(PinState::Low);
    let valve = valve::Converter::start(device.DAC, a.pa4.into_analog(), &mut rcc);
    let steps = Steps::start(device.TIM4, b.pb6, c.pc7, &mut rcc).expect("APB1 timers run at 90 MHz");
    let tracks = Encoder::pins(a.pa0, a.pa1);
    let sensors = (c.pc0.into_analog(), c.pc1.into_analog(), b.pb0.into_analog());
    let mut control = Control::with_recorder(recorder);
    let timer = ControlTimer::start(device.TIM5, &mut rcc).expect("APB1 timers run at 90 MHz");
    let mut board = NucleoBoard {
        name: "Nucleo-F446RE",
        clock: Clock::start(timer, control.config().timing),
        encoder: Encoder::start(device.TIM2, tracks, &mut rcc),
        pressures: Converter::start(device.ADC1, device.ADC_COMMON, device.DMA2, sensors, &mut rcc),
        home_switch: a.pa9.into_pull_up_input(),
        terminals: terminals::start(
            (c.pc2, c.pc3, c.pc4, c.pc5, c.pc6, c.pc8, c.pc9, c.pc12),
            (b.pb12, b.pb13, b.pb14, a.pa5),
        ),
        stages: Stages::new(valve, steps, enable),
        spool: KeptSpool,
        store: store(device.FLASH, watchdog)
            .unwrap_or_else(|_| panic!("the plan's layout is that of this flash")),
        position: 0,
        enabled_us: 0,
    };
    take_up(&mut control, &mut board, &reset);
    board.clock.keep(control.config().timing);
    let (.., received, sent) = streams(device.DMA1, &mut rcc);
    let port = Port::open(device.USART2, (received, sent), (a.pa2, a.pa3), &mut rcc);
    let port = port.unwrap_or_else(|_| panic!("APB1 runs at 45 MHz"));
    watchdog.start();
    (Drive::new(control, board, PIECE_US), Talk::new(port, watchdog))
}
