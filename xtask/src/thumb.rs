//! The Thumb-2 instructions of a section, as far as the verdict on an image needs them (Arm
//! Architecture Reference Manual ARMv7-M, A5.1 and A5.3).
//!
//! Literal pools and jump tables lie between the instructions. Mapping symbols distinguish them (ELF for the Arm
//! Architecture, 5.5.5): `$t` begins code, `$d` begins data.

/// The kind of the bytes from an address on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Instructions.
    Code,
    /// A literal pool or a jump table.
    Data,
}

/// A mapping symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Its address.
    pub address: u32,
    /// The kind that begins there.
    pub content: Content,
}

impl Mark {
    /// The mark that a symbol is, if it is one: `$t`, `$d`, each also with a suffix (`$t.3`).
    #[must_use]
    pub fn from_symbol(name: &str, address: u32) -> Option<Mark> {
        let content = match name.split('.').next()? {
            "$t" => Content::Code,
            "$d" => Content::Data,
            _ => return None,
        };
        Some(Mark { address, content })
    }
}

/// One instruction: a halfword or two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// Its address.
    pub address: u32,
    /// Its first halfword.
    pub first: u16,
    /// Its second halfword, when it has 32 bits.
    pub second: Option<u16>,
}

impl Instruction {
    /// Whether it belongs to the floating-point extension: coprocessor 10 or 11.
    #[must_use]
    pub fn is_float(&self) -> bool {
        let coprocessor = self.first & 0xEC00 == 0xEC00;
        coprocessor && self.second.is_some_and(|second| second & 0x0E00 == 0x0A00)
    }

    /// Whether it goes where a register says, other than back to the caller: BLX or BX.
    #[must_use]
    pub fn is_indirect_call(&self) -> bool {
        let register = self.first >> 3 & 0xF;
        self.second.is_none() && self.first & 0xFF07 == 0x4700 && (register != 14 || self.first & 0x80 != 0)
    }

    /// Whether it is a BL.
    #[must_use]
    pub fn is_call(&self) -> bool {
        self.first & 0xF800 == 0xF000 && self.second.is_some_and(|second| second & 0xD000 == 0xD000)
    }

    /// Where a BL goes, or a B that always goes (a tail call, or a jump inside a function).
    #[must_use]
    pub fn call_target(&self) -> Option<u32> {
        let Some(second) = self.second else { return self.short_target() };
        if self.first & 0xF800 != 0xF000 || second & 0x9000 != 0x9000 {
            return None;
        }
        let bit = |halfword: u16, place: u32| u32::from(halfword >> place & 1);
        let sign = bit(self.first, 10);
        let i1 = 1 ^ bit(second, 13) ^ sign;
        let i2 = 1 ^ bit(second, 11) ^ sign;
        let high = sign << 24 | i1 << 23 | i2 << 22;
        let offset = high | u32::from(self.first & 0x3FF) << 12 | u32::from(second & 0x7FF) << 1;
        // 25 bits, two's complement.
        let extended = (offset << 7).cast_signed() >> 7;
        Some(self.address.wrapping_add(4).wrapping_add_signed(extended))
    }

    fn short_target(&self) -> Option<u32> {
        let offset = (i32::from(self.first & 0x7FF) << 21) >> 20;
        (self.first & 0xF800 == 0xE000).then(|| self.address.wrapping_add(4).wrapping_add_signed(offset))
    }
}

/// The instructions of a section that starts at `address`. `marks` are in order of address. Bytes before the first
/// mark count as code, so that nothing is overlooked.
#[must_use]
pub fn instructions(address: u32, bytes: &[u8], marks: &[Mark]) -> Vec<Instruction> {
    let halfword = |index: usize| {
        let pair = bytes.get(index..index + 2)?;
        Some(u16::from_le_bytes([pair[0], pair[1]]))
    };
    let mut found = Vec::new();
    let mut index = 0;
    while let Some(first) = halfword(index) {
        let here = address + index as u32;
        index += 2;
        if content(marks, here) == Content::Data {
            continue;
        }
        let second = if first >= 0xE800 { halfword(index) } else { None };
        index += if second.is_some() { 2 } else { 0 };
        found.push(Instruction { address: here, first, second });
    }
    found
}

