//! A bus on which every transaction fails.

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};

#[derive(Debug)]
pub struct FailingBus;

impl ErrorType for FailingBus {
    type Error = ErrorKind;
}

impl SpiDevice for FailingBus {
    fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        Err(ErrorKind::Other)
    }
}
