//! What is shown while the board's clock is missing. The processor runs on its internal one then, of 16 MHz.

/// Cycles of a millisecond on the internal clock.
pub const CYCLES_PER_MS: u32 = 16_000;

/// A clock that comes within this time is on its way, ms: that of the Nucleo comes from another processor, which starts at
/// the same time.
const PATIENCE_MS: u32 = 500;

/// Three flashes of a fifth of a second, then dark for as long.
const FLASH_MS: u32 = 200;

/// Whether the lamp is lit after the clock has been missing for this long, ms.
#[must_use]
pub fn is_lit(missing_ms: u32) -> bool {
    let step = missing_ms.saturating_sub(PATIENCE_MS) / FLASH_MS % 12;
    missing_ms >= PATIENCE_MS && matches!(step, 0 | 2 | 4)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::String;

    #[test]
    fn a_clock_that_is_missing_is_told_by_three_flashes_again_and_again() {
        let seen: String = (0..30).map(|step| if is_lit(500 + 200 * step) { '*' } else { '.' }).collect();
        assert_eq!(seen, "*.*.*.......*.*.*.......*.*.*.");
        assert!((0..500).all(|ms| !is_lit(ms)), "one that is on its way is not missing");
    }
}
