//! Libraries of FMUs, and the systems that they run on, by their first bytes.
//!
//! ```text
//! ELF      7f 45 4c 46       e_machine at 18                   Linux
//! Mach-O   cf fa ed fe       cputype at 4                      macOS
//! PE       4d 5a             Machine 4 behind the place that the word at 3c names    Windows
//! ```

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};

/// A function that each FMU has: its name is in the library.
const FUNCTION: &[u8] = b"fmi3InstantiateCoSimulation";

/// A library of FMUs.
#[derive(Clone, Debug)]
pub struct Library {
    /// The processor and the system, as Rust calls them.
    pub(crate) system: [&'static str; 2],
    /// The ending of its file.
    pub(crate) suffix: &'static str,
    pub(crate) bytes: Vec<u8>,
}

impl Library {
    /// The library in a file.
    ///
    /// # Errors
    /// When it cannot be read, is another library, or of a system that is not known.
    pub fn read(path: &Path) -> Result<Library> {
        let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        ensure!(
            bytes.windows(FUNCTION.len()).any(|window| window == FUNCTION),
            "{} is not the library of FMUs: it has no {}",
            path.display(),
            String::from_utf8_lossy(FUNCTION)
        );
        let Some((system, suffix)) = system_of(&bytes) else {
            bail!("{} is no library of Linux, Windows or macOS on x86_64 or aarch64", path.display());
        };
        Ok(Library { system, suffix, bytes })
    }
}

fn system_of(bytes: &[u8]) -> Option<([&'static str; 2], &'static str)> {
    let half = |at: usize| Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let (number, x86, arm, system, suffix) = if bytes.starts_with(b"\x7fELF") {
        (half(18)?.into(), 62, 183, "linux", ".so")
    } else if word(0)? == 0xfeed_facf {
        (word(4)?, 0x0100_0007, 0x0100_000c, "macos", ".dylib")
    } else if bytes.starts_with(b"MZ") {
        let head = usize::try_from(word(0x3c)?).ok()?;
        (half(head + 4)?.into(), 0x8664, 0xaa64, "windows", ".dll")
    } else {
        return None;
    };
    let processor = [(x86, "x86_64"), (arm, "aarch64")].into_iter().find(|(of, _)| *of == number)?.1;
    Some(([processor, system], suffix))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_head_of_a_library_names_its_system() {
        let mut elf = b"\x7fELF".to_vec();
        elf.resize(18, 0);
        elf.extend(183_u16.to_le_bytes());
        assert_eq!(system_of(&elf), Some((["aarch64", "linux"], ".so")));
        let mach = [0xfeed_facf_u32.to_le_bytes(), 0x0100_000c_u32.to_le_bytes()].concat();
        assert_eq!(system_of(&mach), Some((["aarch64", "macos"], ".dylib")));
        let mut pe = b"MZ".to_vec();
        pe.resize(0x3c, 0);
        pe.extend(0x80_u32.to_le_bytes());
        pe.resize(0x84, 0);
        pe.extend(0x8664_u16.to_le_bytes());
        assert_eq!(system_of(&pe), Some((["x86_64", "windows"], ".dll")));
        for other in [&elf[..10], &mach[..6], &pe[..0x83], b"", b"MZ\xff"] {
            assert_eq!(system_of(other), None, "{other:?}");
        }
    }
}
