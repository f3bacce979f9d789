//! TIM2: 32 bits of quadrature counts, all four edges of a period.

use core::convert::Infallible;

use pneudrive_interfaces::EncoderCounter;
use stm32f4xx_hal::gpio::{Alternate, PA0, PA1, Pull};
use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// The encoder's counter.
pub struct Encoder(TIM2);

/// The two tracks.
pub type Pins = (PA0<Alternate<1>>, PA1<Alternate<1>>);

impl Encoder {
    /// The tracks, pulled up: a wire that is off counts nothing, where an open input would count what it picks up.
    pub fn pins(a: PA0, b: PA1) -> Pins {
        (a.into_alternate().internal_resistor(Pull::Up), b.into_alternate().internal_resistor(Pull::Up))
    }

    /// Starts counting from 0.
    pub fn start(timer: TIM2, _: Pins, rcc: &mut Rcc) -> Encoder {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        // A level counts once it has stood for 8 timer clocks, 90 ns: spikes are no edges.
        timer.ccmr1_input().write(|w| w.cc1s().ti1().ic1f().fck_int_n8().cc2s().ti2().ic2f().fck_int_n8());
        timer.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit());
        timer.smcr().write(|w| w.sms().encoder_mode_3());
        timer.arr().write(|w| w.arr().set(u32::MAX));
        timer.cr1().write(|w| w.cen().set_bit());
        Encoder(timer)
    }
}

impl EncoderCounter for Encoder {
    type Error = Infallible;

    #[inline]
    fn count(&mut self) -> Result<i32, Infallible> {
        Ok(self.0.cnt().read().cnt().bits().cast_signed())
    }
}
