//! Which peripheral is at which address. RM0390 section 2.2.2, and 2.3 of PM0214 for the bit-band.

use crate::board::{A, B, Board, C, NO_CLOCK, SENDER, SERIAL_CHANNEL, Stop};
use crate::peripheral::adc::Adc;
use crate::peripheral::control_timer::ControlTimer;
use crate::peripheral::dac::Dac;
use crate::peripheral::dma::Memory;
use crate::peripheral::encoder_timer::{EncoderTimer, tracks_at};
use crate::peripheral::pulse_timer::PulseTimer;
use crate::peripheral::rcc::{Cause, Gate};
use crate::peripheral::system;
use crate::peripheral::usart::Usart;
use crate::register::Write;

pub(super) const TIM2: Gate = Gate::Apb1(0);
pub(super) const TIM4: Gate = Gate::Apb1(2);
pub(super) const TIM5: Gate = Gate::Apb1(3);
pub(super) const USART2: Gate = Gate::Apb1(17);
const PWR: Gate = Gate::Apb1(28);
const DAC: Gate = Gate::Apb1(29);
const ADC: Gate = Gate::Apb2(8);
const DMA1: Gate = Gate::Ahb1(21);
const DMA2: Gate = Gate::Ahb1(22);

/// The register of the debug unit that says what a halt freezes (33.16.4).
pub(super) const APB1_FZ: u32 = 8;

/// The state register of the line, which the idle task looks at once a round, and the encoder's counter.
const LINE_STATE: u32 = 0x4000_4400;
const ENCODER_COUNT: u32 = 0x4000_0024;

/// The peripherals' own memory, and its alias that has a word for each bit.
pub const PERIPHERALS: u32 = 0x4000_0000;
/// The alias.
pub const BIT_BAND: u32 = 0x4200_0000;

/// A peripheral.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Peripheral {
    Encoder,
    Pulses,
    Timer,
    Watchdog,
    Usart,
    Pwr,
    Dac,
    Adc,
    Port(usize),
    Rcc,
    Flash,
    Dma1,
    Dma2,
    Counter,
    System,
    Debug,
}

/// The peripheral at an address, its clock's gate if it has one, and where it starts.
fn peripheral(address: u32) -> Option<(Peripheral, Option<Gate>, u32)> {
    let (peripheral, gate) = match address & !0x3ff {
        0x4000_0000 => (Peripheral::Encoder, Some(TIM2)),
        0x4000_0800 => (Peripheral::Pulses, Some(TIM4)),
        0x4000_0c00 => (Peripheral::Timer, Some(TIM5)),
        0x4000_3000 => (Peripheral::Watchdog, None),
        0x4000_4400 => (Peripheral::Usart, Some(USART2)),
        0x4000_7000 => (Peripheral::Pwr, Some(PWR)),
        0x4000_7400 => (Peripheral::Dac, Some(DAC)),
        0x4001_2000 => (Peripheral::Adc, Some(ADC)),
        0x4002_0000 => (Peripheral::Port(A), Some(Gate::Ahb1(0))),
        0x4002_0400 => (Peripheral::Port(B), Some(Gate::Ahb1(1))),
        0x4002_0800 => (Peripheral::Port(C), Some(Gate::Ahb1(2))),
        0x4002_3800 => (Peripheral::Rcc, None),
        0x4002_3c00 => (Peripheral::Flash, None),
        0x4002_6000 => (Peripheral::Dma1, Some(DMA1)),
        0x4002_6400 => (Peripheral::Dma2, Some(DMA2)),
        system::DWT => (Peripheral::Counter, None),
        0xe000_e000..0xe000_f000 => return Some((Peripheral::System, None, system::START)),
        0xe004_2000 => (Peripheral::Debug, None),
        _ => return None,
    };
    Some((peripheral, gate, address & !0x3ff))
}

impl Board {
    /// Reads this many bytes.
    pub fn read(&mut self, address: u32, bytes: usize, memory: &mut dyn Memory) -> u64 {
        self.settle(memory);
        let Some((peripheral, start)) = self.reached(address, "reads") else { return 0 };
        if address == LINE_STATE && self.idle.begin_round() {
            self.pass_time();
            self.settle(memory);
        }
        if address == ENCODER_COUNT {
            self.note_lateness(0);
        }
        let word = self.read_word(peripheral, (address - start) & !3);
        let shifted = u64::from(word) >> (8 * (address % 4));
        shifted & ((1 << (8 * bytes)) - 1)
    }

    /// Writes this many bytes.
    pub fn write(&mut self, address: u32, bytes: usize, value: u64, memory: &mut dyn Memory) {
        self.settle(memory);
        self.idle.something_happens();
        let Some((peripheral, start)) = self.reached(address, "writes") else { return };
        let was_enabled = self.enabled();
        self.write_word(peripheral, Write::of(address - start, bytes, value), memory);
        if self.enabled() != was_enabled {
            self.enable_log.push((self.now, !was_enabled));
        }
    }

    /// The peripheral at an address; a mistake of the image, or what no model knows, ends the run.
    fn reached(&mut self, address: u32, does: &str) -> Option<(Peripheral, u32)> {
        let handled = match peripheral(address) {
            Some((peripheral, gate, start)) if gate.is_none_or(|gate| self.rcc.is_clocked(gate)) => {
                return Some((peripheral, start));
            }
            Some((peripheral, ..)) => {
                format!("the image {does} {peripheral:?} at {address:#x} while its clock is off")
            }
            None => format!("the image {does} {address:#x}, and no model knows what is there"),
        };
        self.stop.get_or_insert(Stop::Broken(handled));
        None
    }

