//! The way into a reset and out of it: what breaks down disables the drive, leaves a note that a reset does not clear,
//! and resets the board; after the reset the note is read.
//!
//! The reset takes every line to an input, so `drive_enable` is low by its external pull-down. The converter of the valve
//! is on SPI and keeps its code: the enable line alone disables the drive.

use core::cell::UnsafeCell;
use core::hint::black_box;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use pneudrive_app::fault_log::Memory;
use pneudrive_app::runtime::reset::{CLOCK_FAILED, PANICKED, Reset, noted};
use rp235x_hal::pac::{POWMAN, SIO};

use crate::scratch;
use pneudrive_app::log;

/// The pin of `drive_enable`, which `start` makes an output.
const ENABLE_PIN: u8 = 8;

/// Memory that the start-up code leaves as it is.
struct Kept<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: the one below is handed out once.
unsafe impl<T: Send> Sync for Kept<T> {}

#[unsafe(link_section = ".uninit.faults")]
static FAULTS: Kept<Memory> = Kept(UnsafeCell::new(MaybeUninit::uninit()));

/// Why the board was reset. Once after a reset: the next reset finds none of this.
pub fn reason(power: &POWMAN) -> Reset {
    let (watchdog, software) = scratch::reason();
    let chip = power.chip_reset().read();
    // These flags stay until the next reset of the whole chip; one by the watchdog comes after it.
    let power = !watchdog && !software && (chip.had_por().bit_is_set() || chip.had_bor().bit_is_set());
    let reset = Reset { watchdog, software, power, note: scratch::note() };
    scratch::leave_note(0);
    reset
}

/// The memory of the fault log, with whatever stands in it.
///
/// # Safety
/// Once after a reset: there must be one reference to it.
pub unsafe fn fault_memory() -> &'static mut Memory {
    // SAFETY: any bytes are such a memory, and the caller sees to the rest. The compiler is not to know that nobody has
    // written them.
    unsafe { &mut *black_box(FAULTS.0.get()).cast() }
}

/// Drive disabled, from wherever the program is.
fn switch_off() {
    // SAFETY: the program does not go on after this, so nobody else uses this register; the bit is that of one pin.
    unsafe { &*SIO::ptr() }.gpio_out_clr().write(|w| unsafe { w.bits(1 << ENABLE_PIN) });
}

/// Switches the drive off, leaves the note, tells the cause and resets the board. A breakdown while telling is not
/// told again.
fn break_down(cause: u32, tell: impl FnOnce()) -> ! {
    cortex_m::interrupt::disable();
    switch_off();
    if noted(scratch::note()).is_none() {
        scratch::leave_note(cause);
        tell();
    }
    scratch::reset()
}

/// Crystal and ring oscillator disagree.
pub fn clock_failed() -> ! {
    break_down(CLOCK_FAILED, || log!(error, "the crystal and the ring oscillator disagree"))
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    break_down(PANICKED, || {
        if let Some(place) = info.location() {
            log!(error, "broke down at {=str}:{=u32}", place.file(), place.line());
        }
    })
}

/// A fault of the processor, such as an address that does not exist.
// SAFETY: the attribute wants `unsafe`. It does not return, so it cannot disturb what it interrupted.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    break_down(PANICKED, || log!(error, "fault of the processor at {=u32:#x}", frame.pc()))
}
