//! Models of the chips on SPI, bit by bit, after their data sheets, which the drivers name
//! (`pneudrive_interfaces::chip`). They know nothing of the drivers.

use super::Chip;
use super::bus::{ChipModel, Limits};
use super::wires::Wires;
use crate::converter::{code_of, output_v};

/// MCP4922, converter A.
pub struct Mcp4922 {
    pub wires: Wires,
    shifted: u32,
    clocks: u32,
}

impl Mcp4922 {
    pub fn new(wires: Wires) -> Mcp4922 {
        Mcp4922 { wires, shifted: 0, clocks: 0 }
    }
}

impl ChipModel for Mcp4922 {
    const CHIP: Chip = Chip::Mcp4922;

    /// In mode 0 nothing is asked for between select and clock.
    const LIMITS: Limits = Limits { high_ns: 15, idle_ns: 40, setup_ns: 0, hold_ns: 15, half_clock_ns: 15 };

    fn select(&mut self) {
        (self.shifted, self.clocks) = (0, 0);
    }

    /// Clocks beyond the sixteenth are ignored; there is no output.
    fn clock(&mut self, input: bool) -> bool {
        if self.clocks < 16 {
            self.shifted = self.shifted << 1 | u32::from(input);
            self.clocks += 1;
        }
        true
    }

    /// A frame that was cut short is ignored.
    fn deselect(&mut self) {
        let is_for_b = self.shifted >> 15 & 1 == 1;
        if self.clocks < 16 || is_for_b {
            return;
        }
        let gain = if self.shifted >> 13 & 1 == 1 { 1.0 } else { 2.0 };
        let active = self.shifted >> 12 & 1 == 1;
        let volts = gain * output_v((self.shifted & 0xfff) as u16);
        self.wires.borrow_mut().command_v = active.then_some(volts);
    }
}

/// MCP3208 with pressure 1, pressure 2 and spool at channels 0, 1 and 2; the others are at ground.
pub struct Mcp3208 {
    pub wires: Wires,
    /// Clocks since the start bit, that one included; 0 before it.
    clocks: u32,
    single_ended: bool,
    channel: usize,
    code: u16,
}

impl Mcp3208 {
    pub fn new(wires: Wires) -> Mcp3208 {
        Mcp3208 { wires, clocks: 0, single_ended: false, channel: 0, code: 0 }
    }

    /// The code of the voltage at the channel.
    fn converted(&self) -> u16 {
        let volts = self.wires.borrow().sensors_v.get(self.channel).copied().unwrap_or(0.0);
        if self.single_ended { code_of(volts) } else { 0 }
    }
}

impl ChipModel for Mcp3208 {
    const CHIP: Chip = Chip::Mcp3208;

    const LIMITS: Limits = Limits { high_ns: 500, idle_ns: 0, setup_ns: 100, hold_ns: 0, half_clock_ns: 250 };

    fn select(&mut self) {
        (self.clocks, self.channel) = (0, 0);
    }

    /// Start bit, S, D2, D1, D0, the end of the sample, the null bit, B11 to B0, B1 to B11, zeros.
    fn clock(&mut self, input: bool) -> bool {
        if self.clocks > 0 || input {
            self.clocks += 1;
        }
        match self.clocks {
            2 => self.single_ended = input,
            3..=5 => self.channel = self.channel << 1 | usize::from(input),
            6 => self.code = self.converted(),
            7 => return false,
            clock @ 8..=19 => return self.code >> (19 - clock) & 1 == 1,
            clock @ 20..=30 => return self.code >> (clock - 19) & 1 == 1,
            31.. => return false,
            _ => {}
        }
        true
    }

    fn deselect(&mut self) {}
}

/// LS7366R: its instruction, and the registers that a drive uses.
#[derive(Default)]
pub struct Ls7366r {
    mode_0: u8,
    mode_1: u8,
    count: u32,
    /// Clocks since the chip select fell, and the bits that came with them.
    clocks: u32,
    shifted: u64,
    output: u64,
    tracks: [bool; 2],
}

impl Ls7366r {
    /// An edge of the encoder. Four counts a period: A ahead of B counts up.
    pub fn see(&mut self, tracks: [bool; 2]) {
        let phase = |[a, b]: [bool; 2]| u32::from(b) << 1 | u32::from(a != b);
        let turned = phase(tracks).wrapping_sub(phase(self.tracks)) & 3;
        self.tracks = tracks;
        if self.mode_0 & 3 == 3 && self.mode_1 & 4 == 0 {
            self.count = match turned {
                1 => self.count.wrapping_add(1),
                3 => self.count.wrapping_sub(1),
                _ => self.count,
            };
        }
    }

    /// The power goes and comes: all registers are cleared.
    pub fn lose_power(&mut self) {
        *self = Ls7366r { tracks: self.tracks, ..Ls7366r::default() };
    }

    /// An instruction is complete: what it reads goes to the output, most significant bit first.
    fn instruct(&mut self, instruction: u8) {
        match instruction & 0xf8 {
            0x08 => self.mode_0 = 0,
            0x10 => self.mode_1 = 0,
            0x20 => self.count = 0,
            0x48 => self.output = u64::from(self.mode_0) << 56,
            0x50 => self.output = u64::from(self.mode_1) << 56,
            // The width of the counter is in the lowest bits of MDR1: 0 is four bytes.
            0x60 if self.mode_1 & 3 == 0 => self.output = u64::from(self.count) << 32,
            _ => {}
        }
    }
}

impl ChipModel for Ls7366r {
    const CHIP: Chip = Chip::Ls7366r;

    /// Half a clock of 4 MHz for each, as the sheet's table was not at hand.
    const LIMITS: Limits =
        Limits { high_ns: 125, idle_ns: 125, setup_ns: 125, hold_ns: 125, half_clock_ns: 125 };

    fn select(&mut self) {
        (self.clocks, self.shifted, self.output) = (0, 0, 0);
    }

    fn clock(&mut self, input: bool) -> bool {
        let output = self.output >> 63 == 1;
        self.output <<= 1;
        self.shifted = self.shifted << 1 | u64::from(input);
        self.clocks += 1;
        if self.clocks == 8 {
            self.instruct(self.shifted as u8);
        }
        output
    }

    /// What was written is taken over.
    fn deselect(&mut self) {
        let written = self.shifted as u8;
        match (self.clocks, (self.shifted >> 8) as u8 & 0xf8) {
            (16, 0x88) => self.mode_0 = written,
            (16, 0x90) => self.mode_1 = written,
            _ => {}
        }
    }
}
