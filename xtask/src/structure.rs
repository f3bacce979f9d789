//! The structure of the sources: which module uses which.
//!
//! ```text
//! siblings     one way: no circle between modules of the same parent, whatever their children use
//! parent       gives its children types, constants and macros; no function of it is called from below
//! crates       use only crates of a lower layer
//! ```

mod crates;
mod graph;
mod module;
mod paths;

use std::path::Path;

use anyhow::{Result, bail};

use module::Modules;

/// Crates whose modules are looked into: their folders.
const CRATES: [&str; 20] = [
    "shared/controller",
    "shared/protocol",
    "firmware/app",
    "sim/solver",
    "sim",
    "host/tables",
    "host/records",
    "host/link",
    "host/rigs",
    "host/analysis",
    "host/design",
    "host/page",
    "host/studio",
    "host/fmu",
    "host",
    "host/python",
    "hil-tests",
    "hil-tests/link-states",
    "hil-tests/flashed-image",
    "xtask",
];

/// Looks into all crates.
///
/// # Errors
/// When a source cannot be read, or breaks a rule.
pub fn check(root: &Path) -> Result<()> {
    let mut broken = crates::upward(root)?;
    for folder in CRATES {
        broken.extend(of_crate(&root.join(folder))?.into_iter().map(|text| format!("{folder}: {text}")));
    }
    if !broken.is_empty() {
        bail!("{} arrows against the structure:\n{}", broken.len(), broken.join("\n"));
    }
    Ok(())
}

/// What breaks a rule in the modules of a crate.
///
/// # Errors
/// When a source cannot be read.
pub fn of_crate(folder: &Path) -> Result<Vec<String>> {
    let modules = Modules::read(&folder.join("src"))?;
    let uses = paths::uses(&modules);
    let mut broken = graph::circles(&modules, &uses);
    broken.extend(paths::functions_of_parents(&modules, &uses));
    Ok(broken)
}

#[cfg(test)]
mod tests;
