//! The SHA-256 of each file, as `sha256sum --check` reads it.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use sha2::{Digest, Sha256};

const NAME: &str = "SHA256SUMS";

/// Writes the sums of all files in a folder.
///
/// # Errors
/// When a file cannot be read.
pub fn write(folder: &Path) -> Result<()> {
    let mut sums = BTreeMap::new();
    gather(folder, folder, &mut sums)?;
    let lines: Vec<String> = sums.iter().map(|(name, sum)| format!("{sum}  {name}\n")).collect();
    fs::write(folder.join(NAME), lines.concat()).context(NAME)
}

/// The lines of a folder's sums.
///
/// # Errors
/// When there are none.
pub fn read(folder: &Path) -> Result<Vec<String>> {
    let text =
        fs::read_to_string(folder.join(NAME)).with_context(|| folder.join(NAME).display().to_string())?;
    Ok(text.lines().map(str::to_owned).collect())
}

fn gather(top: &Path, folder: &Path, sums: &mut BTreeMap<String, String>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            gather(top, &path, sums)?;
        } else {
            let name = path.strip_prefix(top)?.to_str().context("a name in UTF-8")?;
            let digest = Sha256::digest(fs::read(&path).with_context(|| name.to_owned())?);
            sums.insert(name.replace('\\', "/"), digest.iter().map(|byte| format!("{byte:02x}")).collect());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sums_are_those_of_sha256sum() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("a")).expect("a folder");
        fs::write(folder.path().join("a/abc"), "abc").expect("a file");
        fs::write(folder.path().join("empty"), "").expect("a file");
        write(folder.path()).expect("sums");
        // FIPS 180-4's example, and the sum of nothing.
        let wanted = [
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  a/abc",
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  empty",
        ];
        assert_eq!(read(folder.path()).expect("sums"), wanted);
    }
}
