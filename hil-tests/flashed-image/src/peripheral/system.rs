//! The private peripherals of the processor. PM0214 section 2.3 (exceptions), 4.3 (interrupt controller), 4.4 (system control
//! block); RM0390 section 10.2 (vectors); the cycle counter of the debug unit (DWT).
//!
//! ```text
//! an exception is taken when its priority is above (a smaller number than) that of what runs, and
//! PRIMASK is 0 and BASEPRI is 0 or above its number; the two faults and NMI do not ask
//! ```
//!
//! Priorities have four bits. There is no sub-priority: AIRCR keeps its value of the reset.

use crate::register::{Words, Write};
use crate::time::Ticks;

/// Where the block of the system control space is.
pub const START: u32 = 0xe000_e000;
/// Where the debug unit's counter is.
pub const DWT: u32 = 0xe000_1000;

const ISER: u32 = 0x100;
const ICER: u32 = 0x180;
const IPR: u32 = 0x400;
const CPUID: u32 = 0xd00;
const VTOR: u32 = 0xd08;
const AIRCR: u32 = 0xd0c;
const DHCSR: u32 = 0xdf0;

/// A write to AIRCR that resets: the key, and SYSRESETREQ.
const RESET: u32 = 0x05fa_0004;

/// Clock security system.
pub const NMI: u32 = 2;
/// Any fault of the processor.
pub const HARD_FAULT: u32 = 3;
/// The first exception of a peripheral.
pub const INTERRUPTS: u32 = 16;
/// TIM5's interrupt.
pub const TIM5: u32 = 50;

/// What masks interrupts: PRIMASK, BASEPRI.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    /// Interrupts are disabled.
    pub primask: bool,
    /// Interrupts of this number and above are disabled; 0: none.
    pub basepri: u8,
}

/// The controller and the control block.
pub struct System {
    words: Words<1024>,
    enabled: [u32; 8],
    /// Exceptions that have begun and not returned, the last one last.
    active: Vec<u32>,
    cycle_counter: bool,
}

impl Default for System {
    fn default() -> System {
        let words = Words::after_reset(&[(CPUID, 0x410f_c241), (AIRCR, 0xfa05_0000)]);
        System { words, enabled: [0; 8], active: Vec::new(), cycle_counter: false }
    }
}

impl System {
    /// A register, its offset that from 0xE000_E000 on.
    #[must_use]
    pub fn read(&self, offset: u32) -> u32 {
        match offset {
            ISER..0x120 => self.enabled[(offset - ISER) as usize / 4],
            ICER..0x1a0 => self.enabled[(offset - ICER) as usize / 4],
            // Nobody debugs.
            DHCSR => 0,
            _ => self.words.get(offset),
        }
    }

    /// Writes a register; whether that resets the board.
    pub fn write(&mut self, write: Write) -> bool {
        match write.offset {
            ISER..0x120 => self.enabled[(write.offset - ISER) as usize / 4] |= write.value,
            ICER..0x1a0 => self.enabled[(write.offset - ICER) as usize / 4] &= !write.value,
            CPUID => {}
            AIRCR => return write.value & RESET == RESET,
            _ => {
                self.words.keep(write);
            }
        }
        false
    }

    /// The cycle counter's registers, at the processor's cycle.
    #[must_use]
    pub fn read_counter(&self, offset: u32, now: Ticks, cycle: Ticks) -> u32 {
        match offset {
            0 => 0x4000_0000 | u32::from(self.cycle_counter),
            4 if self.cycle_counter => (now / cycle) as u32,
            _ => 0,
        }
    }

    /// Writes one of them.
    pub fn write_counter(&mut self, write: Write) {
        if write.offset == 0 {
            self.cycle_counter = write.value & 1 == 1;
        }
    }

    /// Where the vectors stand.
    #[must_use]
    pub fn vectors(&self) -> u32 {
        self.words.get(VTOR)
    }

    /// The exception that is taken next, if the clock security system (`nmi`) or TIM5 asks for one.
    #[must_use]
    pub fn next(&self, nmi: bool, timer: bool, mask: Mask) -> Option<u32> {
        let running = self.active.iter().map(|&active| self.priority(active)).min().unwrap_or(256);
        if nmi && self.priority(NMI) < running {
            return Some(NMI);
        }
        let enabled = timer && self.enabled[TIM5 as usize / 32] >> (TIM5 % 32) & 1 == 1;
        let priority = self.priority(INTERRUPTS + TIM5);
        let masked = mask.primask || (mask.basepri > 0 && priority >= i32::from(mask.basepri));
        (enabled && !masked && priority < running).then_some(INTERRUPTS + TIM5)
    }

    /// An exception begins; false: the processor locks up, since it is a fault in the handling of one.
    pub fn begin(&mut self, exception: u32) -> bool {
        let locks_up = exception == HARD_FAULT && self.active.iter().any(|&active| active <= HARD_FAULT);
        self.active.push(exception);
        !locks_up
    }

    /// The last exception that has begun returns.
    pub fn end(&mut self) {
        self.active.pop();
    }

    /// The exception that runs; 0: none.
    #[must_use]
    pub fn running(&self) -> u32 {
        self.active.last().copied().unwrap_or(0)
    }

    fn priority(&self, exception: u32) -> i32 {
        match exception {
            NMI => -2,
            HARD_FAULT => -1,
            _ => {
                let number = exception.saturating_sub(INTERRUPTS);
                (self.words.field(IPR + (number & !3), 8 * (number % 4), 8) & 0xf0).cast_signed()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPEN: Mask = Mask { primask: false, basepri: 0 };

    fn enabled() -> System {
        let mut system = System::default();
        system.write(Write::of(ISER + 4, 4, 1 << 18));
        system.write(Write::of(IPR + TIM5, 1, 0x10));
        system
    }

    #[test]
    fn an_interrupt_waits_for_its_enable_and_for_the_masks() {
        let system = enabled();
        let taken = |mask| system.next(false, true, mask);
        assert_eq!(taken(OPEN), Some(INTERRUPTS + TIM5));
        assert_eq!(taken(Mask { primask: true, ..OPEN }), None);
        assert_eq!(taken(Mask { basepri: 0x10, ..OPEN }), None);
        assert_eq!(taken(Mask { basepri: 0x20, ..OPEN }), Some(INTERRUPTS + TIM5));
        assert_eq!(System::default().next(false, true, OPEN), None);
    }

    #[test]
    fn an_interrupt_does_not_interrupt_itself_and_the_clock_security_system_interrupts_all() {
        let mut system = enabled();
        assert!(system.begin(INTERRUPTS + TIM5));
        assert_eq!(system.next(false, true, OPEN), None);
        assert_eq!(system.next(true, true, Mask { primask: true, ..OPEN }), Some(NMI));
        system.end();
        assert_eq!(system.next(false, true, OPEN), Some(INTERRUPTS + TIM5));
    }

    #[test]
    fn a_fault_in_a_fault_locks_up() {
        let mut system = enabled();
        assert!(system.begin(HARD_FAULT));
        assert!(!system.begin(HARD_FAULT));
    }

    #[test]
    fn the_program_resets_the_board_by_key() {
        let mut system = System::default();
        assert!(!system.write(Write::of(AIRCR, 4, 4)));
        assert!(system.write(Write::of(AIRCR, 4, 0x05fa_0004)));
    }
}
