//! The processor: Unicorn executes its instructions block by block; exception entry and return are done here.
//!
//! ```text
//! time      = instructions * cycles an instruction * a cycle's ticks     (an interval: Corner)
//! exception = eight words on the stack, LR = EXC_RETURN, PC = its vector (PM0214 2.3.7)
//! ```
//!
//! The emulator knows no interrupt controller, so an exception runs in what it takes for thread mode, and its return is
//! a jump to an address from which nothing is executed. The image has no float, so no exception saves float registers.

use std::cell::RefCell;
use std::rc::Rc;

use anyhow::{Result, anyhow};
use unicorn_engine::{Arch, ArmCpuModel, Mode, Prot, RegisterARM, Unicorn, uc_error};

use crate::board::{BIT_BAND, Board, PERIPHERALS, Stop};
use crate::peripheral::dma::Memory;
use crate::peripheral::flash;
use crate::peripheral::system::{HARD_FAULT, Mask, NMI};
use crate::time::Ticks;

/// Return to thread mode, main stack, no float registers; what EXC_RETURN is without the Thumb bit.
const RETURN: u32 = 0xffff_fff9;
const RETURN_ADDRESS: u64 = 0xffff_fff8;

const MEMORY: u32 = 0x2000_0000;
const MEMORY_BYTES: usize = 128 * 1024;

/// The sectors that the firmware writes are cells of a model; all others are memory of the emulator.
const KEPT: std::ops::Range<u32> = 0x4000..0x2_0000;

/// Bytes of the manufacturer: the size of the flash in KiB at 0x1FFF_7A22 (RM0390 34.2).
const SYSTEM_MEMORY: u64 = 0x1fff_0000;
const FLASH_SIZE: u64 = 0x1fff_7a22;

/// Cycles of entering an exception.
const ENTRY_CYCLES: Ticks = 12;

/// What an exception saves, from the stack pointer upward.
const SAVED: [RegisterARM; 7] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R12,
    RegisterARM::LR,
    RegisterARM::PC,
];

/// The bit of xPSR that says "Thumb", its bits of an interrupted IT block and of the exception that runs, and the one
/// that says that the stack was aligned.
const THUMB: u32 = 1 << 24;
const IT: u32 = 0x0600_fc00;
const EXCEPTION: u32 = 0x1ff;
const ALIGNED: u32 = 1 << 9;

type Core = Unicorn<'static, ()>;

/// The emulator as the memory that a DMA controller reaches.
struct Reached<'a, 'b>(&'a mut Unicorn<'b, ()>);

impl Memory for Reached<'_, '_> {
    fn fetch(&mut self, address: u32, bytes: &mut [u8]) {
        // An address that is no memory reads as what stands in `bytes`: a bus error ends the stream.
        let _ = self.0.mem_read(address.into(), bytes);
    }

    fn store(&mut self, address: u32, bytes: &[u8]) {
        let _ = self.0.mem_write(address.into(), bytes);
    }
}

/// The processor and its board.
pub struct Processor {
    core: Core,
    board: Rc<RefCell<Board>>,
}

fn emulator_error(error: uc_error) -> anyhow::Error {
    anyhow!("the emulator of the processor: {error:?}")
}

impl Processor {
    /// A processor that stands before its first instruction; memory holds anything.
    ///
    /// # Errors
    /// When the emulator cannot be set up.
    pub fn new(board: Board) -> Result<Processor> {
        let board = Rc::new(RefCell::new(board));
        let core = emulator(&board).map_err(emulator_error)?;
        let mut processor = Processor { core, board };
        processor.reset().map_err(emulator_error)?;
        Ok(processor)
    }

