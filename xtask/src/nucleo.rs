//! Builds the images for the Nucleo board and checks them: whether they fit, whether they spare the stored data in flash,
//! and whether their control interrupt can panic.

use std::fs;
use std::ops::Range;

use anyhow::{Context, Result, ensure};
use pneudrive_nucleo_plan::flash::KEPT;

use crate::cargo;
use crate::firmware;
use crate::forbidden::Kind;
use crate::image::Image;

const NAME: &str = "nucleo-f446";

/// An image of it: the features that it is built with, and the interrupt of its control.
struct Variant {
    features: &'static [&'static str],
    interrupt: &'static str,
}

/// For a simulated plant, and for a cylinder: the one that is flashed is built last and stays.
const VARIANTS: [Variant; 2] = [
    Variant { features: &["plant-bus"], interrupt: "DMA1_STREAM1" },
    Variant { features: &[], interrupt: "TIM5" },
];

const FLASH_START: u64 = 0x0800_0000;
const MEMORY_END: u64 = 0x2000_0000 + 128 * 1024;

/// Most bytes of code and constants.
const FLASH_LIMIT: u64 = 96 * 1024;
/// Least bytes that are left to the stack.
const STACK_LEAST: u64 = 8 * 1024;
/// Least bytes of the transient buffer.
const RECORDER_LEAST: u64 = 60 * 1024;

/// Builds both images, prints what they take and judges them.
///
/// # Errors
/// When one can't be built, does not fit, would overwrite what is kept, computes with floats, or its
/// control interrupt can panic.
pub fn check() -> Result<()> {
    VARIANTS.iter().try_for_each(|variant| {
        let name = [&[NAME], variant.features].concat().join(" with ");
        judge(variant, &name).with_context(|| name)
    })
}

fn judge(variant: &Variant, name: &str) -> Result<()> {
    let path = firmware::build(&cargo::image_folder()?, NAME, variant.features)?;
    let file = fs::read(&path).with_context(|| format!("{}", path.display()))?;
    let image = Image::read(&file).with_context(|| format!("{}", path.display()))?;
    fits(&image, name)?;
    keeps(&image)?;
    no_float(&image)?;
    interrupt_is_safe(&image, name, variant.interrupt)
}

fn fits(image: &Image, name: &str) -> Result<()> {
    let stack = MEMORY_END.saturating_sub(image.memory_end);
    let (flash, recorder) = (image.flash_bytes, image.largest_variable);
    println!("{name}: {flash} bytes of flash, {recorder} of recorder, {stack} left to the stack");
    ensure!(flash <= FLASH_LIMIT, "code and constants take more than {FLASH_LIMIT} bytes");
    ensure!(recorder >= RECORDER_LEAST, "the transient buffer has less than {RECORDER_LEAST} bytes");
    ensure!(stack >= STACK_LEAST, "the stack has less than {STACK_LEAST} bytes");
    Ok(())
}

fn keeps(image: &Image) -> Result<()> {
    let kept = FLASH_START + u64::from(KEPT.start)..FLASH_START + u64::from(KEPT.end);
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
