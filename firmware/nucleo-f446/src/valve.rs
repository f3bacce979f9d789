//! The two drive stages and the line that enables them. Which stage drives, the configuration says.
//!
//! - the DAC on PA4, for the amplifier of a solenoid valve;
//! - step and direction, for a translator; TIM4 times the pulse ([`pneudrive_nucleo_plan::pulse`]).

use core::sync::atomic::{AtomicU16, Ordering};

use pneudrive_controller::Command;
use pneudrive_controller::drive::DriveConfig;
use pneudrive_nucleo_plan::pulse::Pulse;
use pneudrive_nucleo_plan::time::prescaler;
use stm32f4xx_hal::gpio::{Alternate, Analog, Output, PA4, PB6, PB10, PC7, PinState};
use stm32f4xx_hal::pac::{DAC, GPIOB, TIM4};
use stm32f4xx_hal::rcc::{BusTimerClock, Enable, Rcc, Reset};

/// Half of the converter's range: null, until a configuration says otherwise, and with a stepper.
const MIDDLE: u16 = 2048;

/// The code of the valve's null, for whoever switches off from outside.
static NULL_CODE: AtomicU16 = AtomicU16::new(MIDDLE);

/// The valve's lines.
pub struct Valve {
    dac: DAC,
    _dac_pin: PA4<Analog>,
    step: TIM4,
    direction: PC7<Output>,
    enable: PB10<Output>,
}

/// The pins as they are after a reset: inputs. External pull-downs hold `drive_enable` and `step` low.
pub struct Pins {
    /// The converter's output.
    pub dac: PA4<Analog>,
    /// The translator's pulse.
    pub step: PB6,
    /// The translator's direction: high extends.
    pub direction: PC7,
    /// Gates amplifier, translator and dump valve.
    pub enable: PB10,
}

impl Valve {
    /// Disabled, at null. None if the step timer's clock can't be divided to microseconds.
    pub fn start(dac: DAC, step: TIM4, pins: Pins, rcc: &mut Rcc) -> Option<Valve> {
        let enable = pins.enable.into_push_pull_output_in_state(PinState::Low);
        DAC::enable(rcc);
        DAC::reset(rcc);
        dac.dhr12r1().write(|w| w.daccdhr().set(MIDDLE));
        dac.cr().write(|w| w.en1().set_bit());
        start_pulses(&step, rcc)?;
        let _: PB6<Alternate<2>> = pins.step.into_alternate();
        let direction = pins.direction.into_push_pull_output_in_state(PinState::Low);
        Some(Valve { dac, _dac_pin: pins.dac, step, direction, enable })
    }

    /// Drives the stage. A drive is disabled before anything else changes, and enabled after.
    pub fn drive(&mut self, config: &DriveConfig, command: Command) {
        if !command.drive_enable {
            self.enable.set_low();
        }
        match config {
            DriveConfig::Dac(dac) => {
                NULL_CODE.store(dac.null_code, Ordering::Relaxed);
                self.convert(dac.code(command.counts));
            }
            DriveConfig::Stepper { translator, .. } => {
                self.convert(MIDDLE);
                self.step(Pulse::of(translator), command.step);
            }
        }
        if command.drive_enable {
            self.enable.set_high();
        }
    }

    fn convert(&mut self, code: u16) {
        self.dac.dhr12r1().write(|w| w.daccdhr().set(code));
    }

    /// Sets the direction and starts the timer, which gives the pulse after the set-up time.
    fn step(&mut self, pulse: Pulse, step: i8) {
        match step {
            0 => return,
            1.. => self.direction.set_high(),
            _ => self.direction.set_low(),
        }
        self.step.ccr1().write(|w| w.ccr().set(pulse.compare));
        self.step.arr().write(|w| w.arr().set(pulse.reload));
        self.step.cr1().modify(|_, w| w.cen().set_bit());
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