    /// The board.
    pub fn board(&self) -> std::cell::RefMut<'_, Board> {
        self.board.borrow_mut()
    }

    /// Runs until a time, or until the board stops it.
    ///
    /// # Errors
    /// When it has stopped.
    pub fn run(&mut self, until: Ticks) -> Result<(), Stop> {
        self.board.borrow_mut().go_until(until);
        loop {
            {
                let mut board = self.board.borrow_mut();
                board.settle(&mut Reached(&mut self.core));
                if let Some(stop) = board.stop.clone() {
                    return Err(stop);
                }
                if board.now >= until {
                    return Ok(());
                }
                if board.cycle().is_none() {
                    board.pass_time();
                    continue;
                }
            }
            self.step().map_err(|error| Stop::Broken(emulator_error(error).to_string()))?;
        }
    }

    /// Enters an exception that is due, or executes up to the next event.
    fn step(&mut self) -> Result<(), uc_error> {
        let next = next_exception(&self.board.borrow(), &self.core);
        if let Some(exception) = next {
            return self.enter(exception);
        }
        let pc = self.core.reg_read(RegisterARM::PC)?;
        let outcome = self.core.emu_start(pc | 1, RETURN_ADDRESS, 0, 0);
        if self.board.borrow().stop.is_some() {
            return Ok(());
        }
        let at = self.core.reg_read(RegisterARM::PC)? & !1;
        match outcome {
            _ if at == RETURN_ADDRESS => self.leave(),
            Ok(()) => Ok(()),
            Err(error) => {
                self.board.borrow_mut().faults.push(format!("{error:?} at {at:#x}"));
                self.enter(HARD_FAULT)
            }
        }
    }

    /// The registers of a reset, from the first two vectors.
    fn reset(&mut self) -> Result<(), uc_error> {
        let mut vectors = [0; 8];
        self.core.mem_read(flash::START.into(), &mut vectors)?;
        let [stack, start] = [0, 4].map(|place| word_at(&vectors, place));
        for register in [RegisterARM::PRIMASK, RegisterARM::BASEPRI, RegisterARM::CONTROL] {
            self.core.reg_write(register, 0)?;
        }
        self.core.reg_write(RegisterARM::XPSR, THUMB.into())?;
        self.core.reg_write(RegisterARM::LR, u64::from(u32::MAX))?;
        self.core.reg_write(RegisterARM::SP, stack.into())?;
        self.core.reg_write(RegisterARM::PC, start.into())
    }

    /// The board is reset.
    ///
    /// # Errors
    /// When the emulator does not take it.
    pub fn restart(&mut self, cause: crate::peripheral::rcc::Cause) -> Result<()> {
        self.board.borrow_mut().reset(cause);
        self.reset().map_err(emulator_error)
    }

    /// The next instruction is that at an address.
    ///
    /// # Errors
    /// When the emulator does not take it.
    pub fn jump(&mut self, address: u32) -> Result<()> {
        self.core.reg_write(RegisterARM::PC, address.into()).map_err(emulator_error)
    }

    /// Saves the registers on the stack and goes to the vector.
    fn enter(&mut self, exception: u32) -> Result<(), uc_error> {
        let (vectors, running) = {
            let mut board = self.board.borrow_mut();
            let running = board.system().running();
            if !board.system().begin(exception) {
                board.locked_up = true;
                return Ok(());
            }
            let cycle = board.cycle().unwrap_or(0);
            board.now += ENTRY_CYCLES * cycle;
            (board.asks().0.vectors(), running)
        };
        let stack = self.core.reg_read(RegisterARM::SP)? as u32;
        let frame = (stack - 32) & !7;
        let mut words = Vec::with_capacity(8);
        for register in SAVED {
            words.push(self.core.reg_read(register)? as u32);
        }
        let state = self.core.reg_read(RegisterARM::XPSR)? as u32 & !EXCEPTION;
        words.push(state | running | if stack - 32 == frame { 0 } else { ALIGNED });
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let mut vector = [0; 4];
        self.core.mem_read(u64::from(flash::START.max(vectors) + 4 * exception), &mut vector)?;
        if self.core.mem_write(frame.into(), &bytes).is_err() {
            // A stack that is no memory: a fault in the handling of one.
            self.board.borrow_mut().locked_up = true;
            return Ok(());
        }
        self.core.reg_write(RegisterARM::SP, frame.into())?;
        self.core.reg_write(RegisterARM::LR, RETURN.into())?;
        self.core.reg_write(RegisterARM::XPSR, THUMB.into())?;
        self.core.reg_write(RegisterARM::PC, u32::from_le_bytes(vector).into())
    }

    /// Takes the registers from the stack and goes on where the exception came.
    fn leave(&mut self) -> Result<(), uc_error> {
        let frame = self.core.reg_read(RegisterARM::SP)?;
        let mut bytes = [0; 32];
        self.core.mem_read(frame, &mut bytes)?;
        let state = word_at(&bytes, 28);
        let aligned = if state & ALIGNED == 0 { 0 } else { 4 };
        self.core.reg_write(RegisterARM::SP, frame + 32 + aligned)?;
        self.core.reg_write(RegisterARM::XPSR, u64::from(state & !EXCEPTION & !ALIGNED | THUMB))?;
        for (place, register) in SAVED.into_iter().enumerate() {
            self.core.reg_write(register, word_at(&bytes, 4 * place).into())?;
        }
        let mut board = self.board.borrow_mut();
        let cycle = board.cycle().unwrap_or(0);
        board.now += ENTRY_CYCLES * cycle;
        board.system().end();
        Ok(())
    }
}

