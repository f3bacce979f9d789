//! USART2, the virtual serial port of the ST-LINK: 921,600 baud, both directions by DMA.
//!
//! What comes in goes round in a ring that is looked at between other work. A reply is collected and
//! then sent in one go; until it has gone, no request is taken. So nobody waits here, and no interrupt
//! is needed.

use core::convert::Infallible;
use core::sync::atomic::{AtomicU8, Ordering, fence};

use embedded_io::{ErrorType, Write};
use pneudrive_nucleo_plan::ring::Reader;
use pneudrive_protocol::MAX_FRAME;
use stm32f4xx_hal::gpio::{PA2, PA3};
use stm32f4xx_hal::pac::{DMA1, USART2};
use stm32f4xx_hal::rcc::{Enable, Rcc};
use stm32f4xx_hal::serial::config::{Config, DmaConfig, InvalidConfig};
use stm32f4xx_hal::serial::{Serial, SerialExt};
use stm32f4xx_hal::time::Bps;

/// Bits a second.
const BAUD: u32 = 921_600;

/// 11 ms of bytes.
const RING: usize = 1024;

/// The streams that USART2 has on channel 4.
const CHANNEL: u8 = 4;
const RECEIVE: usize = 5;
const SEND: usize = 6;

static RECEIVED: [AtomicU8; RING] = [const { AtomicU8::new(0) }; RING];
static REPLY: [AtomicU8; MAX_FRAME] = [const { AtomicU8::new(0) }; MAX_FRAME];

/// The port.
pub struct Port {
    usart: USART2,
    dma: DMA1,
    reader: Reader,
    collected: usize,
}

impl Port {
    /// Opens the port; bytes are received from now on.
    ///
    /// # Errors
    /// When the baud rate can't be had.
    pub fn open(usart: USART2, dma: DMA1, pins: (PA2, PA3), rcc: &mut Rcc) -> Result<Port, InvalidConfig> {
        let config = Config::default().baudrate(Bps(BAUD)).dma(DmaConfig::TxRx);
        let serial: Serial<USART2> = usart.serial(pins, config, rcc)?;
        let (usart, _) = serial.release();
        DMA1::enable(rcc);
        let port = Port { usart, dma, reader: Reader::default(), collected: 0 };
        port.receive();
        Ok(port)
    }

    /// Lets the receiver fill the ring, round after round.
    fn receive(&self) {
        let stream = self.dma.st(RECEIVE);
        // SAFETY: the data register of the port, which is on this DMA's bus.
        stream.par().write(|w| unsafe { w.pa().bits(self.usart.dr().as_ptr() as u32) });
        // SAFETY: a static whose bytes may change at any time; the stream writes no more than it has.
        stream.m0ar().write(|w| unsafe { w.m0a().bits(RECEIVED.as_ptr() as u32) });
        stream.ndtr().write(|w| w.ndt().set(RING as u16));
        stream.cr().write(|w| w.chsel().set(CHANNEL).minc().set_bit().circ().set_bit());
        stream.cr().modify(|_, w| w.en().set_bit());
    }

    /// Whether the last reply has gone.
    pub fn is_free(&self) -> bool {
        self.dma.st(SEND).cr().read().en().bit_is_clear()
    }

    /// A byte that has come.
    pub fn read(&mut self) -> Option<u8> {
        let left = self.dma.st(RECEIVE).ndtr().read().ndt().bits();
        let place = self.reader.next(RING, usize::from(left))?;
        // What the DMA has written is read after its counter.
        fence(Ordering::Acquire);
        RECEIVED.get(place).map(|byte| byte.load(Ordering::Relaxed))
    }

    /// Whether there is a reply to be sent.
    pub fn has_collected(&self) -> bool {
        self.collected > 0
    }

    /// Sends what was collected. The port must be free.
    pub fn send(&mut self) {
        if self.collected == 0 {
            return;
        }
        self.dma.hifcr().write(|w| {
            w.ctcif6().set_bit().chtif6().set_bit().cteif6().set_bit().cdmeif6().set_bit().cfeif6().set_bit()
        });
        let stream = self.dma.st(SEND);
        // SAFETY: the data register of the port, which is on this DMA's bus.
        stream.par().write(|w| unsafe { w.pa().bits(self.usart.dr().as_ptr() as u32) });
        // SAFETY: a static that is not written before the stream has ended.
        stream.m0ar().write(|w| unsafe { w.m0a().bits(REPLY.as_ptr() as u32) });
        stream.ndtr().write(|w| w.ndt().set(self.collected as u16));
        // What was collected is in memory before the DMA reads it.
        fence(Ordering::Release);
        stream.cr().write(|w| w.chsel().set(CHANNEL).dir().memory_to_peripheral().minc().set_bit());
        stream.cr().modify(|_, w| w.en().set_bit());
        self.collected = 0;
    }

    /// Clears what noise on the line has left, so that reception goes on.
    pub fn clear_errors(&mut self) {
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
