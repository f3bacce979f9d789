//! Streams of DMA1, which serve the serial ports: all of theirs are on channel 4.

use core::sync::atomic::{AtomicU8, Ordering, fence};

use stm32f4xx_hal::pac::DMA1;
use stm32f4xx_hal::pac::dma2::ST;
use stm32f4xx_hal::rcc::{Enable, Rcc};

const CHANNEL: u8 = 4;

/// Looks at a stream's state before it is given up: it ends within a transfer or two.
const PATIENCE: u32 = 1000;

/// One of the streams.
pub struct Stream<const N: usize>(());

/// Those of USART3 in and out, then of USART2 in and out.
pub type Streams = (Stream<1>, Stream<3>, Stream<5>, Stream<6>);

/// Takes the controller apart.
pub fn streams(_: DMA1, rcc: &mut Rcc) -> Streams {
    DMA1::enable(rcc);
    (Stream(()), Stream(()), Stream(()), Stream(()))
}

impl<const N: usize> Stream<N> {
    fn registers(&self) -> &ST {
        // SAFETY: `streams` has taken the controller, and a stream's registers are reached by this one alone.
        unsafe { &*DMA1::ptr() }.st(N)
    }

    /// Fills memory from a port's data register, round after round.
    pub fn fill_round(&mut self, port: *const u32, memory: &'static [AtomicU8]) {
        self.point(port, memory, memory.len());
        self.registers().cr().write(|w| w.chsel().set(CHANNEL).minc().set_bit().circ().set_bit());
        self.registers().cr().modify(|_, w| w.en().set_bit());
    }

    /// Fills this many bytes of memory, no more than it has, from a port's data register; the end is an interrupt.
    #[cfg(feature = "plant-bus")]
    pub fn fill(&mut self, port: *const u32, memory: &'static [AtomicU8], bytes: usize) {
        self.point(port, memory, bytes);
        self.registers().cr().write(|w| w.chsel().set(CHANNEL).minc().set_bit().tcie().set_bit());
        self.registers().cr().modify(|_, w| w.en().set_bit());
    }

    /// Sends this many bytes of memory, no more than it has, to a port's data register.
    pub fn send(&mut self, port: *const u32, memory: &'static [AtomicU8], bytes: usize) {
        self.point(port, memory, bytes);
        // What was put into memory is there before the stream reads it.
        fence(Ordering::Release);
        let stream = self.registers();
        stream.cr().write(|w| w.chsel().set(CHANNEL).dir().memory_to_peripheral().minc().set_bit());
        stream.cr().modify(|_, w| w.en().set_bit());
    }

    fn point(&mut self, port: *const u32, memory: &'static [AtomicU8], bytes: usize) {
        self.stop();
        let stream = self.registers();
        // SAFETY: the data register of a port, which is on this controller's bus.
        stream.par().write(|w| unsafe { w.pa().bits(port as u32) });
        // SAFETY: a static whose bytes may change at any time; the stream takes no more than it has.
        stream.m0ar().write(|w| unsafe { w.m0a().bits(memory.as_ptr() as u32) });
        stream.ndtr().write(|w| w.ndt().set(bytes.min(memory.len()) as u16));
    }

    /// Ends what is on its way.
    fn stop(&mut self) {
        self.registers().cr().modify(|_, w| w.en().clear_bit());
        for _ in 0..PATIENCE {
            if !self.is_on() {
                break;
            }
        }
        self.clear_flags();
    }

    /// Clears the flags of the stream, so that its next end interrupts.
    pub fn clear_flags(&self) {
        const SHIFTS: [u32; 4] = [0, 6, 16, 22];
        let flags = 0x3d << SHIFTS[N % 4];
        // SAFETY: ones clear the flags of this stream, zeros leave those of the others.
        unsafe {
            let dma = &*DMA1::ptr();
            if N < 4 {
                dma.lifcr().write(|w| w.bits(flags));
            } else {
                dma.hifcr().write(|w| w.bits(flags));
            }
        }
    }

    /// Whether it has not come to its end.
    pub fn is_on(&self) -> bool {
        self.registers().cr().read().en().bit_is_set()
    }

    /// Bytes that are left of the memory.
    pub fn left(&self) -> usize {
        usize::from(self.registers().ndtr().read().ndt().bits())
    }
}