fn word_at(bytes: &[u8], place: usize) -> u32 {
    bytes[place..].first_chunk().map_or(0, |word| u32::from_le_bytes(*word))
}

/// The exception that is taken next. None in the middle of an IT block, which is over in a few instructions.
fn next_exception(board: &Board, core: &Unicorn<'_, ()>) -> Option<u32> {
    let (system, nmi, timer) = board.asks();
    if !nmi && !timer {
        return None;
    }
    let register = |register| core.reg_read(register).unwrap_or(0) as u32;
    let mask = Mask {
        primask: register(RegisterARM::PRIMASK) & 1 == 1,
        basepri: register(RegisterARM::BASEPRI) as u8,
    };
    let next = system.next(nmi, timer, mask)?;
    (next == NMI || register(RegisterARM::XPSR) & IT == 0).then_some(next)
}

/// Instructions of a block: those that begin with 0b11101 and above are four bytes long.
fn instructions(block: &[u8]) -> u64 {
    let (mut count, mut place) = (0, 0);
    while let Some(high) = block.get(place + 1) {
        place += if high >> 3 >= 0b11101 { 4 } else { 2 };
        count += 1;
    }
    count
}

fn emulator(board: &Rc<RefCell<Board>>) -> Result<Core, uc_error> {
    let mut core = Unicorn::new(Arch::ARM, Mode::THUMB | Mode::MCLASS)?;
    core.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)?;
    let cells = board.borrow().flash.cells().to_vec();
    map_memory(&mut core, &cells)?;
    map_kept(&mut core, board)?;
    map_peripherals(&mut core, board)?;
    count_instructions(&mut core, board, cells)?;
    Ok(core)
}

fn map_memory(core: &mut Core, cells: &[u8]) -> Result<(), uc_error> {
    let start = u64::from(flash::START);
    let (before, behind) = (KEPT.start as usize, KEPT.end as usize);
    for (from, to) in [(0, before), (behind, flash::BYTES)] {
        core.mem_map(start + from as u64, (to - from) as u64, Prot::READ | Prot::EXEC)?;
        core.mem_write(start + from as u64, &cells[from..to])?;
    }
    core.mem_map(MEMORY.into(), MEMORY_BYTES as u64, Prot::ALL)?;
    // Memory holds anything when the power comes.
    let anything: Vec<u8> = (0..MEMORY_BYTES).map(|k| (k * 37 + 11) as u8).collect();
    core.mem_write(MEMORY.into(), &anything)?;
    core.mem_map(SYSTEM_MEMORY, 0x1_0000, Prot::READ)?;
    core.mem_write(FLASH_SIZE, &((flash::BYTES / 1024) as u16).to_le_bytes())
}

