//! The independent watchdog. It runs on a clock of its own, and nothing stops it once it has started.

use pneudrive_app::runtime::talk;
use pneudrive_plan::nucleo::watchdog::{RUNNING, Timeout, WRITING_FLASH};
use stm32f4xx_hal::pac::iwdg::RegisterBlock;
use stm32f4xx_hal::pac::iwdg::kr::KEY;
use stm32f4xx_hal::pac::{DBGMCU, IWDG};

/// Whether watchdog and timer stand while a debugger has halted the processor.
const HALTS: bool = cfg!(feature = "debug");

/// Looks at the watchdog's state before it is given up: it takes over a time within five of its
/// clocks, 0.3 ms at most.
const PATIENCE: u32 = 100_000;

/// The watchdog: the server feeds it, and the flash asks it for time. Both belong to the idle task.
#[derive(Clone, Copy)]
pub struct Watchdog(());

impl Watchdog {
    /// Gets it ready; it does not run yet. It goes on while a debugger has halted the processor: a valve that is open
    /// then would stay open. With the feature `debug` it stands. No reset but that of the power clears these bits (RM0390,
    /// DBGMCU_APB1_FZ).
    pub fn new(_: IWDG, debug: &DBGMCU) -> Watchdog {
        debug.apb1_fz().modify(|_, w| w.dbg_iwdg_stop().bit(HALTS).dbg_tim5_stop().bit(HALTS));
        Watchdog(())
    }

    fn registers(&self) -> &'static RegisterBlock {
        // SAFETY: `new` has taken the peripheral, and the idle task alone reaches these registers after.
        unsafe { &*IWDG::ptr() }
    }

    /// From now on it must be fed.
    pub fn start(&mut self) {
        self.key(KEY::Start);
        self.set(RUNNING);
    }

    /// Gives the work the time that writing flash takes. For a disabled drive.
    pub fn while_writing<T>(&mut self, work: impl FnOnce() -> T) -> T {
        self.set(WRITING_FLASH);
        let result = work();
        self.set(RUNNING);
        result
    }

    fn set(&mut self, timeout: Timeout) {
        self.wait();
        self.key(KEY::Unlock);
        // SAFETY: the prescaler has three bits, and so has every value of the plan.
        self.registers().pr().write(|w| unsafe { w.bits(u16::from(timeout.prescaler)) });
        self.registers().rlr().write(|w| w.rl().set(timeout.reload));
        self.wait();
        self.key(KEY::Feed);
    }

    /// Until it has taken over what was set before.
    fn wait(&self) {
        for _ in 0..PATIENCE {
            let state = self.registers().sr().read();
            if state.pvu().bit_is_clear() && state.rvu().bit_is_clear() {
                break;
            }
        }
    }

    fn key(&self, key: KEY) {
        self.registers().kr().write(|w| w.key().variant(key));
    }
}

impl talk::Watchdog for Watchdog {
    fn feed(&mut self) {
        self.key(KEY::Feed);
    }
}
