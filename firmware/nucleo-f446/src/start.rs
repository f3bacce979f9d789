//! From the peripherals to the parts: which pin is what.

use pneudrive_app::fault_log::{Recovery, Restored};
use pneudrive_app::storage::LayoutError;
use pneudrive_app::store::FlashStore;
use pneudrive_app::{Recorder, Server};
use pneudrive_nucleo_plan::flash::layout;
use pneudrive_nucleo_plan::reset::Reset;
use stm32f4xx_hal::gpio::GpioExt;
use stm32f4xx_hal::pac::{FLASH, Peripherals, RCC};
use stm32f4xx_hal::rcc::{Config, Rcc, RccExt};
use stm32f4xx_hal::time::MegaHertz;

use crate::board::{NucleoBoard, Store};
use crate::clock::Clock;
use crate::converter::Converter;
use crate::encoder::Encoder;
use crate::flash::KeptFlash;
use crate::port::Port;
use crate::reset;
use crate::valve::{self, Valve};
use crate::watchdog::Watchdog;
use crate::{Control, Drive, Talk};

/// 180 MHz from the 8 MHz of the ST-LINK: both timer clocks are whole megahertz, and 921,600 baud is
/// met within 0.4 %.
fn clocks(rcc: RCC) -> Rcc {
    let source = Config::hse(MegaHertz::from_raw(8).convert()).bypass_hse_oscillator();
    let limits = |mhz| MegaHertz::from_raw(mhz).convert();
    rcc.freeze(source.sysclk(limits(180)).pclk1(limits(45)).pclk2(limits(90)))
}

/// All that there is. Runs once, with interrupts disabled; what goes wrong here breaks down.
pub fn start(device: Peripherals, recorder: &'static mut Recorder) -> (Drive, Talk) {
    let reset = reset::reason(&device.RCC);
    let mut watchdog = Watchdog::new(device.IWDG, &device.DBGMCU);
    let mut rcc = clocks(device.RCC);
    let (a, b, c) =
        (device.GPIOA.split(&mut rcc), device.GPIOB.split(&mut rcc), device.GPIOC.split(&mut rcc));

    // First of all the line that must be low.
    let pins = valve::Pins { dac: a.pa4.into_analog(), step: b.pb6, direction: c.pc7, enable: b.pb10 };
    let valve = Valve::start(device.DAC, device.TIM4, pins, &mut rcc).expect("APB1 timers run at 90 MHz");
    let tracks = (a.pa0.into_alternate(), a.pa1.into_alternate());
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
    let port = Port::open(device.USART2, device.DMA1, (a.pa2, a.pa3), &mut rcc);
    let port = port.expect("APB1 runs at 45 MHz");
    watchdog.start();
    let talk = Talk { server: Server::default(), port, watchdog, flash_refuses: false };
    (Drive { control, board, ran: false }, talk)
}

/// What is kept in flash, and in memory through a reset.
fn store(flash: FLASH, watchdog: Watchdog) -> Result<Store, LayoutError> {
    // SAFETY: once after a reset, since the flash is taken but once.
    let memory = unsafe { reset::fault_memory() };
    let (store, recovery, restored) = FlashStore::take_up(KeptFlash::new(flash, watchdog), layout(), memory)?;
    match recovery {
        Recovery::Lost => defmt::info!("fault log: none in memory"),
        Recovery::Kept { events, damaged } => {
            defmt::info!("fault log: {=usize} events in memory, {=usize} damaged", events, damaged);
        }
    }
    if let Restored::Events(events) = restored {
        defmt::info!("fault log: {=usize} events from flash", events);
    }
    Ok(store)
}

/// The reason of the reset, if it is a fault, and what was stored before it.
fn take_up(control: &mut Control, board: &mut NucleoBoard, reset: &Reset) {
    if let Some(fault) = reset.fault() {
        defmt::error!("reset by fault {=u8}", fault.code());
        control.trip(fault);
    }
    control.take_up(board);
    board.clock.keep(control.config().timing);
}