fn map_kept(core: &mut Core, board: &Rc<RefCell<Board>>) -> Result<(), uc_error> {
    let (reads, writes) = (Rc::clone(board), Rc::clone(board));
    let read = move |_: &mut Unicorn<'_, ()>, offset: u64, bytes: usize| {
        reads.borrow().flash.load(KEPT.start as usize + offset as usize, bytes)
    };
    let write = move |core: &mut Unicorn<'_, ()>, offset: u64, bytes: usize, value: u64| {
        let mut board = writes.borrow_mut();
        board.program(KEPT.start as usize + offset as usize, bytes, value);
        stop_if_asked(core, &board);
    };
    let start = u64::from(flash::START + KEPT.start);
    core.mmio_map(start, u64::from(KEPT.end - KEPT.start), Some(read), Some(write))
}

fn map_peripherals(core: &mut Core, board: &Rc<RefCell<Board>>) -> Result<(), uc_error> {
    for (start, bytes) in [(PERIPHERALS, 0x8_0000), (0xe000_0000, 0x10_0000)] {
        let (reads, writes) = (Rc::clone(board), Rc::clone(board));
        let read = move |core: &mut Unicorn<'_, ()>, offset: u64, bytes: usize| {
            let mut board = reads.borrow_mut();
            let value = board.read(start + offset as u32, bytes, &mut Reached(core));
            stop_if_asked(core, &board);
            value
        };
        let write = move |core: &mut Unicorn<'_, ()>, offset: u64, bytes: usize, value: u64| {
            let mut board = writes.borrow_mut();
            board.write(start + offset as u32, bytes, value, &mut Reached(core));
            stop_if_asked(core, &board);
        };
        core.mmio_map(start.into(), bytes, Some(read), Some(write))?;
    }
    let (reads, writes) = (Rc::clone(board), Rc::clone(board));
    let read = move |core: &mut Unicorn<'_, ()>, offset: u64, _: usize| {
        let mut board = reads.borrow_mut();
        let value = board.read_bit(BIT_BAND + offset as u32, &mut Reached(core));
        stop_if_asked(core, &board);
        value
    };
    let write = move |core: &mut Unicorn<'_, ()>, offset: u64, _: usize, value: u64| {
        let mut board = writes.borrow_mut();
        board.write_bit(BIT_BAND + offset as u32, value, &mut Reached(core));
        stop_if_asked(core, &board);
    };
    core.mmio_map(BIT_BAND.into(), 0x100_0000, Some(read), Some(write))
}

fn stop_if_asked(core: &mut Unicorn<'_, ()>, board: &Board) {
    if board.stop.is_some() {
        let _ = core.emu_stop();
    }
}

/// Before each block: whether something is due; if not, the time that the block takes goes by.
fn count_instructions(core: &mut Core, board: &Rc<RefCell<Board>>, program: Vec<u8>) -> Result<(), uc_error> {
    let board = Rc::clone(board);
    let count = move |core: &mut Unicorn<'_, ()>, address: u64, bytes: u32| {
        let mut board = board.borrow_mut();
        let due = board.now >= board.horizon() || board.stop.is_some() || board.cycle().is_none();
        if due || next_exception(&board, core).is_some() {
            let _ = core.emu_stop();
            return;
        }
        let from = (address as usize).saturating_sub(flash::START as usize);
        let block = program.get(from..from + bytes as usize).unwrap_or(&[]);
        let cycles = instructions(block) * board.corner.cycles_per_instruction;
        board.now += cycles * board.cycle().unwrap_or(0);
    };
    core.add_block_hook(1, 0, count).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instructions_are_two_or_four_bytes_long() {
        // nop; ldr.w r0, [r1, #4]; bx lr
        assert_eq!(instructions(&[0x00, 0xbf, 0xd1, 0xf8, 0x04, 0x00, 0x70, 0x47]), 3);
        assert_eq!(instructions(&[]), 0);
    }
}
