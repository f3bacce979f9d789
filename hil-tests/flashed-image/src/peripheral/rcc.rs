//! Reset and clock control. RM0390 section 6: 6.2 (clocks, the security system in 6.2.7), 6.3 (registers).
//!
//! ```text
//! f(VCO)    = f(source) / PLLM * PLLN        source: HSI 16 MHz, HSE 8 MHz (the ST-LINK's)
//! f(PLL)    = f(VCO) / PLLP                  PLLP: 2, 4, 6, 8
//! SYSCLK    = HSI, HSE or PLL, by SW
//! HCLK      = SYSCLK / HPRE;  PCLK1 = HCLK / PPRE1;  PCLK2 = HCLK / PPRE2
//! timers of a bus run at PCLK where PPRE is 1, else at twice PCLK
//! ```
//!
//! Oscillators and PLL are ready as soon as they are on; their start-up times are not modelled. What a PLL does whose
//! source has failed, neither: the processor is taken to stand still.

use crate::register::{Words, Write};
use crate::time::{Ticks, cycle_of};

const CR: u32 = 0x00;
const PLLCFGR: u32 = 0x04;
const CFGR: u32 = 0x08;
const CIR: u32 = 0x0c;
const APB1RSTR: u32 = 0x20;
const APB2RSTR: u32 = 0x24;
const AHB1ENR: u32 = 0x30;
const APB1ENR: u32 = 0x40;
const APB2ENR: u32 = 0x44;
const CSR: u32 = 0x74;

const HSEON: u32 = 16;
const CSSON: u32 = 19;
const PLLON: u32 = 24;
const CSSF: u32 = 7;
const CSSC: u32 = 23;
const RMVF: u32 = 24;

const HSI_HZ: u64 = 16_000_000;
const HSE_HZ: u64 = 8_000_000;

/// Why the board was reset: flags of CSR.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The power came.
    Power,
    /// The independent watchdog.
    Watchdog,
    /// The program.
    Software,
}

impl Cause {
    /// The flags that it leaves: the pin's own is set by every reset.
    fn flags(self) -> u32 {
        const PIN: u32 = 1 << 26;
        PIN | match self {
            Cause::Power => 1 << 25 | 1 << 27,
            Cause::Watchdog => 1 << 29,
            Cause::Software => 1 << 28,
        }
    }
}

/// What the clocks are, ticks of a cycle each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clocks {
    /// Of the processor.
    pub core: Ticks,
    /// Of the peripherals on APB1.
    pub apb1: Ticks,
    /// Of the timers on APB1.
    pub apb1_timers: Ticks,
    /// Of the peripherals on APB2.
    pub apb2: Ticks,
}

/// A peripheral that has a clock gate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gate {
    /// On AHB1, by the number of its bit.
    Ahb1(u32),
    /// On APB1.
    Apb1(u32),
    /// On APB2.
    Apb2(u32),
}

/// The peripheral.
pub struct Rcc {
    words: Words<40>,
    /// The 8 MHz of the ST-LINK come.
    pub crystal: bool,
}

