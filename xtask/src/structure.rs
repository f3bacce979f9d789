//! The structure of the sources: which module uses which.
//!
//! ```text
//! siblings     one way: no circle between modules of the same parent, whatever their children use
//! parent       gives its children types, constants and macros; no function of it is called from below
//! crates       as the map of ARCHITECTURE.md has them: each uses only crates that stand above it there
//! words        of laws and parameters are spelled in one place
//! tests        each file of a crate's tests is in a test program
//! libraries    that one module of a crate knows are named nowhere else in it
//! models       of a component are named in their own files and in its list alone
//! ```

mod crates;
mod graph;
mod libraries;
mod models;
mod module;
mod paths;
mod programs;
mod vocabulary;

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Result, bail};

use crates::Map;
use module::Modules;

/// Looks into all crates, and holds the map against them.
///
/// # Errors
/// When a source cannot be read, or breaks a rule.
pub fn check(root: &Path) -> Result<()> {
    let (uses, workspaces) = crates::of_cargo(root)?;
    let mut broken = crates::broken(&Map::of_project(root)?, &uses, &workspaces);
    let folders: Vec<&str> = uses.keys().map(String::as_str).collect();
    broken.extend(models::named_elsewhere(root, &folders)?);
    broken.extend(libraries::named_elsewhere(root)?);
    let words = vocabulary::words(root)?;
    for folder in uses.keys() {
        broken.extend(
            of_crate(&root.join(folder), &words)?.into_iter().map(|text| format!("{folder}: {text}")),
        );
    }
    for folder in uses.keys() {
        let forgotten = programs::forgotten(&root.join(folder))?;
        broken.extend(forgotten.into_iter().map(|text| format!("{folder}: {text}")));
    }
    if !broken.is_empty() {
        bail!("{} breaks of the structure:\n{}", broken.len(), broken.join("\n"));
    }
    Ok(())
}

/// What breaks a rule in the modules of a crate, which must not spell these words.
///
/// # Errors
/// When a source cannot be read.
pub fn of_crate(folder: &Path, words: &BTreeSet<String>) -> Result<Vec<String>> {
    let modules = Modules::read(&folder.join("src"))?;
    let uses = paths::uses(&modules);
    let mut broken = graph::circles(&modules, &uses);
    broken.extend(paths::functions_of_parents(&modules, &uses));
    broken.extend(vocabulary::spelled_again(&modules, words));
    Ok(broken)
}

#[cfg(test)]
mod tests;
