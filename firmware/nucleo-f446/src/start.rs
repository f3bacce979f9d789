//! What every start has in common: clocks, what was kept, why there was a reset.

use pneudrive_app::Board;
use pneudrive_app::fault_log::{Memory, Recovery, Restored};
use pneudrive_app::log;
use pneudrive_app::runtime::reset::Reset;
use pneudrive_app::storage::LayoutError;
use pneudrive_app::store::FlashStore;
use pneudrive_plan::nucleo::flash::layout;
use stm32f4xx_hal::pac::{FLASH, GPIOA, RCC};
use stm32f4xx_hal::rcc::{Config, Rcc, RccExt};
use stm32f4xx_hal::time::MegaHertz;

use crate::Control;
use crate::flash::KeptFlash;
use crate::options::raise_brown_out_level;
use crate::oscillator::{await_clock, watch_clock};
use crate::reset;
use crate::watchdog::Watchdog;

/// What is kept through a reset.
pub type Store = FlashStore<KeptFlash, &'static mut Memory>;

/// The processor's clock, MHz.
pub const PROCESSOR_MHZ: u32 = 180;

/// 180 MHz from the 8 MHz of the ST-LINK: both timer clocks are whole megahertz, and 921,600 baud is
/// met within 0.4 %. Waits for them, and watches them from then on.
pub fn clocks(rcc: RCC, lines: &GPIOA) -> Rcc {
    await_clock(&rcc, lines);
    let source = Config::hse(MegaHertz::from_raw(8).convert()).bypass_hse_oscillator();
    let limits = |mhz| MegaHertz::from_raw(mhz).convert();
    let rcc = rcc.freeze(source.sysclk(limits(PROCESSOR_MHZ)).pclk1(limits(45)).pclk2(limits(90)));
    watch_clock(&rcc);
    rcc
}

/// What is kept in flash, and in memory through a reset.
pub fn store(flash: FLASH, watchdog: Watchdog) -> Result<Store, LayoutError> {
    raise_brown_out_level(&flash);
    // SAFETY: once after a reset, since the flash is taken but once.
    let memory = unsafe { reset::fault_memory() };
    let (store, recovery, restored) = FlashStore::take_up(KeptFlash::new(flash, watchdog), layout(), memory)?;
    match recovery {
        Recovery::Lost => log!(info, "fault log: none in memory"),
        Recovery::Kept { events, damaged } => {
            log!(info, "fault log: {=usize} events in memory, {=usize} damaged", events, damaged);
        }
    }
    if let Restored::Events(events) = restored {
        log!(info, "fault log: {=usize} events from flash", events);
    }
    Ok(store)
}

/// The reason of the reset, if it is a fault, and what was stored before it.
pub fn take_up(control: &mut Control, board: &mut impl Board, reset: &Reset) {
    if board.starts_referenced() {
        control.set_referenced().unwrap_or_else(|_| panic!("a new drive is disarmed"));
    }
    if let Some(fault) = reset.fault() {
        log!(error, "reset by fault {=u8}", fault.code());
        control.trip(fault);
    }
    control.take_up(board);
}
