//! The independent watchdog's times. Its clock is good to little more than a factor of two: the data
//! sheet gives 17 to 47 kHz, nominally 32.

/// Slowest and fastest of its clock, Hz.
pub const CLOCK_HZ: [u32; 2] = [17_000, 47_000];

/// A time as the watchdog's registers have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeout {
    /// The clock is divided by 4 << this.
    pub prescaler: u8,
    /// Divided clocks, less one.
    pub reload: u16,
}

/// While the drive may move: above the longest period of 100 ms, whatever the clock.
pub const RUNNING: Timeout = Timeout { prescaler: 2, reload: 499 };

/// While flash is erased and written, which stalls the processor; only with the drive disabled.
pub const WRITING_FLASH: Timeout = Timeout { prescaler: 6, reload: 999 };

impl Timeout {
    /// The time with a clock, ms.
    #[must_use]
    pub const fn milliseconds(&self, clock_hz: u32) -> u32 {
        (self.reload as u32 + 1) * (4 << self.prescaler) * 1000 / clock_hz
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_controller::parameters::{id, lookup};

    #[test]
    fn no_period_that_can_be_set_is_too_long_for_the_watchdog() {
        let longest_ms = lookup(id::PERIOD_US).expect("in the table").max.unsigned_abs() / 1000;
        assert!(RUNNING.milliseconds(CLOCK_HZ[1]) > longest_ms * 3 / 2);
        assert!(RUNNING.milliseconds(CLOCK_HZ[0]) < 500);
    }

    #[test]
    fn the_largest_sector_that_is_kept_is_erased_in_time() {
        // STM32F446 data sheet: 64 KiB byte by byte take 2.4 s at most, and 4 KiB of writing below 0.5 s.
        assert!(WRITING_FLASH.milliseconds(CLOCK_HZ[1]) > 2900);
    }

    #[test]
    fn the_registers_hold_the_times() {
        for Timeout { prescaler, reload } in [RUNNING, WRITING_FLASH] {
            assert!(prescaler <= 6 && reload <= 0xfff);
        }
    }
}
