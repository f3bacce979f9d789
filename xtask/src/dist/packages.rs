//! The crates as crates.io takes them.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo::{built, in_root, run};
use serde::Deserialize;

use super::Source;

/// Packs each library and the command, and builds them from what was packed.
///
/// # Errors
/// When one cannot be packed, or does not build by itself.
pub fn make(source: &Source, out: &Path) -> Result<()> {
    source.cargo("", &arguments(&not_published()?, &[]))?;
    fs::create_dir_all(out)?;
    let packed = source.target().join("package");
    for entry in fs::read_dir(&packed).with_context(|| packed.display().to_string())? {
        let path = entry?.path();
        if path.extension().is_some_and(|kind| kind == "crate") {
            fs::copy(&path, out.join(path.file_name().context("a name")?))?;
        }
    }
    Ok(())
}

/// Packs them as they are here, without building them: a file or a version that is missing is found.
///
/// # Errors
/// When one cannot be packed.
pub fn list() -> Result<()> {
    let folder = built("dist-packages")?;
    let folder = folder.to_str().context("a folder with a name in UTF-8")?;
    run(&mut in_root(&arguments(
        &not_published()?,
        &["--no-verify", "--allow-dirty", "--target-dir", folder],
    )))
}

fn arguments<'a>(excluded: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    let excluded = excluded.iter().flat_map(|name| ["--exclude", name.as_str()]);
    ["package", "--workspace", "--locked", "--quiet"]
        .into_iter()
        .chain(more.iter().copied())
        .chain(excluded)
        .collect()
}

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    /// The registries that take it; none, if empty.
    publish: Option<Vec<String>>,
}

/// The packages of the workspace that only serve its own tests.
fn not_published() -> Result<Vec<String>> {
    let output = in_root(&["metadata", "--format-version", "1", "--no-deps", "--locked"]).output()?;
    ensure!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr).trim());
    let metadata: Metadata = serde_json::from_slice(&output.stdout).context("cargo metadata")?;
    let kept =
        metadata.packages.into_iter().filter(|package| package.publish.as_ref().is_some_and(Vec::is_empty));
    Ok(kept.map(|package| package.name).collect())
}