fn content(marks: &[Mark], address: u32) -> Content {
    let passed = marks.partition_point(|mark| mark.address <= address);
    marks[..passed].last().map_or(Content::Code, |mark| mark.content)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOP: u16 = 0xBF00;
    const VADD_F32_S0_S0_S1: [u16; 2] = [0xEE30, 0x0A20];
    const VLDR_S0_R0: [u16; 2] = [0xED90, 0x0A00];
    const LDR_W_R0_R1: [u16; 2] = [0xF8D1, 0x0000];
    const MRC_P15: [u16; 2] = [0xEE11, 0x0F10];

    fn decode(address: u32, halfwords: &[u16], marks: &[Mark]) -> Vec<Instruction> {
        let bytes: Vec<u8> = halfwords.iter().flat_map(|halfword| halfword.to_le_bytes()).collect();
        instructions(address, &bytes, marks)
    }

    fn floats(halfwords: &[u16], marks: &[Mark]) -> Vec<u32> {
        decode(0x100, halfwords, marks).iter().filter(|i| i.is_float()).map(|i| i.address).collect()
    }

    #[test]
    fn arithmetic_and_loads_of_the_float_unit_are_found() {
        let [add, add_2] = VADD_F32_S0_S0_S1;
        let [load, load_2] = VLDR_S0_R0;
        assert_eq!(floats(&[NOP, add, add_2, NOP, load, load_2], &[]), [0x102, 0x108]);
    }

    #[test]
    fn integer_instructions_and_other_coprocessors_are_not() {
        let [load, load_2] = LDR_W_R0_R1;
        let [read, read_2] = MRC_P15;
        assert_eq!(floats(&[0x4800, load, load_2, read, read_2], &[]), [0; 0]);
    }

    #[test]
    fn a_second_halfword_is_not_taken_for_a_first() {
        // ldr.w r0, [r1, #...] whose second halfword looks like the first of a vadd.
        let [load, _] = LDR_W_R0_R1;
        let [looks_like, second] = VADD_F32_S0_S0_S1;
        assert_eq!(floats(&[load, looks_like, second], &[]), [0; 0]);
    }

    #[test]
    fn a_literal_pool_is_skipped_and_the_code_after_it_is_not() {
        let [add, add_2] = VADD_F32_S0_S0_S1;
        let marks = [
            Mark { address: 0x100, content: Content::Code },
            Mark { address: 0x102, content: Content::Data },
            Mark { address: 0x106, content: Content::Code },
        ];
        assert_eq!(floats(&[NOP, add, add_2, add, add_2], &marks), [0x106]);
    }

    #[test]
    fn an_instruction_cut_off_at_the_end_is_no_float() {
        assert_eq!(floats(&[VADD_F32_S0_S0_S1[0]], &[]), [0; 0]);
    }

    #[test]
    fn calls_and_tail_calls_tell_where_they_go() {
        let target = |address, halfwords: &[u16]| decode(address, halfwords, &[])[0].call_target();
        assert_eq!(target(0x1000, &[0xF000, 0xF802]), Some(0x1008), "bl forward");
        assert_eq!(target(0x1000, &[0xF7FF, 0xFFFE]), Some(0x1000), "bl to itself");
        assert_eq!(target(0x1000, &[0xF000, 0xB802]), Some(0x1008), "b.w");
        assert_eq!(target(0x1000, &[0xE002]), Some(0x1008), "b forward");
        assert_eq!(target(0x1000, &[0xE7FE]), Some(0x1000), "b to itself");
        assert_eq!(target(0x1000, &LDR_W_R0_R1), None);
        let is_call = |halfwords: &[u16]| decode(0x1000, halfwords, &[])[0].is_call();
        assert!(is_call(&[0xF000, 0xF802]) && is_call(&[0xF7FF, 0xFFFE]), "bl");
        assert!(!is_call(&[0xF000, 0xB802]) && !is_call(&[0xE002]) && !is_call(&LDR_W_R0_R1));
    }

    #[test]
    fn calls_by_register_are_told_from_returns() {
        let indirect = |first| decode(0x1000, &[first], &[])[0].is_indirect_call();
        assert!(indirect(0x4798), "blx r3");
        assert!(indirect(0x4718), "bx r3");
        assert!(!indirect(0x4770), "bx lr");
        assert!(!indirect(NOP));
    }

    #[test]
    fn mapping_symbols_are_told_from_others() {
        let content = |name| Mark::from_symbol(name, 0).map(|mark| mark.content);
        assert_eq!((content("$t"), content("$t.12")), (Some(Content::Code), Some(Content::Code)));
        assert_eq!((content("$d"), content("$d.0")), (Some(Content::Data), Some(Content::Data)));
        assert_eq!((content("$tail"), content("probe_sample")), (None, None));
    }
}
