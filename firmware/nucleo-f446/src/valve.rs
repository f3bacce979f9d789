//! The two drive stages and how they are switched off. Which stage drives, the configuration says.
//!
//! - the DAC on PA4, for the amplifier of a solenoid valve;
//! - step and direction, for a translator; TIM4 times the pulse ([`pneudrive_app::runtime::pulse`]).

use core::convert::Infallible;
use core::sync::atomic::{AtomicU16, Ordering};

use pneudrive_app::runtime::instants::prescaler;
use pneudrive_app::runtime::pulse::Pulse;
use pneudrive_controller::drive::{DacCode, Translator};
use pneudrive_interfaces::{Direction, StepDirection, ValveOutput};
use stm32f4xx_hal::gpio::{Alternate, Analog, Output, PA4, PB6, PC7, PinState};
use stm32f4xx_hal::pac::{DAC, GPIOB, TIM4};
use stm32f4xx_hal::rcc::{BusTimerClock, Enable, Rcc, Reset};

/// Half of the converter's range: null, until a configuration says otherwise.
const MIDDLE: u16 = DacCode::MIDDLE.get();

/// The code of the valve's null, for whoever switches off from outside.
static NULL_CODE: AtomicU16 = AtomicU16::new(MIDDLE);

/// The converter of a solenoid valve's amplifier.
pub struct Converter {
    dac: DAC,
    _pin: PA4<Analog>,
}

impl Converter {
    /// At the middle of its range.
    pub fn start(dac: DAC, pin: PA4<Analog>, rcc: &mut Rcc) -> Converter {
        DAC::enable(rcc);
        DAC::reset(rcc);
        dac.dhr12r1().write(|w| w.daccdhr().set(MIDDLE));
        dac.cr().write(|w| w.en1().set_bit());
        Converter { dac, _pin: pin }
    }
}

impl ValveOutput for Converter {
    type Error = Infallible;

    #[inline]
    fn set_code(&mut self, code: DacCode) -> Result<(), Infallible> {
        self.dac.dhr12r1().write(|w| w.daccdhr().set(code.get()));
        Ok(())
    }

    #[inline]
    fn note_null(&mut self, code: DacCode) {
        NULL_CODE.store(code.get(), Ordering::Relaxed);
    }
}

/// The lines of a translator. External pull-downs hold the pulse line low until they are driven.
pub struct Steps {
    timer: TIM4,
    direction: PC7<Output>,
}

impl Steps {
    /// No pulse. None if the timer's clock can't be divided to microseconds.
    pub fn start(timer: TIM4, pulse: PB6, direction: PC7, rcc: &mut Rcc) -> Option<Steps> {
        start_pulses(&timer, rcc)?;
        let _: PB6<Alternate<2>> = pulse.into_alternate();
        let direction = direction.into_push_pull_output_in_state(PinState::Low);
        Some(Steps { timer, direction })
    }
}

impl StepDirection for Steps {
    type Error = Infallible;

    /// Sets the direction and starts the timer, which gives the pulse after the set-up time.
    #[inline]
    fn step(&mut self, translator: &Translator, direction: Direction) -> Result<(), Infallible> {
        let pulse = Pulse::of(translator);
        match direction {
            Direction::Extend => self.direction.set_high(),
            Direction::Retract => self.direction.set_low(),
        }
        self.timer.ccr1().write(|w| w.ccr().set(pulse.compare));
        self.timer.arr().write(|w| w.arr().set(pulse.reload));
        self.timer.cr1().modify(|_, w| w.cen().set_bit());
        Ok(())
    }
}

/// Channel 1 is driven from the compare value to the reload value; then the timer stops.
fn start_pulses(timer: &TIM4, rcc: &mut Rcc) -> Option<()> {
    TIM4::enable(rcc);
    TIM4::reset(rcc);
    let divider = prescaler(TIM4::timer_clock(&rcc.clocks).raw())?;
    timer.psc().write(|w| w.psc().set(divider));
    timer.egr().write(|w| w.ug().set_bit());
    timer.ccr1().write(|w| w.ccr().set(1));
    timer.ccmr1_output().write(|w| w.oc1m().pwm_mode2());
    timer.ccer().write(|w| w.cc1e().set_bit());
    timer.cr1().write(|w| w.opm().set_bit());
    Some(())
}

/// Drive disabled, valve at null, from wherever the program is.
pub fn switch_off() {
    let code = NULL_CODE.load(Ordering::Relaxed);
    // SAFETY: the program does not go on after this, so nobody else uses these registers.
    let (dac, port) = unsafe { (DAC::steal(), GPIOB::steal()) };
    port.bsrr().write(|w| w.br10().set_bit());
    dac.dhr12r1().write(|w| w.daccdhr().set(code));
}
