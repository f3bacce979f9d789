//! Builds the probe image of the firmware and checks it.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use pneudrive_build::cargo;
use pneudrive_build::firmware;

use crate::forbidden::Kind;
use crate::image::Image;

/// Functions without which the image proves nothing.
const REQUIRED: [&str; 4] = ["probe_sample", "probe_output", "probe_configure", "probe_set"];

/// Which image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// The controller alone.
    Honest,
    /// With one of each kind of forbidden content.
    Guilty,
}

/// Builds the probe into a target folder and returns the path of the image.
///
/// # Errors
/// When the target of the boards is missing, or the build fails.
pub fn build(target_folder: &Path, variant: Variant) -> Result<PathBuf> {
    let features: &[&str] = if variant == Variant::Guilty { &["guilty"] } else { &[] };
    firmware::build(target_folder, "probe", features)
}

/// Reads the image of a probe.
///
/// # Errors
/// When it can't be read, or lacks the functions that it's there for.
pub fn read(path: &Path) -> Result<Image> {
    let file = fs::read(path).with_context(|| format!("{}", path.display()))?;
    let image = Image::read(&file).with_context(|| format!("{}", path.display()))?;
    for name in REQUIRED {
        ensure!(image.has_function(name), "{}: there is no function {name}", path.display());
    }
    Ok(image)
}

/// Builds the honest probe, prints its size and the list of the searched contents.
///
/// # Errors
/// When it has forbidden content.
pub fn check() -> Result<()> {
    let image = read(&build(&cargo::image_folder()?, Variant::Honest)?)?;
    let findings = image.findings();
    println!("probe: {} bytes of flash (code and constants)", image.flash_bytes);
    for kind in Kind::ALL {
        let count = findings.iter().filter(|finding| finding.kind == kind).count();
        println!("probe: {count} found of {kind}: {}", kind.sought());
    }
    if findings.is_empty() {
        return Ok(());
    }
    let list: Vec<String> = findings.iter().map(ToString::to_string).collect();
    bail!("the image has forbidden content:\n  {}", list.join("\n  "))
}
