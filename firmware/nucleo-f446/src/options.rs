//! The option bytes, written once in the life of a board ([`pneudrive_plan::nucleo::options`]).

use pneudrive_app::log;
use pneudrive_plan::nucleo::options::{KEYS, with_highest_level};
use stm32f4xx_hal::pac::FLASH;

/// Has the chip held in reset from below 2.7 V on, if it is not yet. For the start: the drive is disabled.
pub fn raise_brown_out_level(flash: &FLASH) {
    let Some(options) = with_highest_level(flash.optcr().read().bits()) else { return };
    log!(info, "brown-out level raised");
    for key in KEYS {
        // SAFETY: the register takes any word; these two unlock the next one (RM0390, 3.6.2).
        flash.optkeyr().write(|w| unsafe { w.bits(key) });
    }
    // SAFETY: the register as it was read, but for the level and the two bits that begin nothing.
    flash.optcr().write(|w| unsafe { w.bits(options) });
    flash.optcr().modify(|_, w| w.optstrt().set_bit());
    while flash.sr().read().bsy().bit_is_set() {}
    flash.optcr().modify(|_, w| w.optlock().set_bit());
}
