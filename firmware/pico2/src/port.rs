//! UART0, to a debug probe or another converter to USB: 921,600 baud, both directions by DMA.
//!
//! What comes in goes round in a ring that is looked at between other work. A reply is collected and then sent in one
//! go; until it has gone, no request is taken. So nobody waits here, and no interrupt is needed.

use core::convert::Infallible;
use core::sync::atomic::{AtomicU8, Ordering, fence};

use embedded_io::{ErrorType, Write};
use pneudrive_app::runtime::ring::Reader;
use pneudrive_app::runtime::talk;
use pneudrive_protocol::MAX_FRAME;
use rp235x_hal::fugit::{HertzU32, RateExtU32};
use rp235x_hal::gpio::bank0::{Gpio0, Gpio1};
use rp235x_hal::gpio::{FunctionUart, Pin, PullNone, PullUp};
use rp235x_hal::pac::dma::CH;
use rp235x_hal::pac::{DMA, RESETS, UART0};
use rp235x_hal::uart::{DataBits, Error, StopBits, UartConfig, UartPeripheral};

/// Bits a second.
const BAUD: u32 = 921_600;

/// 11 ms of bytes, and the power of two that the DMA goes round in.
const RING: usize = 1 << RING_BITS;
const RING_BITS: u8 = 10;

/// Channels of the DMA.
const RECEIVE: usize = 0;
const SEND: usize = 1;

/// A count of transfers that never ends (RP2350 data sheet, 12.6: mode 0xf in the upper four bits).
const ENDLESS: u32 = 0xf << 28 | 1;

/// The DMA goes round in the lowest bits of the address.
#[repr(align(1024))]
struct Ring([AtomicU8; RING]);

static RECEIVED: Ring = Ring([const { AtomicU8::new(0) }; RING]);
static REPLY: [AtomicU8; MAX_FRAME] = [const { AtomicU8::new(0) }; MAX_FRAME];

/// Transmitter and receiver; a line that is off rests high.
pub type Pins = (Pin<Gpio0, FunctionUart, PullNone>, Pin<Gpio1, FunctionUart, PullUp>);

/// The port.
pub struct Port {
    uart: UART0,
    dma: DMA,
    reader: Reader,
    collected: usize,
}

impl Port {
    /// Opens the port; bytes are received from now on.
    ///
    /// # Errors
    /// When the baud rate can't be had.
    pub fn open(
        uart: UART0,
        dma: DMA,
        pins: Pins,
        resets: &mut RESETS,
        peripheral_clock: HertzU32,
    ) -> Result<Port, Error> {
        let config = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
        let (uart, _) = UartPeripheral::new(uart, pins, resets).enable(config, peripheral_clock)?.free();
        resets.reset().modify(|_, w| w.dma().clear_bit());
        while resets.reset_done().read().dma().bit_is_clear() {}
        let port = Port { uart, dma, reader: Reader::default(), collected: 0 };
        port.receive();
        Ok(port)
    }

    fn channel(&self, number: usize) -> &CH {
        self.dma.ch(number)
    }

    /// Fills the ring, round after round.
    fn receive(&self) {
        let channel = self.channel(RECEIVE);
        let (from, to) = (self.uart.uartdr().as_ptr() as u32, RECEIVED.0.as_ptr() as u32);
        // SAFETY: the data register of the port, and a static whose bytes may change at any time; the channel goes round in it.
        channel.ch_read_addr().write(|w| unsafe { w.bits(from) });
        // SAFETY: as above.
        channel.ch_write_addr().write(|w| unsafe { w.bits(to) });
        // SAFETY: as above.
        channel.ch_trans_count().write(|w| unsafe { w.bits(ENDLESS) });
        // SAFETY: a channel that chains to itself chains to none, and the ring has this many address bits.
        channel.ch_ctrl_trig().write(|w| unsafe {
            w.data_size().size_byte().incr_write().set_bit().ring_sel().set_bit().ring_size().bits(RING_BITS);
            w.treq_sel().uart0_rx().chain_to().bits(RECEIVE as u8).en().set_bit()
        });
    }

    /// Places of the ring that are left before the DMA starts over.
    fn left(&self) -> usize {
        let filled = self.channel(RECEIVE).ch_write_addr().read().bits() as usize % RING;
        RING - filled
    }
}

impl talk::Port for Port {
    fn is_free(&self) -> bool {
        self.channel(SEND).ch_ctrl_trig().read().busy().bit_is_clear()
    }

    fn read(&mut self) -> Option<u8> {
        let place = self.reader.next(RING, self.left())?;
        // What the DMA has written is read after its address.
        fence(Ordering::Acquire);
        RECEIVED.0.get(place).map(|byte| byte.load(Ordering::Relaxed))
    }

    fn has_collected(&self) -> bool {
        self.collected > 0
    }

    fn send(&mut self) {
        if self.collected == 0 {
            return;
        }
        // What is sent was written before.
        fence(Ordering::Release);
        let channel = self.channel(SEND);
        let (from, to) = (REPLY.as_ptr() as u32, self.uart.uartdr().as_ptr() as u32);
        // SAFETY: a static of more bytes than were collected, and the data register of the port.
        channel.ch_read_addr().write(|w| unsafe { w.bits(from) });
        // SAFETY: as above.
        channel.ch_write_addr().write(|w| unsafe { w.bits(to) });
        // SAFETY: as above.
        channel.ch_trans_count().write(|w| unsafe { w.bits(self.collected as u32) });
        // SAFETY: a channel that chains to itself chains to none.
        channel.ch_ctrl_trig().write(|w| unsafe {
            w.data_size().size_byte().incr_read().set_bit().treq_sel().uart0_tx();
            w.chain_to().bits(SEND as u8).en().set_bit()
        });
        self.collected = 0;
    }

    /// What is wrong with a byte stands beside it, and the DMA takes the byte alone: there is nothing to be cleared.
    fn clear_errors(&mut self) {}
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
