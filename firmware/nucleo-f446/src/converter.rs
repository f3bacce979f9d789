//! ADC1: three channels in a row when a sample is due, each by DMA into its place.

use core::sync::atomic::{AtomicU16, Ordering, fence};

use pneudrive_interfaces::{Conversions, PressureInput};
use stm32f4xx_hal::gpio::{Analog, PB0, PC0, PC1};
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1, DMA2};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Channels that are converted at a sample.
const CHANNELS: usize = 3;

/// Looks at the DMA before the conversions are given up: some 20 us. They take 5.4.
const PATIENCE: u32 = 400;

/// The stream that ADC1 has on its channel 0.
const STREAM: usize = 0;

/// Where the DMA puts the conversions: pressure 1, pressure 2, spool.
static CONVERTED: [AtomicU16; CHANNELS] = [const { AtomicU16::new(0) }; CHANNELS];

/// The analogue inputs.
pub struct Converter {
    adc: ADC1,
    dma: DMA2,
}

/// Pressure 1, pressure 2 and spool: channels 10, 11 and 8.
pub type Pins = (PC0<Analog>, PC1<Analog>, PB0<Analog>);

impl Converter {
    /// Gets the converter ready. It must have 3 us before the first conversion.
    pub fn start(adc: ADC1, common: ADC_COMMON, dma: DMA2, _: Pins, rcc: &mut Rcc) -> Converter {
        ADC1::enable(rcc);
        ADC1::reset(rcc);
        DMA2::enable(rcc);
        // 90 MHz / 4 = 22.5 MHz; a channel takes 28 + 12 clocks.
        common.ccr().modify(|_, w| w.adcpre().div4());
        adc.cr1().write(|w| w.scan().set_bit());
        adc.smpr1().write(|w| w.smp10().cycles28().smp11().cycles28());
        adc.smpr2().write(|w| w.smp8().cycles28());
        adc.sqr1().write(|w| w.l().set(CHANNELS as u8 - 1));
        // SAFETY: channels 10, 11 and 8 exist.
        adc.sqr3().write(|w| unsafe { w.sq1().bits(10).sq2().bits(11).sq3().bits(8) });
        let mut converter = Converter { adc, dma };
        converter.restart();
        converter
    }

    /// Sets DMA and converter to the first channel.
    fn restart(&mut self) {
        let stream = self.dma.st(STREAM);
        self.adc.cr2().write(|w| w);
        self.adc.sr().write(|w| w.ovr().clear_bit());
        stream.cr().write(|w| w);
        for _ in 0..PATIENCE {
            if stream.cr().read().en().bit_is_clear() {
                break;
            }
        }
        self.clear_flags();
        // SAFETY: a half-word register of the converter, which is on this DMA's bus.
        stream.par().write(|w| unsafe { w.pa().bits(self.adc.dr().as_ptr() as u32) });
        // SAFETY: a static whose half-words may change at any time; the stream writes no more than it has.
        stream.m0ar().write(|w| unsafe { w.m0a().bits(CONVERTED.as_ptr() as u32) });
        stream.ndtr().write(|w| w.ndt().set(CHANNELS as u16));
        stream.cr().write(|w| w.psize().bits16().msize().bits16().minc().set_bit().circ().set_bit());
        stream.cr().modify(|_, w| w.pl().very_high().en().set_bit());
        self.adc.cr2().write(|w| w.adon().set_bit().dma().set_bit().dds().set_bit());
    }

    fn clear_flags(&self) {
        let all = self.dma.lifcr();
        all.write(|w| {
            w.ctcif0().set_bit().chtif0().set_bit().cteif0().set_bit().cdmeif0().set_bit().cfeif0().set_bit()
        });
    }
}

/// The conversions did not come.
pub struct NoConversion;

impl PressureInput for Converter {
    type Error = NoConversion;

    #[inline]
    fn convert(&mut self) -> Result<Conversions, NoConversion> {
        self.clear_flags();
        self.adc.cr2().modify(|_, w| w.swstart().set_bit());
        for _ in 0..PATIENCE {
            if self.dma.lisr().read().tcif0().bit_is_set() {
                // What the DMA has written is read after its flag.
                fence(Ordering::Acquire);
                let [pressure_1, pressure_2, spool] = [0, 1, 2].map(load);
                return Ok(Conversions { pressure_1, pressure_2, spool });
            }
        }
        self.restart();
        Err(NoConversion)
    }
}

fn load(channel: usize) -> u16 {
    CONVERTED.get(channel).map_or(0, |converted| converted.load(Ordering::Relaxed))
}
