//! Reads an image of the firmware and finds in it what must not be there.

use std::fmt;

use anyhow::{Context, Result, ensure};
use object::elf::FileHeader32;
use object::read::elf::ElfFile;
use object::{LittleEndian, Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use crate::forbidden::Kind;
use crate::thumb::{self, Instruction, Mark};

/// What is looked at in an image.
#[derive(Clone, Debug)]
pub struct Image {
    /// Bytes of code and constants: what the flash must hold.
    pub flash_bytes: u64,
    /// In order of address.
    symbols: Vec<Symbol>,
    instructions: Vec<Instruction>,
}

#[derive(Clone, Debug)]
struct Symbol {
    name: String,
    address: u32,
    defined: bool,
}

/// One thing that must not be in the image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What it is.
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
    /// When it is none, or is stripped: without symbols nothing can be said of it.
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

        let mut image = Image { flash_bytes: 0, symbols, instructions: Vec::new() };
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

    /// Whether there is a function of this name.
    #[must_use]
    pub fn has_function(&self, name: &str) -> bool {
        self.symbols.iter().any(|symbol| symbol.defined && symbol.name == name)
    }

    /// Everything in the image that must not be there.
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
