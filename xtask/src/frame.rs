//! The stack that instructions use (Arm Architecture Reference Manual ARMv7-M, A7.7).

use crate::thumb::Instruction;

/// The stack use of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// This many bytes; 0 for an instruction that takes none, or frees some.
    Bytes(u32),
    /// The value of a register.
    Unknown,
}

impl Taken {
    /// PUSH, STR and STRD below the stack pointer, VPUSH, and the stack pointer less a number.
    #[must_use]
    pub fn by(instruction: &Instruction) -> Taken {
        let first = u32::from(instruction.first);
        match instruction.second {
            None => by_halfword(first),
            Some(second) => by_word(first, u32::from(second)),
        }
    }
}

fn by_halfword(first: u32) -> Taken {
    match first {
        0xB400..=0xB5FF => Taken::Bytes(4 * (first & 0x1FF).count_ones()),
        0xB080..=0xB0FF => Taken::Bytes(4 * (first & 0x7F)),
        // mov sp, rN
        _ if first & 0xFF87 == 0x4685 => Taken::Unknown,
        _ => Taken::Bytes(0),
    }
}

fn by_word(first: u32, second: u32) -> Taken {
    // Where the result goes, or how an address is formed; D is the stack pointer there, or "below, and kept".
    let place = second >> 8 & 0xF;
    match (first, place) {
        (0xE92D, _) => Taken::Bytes(4 * second.count_ones()),
        (0xE96D, _) => Taken::Bytes(4 * (second & 0xFF)),
        (0xF84D, 0xD) => Taken::Bytes(second & 0xFF),
        (0xED2D | 0xED6D, 0xA | 0xB) => Taken::Bytes(4 * (second & 0xFF)),
        (0xEBAD | 0xEBBD, 0xD) => Taken::Unknown,
        // sub.w sp, sp, #modified and subw sp, sp, #plain
        (0xF1AD | 0xF5AD, 0xD) => Taken::Bytes(expanded(immediate(first, second))),
        (0xF2AD | 0xF6AD, 0xD) => Taken::Bytes(immediate(first, second)),
        _ => Taken::Bytes(0),
    }
}

/// The twelve bits i:imm3:imm8 of an instruction.
fn immediate(first: u32, second: u32) -> u32 {
    (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF
}

/// The number that twelve bits stand for (A5.3.2): bytes repeated, or eight bits turned to their place.
fn expanded(bits: u32) -> u32 {
    let byte = bits & 0xFF;
    match bits >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte * 0x0101_0101,
        _ => (0x80 | bits & 0x7F).rotate_right(bits >> 7),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(first: u16, second: Option<u16>) -> Taken {
        Taken::by(&Instruction { address: 0x1000, first, second })
    }

    #[test]
    fn what_is_pushed_is_taken() {
        assert_eq!(taken(0xB5F0, None), Taken::Bytes(20), "push {{r4, r5, r6, r7, lr}}");
        assert_eq!(taken(0xE92D, Some(0x0F00)), Taken::Bytes(16), "push.w {{r8, r9, r10, r11}}");
        assert_eq!(taken(0xF84D, Some(0xBD04)), Taken::Bytes(4), "str r11, [sp, #-4]!");
        assert_eq!(taken(0xE96D, Some(0x0104)), Taken::Bytes(16), "strd r0, r1, [sp, #-16]!");
        assert_eq!(taken(0xED2D, Some(0x8B04)), Taken::Bytes(16), "vpush {{d8, d9}}");
    }

    #[test]
    fn what_the_stack_pointer_is_lowered_by_is_taken() {
        assert_eq!(taken(0xB093, None), Taken::Bytes(76), "sub sp, #76");
        assert_eq!(taken(0xF5AD, Some(0x6D80)), Taken::Bytes(1024), "sub.w sp, sp, #1024");
        assert_eq!(taken(0xF1AD, Some(0x0D08)), Taken::Bytes(8), "sub.w sp, sp, #8");
        assert_eq!(taken(0xF2AD, Some(0x6D24)), Taken::Bytes(0x624), "subw sp, sp, #1572");
    }

    #[test]
    fn what_is_given_back_or_only_written_is_not_taken() {
        for (first, second) in [
            (0xB013, None),         // add sp, #76
            (0xBDF0, None),         // pop {r4, r5, r6, r7, pc}
            (0xE8BD, Some(0x0F00)), // pop.w {r8, r9, r10, r11}
            (0xF85D, Some(0xBB04)), // ldr r11, [sp], #4
            (0xF8CD, Some(0xB004)), // str.w r11, [sp, #4]
            (0xF1AD, Some(0x0008)), // sub.w r0, sp, #8
            (0x466F, None),         // mov r7, sp
        ] {
            assert_eq!(taken(first, second), Taken::Bytes(0), "{first:x} {second:x?}");
        }
    }

    #[test]
    fn what_a_register_says_is_not_known() {
        assert_eq!(taken(0x46A5, None), Taken::Unknown, "mov sp, r4");
        assert_eq!(taken(0xEBAD, Some(0x0D00)), Taken::Unknown, "sub.w sp, sp, r0");
    }
}
