//! The board's clock: awaited at the start, and watched from then on. Without it nothing runs but this.

use cortex_m::asm;
use pneudrive_plan::nucleo::oscillator::{CYCLES_PER_MS, is_lit};
use stm32f4xx_hal::pac::{GPIOA, RCC};

/// Waits for the clock from outside. While it is missing the lamp of the board (LD2, PA5) flashes; all other lines stay
/// inputs, and `drive_enable` low by its resistor.
pub fn await_clock(rcc: &RCC, lines: &GPIOA) {
    // The bypass is chosen while the oscillator is off.
    rcc.cr().modify(|_, w| w.hsebyp().set_bit());
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    rcc.ahb1enr().modify(|_, w| w.gpioaen().set_bit());
    lines.moder().modify(|_, w| w.moder5().output());
    let mut missing_ms: u32 = 0;
    while rcc.cr().read().hserdy().bit_is_clear() {
        lines.odr().modify(|_, w| w.odr5().bit(is_lit(missing_ms)));
        asm::delay(CYCLES_PER_MS);
        missing_ms = missing_ms.wrapping_add(1);
    }
}

/// From now on its failure is an interrupt that nothing masks ([`crate::reset`]).
pub fn watch_clock(rcc: &RCC) {
    rcc.cr().modify(|_, w| w.csson().set_bit());
}
