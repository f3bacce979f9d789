//! The clocks of the chip ([`pneudrive_plan::pico2::clocks`]): the crystal's for processor and control, the ring
//! oscillator's for the watchdog.

use pneudrive_plan::pico2::clocks::{CRYSTAL_HZ, PLL_DIVIDER, PLL_MHZ, tick_cycles};
use rp235x_hal::clocks::{Clock, ClocksManager};
use rp235x_hal::fugit::{HertzU32, RateExtU32};
use rp235x_hal::pac::{CLOCKS, PLL_SYS, RESETS, ROSC, TICKS, XOSC};
use rp235x_hal::pll::{PLLConfig, setup_pll_blocking};
use rp235x_hal::rosc::RingOscillator;
use rp235x_hal::xosc::setup_xosc_blocking;

/// 768 MHz / 6.
const PLL: PLLConfig =
    PLLConfig { vco_freq: HertzU32::MHz(PLL_MHZ), refdiv: 1, post_div1: PLL_DIVIDER, post_div2: 1 };

/// The parts of the chip that make clocks.
pub struct Sources {
    /// The crystal's oscillator.
    pub crystal: XOSC,
    /// The oscillator that needs nothing.
    pub ring: ROSC,
    /// What multiplies the crystal's.
    pub pll: PLL_SYS,
    /// Which clock goes where.
    pub clocks: CLOCKS,
    /// What makes the watchdog's microseconds.
    pub ticks: TICKS,
}

/// Starts them, and tells what the peripherals have: the processor's clock. Waits for the crystal, however long that
/// takes. None where an oscillator has a frequency that it cannot have.
pub fn start(sources: Sources, resets: &mut RESETS) -> Option<HertzU32> {
    let Sources { crystal, ring, pll, clocks, ticks } = sources;
    let crystal = setup_xosc_blocking(crystal, CRYSTAL_HZ.Hz()).ok()?;
    let mut clocks = ClocksManager::new(clocks);
    let pll = setup_pll_blocking(pll, crystal.operating_frequency(), PLL, &mut clocks, resets).ok()?;
    clocks.reference_clock.configure_clock(&crystal, CRYSTAL_HZ.Hz()).ok()?;
    clocks.system_clock.configure_clock(&pll, pll.operating_frequency()).ok()?;
    clocks.peripheral_clock.configure_clock(&clocks.system_clock, clocks.system_clock.freq()).ok()?;
    let processor = clocks.peripheral_clock.freq();

    let clocks = clocks.free();
    let ring_khz = ring_khz(&clocks);
    count_by(&ticks, tick_cycles(ring_khz)?);
    let ring = RingOscillator::new(ring).initialize_with_freq(ring_khz.kHz());
    ClocksManager::new(clocks).reference_clock.configure_clock(&ring, ring_khz.kHz()).ok()?;
    Some(processor)
}

/// The ring oscillator as the crystal sees it, in 1 ms and more (data sheet, 8.1.4).
fn ring_khz(clocks: &CLOCKS) -> u32 {
    while clocks.fc0_status().read().running().bit_is_set() {}
    // SAFETY: of 20 bits, the reference's kilohertz.
    clocks.fc0_ref_khz().write(|w| unsafe { w.fc0_ref_khz().bits(CRYSTAL_HZ / 1000) });
    // SAFETY: of four bits: the longest interval.
    clocks.fc0_interval().write(|w| unsafe { w.fc0_interval().bits(15) });
    clocks.fc0_src().write(|w| w.fc0_src().rosc_clksrc_ph());
    while clocks.fc0_status().read().done().bit_is_clear() {}
    clocks.fc0_result().read().khz().bits()
}

/// The watchdog alone counts by the reference clock. A divider is changed while it stands (data sheet, 8.5.1).
fn count_by(ticks: &TICKS, cycles: u16) {
    let watchdog = ticks.tick(WATCHDOG);
    watchdog.ctrl().write(|w| w.enable().clear_bit());
    // SAFETY: of nine bits, as the plan sees to.
    watchdog.cycles().write(|w| unsafe { w.proc0_cycles().bits(cycles) });
    watchdog.ctrl().write(|w| w.enable().set_bit());
}

/// Its place among the tick generators (data sheet, table 617).
const WATCHDOG: usize = 4;
