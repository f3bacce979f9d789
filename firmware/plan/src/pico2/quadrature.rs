//! The program of the state machine (PIO) that counts the encoder's edges. RP2350 data sheet, chapter 11.
//!
//! It stands at address 0. The two levels of the last look and those of the present one, four bits, are the address that
//! it goes to: a table of 16 jumps. A ahead of B counts up, all four edges of a period count, and both tracks at once set
//! flag 0: an edge was missed, so the count is wrong from then on. Every round offers the count to the processor.
//!
//! ```text
//! levels B A    00 -> 01 -> 11 -> 10 -> 00   up
//! register Y    the count
//! register OSR  the levels of the last look, in its two lowest bits
//! ```
//!
//! A round takes 10 cycles at most. Shift directions: in to the left, out to the right.

use pio::{
    Instruction, InstructionOperands, MovDestination, MovOperation, MovSource, Program,
    RP2040_MAX_PROGRAM_SIZE, SetDestination,
};

/// The most cycles from one look at the tracks to the next.
pub const CYCLES_A_ROUND: u32 = 10;

/// The flag that a missed edge sets.
pub const MISSED: u8 = 0;

/// The program.
#[must_use]
pub fn program() -> Program<RP2040_MAX_PROGRAM_SIZE> {
    let assembled = pio::pio_asm!(
        ".origin 0",
        "    jmp look",   // 00 -> 00
        "    jmp up",     // 00 -> 01
        "    jmp down",   // 00 -> 10
        "    jmp missed", // 00 -> 11
        "    jmp down",   // 01 -> 00
        "    jmp look",   // 01 -> 01
        "    jmp missed", // 01 -> 10
        "    jmp up",     // 01 -> 11
        "    jmp up",     // 10 -> 00
        "    jmp missed", // 10 -> 01
        "    jmp look",   // 10 -> 10
        "    jmp down",   // 10 -> 11
        "    jmp missed", // 11 -> 00
        "    jmp down",   // 11 -> 01
        "    jmp up",     // 11 -> 10
        "    jmp look",   // 11 -> 11
        "missed:",
        "    irq nowait 0",
        "    jmp look",
        "down:",
        "    jmp y-- look", // Counts down and goes to the next instruction, whether Y was 0 or not.
        ".wrap_target",
        "look:",
        "    mov isr, y",
        "    push noblock",
        "    out isr, 2",   // The levels of the last look,
        "    in pins, 2",   // and those of this one:
        "    mov osr, isr", // remembered,
        "    mov pc, isr",  // and gone to.
        "up:",
        "    mov y, ~y", // There is no instruction that counts up: -(-y - 1) = y + 1, and ~y = -y - 1.
        "    jmp y-- still_up",
        "still_up:",
        "    mov y, ~y",
        ".wrap",
    );
    assembled.program
}

/// What the state machine carries out before the program: the levels that it finds are no edge, and the count is 0.
#[must_use]
pub fn first_look() -> [Instruction; 2] {
    let (op, source) = (MovOperation::None, MovSource::PINS);
    let levels = InstructionOperands::MOV { destination: MovDestination::OSR, op, source };
    let count = InstructionOperands::SET { destination: SetDestination::Y, data: 0 };
    [levels, count].map(|operands| Instruction { operands, delay: 0, side_set: None })
}

#[cfg(test)]
mod tests {
    extern crate std;

    use pio::{InSource, InstructionOperands as Operands, JmpCondition};
    use std::vec::Vec;

    use super::*;

    /// A state machine with these levels at its pins: only the instructions of the program.
    struct Machine {
        code: Vec<Operands>,
        wrap: (u8, u8),
        pc: u8,
        y: u32,
        isr: u32,
        osr: u32,
        levels: u32,
        offered: Option<u32>,
        missed: bool,
    }

    impl Machine {
        /// As the board starts it; what it had counted before is anything.
        fn new(levels: u32) -> Machine {
            let program = program();
            let code = program.code.iter().map(|&word| Operands::decode(word).expect("an instruction"));
            let wrap = (program.wrap.target, program.wrap.source);
            let code = code.collect();
            let (y, isr, osr, offered, missed) = (77, 0, 0b1001, None, false);
            let mut machine = Machine { code, wrap, pc: wrap.0, y, isr, osr, levels, offered, missed };
            first_look().into_iter().for_each(|instruction| machine.carry_out(instruction.operands));
            machine
        }

