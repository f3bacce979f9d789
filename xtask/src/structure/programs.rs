//! Test programs: a crate that names its own has no file in `tests/` that none of them takes in, as no test of it would run.

use std::path::Path;

use anyhow::{Context, Result};
use toml_edit::{DocumentMut, Item};

/// Files in the `tests` folder of a crate whose tests do not run.
///
/// # Errors
/// When a file cannot be read.
pub fn forgotten(folder: &Path) -> Result<Vec<String>> {
    let manifest: DocumentMut = read(&folder.join("Cargo.toml"))?.parse()?;
    if manifest["package"].get("autotests").and_then(Item::as_bool) != Some(false) {
        return Ok(Vec::new());
    }
    let programs = manifest.get("test").and_then(Item::as_array_of_tables);
    let programs = programs.into_iter().flatten().filter_map(|program| program.get("name")?.as_str());
    let programs: Vec<&str> = programs.collect();
    let tests = folder.join("tests");
    let mut taken_in: Vec<String> = programs.iter().map(|name| (*name).to_owned()).collect();
    for program in programs {
        let text = read(&tests.join(program).with_extension("rs"))?;
        taken_in.extend(
            text.lines().filter_map(|line| Some(line.strip_prefix("mod ")?.strip_suffix(';')?.to_owned())),
        );
    }
    let mut forgotten = Vec::new();
    for entry in std::fs::read_dir(&tests).with_context(|| tests.display().to_string())? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name.strip_suffix(".rs").is_some_and(|stem| !taken_in.iter().any(|module| module == stem)) {
            forgotten.push(format!("tests/{name} is in no test program"));
        }
    }
    Ok(forgotten)
}

fn read(file: &Path) -> Result<String> {
    std::fs::read_to_string(file).with_context(|| file.display().to_string())
}
