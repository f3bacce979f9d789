//! The way into a reset and out of it: what breaks down switches the drive off, leaves a note in memory
//! that a reset does not clear, and resets the board; after the reset the note is read.
//!
//! The reset takes every line to an input, so `drive_enable` is low by its external pull-down.

use core::cell::UnsafeCell;
use core::hint::black_box;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use core::ptr::{read_volatile, write_volatile};

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use pneudrive_app::fault_log::Memory;
use pneudrive_app::log;
use pneudrive_app::runtime::reset::{CLOCK_FAILED, PANICKED, Reset, noted};
use stm32f4xx_hal::pac::RCC;

use crate::switch_off;

/// Memory that the start-up code leaves as it is.
pub struct Kept<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: each one is used in one place at a time, as is said there.
unsafe impl<T: Send> Sync for Kept<T> {}

impl<T> Kept<T> {
    /// Memory that holds anything.
    pub const fn new() -> Kept<T> {
        Kept(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// Where it is.
    pub const fn get(&self) -> *mut T {
        self.0.get().cast()
    }
}

#[unsafe(link_section = ".uninit.note")]
static NOTE: Kept<u32> = Kept::new();

#[unsafe(link_section = ".uninit.faults")]
static FAULTS: Kept<Memory> = Kept::new();

fn note() -> u32 {
    // SAFETY: any four bytes are a number. `reason` runs before all else, and `break_down` with interrupts disabled; the
    // one that cannot be, of the clock, does not return to whom it has interrupted.
    unsafe { read_volatile(NOTE.get()) }
}

fn leave_note(note: u32) {
    // SAFETY: as for reading.
    unsafe { write_volatile(NOTE.get(), note) }
}

/// Why the board was reset. Once after a reset: the next reset finds none of this.
pub fn reason(rcc: &RCC) -> Reset {
    let flags = rcc.csr().read();
    let reset = Reset {
        watchdog: flags.wdgrstf().bit_is_set(),
        software: flags.sftrstf().bit_is_set(),
        power: flags.porrstf().bit_is_set() || flags.borrstf().bit_is_set(),
        note: note(),
    };
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    leave_note(0);
    reset
}

/// The memory of the fault log, with whatever stands in it.
///
/// # Safety
/// Once after a reset: there must be one reference to it.
pub unsafe fn fault_memory() -> &'static mut Memory {
    // SAFETY: any bytes are such a memory, and the caller sees to the rest. The compiler is not to know
    // that nobody has written them.
    unsafe { &mut *black_box(FAULTS.0.get()).cast() }
}

/// Switches the drive off, leaves the note, tells the cause and resets the board. A breakdown while telling is not
/// told again.
fn break_down(cause: u32, tell: impl FnOnce()) -> ! {
    cortex_m::interrupt::disable();
    switch_off();
    if noted(note()).is_none() {
        leave_note(cause);
        tell();
    }
    SCB::sys_reset()
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

/// The clock has failed, and the clock security system has put the processor on its internal one (RM0390, 6.2.7). No
/// period is right any more.
// SAFETY: as above.
#[exception]
unsafe fn NonMaskableInt() {
    break_down(CLOCK_FAILED, || log!(error, "the clock has failed"))
}
