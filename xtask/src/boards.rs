//! Builds the images for boards and checks them: whether they fit, whether they spare the stored data in flash, whether
//! they compute with floats, and whether their control interrupts can panic.

use std::fs;
use std::ops::Range;

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo;
use pneudrive_build::firmware;
use pneudrive_plan::nucleo::flash as nucleo;
use pneudrive_plan::pico2::flash as pico2;

use crate::forbidden::Kind;
use crate::image::Image;

/// An image of a board: the features that it is built with, and the interrupts of its control.
struct Variant {
    features: &'static [&'static str],
    interrupts: &'static [&'static str],
}

/// A board.
struct Board {
    image: &'static str,
    variants: &'static [Variant],
    /// The start of the flash, and the range in which no program may have bytes.
    flash_start: u64,
    kept: Range<u32>,
    /// Most bytes of code and constants.
    flash_limit: u64,
    memory_end: u64,
}

/// For a simulated plant, and for a cylinder: the one that is flashed is built last and stays. A program takes one sector at
/// most.
const NUCLEO: Board = Board {
    image: "nucleo-f446",
    variants: &[
        Variant { features: &["plant-bus"], interrupts: &["DMA1_STREAM1"] },
        Variant { features: &["log"], interrupts: &["TIM5"] },
        Variant { features: &[], interrupts: &["TIM5"] },
    ],
    flash_start: 0x0800_0000,
    kept: nucleo::KEPT,
    flash_limit: 128 * 1024,
    memory_end: 0x2000_0000 + 128 * 1024,
};

const PICO2: Board = Board {
    image: firmware::PICO2,
    variants: &[
        Variant { features: &["log"], interrupts: &["TIMER0_IRQ_0", "TIMER0_IRQ_1"] },
        Variant { features: &[], interrupts: &["TIMER0_IRQ_0", "TIMER0_IRQ_1"] },
    ],
    flash_start: 0x1000_0000,
    kept: pico2::KEPT,
    flash_limit: pico2::KEPT.start as u64,
    memory_end: 0x2000_0000 + 512 * 1024,
};

/// Least bytes that are left to the stack.
const STACK_MIN: u64 = 8 * 1024;
/// Least bytes of the transient buffer.
const RECORDER_MIN: u64 = 60 * 1024;

/// Builds the images of the Nucleo board, prints their sizes and judges them.
///
/// # Errors
/// When one can't be built, does not fit, would overwrite what is kept, computes with floats, or its
/// control interrupt can panic.
pub fn check_nucleo() -> Result<()> {
    check(&NUCLEO)
}

/// The same checks for the Pico 2.
///
/// # Errors
/// As [`check_nucleo`].
pub fn check_pico2() -> Result<()> {
    check(&PICO2)
}

fn check(board: &Board) -> Result<()> {
    ensure!(
        firmware::is_refused(board.image, "debug", "never in a release image")?,
        "{}: a release image with the feature debug can be built: halted, an open valve would stay open",
        board.image
    );
    board.variants.iter().try_for_each(|variant| {
        let name = [&[board.image], variant.features].concat().join(" with ");
        judge(board, variant, &name).with_context(|| name)
    })
}

/// Builds the image for the emulated board and prints what it takes of the flash.
///
/// # Errors
/// When it can't be built or read.
pub fn check_emulated() -> Result<()> {
    let path = firmware::build_emulated()?;
    let file = fs::read(&path).with_context(|| format!("{}", path.display()))?;
    let image = Image::read(&file).with_context(|| format!("{}", path.display()))?;
    println!("{}: {} bytes of flash (code and constants)", firmware::EMULATED, image.flash_bytes);
    Ok(())
}

fn judge(board: &Board, variant: &Variant, name: &str) -> Result<()> {
    let path = firmware::build(&cargo::image_folder()?, board.image, variant.features)?;
    let file = fs::read(&path).with_context(|| format!("{}", path.display()))?;
    let image = Image::read(&file).with_context(|| format!("{}", path.display()))?;
    fits(&image, board, name)?;
    keeps(&image, board)?;
    no_float(&image)?;
    variant.interrupts.iter().try_for_each(|interrupt| interrupt_is_safe(&image, name, interrupt))
}

fn fits(image: &Image, board: &Board, name: &str) -> Result<()> {
    let stack = board.memory_end.saturating_sub(image.memory_end);
    let (flash, recorder) = (image.flash_bytes, image.largest_variable);
    println!("{name}: {flash} bytes of flash, {recorder} of recorder, {stack} left to the stack");
    let limit = board.flash_limit;
    ensure!(flash <= limit, "code and constants take more than {limit} bytes");
    ensure!(recorder >= RECORDER_MIN, "the transient buffer has less than {RECORDER_MIN} bytes");
    ensure!(stack >= STACK_MIN, "the stack has less than {STACK_MIN} bytes");
    Ok(())
}

fn keeps(image: &Image, board: &Board) -> Result<()> {
    let Board { flash_start, kept, .. } = board;
    let kept = flash_start + u64::from(kept.start)..flash_start + u64::from(kept.end);
    let overlaps = |written: &&Range<u64>| written.start < kept.end && kept.start < written.end;
    match image.written.iter().find(overlaps) {
        None => Ok(()),
        Some(written) => anyhow::bail!("{written:#x?} would overwrite configuration and fault log"),
    }
}

fn no_float(image: &Image) -> Result<()> {
    let findings = image.findings();
    let floats = findings.iter().find(|f| matches!(f.kind, Kind::FloatInstruction | Kind::SoftFloat));
    ensure!(
        floats.is_none(),
        "the image computes with floats: {}",
        floats.map_or_else(String::new, |f| f.to_string())
    );
    Ok(())
}

fn interrupt_is_safe(image: &Image, name: &str, interrupt: &str) -> Result<()> {
    ensure!(image.has_function(interrupt), "there is no function {interrupt}");
    let (reached, indirect) = image.reached_from(interrupt);
    println!("{name}: {interrupt} reaches {} functions", reached.len());
    ensure!(indirect.is_empty(), "what {interrupt} calls is not known: {}", indirect.join(", "));
    let bad: Vec<&str> =
        reached.iter().map(String::as_str).filter(|name| Kind::of_symbol(name).is_some()).collect();
    ensure!(bad.is_empty(), "{interrupt} reaches {}", bad.join(", "));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value in a file of cargo or rustup, by the path of its keys.
    fn named(file: &str, keys: &[&str]) -> String {
        let text =
            fs::read_to_string(cargo::root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        let document: toml_edit::DocumentMut = text.parse().unwrap_or_else(|error| panic!("{file}: {error}"));
        let item = keys.iter().try_fold(document.as_item(), |item, key| item.get(key));
        item.unwrap_or_else(|| panic!("{file}: no {keys:?}")).to_string()
    }

    #[test]
    fn the_toolchain_of_a_fresh_machine_has_the_target_of_each_board() {
        let targets = named("rust-toolchain.toml", &["toolchain", "targets"]);
        for workspace in ["firmware", "firmware/pico2"] {
            let target = named(&format!("{workspace}/.cargo/config.toml"), &["build", "target"]);
            assert!(targets.contains(target.trim()), "{workspace}: {target} is not among {targets}");
        }
    }
}
