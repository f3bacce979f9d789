//! Two clocks that know nothing of each other: the crystal's, by which the control samples, and that of the ring
//! oscillator, by which the watchdog counts (RP2350 data sheet, 8.1.2 and 8.5.1).
//!
//! ```text
//! crystal 12 MHz -> PLL 128 MHz -> processor, TIMER0        counts 128 a microsecond
//! ring oscillator, 4.6 to 19.6 MHz -> tick -> watchdog      measured against the crystal at the start
//! ```
//!
//! If the crystal stops, the PLL goes on at a speed of its own, or stops with it. In the first case the two clocks
//! disagree and the program says so; in the second nobody feeds the watchdog, which counts on.

/// The crystal, Hz.
pub const CRYSTAL_HZ: u32 = 12_000_000;

/// The oscillator of the PLL, MHz: 64 times the crystal, within its 400 to 1600.
pub const PLL_MHZ: u32 = 768;

/// The PLL's output is this part of its oscillator.
pub const PLL_DIVIDER: u8 = 6;

/// A microsecond has 2^7 cycles of the processor: microseconds are bits of the count, and no division is needed.
pub const CYCLE_BITS: u32 = 7;

/// The count of the timer, of 64 bits, as microseconds; both wrap through 32 bits.
#[must_use]
pub const fn microseconds(high: u32, low: u32) -> u32 {
    high << (u32::BITS - CYCLE_BITS) | low >> CYCLE_BITS
}

/// Where the lower half of the count stands at an instant of microseconds. It comes by every 33 s.
#[must_use]
pub const fn cycles(instant_us: u32) -> u32 {
    instant_us << CYCLE_BITS
}

/// Cycles of a wait, at least the time.
#[must_use]
pub const fn wait_cycles(ns: u32) -> u32 {
    // 7.8125 ns a cycle.
    ns.div_ceil(7)
}

/// Cycles of the ring oscillator that the watchdog takes for a microsecond; None if it is slower than a watchdog can
/// count by, or faster than its divider of nine bits.
#[must_use]
pub fn tick_cycles(ring_khz: u32) -> Option<u16> {
    u16::try_from((ring_khz + 500) / 1000).ok().filter(|cycles| (1..512).contains(cycles))
}

/// While the drive may move, microseconds of the watchdog: above the longest period of 100 ms, even when [`LOOK_US`] of it
/// have passed already.
pub const RUNNING_US: u32 = 330_000;

/// The watchdog is fed, and the clocks are compared, after this much of its time, microseconds.
pub const LOOK_US: u32 = 50_000;

/// While a sector is erased or pages are written: 4 KiB take 400 ms at most.
pub const WRITING_FLASH_US: u32 = 2_000_000;

/// Whether a time by the watchdog and by the timer may be the same one: neither is more than half as long again as the
/// other. The ring oscillator was measured at the start, and moves with temperature and voltage since; a PLL without its
/// crystal ends at either end of its 400 to 1600 MHz, which is half and twice the speed.
#[must_use]
pub const fn agree(watchdog_us: u32, timer_us: u32) -> bool {
    let (watchdog, timer) = (watchdog_us as u64, timer_us as u64);
    2 * watchdog <= 3 * timer && 2 * timer <= 3 * watchdog
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_controller::parameters::{id, lookup};

    #[test]
    fn the_processor_has_a_power_of_two_of_cycles_a_microsecond() {
        assert_eq!(PLL_MHZ / u32::from(PLL_DIVIDER), 1 << CYCLE_BITS);
        assert_eq!(PLL_MHZ * 1_000_000 % CRYSTAL_HZ, 0, "the feedback divider is whole");
        assert!((400..=1600).contains(&PLL_MHZ));
    }

    #[test]
    fn microseconds_go_on_where_either_half_of_the_count_wraps() {
        let at = |count: u64| microseconds((count >> 32) as u32, count as u32);
        for us in [0, 1, (1 << 25) - 1, 1 << 25, u64::from(u32::MAX) - 1, u64::from(u32::MAX)] {
            assert_eq!(u64::from(at(us * 128)), us, "{us}");
            assert_eq!(at(us * 128 + 127), at(us * 128), "in a microsecond");
            assert_eq!(cycles(us as u32), (us * 128) as u32);
        }
        assert_eq!(at((1 << 32) * 128), 0);
    }

    #[test]
    fn a_wait_is_never_shorter_than_asked() {
        for ns in [0, 1, 40, 100, 500, 1000, 20_000, 1_000_000] {
            assert!(f64::from(wait_cycles(ns)) * 7.8125 >= f64::from(ns), "{ns} ns");
        }
    }

    #[test]
    fn every_ring_oscillator_of_the_data_sheet_makes_the_watchdogs_microsecond_within_an_eighth() {
        for khz in 4_600..=19_600 {
            let cycles = tick_cycles(khz).expect("it can be counted by");
            let microsecond = f64::from(cycles) * 1000.0 / f64::from(khz);
            assert!((0.87..=1.13).contains(&microsecond), "{khz} kHz: {microsecond}");
        }
        assert_eq!((tick_cycles(0), tick_cycles(400), tick_cycles(600_000)), (None, None, None));
    }

    #[test]
    fn clocks_that_drift_agree_and_a_pll_without_its_crystal_does_not() {
        assert!(agree(50_000, 50_000) && agree(50_000, 35_000) && agree(50_000, 74_000));
        let freewheeling = |mhz: u32| 50_000 * mhz / PLL_MHZ;
        assert!(!agree(50_000, freewheeling(400)) && !agree(50_000, freewheeling(1600)));
        assert!(!agree(50_000, 0), "a timer that stands");
    }

    /// A watchdog that was fed [`LOOK_US`] ago is not fed again, and the clocks may differ by half.
    #[test]
    fn no_period_that_can_be_set_is_too_long_for_the_watchdog() {
        let longest_us = lookup(id::PERIOD_US).expect("in the table").max.unsigned_abs();
        assert!((RUNNING_US - LOOK_US) * 2 / 3 > longest_us * 3 / 2);
        const { assert!(RUNNING_US * 3 / 2 < 500_000) };
    }

    /// The flash of the Pico 2 erases 4 KiB in 400 ms at most; the counter has 24 bits.
    #[test]
    fn a_sector_is_erased_in_time() {
        const { assert!(WRITING_FLASH_US * 2 / 3 > 2 * 400_000 && WRITING_FLASH_US < 1 << 24) };
    }
}