impl Rcc {
    /// After a reset.
    #[must_use]
    pub fn new(cause: Cause) -> Rcc {
        let values = [(CR, 0x83), (PLLCFGR, 0x2400_3010), (AHB1ENR, 0x0010_0000), (CSR, cause.flags())];
        Rcc { words: Words::after_reset(&values), crystal: true }
    }

    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        let value = self.words.get(offset);
        match offset {
            CR => {
                let ready = |on: u32, is: bool| u32::from(value >> on & 1 == 1 && is) << (on + 1);
                value & !(1 << (HSEON + 1) | 1 << (PLLON + 1))
                    | ready(HSEON, self.crystal)
                    | ready(PLLON, self.pll_hz().is_some())
            }
            // The switch follows at once.
            CFGR => value & !0xc | (value & 3) << 2,
            _ => value,
        }
    }

    /// Writes a register; the bits of a bus's reset register that were set by it.
    pub fn write(&mut self, write: Write) -> Option<Gate> {
        let old = self.words.get(write.offset);
        let value = self.words.keep(write);
        match write.offset {
            CSR if value >> RMVF & 1 == 1 => self.words.set(CSR, value & 0x00ff_ffff & !(1 << RMVF)),
            CIR if value >> CSSC & 1 == 1 => self.words.set(CIR, value & !(1 << CSSC | 1 << CSSF)),
            APB1RSTR => return newly_set(old, value).map(Gate::Apb1),
            APB2RSTR => return newly_set(old, value).map(Gate::Apb2),
            _ => {}
        }
        None
    }

    /// Whether a peripheral has its clock.
    #[must_use]
    pub fn is_clocked(&self, gate: Gate) -> bool {
        match gate {
            Gate::Ahb1(bit) => self.words.bit(AHB1ENR, bit),
            Gate::Apb1(bit) => self.words.bit(APB1ENR, bit),
            Gate::Apb2(bit) => self.words.bit(APB2ENR, bit),
        }
    }

    /// The crystal's clock fails. With the security system on, the processor goes on with its own oscillator, and
    /// the interrupt that cannot be masked comes: true.
    pub fn lose_crystal(&mut self) -> bool {
        self.crystal = false;
        if !self.words.bit(CR, CSSON) {
            return false;
        }
        self.words.put(CR, HSEON, false);
        self.words.put(CR, PLLON, false);
        self.words.put(CR, CSSON, false);
        self.words.set(CFGR, self.words.get(CFGR) & !3);
        self.words.put(CIR, CSSF, true);
        true
    }

    /// Whether the interrupt of the clock security system waits.
    #[must_use]
    pub fn tells_clock_loss(&self) -> bool {
        self.words.bit(CIR, CSSF)
    }

    /// The clocks; None: the processor stands still.
    #[must_use]
    pub fn clocks(&self) -> Option<Clocks> {
        let system = match self.words.field(CFGR, 0, 2) {
            0 => HSI_HZ,
            1 if self.crystal => HSE_HZ,
            2 => self.pll_hz()?,
            _ => return None,
        };
        let shift = [1, 2, 3, 4, 6, 7, 8, 9][self.words.field(CFGR, 4, 3) as usize];
        let ahb = if self.words.bit(CFGR, 7) { system >> shift } else { system };
        let divided = |low: u32| {
            let prescaler = self.words.field(CFGR, low, 3);
            if prescaler < 4 { (ahb, ahb) } else { (ahb >> (prescaler - 3), ahb >> (prescaler - 4)) }
        };
        let ((apb1, apb1_timers), (apb2, _)) = (divided(10), divided(13));
        Some(Clocks {
            core: cycle_of(ahb)?,
            apb1: cycle_of(apb1)?,
            apb1_timers: cycle_of(apb1_timers)?,
            apb2: cycle_of(apb2)?,
        })
    }

    fn pll_hz(&self) -> Option<u64> {
        let of_crystal = self.words.bit(PLLCFGR, 22);
        let source = if of_crystal { HSE_HZ } else { HSI_HZ };
        let runs = self.words.bit(CR, PLLON) && (self.crystal || !of_crystal);
        let field = |low, bits| u64::from(self.words.field(PLLCFGR, low, bits));
        let (m, n, p) = (field(0, 6), field(6, 9), 2 * field(16, 2) + 2);
        (runs && m > 1).then(|| source / m * n / p)
    }
}

fn newly_set(old: u32, new: u32) -> Option<u32> {
    let set = new & !old;
    (set != 0).then(|| set.trailing_zeros())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The board's: 8 MHz / 4 * 180 / 2 = 180 MHz, APB1 a quarter, APB2 half of it.
    fn running() -> Rcc {
        let mut rcc = Rcc::new(Cause::Power);
        let on = 1 << HSEON | 1 << PLLON | 1 << CSSON;
        for (offset, value) in [(PLLCFGR, 4 | 180 << 6 | 1 << 22), (CR, on), (CFGR, 2 | 5 << 10 | 4 << 13)] {
            let _ = rcc.write(Write::of(offset, 4, value));
        }
        rcc
    }

    #[test]
    fn the_boards_clocks_are_180_45_and_90_mhz() {
        let clocks = Clocks { core: 4, apb1: 16, apb1_timers: 8, apb2: 8 };
        assert_eq!(running().clocks(), Some(clocks));
        assert_eq!(running().read(CFGR) >> 2 & 3, 2, "the switch is where it was set");
    }

    #[test]
    fn a_lost_crystal_stops_the_processor_unless_the_security_system_watches() {
        let mut watched = running();
        assert!(watched.lose_crystal() && watched.tells_clock_loss());
        assert_eq!(watched.clocks().map(|clocks| clocks.core), Some(45), "16 MHz of its own");
        let mut unwatched = running();
        let _ = unwatched.write(Write::of(CR, 4, 1 << HSEON | 1 << PLLON));
        assert!(!unwatched.lose_crystal());
        assert_eq!(unwatched.clocks(), None);
        assert_eq!(unwatched.read(CR) >> 17 & 1, 0, "not ready");
    }
}