        fn source(&self, source: MovSource) -> u32 {
            match source {
                MovSource::Y => self.y,
                MovSource::ISR => self.isr,
                MovSource::PINS => self.levels,
                other => panic!("{other:?}"),
            }
        }

        fn step(&mut self) {
            let at = self.pc;
            self.pc = if at == self.wrap.1 { self.wrap.0 } else { at + 1 };
            self.carry_out(self.code[usize::from(at)]);
        }

        fn carry_out(&mut self, operands: Operands) {
            match operands {
                Operands::JMP { condition: JmpCondition::Always, address } => self.pc = address,
                Operands::JMP { condition: JmpCondition::YDecNonZero, address } => {
                    if self.y != 0 {
                        self.pc = address;
                    }
                    self.y = self.y.wrapping_sub(1);
                }
                Operands::MOV { destination, op, source } => self.mov(destination, op, source),
                Operands::PUSH { if_full: false, block: false } => self.offered = Some(self.isr),
                Operands::OUT { destination: pio::OutDestination::ISR, bit_count: 2 } => {
                    self.isr = self.osr & 3;
                    self.osr >>= 2;
                }
                Operands::IN { source: InSource::PINS, bit_count: 2 } => {
                    self.isr = self.isr << 2 | self.levels
                }
                Operands::SET { destination: SetDestination::Y, data } => self.y = u32::from(data),
                Operands::IRQ { clear: false, wait: false, index: MISSED, .. } => self.missed = true,
                other => panic!("{other:?}"),
            }
        }

        fn mov(&mut self, destination: MovDestination, op: MovOperation, source: MovSource) {
            let value = self.source(source);
            let value = if matches!(op, MovOperation::Invert) { !value } else { value };
            match destination {
                MovDestination::Y => self.y = value,
                MovDestination::ISR => self.isr = value,
                MovDestination::OSR => self.osr = value,
                MovDestination::PC => self.pc = (value & 31) as u8,
                other => panic!("{other:?}"),
            }
        }

        /// The count after the levels have stood for two rounds.
        fn count(&mut self, levels: u32) -> i32 {
            self.levels = levels;
            (0..2 * CYCLES_A_ROUND).for_each(|_| self.step());
            self.offered.expect("every round offers the count").cast_signed()
        }
    }

    /// The levels B A at a position, quarters of a period.
    fn levels(position: i32) -> u32 {
        [0b00, 0b01, 0b11, 0b10][position.rem_euclid(4) as usize]
    }

    #[test]
    fn every_edge_counts_up_or_down_through_0_from_any_level() {
        for start in 0..4 {
            let mut machine = Machine::new(levels(start));
            let path = (1..=9).chain((-9..9).rev()).chain(-9..=0);
            for position in path {
                let count = machine.count(levels(start + position));
                assert_eq!(count, position, "from {start}");
            }
            assert!(!machine.missed);
        }
    }

    #[test]
    fn tracks_that_stand_count_nothing() {
        let mut machine = Machine::new(0b01);
        assert!((0..100).all(|_| machine.count(0b01) == 0));
    }

    #[test]
    fn a_spike_on_one_track_counts_there_and_back() {
        let mut machine = Machine::new(0b00);
        assert_eq!((machine.count(0b10), machine.count(0b00)), (-1, 0));
        assert!(!machine.missed);
    }

    #[test]
    fn both_tracks_at_once_are_an_edge_that_was_missed() {
        for (from, to) in [(0b00, 0b11), (0b11, 0b00), (0b01, 0b10), (0b10, 0b01)] {
            let mut machine = Machine::new(from);
            assert_eq!(machine.count(to), 0);
            assert!(machine.missed, "{from:b} -> {to:b}");
        }
    }

    #[test]
    fn no_round_is_longer_than_it_is_said_to_be() {
        for step in [1, -1] {
            let (mut machine, mut position, mut since_look) = (Machine::new(0), 0, 0);
            for _ in 0..1000 {
                let looks = machine.pc == program().wrap.target;
                if looks {
                    assert!(since_look <= CYCLES_A_ROUND, "{since_look} cycles");
                    position += step;
                    (machine.levels, since_look) = (levels(position), 0);
                }
                machine.step();
                since_look += 1;
            }
        }
    }

    #[test]
    fn the_program_fits_the_memory_of_its_state_machine_and_stands_at_0() {
        let program = program();
        assert!(program.code.len() <= RP2040_MAX_PROGRAM_SIZE, "{}", program.code.len());
        assert_eq!(program.origin, Some(0));
    }
}
