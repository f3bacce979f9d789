//! The time of the board. A tick is 1/720 of a microsecond: every clock of the board is a whole number of ticks.

/// Ticks since the power came.
pub type Ticks = u64;

/// A microsecond.
pub const MICROSECOND: Ticks = 720;

/// A millisecond.
pub const MILLISECOND: Ticks = 1000 * MICROSECOND;

/// A second.
pub const SECOND: Ticks = 1000 * MILLISECOND;

/// Ticks of one cycle of a clock; None where they are not whole, or the clock stands.
#[must_use]
pub fn cycle_of(hz: u64) -> Option<Ticks> {
    (hz > 0 && SECOND.is_multiple_of(hz)).then(|| SECOND / hz)
}

/// In microseconds, for messages.
#[must_use]
pub fn microseconds(ticks: Ticks) -> f64 {
    ticks as f64 / MICROSECOND as f64
}

/// What is not known of the board more closely than an interval; a run takes one value of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Cycles of the processor for an instruction, waits for the flash included.
    pub cycles_per_instruction: u64,
    /// The clock of the independent watchdog, Hz (data sheet DS10693, LSI: 17 to 47 kHz).
    pub watchdog_hz: u64,
    /// Erasing a sector of 16 KiB at 8 bits, ms (data sheet, flash memory programming); one of 64 KiB takes three times
    /// as long.
    pub erase_16k_ms: u64,
    /// Programming a byte, microseconds.
    pub program_us: u64,
}

/// Fast code, the slowest watchdog, a typical flash.
pub const FAST: Corner =
    Corner { cycles_per_instruction: 1, watchdog_hz: 17_000, erase_16k_ms: 400, program_us: 16 };

/// Every instruction waits for the flash, all five wait states of it: slower than any code. The fastest watchdog, the slowest
/// flash.
pub const SLOWEST: Corner =
    Corner { cycles_per_instruction: 6, watchdog_hz: 47_000, erase_16k_ms: 800, program_us: 100 };

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clocks_of_the_board_are_whole_ticks() {
        let megahertz = [8, 16, 45, 90, 180].map(|mhz| cycle_of(mhz * 1_000_000));
        assert_eq!(megahertz, [Some(90), Some(45), Some(16), Some(8), Some(4)]);
        assert_eq!((cycle_of(0), cycle_of(7_000_000)), (None, None));
    }
}
