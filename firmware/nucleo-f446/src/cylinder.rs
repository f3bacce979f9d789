//! The control of a real valve and cylinder: TIM5 says when.

use pneudrive_app::Recorder;
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac::{CorePeripherals, Peripherals};

use crate::board::NucleoBoard;
use crate::clock::Clock;
use crate::converter::Converter;
use crate::dma::streams;
use crate::encoder::Encoder;
use crate::port::Port;
use crate::start::{clocks, store, take_up};
use crate::valve::{self, Valve};
use crate::watchdog::Watchdog;
use crate::{Control, Talk, reset};

/// The longest request, microseconds: docs/firmware-figures.md tells what they take.
const REQUEST_US: u32 = 450;

/// The control and its board: what the two tasks share.
pub struct Drive {
    pub control: Control,
    pub board: NucleoBoard,
    /// The control has run since the watchdog was last fed.
    ran: bool,
}

impl Drive {
    /// The timer's interrupt: whatever is due.
    pub fn tick(&mut self) {
        if self.board.clock.sample_is_due() {
            self.control.on_sample(&mut self.board);
        }
        if self.board.clock.output_is_due() {
            self.control.on_output(&mut self.board);
            self.ran = true;
        }
    }

    /// Whether the control has run since this was last asked; its times are settled then.
    pub fn has_run(&mut self) -> bool {
        self.control.settle_timing();
        core::mem::take(&mut self.ran)
    }

    /// Whether a request can be carried out before the control is due.
    pub fn has_time(&self) -> bool {
        self.board.clock.left_us() > REQUEST_US
    }

    /// Takes over the timing that a request may have changed.
    pub fn keep_timing(&mut self) {
        self.board.clock.keep(self.control.config().timing);
    }

    /// What waits for a disabled drive. False when the flash does not take it.
    pub fn tidy_up(&mut self) -> bool {
        !self.board.rests() || self.control.tidy_up(&mut self.board).is_ok()
    }
}

/// All that there is. Runs once, with interrupts disabled; what goes wrong here breaks down.
pub fn start(_: CorePeripherals, device: Peripherals, recorder: &'static mut Recorder) -> (Drive, Talk) {
    let reset = reset::reason(&device.RCC);
    let mut watchdog = Watchdog::new(device.IWDG, &device.DBGMCU);
    let mut rcc = clocks(device.RCC, &device.GPIOA);
    let (a, b, c) =
        (device.GPIOA.split(&mut rcc), device.GPIOB.split(&mut rcc), device.GPIOC.split(&mut rcc));

    // First of all the line that must be low.
    let pins = valve::Pins { dac: a.pa4.into_analog(), step: b.pb6, direction: c.pc7, enable: b.pb10 };
    let valve = Valve::start(device.DAC, device.TIM4, pins, &mut rcc).expect("APB1 timers run at 90 MHz");
    let tracks = Encoder::pins(a.pa0, a.pa1);
    let sensors = (c.pc0.into_analog(), c.pc1.into_analog(), b.pb0.into_analog());
    let mut control = Control::with_recorder(recorder);
    let timing = control.config().timing;
    let mut board = NucleoBoard {
        clock: Clock::start(device.TIM5, timing, &mut rcc).expect("APB1 timers run at 90 MHz"),
        encoder: Encoder::start(device.TIM2, tracks, &mut rcc),
        converter: Converter::start(device.ADC1, device.ADC_COMMON, device.DMA2, sensors, &mut rcc),
        home_switch: a.pa9.into_pull_up_input(),
        valve,
        store: store(device.FLASH, watchdog).expect("the plan's layout is that of this flash"),
        enabled_us: 0,
    };
    take_up(&mut control, &mut board, &reset);
    board.clock.keep(control.config().timing);
    let (.., received, sent) = streams(device.DMA1, &mut rcc);
    let port = Port::open(device.USART2, (received, sent), (a.pa2, a.pa3), &mut rcc);
    let port = port.expect("APB1 runs at 45 MHz");
    watchdog.start();
    (Drive { control, board, ran: false }, Talk::new(port, watchdog))
}
