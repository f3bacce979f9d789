//! Reads an image of the firmware and finds forbidden content in it.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;

use anyhow::{Context, Result, ensure};
use object::elf::FileHeader32;
use object::read::elf::{ElfFile, ElfSegment32};
use object::{LittleEndian, Object, ObjectSection, ObjectSegment, ObjectSymbol, SectionKind, SymbolKind};

use crate::forbidden::Kind;
use crate::thumb::{self, Instruction, Mark};

/// The inspected parts of an image.
#[derive(Clone, Debug)]
pub struct Image {
    /// Bytes of code and constants: the contents of the flash.
    pub flash_bytes: u64,
    /// Address after the last variable; 0 without any. The rest of the memory is the stack's.
    pub memory_end: u64,
    /// Bytes of the largest variable.
    pub largest_variable: u64,
    /// Addresses that a programmer writes to.
    pub written: Vec<Range<u64>>,
    /// The instructions, in order of address.
    symbols: Vec<Symbol>,
    instructions: Vec<Instruction>,
}

#[derive(Clone, Debug)]
struct Symbol {
    name: String,
    address: u32,
    defined: bool,
}

/// Bytes of the flash, and their address.
#[derive(Clone, Debug)]
pub struct Load {
    /// The address of the first byte.
    pub address: u32,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// Where a segment lies in the flash; a variable's start value lies elsewhere than the variable.
fn load_address(segment: &ElfSegment32<'_, '_, LittleEndian>) -> u32 {
    segment.elf_program_header().p_paddr.get(LittleEndian)
}

/// A forbidden item in the image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Its name.
    pub kind: Kind,
    /// The symbol, or where the instruction stands.
    pub what: String,
    /// The functions that call it, as far as calls are direct.
    pub callers: Vec<String>,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.kind, self.what)?;
        if self.callers.is_empty() { Ok(()) } else { write!(f, ", called by {}", self.callers.join(", ")) }
    }
}

impl Image {
    /// Reads the ELF file of a Thumb-2 image.
    ///
    /// # Errors
    /// When it is not an image, or is stripped: without symbols nothing can be said of it.
    pub fn read(file: &[u8]) -> Result<Image> {
        let elf = ElfFile::<FileHeader32<LittleEndian>>::parse(file).context("no 32-bit ELF file")?;
        let mut symbols = Vec::new();
        let mut marks = Vec::new();
        for symbol in elf.symbols().filter(|symbol| symbol.kind() != SymbolKind::File) {
            let name = symbol.name().context("a symbol's name is broken")?;
            let address = u32::try_from(symbol.address())?;
            match Mark::from_symbol(name, address) {
                Some(mark) => marks.push(mark),
                // The lowest bit of a function's address says "Thumb".
                None => symbols.push(Symbol {
                    name: name.to_owned(),
                    address: address & !1,
                    defined: symbol.kind() == SymbolKind::Text,
                }),
            }
        }
        symbols.sort_by_key(|symbol| symbol.address);
        marks.sort_by_key(|mark| mark.address);
        ensure!(!marks.is_empty(), "the image has no mapping symbols ($t, $d): stripped, or empty");

        let mut image = Image { symbols, ..Image::of_variables(&elf) };
        for section in elf.sections() {
            let kind = section.kind();
            if kind == SectionKind::Text {
                let start = u32::try_from(section.address())?;
                image.instructions.extend(thumb::instructions(start, section.data()?, &marks));
            }
            // The start values of variables lie in the flash, too.
            if matches!(
                kind,
                SectionKind::Text
                    | SectionKind::ReadOnlyData
                    | SectionKind::ReadOnlyString
                    | SectionKind::Data
            ) {
                image.flash_bytes += section.size();
            }
        }
        Ok(image)
    }

    /// An image without code yet.
    fn of_variables(elf: &ElfFile<'_, FileHeader32<LittleEndian>>) -> Image {
        let sections = elf
            .sections()
            .filter(|section| matches!(section.kind(), SectionKind::Data | SectionKind::UninitializedData));
        let variables = elf.symbols().filter(|symbol| symbol.kind() == SymbolKind::Data);
        let written = elf.segments().filter_map(|segment| {
            let (_, bytes) = segment.file_range();
            let start = u64::from(load_address(&segment));
            (bytes > 0).then(|| start..start + bytes)
        });
        Image {
            flash_bytes: 0,
            memory_end: sections.map(|section| section.address() + section.size()).max().unwrap_or(0),
            largest_variable: variables.map(|variable| variable.size()).max().unwrap_or(0),
            written: written.collect(),
            symbols: Vec::new(),
            instructions: Vec::new(),
        }
    }