    /// A read through the alias: one bit.
    pub fn read_bit(&mut self, alias: u32, memory: &mut dyn Memory) -> u64 {
        let (address, bit) = bit_at(alias);
        self.read(address, 4, memory) >> bit & 1
    }

    /// A write through the alias: one bit.
    pub fn write_bit(&mut self, alias: u32, value: u64, memory: &mut dyn Memory) {
        let (address, bit) = bit_at(alias);
        let word = self.read(address, 4, memory);
        self.write(address, 4, word & !(1 << bit) | (value & 1) << bit, memory);
    }

    fn read_word(&mut self, peripheral: Peripheral, offset: u32) -> u32 {
        match peripheral {
            Peripheral::Encoder => self.encoder.read(offset),
            Peripheral::Pulses => self.pulses.read(offset, self.now),
            Peripheral::Timer => self.timer.read(offset, self.now),
            Peripheral::Watchdog => self.watchdog.read(offset, self.now),
            Peripheral::Usart => self.usart.read(offset),
            Peripheral::Pwr => self.pwr.read(offset),
            Peripheral::Dac => self.dac.read(offset),
            Peripheral::Adc => self.adc.read(offset),
            Peripheral::Port(port) => self.ports[port].read(offset),
            Peripheral::Rcc => self.rcc.read(offset),
            Peripheral::Flash => self.flash.read(offset),
            Peripheral::Dma1 => self.dma_1.read(offset),
            Peripheral::Dma2 => self.dma_2.read(offset),
            Peripheral::Counter => {
                self.system.read_counter(offset, self.now, self.clocks.unwrap_or(NO_CLOCK).core)
            }
            Peripheral::System => self.system.read(offset),
            Peripheral::Debug => self.debug.get(offset),
        }
    }

    fn write_word(&mut self, peripheral: Peripheral, write: Write, memory: &mut dyn Memory) {
        let clocks = self.clocks.unwrap_or(NO_CLOCK);
        match peripheral {
            Peripheral::Encoder => self.encoder.write(write),
            Peripheral::Pulses => self.start_pulse(write),
            Peripheral::Timer => self.timer.write(write, self.now),
            Peripheral::Watchdog => self.watchdog.write(write, self.now),
            Peripheral::Usart => self.usart.write(write),
            Peripheral::Pwr => self.pwr.write(write),
            Peripheral::Dac => {
                if self.dac.write(write) {
                    self.note_lateness(1);
                }
            }
            Peripheral::Adc => self.adc.write(write, clocks.apb2, self.now),
            Peripheral::Port(port) => self.ports[port].write(write),
            Peripheral::Rcc => {
                if let Some(gate) = self.rcc.write(write) {
                    self.renew(gate);
                }
                self.follow_clocks();
            }
            Peripheral::Flash => {
                let stalls = self.flash.write(write);
                self.stall(stalls);
            }
            Peripheral::Dma1 => self.start_stream(write, memory),
            Peripheral::Dma2 => drop(self.dma_2.write(write)),
            Peripheral::Counter => self.system.write_counter(write),
            Peripheral::System => {
                if self.system.write(write) {
                    self.stop.get_or_insert(Stop::Reset(Cause::Software));
                }
            }
            Peripheral::Debug => drop(self.debug.keep(write)),
        }
    }

    /// The processor waits for the flash; the watchdog does not.
    pub(super) fn stall(&mut self, ticks: u64) {
        let bites = self.watchdog.bites_at().unwrap_or(u64::MAX);
        self.now = (self.now + ticks).min(bites);
        if self.flash.dark {
            self.stop = Some(Stop::Dark);
        }
    }

    /// Programs cells of the flash.
    pub fn program(&mut self, offset: usize, bytes: usize, value: u64) {
        self.idle.something_happens();
        let stalls = self.flash.program(offset, bytes, value);
        self.stall(stalls);
    }

    fn start_pulse(&mut self, write: Write) {
        let pulse = self.pulses.write(write, self.now);
        if let Some(pulse) = pulse.filter(|_| self.ports[B].is_alternate(6, 2)) {
            self.coming.push((pulse, self.ports[C].driven(7) == Some(true)));
        }
    }

    fn start_stream(&mut self, write: Write, memory: &mut dyn Memory) {
        let enabled = self.dma_1.write(write);
        if enabled == Some(SENDER) && self.dma_1.serves(SENDER, SERIAL_CHANNEL) {
            let bytes = self.dma_1.outgoing(SENDER, memory);
            if let Some(begun) = self.tap.reply(&bytes) {
                self.bench.begin(begun);
            }
            self.usart.send(bytes, self.now);
        }
    }

    /// A peripheral is reset by the clock control.
    pub(super) fn renew(&mut self, gate: Gate) {
        let clocks = self.clocks.unwrap_or(NO_CLOCK);
        match gate {
            TIM2 => self.encoder = EncoderTimer::new(tracks_at(self.shown)),
            TIM4 => self.pulses = PulseTimer::new(clocks.apb1_timers),
            TIM5 => self.timer = ControlTimer::new(clocks.apb1_timers, self.now),
            USART2 => self.usart = Usart::new(clocks.apb1),
            DAC => self.dac = Dac::default(),
            ADC => self.adc = Adc::new(self.adc_stuck),
            _ => {}
        }
    }
}

fn bit_at(alias: u32) -> (u32, u32) {
    let bit = (alias - BIT_BAND) / 4;
    (PERIPHERALS + bit / 32 * 4, bit % 32)
}
