//! Texts that users keep, through whatever editor or system they came: with a byte order mark, with CRLF, with empty lines at
//! the end.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use pneudrive_tables::text::utf8;

/// The text of a file: UTF-8, without a byte order mark.
///
/// # Errors
/// When it cannot be read, or has another encoding: with the file, and the remedy.
pub fn read(path: &Path) -> Result<String> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    utf8(&bytes).with_context(|| path.display().to_string())
}

/// The same of a file that this program wrote: with LF, and with one line break at the end where there are more.
///
/// # Errors
/// As [`read`].
pub(crate) fn read_own(path: &Path) -> Result<String> {
    read(path).map(|text| as_written(&text))
}

/// A text that this program wrote as it was before other programs changed its line breaks.
#[must_use]
pub(crate) fn as_written(text: &str) -> String {
    let mut text = text.replace("\r\n", "\n");
    // Repeated conversions leave more than one CR.
    while text.contains("\r\n") {
        text = text.replace("\r\n", "\n");
    }
    while text.ends_with("\n\n") {
        text.pop();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_comes_back_through_editors_and_systems() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.txt");
        for changed in ["\u{feff}a\nb\n", "a\r\nb\r\n", "a\r\r\nb\r\r\n", "a\nb\n\n\r\n"] {
            fs::write(&path, changed).expect("written");
            assert_eq!(read_own(&path).expect("a text"), "a\nb\n", "{changed:?}");
        }
        assert_eq!(as_written("a\nb"), "a\nb", "a cut line stays cut");
        let wide: Vec<u8> = "\u{feff}a\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        fs::write(&path, wide).expect("written");
        let told = format!("{:#}", read(&path).expect_err("refused"));
        assert!(told.ends_with("a.txt: it is UTF-16: save it as UTF-8"), "{told}");
    }
}
