//! All of this image that needs `unsafe`: registers at fixed addresses, memory that a reset leaves as it
//! is, and the handlers of what can't be masked.
#![allow(unsafe_code)]

use core::cell::UnsafeCell;
use core::hint::black_box;
use core::mem::MaybeUninit;
use core::ptr::{read_volatile, write_volatile};

use cortex_m::Peripherals;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::{NVIC, SYST};
use cortex_m_rt::{ExceptionFrame, exception};
use pneudrive_app::fault_log::Memory;
use semihosting::{eprintln, process};

use crate::bus;

/// What the board has.
pub struct Hardware {
    /// Those of the protocol's port.
    pub uart: UartRegisters,
    /// The counter.
    pub syst: SYST,
    /// Those of the watchdog.
    pub watchdog: WatchdogRegisters,
    /// The memory of the fault log, with whatever stands in it.
    pub fault_memory: &'static mut Memory,
}

impl Hardware {
    /// The hardware; None at a second call.
    pub fn take() -> Option<Hardware> {
        let peripherals = Peripherals::take()?;
        // There is one port and one watchdog, since the peripherals can be taken but once.
        let (uart, watchdog) = (UartRegisters(()), WatchdogRegisters(()));
        // SAFETY: any bytes are such a memory, and this is its one reference, since the peripherals can be
        // taken but once. The compiler is not to know that nobody has written them.
        let fault_memory = unsafe { &mut *black_box(FAULTS.0.get()).cast() };
        Some(Hardware { uart, syst: peripherals.SYST, watchdog, fault_memory })
    }
}

/// The registers of UART0, a CMSDK APB UART. There is one value of this type.
pub struct UartRegisters(());

const DATA: *mut u32 = 0x4000_4000 as *mut u32;
const STATE: *mut u32 = 0x4000_4004 as *mut u32;
const CONTROL: *mut u32 = 0x4000_4008 as *mut u32;
const INTERRUPT_CLEAR: *mut u32 = 0x4000_400c as *mut u32;
const BAUD_DIVIDER: *mut u32 = 0x4000_4010 as *mut u32;

/// Transmitter, receiver, and an interrupt when a byte has come.
const ENABLE: u32 = 1 << 0 | 1 << 1 | 1 << 3;
/// The receiver's bit of the interrupt register.
const RECEIVE: u32 = 1 << 1;
/// The least divider that the UART takes.
const DIVIDER: u32 = 16;

/// The receiver's interrupt.
#[derive(Clone, Copy)]
struct Received;

// SAFETY: the receiver of UART0 has interrupt 0 on this board.
unsafe impl InterruptNumber for Received {
    fn number(self) -> u16 {
        0
    }
}

impl UartRegisters {
    /// Enables both directions and has the receiver's interrupt end a rest.
    pub fn start(&mut self) {
        // SAFETY: UART0's registers, which only this value reaches. No handler can be entered, since
        // interrupts stay disabled: the interrupt only wakes the processor.
        unsafe {
            write_volatile(BAUD_DIVIDER, DIVIDER);
            write_volatile(CONTROL, ENABLE);
            NVIC::unmask(Received);
        }
    }

    /// The state register.
    pub fn state(&self) -> u32 {
        // SAFETY: a register of UART0; reading it changes nothing.
        unsafe { read_volatile(STATE) }
    }

    /// The byte that has come.
    pub fn read_data(&mut self) -> u8 {
        // SAFETY: a register of UART0, which only this value reaches.
        unsafe { read_volatile(DATA) as u8 }
    }

    /// Sends a byte.
    pub fn write_data(&mut self, byte: u8) {
        // SAFETY: a register of UART0, which only this value reaches.
        unsafe { write_volatile(DATA, u32::from(byte)) }
    }

    /// The next byte wakes the processor again.
    pub fn clear_receive_interrupt(&mut self) {
        // SAFETY: a register of UART0, which only this value reaches.
        unsafe { write_volatile(INTERRUPT_CLEAR, RECEIVE) }
        NVIC::unpend(Received);
    }
}

/// The registers of the watchdog. There is one value of this type.
pub struct WatchdogRegisters(());

const WATCHDOG_LOAD: *mut u32 = 0x4000_8000 as *mut u32;
const WATCHDOG_CONTROL: *mut u32 = 0x4000_8008 as *mut u32;
const WATCHDOG_CLEAR: *mut u32 = 0x4000_800c as *mut u32;

/// It counts and interrupts, and resets the board when it comes to its end again.
const INTERRUPT_AND_RESET: u32 = 1 << 0 | 1 << 1;

impl WatchdogRegisters {
    /// Counts down from this many clocks, again and again.
    pub fn start(&mut self, clocks: u32) {
        // SAFETY: the watchdog's registers, which only this value reaches.
        unsafe {
            write_volatile(WATCHDOG_LOAD, clocks);
            write_volatile(WATCHDOG_CONTROL, INTERRUPT_AND_RESET);
        }
    }

    /// Begins anew, without an interrupt.
    pub fn reload(&mut self) {
        // SAFETY: a register of the watchdog, which only this value reaches.
        unsafe { write_volatile(WATCHDOG_CLEAR, 1) }
    }
}

/// Memory that the start-up code leaves as it is. Without power it is zeros.
struct Kept<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: each of the two below is used in one place at a time, as is said there.
unsafe impl<T: Send> Sync for Kept<T> {}

#[unsafe(link_section = ".uninit.note")]
static NOTE: Kept<u32> = Kept(UnsafeCell::new(MaybeUninit::uninit()));

#[unsafe(link_section = ".uninit.faults")]
static FAULTS: Kept<Memory> = Kept(UnsafeCell::new(MaybeUninit::uninit()));

/// What is left in memory when the watchdog has interrupted.
pub const BITTEN: u32 = 0x50d7_1e02;

/// The note that was left before the reset; there is none after.
pub fn take_note() -> u32 {
    // SAFETY: any four bytes are a number. Who leaves a note does not return.
    let note = unsafe { read_volatile(NOTE.0.get().cast()) };
    leave_note(0);
    note
}

/// Leaves a note for after the reset.
pub fn leave_note(note: u32) {
    // SAFETY: as for taking it.
    unsafe { write_volatile(NOTE.0.get().cast(), note) }
}

/// The watchdog was not fed: that is noted, and nothing else is done until it resets the board.
// SAFETY: the attribute wants `unsafe`. It does not return, so it cannot disturb what it interrupted.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    leave_note(BITTEN);
    loop {
        cortex_m::asm::nop();
    }
}

/// A fault of the processor, such as an address that does not exist: off, and the emulator ends.
// SAFETY: the attribute wants `unsafe`. It does not return, so it cannot disturb what it interrupted.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    bus::switch_off();
    eprintln!("fault of the processor at {:#010x}", frame.pc());
    process::exit(2)
}
