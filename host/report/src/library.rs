//! The library that draws the graphs of a page: plotly.js under its MIT licence, `plotly.min.js` of the package
//! plotly.js-dist-min of npm, compressed. Its crate would bring it, too, with 20 others that nothing here uses.

use std::io::Write;
use std::path::Path;

use anyhow::Result;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::{GzDecoder, GzEncoder};
use pneudrive_records::own_file::refuse_to_replace;
use pneudrive_records::whole_file::put;

/// Where the library of a page is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Library {
    /// In a file beside the page, 4.7 MB that all pages of a folder share.
    #[default]
    Linked,
    /// In the page, compressed: one file to be sent to somebody, 1.9 MB and its data.
    Embedded,
}

/// The file of the library.
const NAME: &str = "plotly-3.0.1.min.js";

/// The library's own statement in every version.
const MARK: &str = "plotly.js v";

impl Library {
    /// Puts the library into the folder of a page that needs it there.
    ///
    /// # Errors
    /// When a file of its name is another's, or cannot be written.
    pub fn put_beside(self, folder: &Path) -> Result<()> {
        if self == Library::Embedded {
            return Ok(());
        }
        let script = unpacked(library()?)?;
        let path = folder.join(NAME);
        let is_there = std::fs::metadata(&path).is_ok_and(|there| there.len() == script.len() as u64);
        if is_there {
            return Ok(());
        }
        refuse_to_replace(&path, MARK)?;
        put(&path, &script)
    }

    /// How the library comes into a page, and the text of a page without it.
    pub(super) fn element(self) -> Result<(String, String)> {
        let library = library()?;
        let element = match self {
            Library::Linked => format!("<script src=\"{NAME}\"></script>\n"),
            Library::Embedded => element("library", library),
        };
        let without =
            format!("The graphs need {NAME} beside this page; --single-file puts it into the page.");
        Ok((element, without))
    }
}

/// A text as an element of a page: compressed, and in letters.
pub(super) fn packed(id: &str, text: &str) -> Result<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(text.as_bytes())?;
    Ok(element(id, &encoder.finish()?))
}

fn element(id: &str, compressed: &[u8]) -> String {
    let letters = STANDARD.encode(compressed);
    format!("<script type=\"application/gzip\" id=\"{id}\">{letters}</script>\n")
}

fn unpacked(compressed: &[u8]) -> Result<Vec<u8>> {
    let mut decoder = GzDecoder::new(Vec::new());
    decoder.write_all(compressed)?;
    Ok(decoder.finish()?)
}

/// The library, compressed.
#[cfg(not(target_family = "wasm"))]
fn library() -> Result<&'static [u8]> {
    Ok(include_bytes!("plotly-3.0.1.min.js.gz"))
}

/// In a browser there are no files to write, so there is nothing to put into them.
#[cfg(target_family = "wasm")]
fn library() -> Result<&'static [u8]> {
    anyhow::bail!("a browser writes no pages")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_of_the_version_that_its_name_says_and_tells_its_licence() {
        let script = unpacked(library().expect("there")).expect("whole");
        let head = String::from_utf8_lossy(&script[..200]).into_owned();
        let (_, version) = head.split_once(MARK).expect("its statement");
        let version = version.split_whitespace().next().expect("a version");
        assert_eq!(NAME, format!("plotly-{version}.min.js"));
        assert!(head.contains("MIT license"), "{head}");
    }
}
