//! All of this image that needs `unsafe`: registers at fixed addresses, and the fault handler.
#![allow(unsafe_code)]

use core::ptr::{read_volatile, write_volatile};

use cortex_m::Peripherals;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::{ExceptionFrame, exception};
use semihosting::{eprintln, process};

use crate::bus;
use crate::clock::Clock;
use crate::uart::Uart;

/// What the board has.
pub struct Hardware {
    /// The protocol's port.
    pub uart: Uart,
    /// The counter.
    pub clock: Clock,
}

impl Hardware {
    /// Starts the hardware; None at a second call.
    pub fn take() -> Option<Hardware> {
        let peripherals = Peripherals::take()?;
        // There is one port, since the peripherals can be taken but once.
        let uart = Uart::start(UartRegisters(()));
        Some(Hardware { uart, clock: Clock::start(peripherals.SYST) })
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

/// A fault of the processor, such as an address that does not exist: off, and the emulator ends.
// SAFETY: the attribute wants `unsafe`. It does not return, so it cannot disturb what it interrupted.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    bus::switch_off();
    eprintln!("fault of the processor at {:#010x}", frame.pc());
    process::exit(2)
}
