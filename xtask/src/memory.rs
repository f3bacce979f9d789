//! The flash, memory and stack that the images use, and their table.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use pneudrive_build::{cargo, figures, firmware};

use crate::image::Image;
use crate::stack::Stack;

/// Where the memory begins, on all boards.
const START: u64 = 0x2000_0000;

/// Bytes that an interrupt takes before its first instruction: the basic frame, and the word that aligns it. The
/// images have no float instruction, so no float registers are kept.
const EXCEPTION_FRAME: u32 = 32 + 4;

/// The table's name in the document.
const TABLE: &str = "memory";

/// An image, and where its control runs.
#[derive(Clone, Copy, Debug)]
struct Kind {
    name: &'static str,
    /// Bytes of its memory.
    memory: u64,
    /// Parts of the names of the functions that the control enters by.
    control: &'static [&'static str],
    /// Whether the control interrupts the program, or is called by it.
    interrupts: bool,
}

const IMAGES: [Kind; 3] = [
    Kind { name: "nucleo-f446", memory: 128 * 1024, control: &["TIM5"], interrupts: true },
    Kind {
        name: firmware::PICO2,
        memory: 512 * 1024,
        control: &["TIMER0_IRQ_0", "TIMER0_IRQ_1"],
        interrupts: true,
    },
    Kind {
        name: firmware::EMULATED,
        memory: 128 * 1024,
        control: &["9on_sample", "9on_output"],
        interrupts: false,
    },
];

/// The memory use of an image, bytes.
#[derive(Clone, Debug)]
pub struct Memory {
    /// Code and constants.
    pub flash: u64,
    /// Variables.
    pub variables: u64,
    /// The transient buffer, the largest of them.
    pub recorder: u64,
    /// The rest for the stack.
    pub left: u64,
    /// The most that the control interrupt takes of the stack.
    pub control: Stack,
    /// The most that the program takes of it, from the reset on.
    pub program: Stack,
    interrupts: bool,
}

impl Memory {
    fn of(image: &Image, kind: Kind) -> Result<Memory> {
        let mut control = Stack::default();
        for part in kind.control {
            let name = image.function_like(part).with_context(|| format!("there is no function {part}"))?;
            let stack = Stack::of(image, &name)?;
            control = if stack.bytes > control.bytes { stack } else { control };
        }
        let variables = image.memory_end.saturating_sub(START);
        Ok(Memory {
            flash: image.flash_bytes,
            variables,
            recorder: image.largest_variable,
            left: kind.memory.saturating_sub(variables),
            control,
            program: Stack::of(image, "Reset")?,
            interrupts: kind.interrupts,
        })
    }

    /// The most that is ever on the stack.
    #[must_use]
    pub fn stack(&self) -> u32 {
        let interrupt = if self.interrupts { EXCEPTION_FRAME + self.control.bytes } else { 0 };
        self.program.bytes + interrupt
    }
}

/// Reads an image that was built.
///
/// # Errors
/// When it can't be read, or its stack has no bound.
fn read(path: &Path, kind: Kind) -> Result<Memory> {
    let file = fs::read(path).with_context(|| format!("{}", path.display()))?;
    Memory::of(&Image::read(&file)?, kind).with_context(|| format!("{}", path.display()))
}

/// Builds the images and reports their memory use, as a table of Markdown.
///
/// # Errors
/// When one can't be built or read, or has more on the stack than is left to it.
fn table() -> Result<String> {
    let mut text = String::from(
        "| image | flash | variables | of them recorder | left to the stack | control | program | most on the stack |\n|---|---|---|---|---|---|---|---|\n",
    );
    for kind in IMAGES {
        let memory = read(&firmware::build(&cargo::image_folder()?, kind.name, &[])?, kind)?;
        tell(kind.name, &memory);
        let (stack, left) = (memory.stack(), memory.left);
        ensure!(u64::from(stack) <= left, "{}: {stack} bytes of stack, and {left} are left to it", kind.name);
        let Memory { flash, variables, recorder, control, program, .. } = memory;
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "| {} | {flash} | {variables} | {recorder} | {left} | {} | {} | {stack} |",
            kind.name, control.bytes, program.bytes
        );
    }
    Ok(text)
}

fn tell(name: &str, memory: &Memory) {
    for (what, stack) in [("control", &memory.control), ("program", &memory.program)] {
        println!("{name}: {} bytes of stack for the {what}: {}", stack.bytes, stack.path.join(" > "));
        stack.indirect.iter().for_each(|call| println!("{name}: not followed: a call by register {call}"));
    }
}

/// Holds the document's table against the images.
///
/// # Errors
/// When a figure is off, with the remedy.
pub fn check() -> Result<()> {
    figures::hold(figures::FIRMWARE, TABLE, &table()?, figures::OffTable::EitherWay)
}

/// Writes the document's table again.
///
/// # Errors
/// When an image can't be built or read.
pub fn write() -> Result<()> {
    figures::write(figures::FIRMWARE, TABLE, &table()?)
}