    /// What a programmer writes to the flash, in order of address.
    ///
    /// # Errors
    /// When it is no image.
    pub fn loads(file: &[u8]) -> Result<Vec<Load>> {
        let elf = ElfFile::<FileHeader32<LittleEndian>>::parse(file).context("no 32-bit ELF file")?;
        let mut loads = Vec::new();
        for segment in elf.segments() {
            let bytes = segment.data().context("a segment")?.to_vec();
            loads.push(Load { address: load_address(&segment), bytes });
        }
        loads.retain(|load| !load.bytes.is_empty());
        loads.sort_by_key(|load| load.address);
        Ok(loads)
    }

    /// Everything that a function reaches by direct calls, itself included, and its calls by a register: nothing is
    /// known beyond those.
    #[must_use]
    pub fn reached_from(&self, name: &str) -> (BTreeSet<String>, Vec<String>) {
        let (mut reached, mut indirect) = (BTreeSet::new(), Vec::new());
        let mut waiting = vec![name.to_owned()];
        while let Some(name) = waiting.pop() {
            for at in self.instructions_of(&name) {
                waiting.extend(at.call_target().map(|target| self.function_at(target)));
                if at.is_indirect_call() {
                    indirect.push(format!("at {:#x} in {name}", at.address));
                }
            }
            reached.insert(name);
            waiting.retain(|name| !reached.contains(name));
        }
        (reached, indirect)
    }

    /// The function that an instruction of another one calls or continues in; None if it stays where it is.
    pub(crate) fn callee(&self, caller: &str, at: &Instruction) -> Option<String> {
        let callee = self.function_at(at.call_target()?);
        (callee != caller || at.is_call()).then_some(callee)
    }

    /// The instructions of a function; none of one that is not there.
    pub(crate) fn instructions_of(&self, name: &str) -> &[Instruction] {
        let mut functions = self.symbols.iter().filter(|symbol| symbol.defined);
        let Some(start) = functions.find(|symbol| symbol.name == name).map(|symbol| symbol.address) else {
            return &[];
        };
        let end = functions.find(|next| next.address > start).map_or(u32::MAX, |next| next.address);
        let place = |address| self.instructions.partition_point(|at| at.address < address);
        &self.instructions[place(start)..place(end)]
    }

    /// Whether there is a function of this name.
    #[must_use]
    pub fn has_function(&self, name: &str) -> bool {
        self.symbols.iter().any(|symbol| symbol.defined && symbol.name == name)
    }

    /// The first function whose name has this part: for one that the compiler has named.
    #[must_use]
    pub fn function_like(&self, part: &str) -> Option<String> {
        let mut functions = self.symbols.iter().filter(|symbol| symbol.defined);
        functions.find(|symbol| symbol.name.contains(part)).map(|symbol| symbol.name.clone())
    }

    /// All forbidden content in the image.
    #[must_use]
    pub fn findings(&self) -> Vec<Finding> {
        let symbols = self.symbols.iter().filter_map(|symbol| {
            let kind = Kind::of_symbol(&symbol.name)?;
            Some(Finding { kind, what: symbol.name.clone(), callers: self.callers(symbol) })
        });
        let floats = self.instructions.iter().filter(|instruction| instruction.is_float()).map(|at| {
            let what = format!("at {:#x} in {}", at.address, self.function_at(at.address));
            Finding { kind: Kind::FloatInstruction, what, callers: Vec::new() }
        });
        symbols.chain(floats).collect()
    }

    fn callers(&self, callee: &Symbol) -> Vec<String> {
        let calls =
            |instruction: &&Instruction| callee.defined && instruction.call_target() == Some(callee.address);
        let mut callers: Vec<String> =
            self.instructions.iter().filter(calls).map(|call| self.function_at(call.address)).collect();
        callers.dedup();
        callers
    }

    fn function_at(&self, address: u32) -> String {
        let mut before = self.symbols.iter().filter(|symbol| symbol.defined && symbol.address <= address);
        before.next_back().map_or_else(|| "no function".to_owned(), |symbol| symbol.name.clone())
    }
}
