//! UART0: the serial port of the protocol. The emulator has no baud rate: a byte is there or not.

use core::convert::Infallible;

use embedded_io::{ErrorType, Write};

use crate::hardware::UartRegisters;

/// Bit of the state: the transmit buffer is full.
const TRANSMIT_FULL: u32 = 1 << 0;
/// Bit of the state: a byte has come.
const RECEIVE_FULL: u32 = 1 << 1;

/// The port.
pub struct Uart(UartRegisters);

impl Uart {
    /// A port whose receiver wakes the processor.
    pub fn start(mut registers: UartRegisters) -> Uart {
        registers.start();
        Uart(registers)
    }

    /// A byte that has come.
    pub fn read(&mut self) -> Option<u8> {
        self.0.clear_receive_interrupt();
        (self.0.state() & RECEIVE_FULL != 0).then(|| self.0.read_data())
    }
}

impl ErrorType for Uart {
    type Error = Infallible;
}

impl Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for &byte in bytes {
            while self.0.state() & TRANSMIT_FULL != 0 {}
            self.0.write_data(byte);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
