//! USART2, the virtual serial port of the ST-LINK: 921,600 baud, both directions by DMA.
//!
//! What comes in goes round in a ring that is looked at between other work. A reply is collected and
//! then sent in one go; until it has gone, no request is taken. So nobody waits here, and no interrupt
//! is needed.

use core::convert::Infallible;
use core::sync::atomic::{AtomicU8, Ordering, fence};

use embedded_io::{ErrorType, Write};
use pneudrive_app::runtime::ring::Reader;
use pneudrive_app::runtime::talk;
use pneudrive_protocol::MAX_FRAME;
use stm32f4xx_hal::gpio::{PA2, PA3};
use stm32f4xx_hal::pac::USART2;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::config::{Config, DmaConfig, InvalidConfig};
use stm32f4xx_hal::serial::{Serial, SerialExt};
use stm32f4xx_hal::time::Bps;

use crate::dma::Stream;

/// Bits a second.
pub const BAUD: u32 = 921_600;

/// 11 ms of bytes.
const RING: usize = 1024;

static RECEIVED: [AtomicU8; RING] = [const { AtomicU8::new(0) }; RING];
static REPLY: [AtomicU8; MAX_FRAME] = [const { AtomicU8::new(0) }; MAX_FRAME];

/// The port.
pub struct Port {
    usart: USART2,
    received: Stream<5>,
    sent: Stream<6>,
    reader: Reader,
    collected: usize,
}

impl Port {
    /// Opens the port; bytes are received from now on.
    ///
    /// # Errors
    /// When the baud rate can't be had.
    pub fn open(
        usart: USART2,
        (mut received, sent): (Stream<5>, Stream<6>),
        pins: (PA2, PA3),
        rcc: &mut Rcc,
    ) -> Result<Port, InvalidConfig> {
        let config = Config::default().baudrate(Bps(BAUD)).dma(DmaConfig::TxRx);
        let serial: Serial<USART2> = usart.serial(pins, config, rcc)?;
        let (usart, _) = serial.release();
        received.fill_round(usart.dr().as_ptr().cast(), &RECEIVED);
        Ok(Port { usart, received, sent, reader: Reader::default(), collected: 0 })
    }
}

impl talk::Port for Port {
    fn is_free(&self) -> bool {
        !self.sent.is_on()
    }

    fn read(&mut self) -> Option<u8> {
        let place = self.reader.next(RING, self.received.left())?;
        // What the DMA has written is read after its counter.
        fence(Ordering::Acquire);
        RECEIVED.get(place).map(|byte| byte.load(Ordering::Relaxed))
    }

    fn has_collected(&self) -> bool {
        self.collected > 0
    }

    fn send(&mut self) {
        if self.collected > 0 {
            self.sent.send(self.usart.dr().as_ptr().cast(), &REPLY, self.collected);
            self.collected = 0;
        }
    }

    fn clear_errors(&mut self) {
        let state = self.usart.sr().read();
        if state.ore().bit_is_set() || state.fe().bit_is_set() || state.nf().bit_is_set() {
            // Reading the state, then the data: that is how the flags are cleared.
            let _ = self.usart.dr().read();
        }
    }
}

impl ErrorType for Port {
    type Error = Infallible;
}

/// Collects a reply. A frame always fits; of anything longer the end is lost.
impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for byte in bytes {
            if let Some(place) = REPLY.get(self.collected) {
                place.store(*byte, Ordering::Relaxed);
                self.collected += 1;
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
