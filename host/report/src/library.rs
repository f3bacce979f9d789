//! The library that draws the graphs of a page: plotly.js, taken from its crate, so that no copy of it is in our sources.

use std::io::Write;
use std::path::Path;

use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use pneudrive_records::own_file::refuse_to_replace;
use pneudrive_records::whole_file::put;

/// Where the library of a page is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Library {
    /// In a file beside the page, 4.7 MB that all pages of a folder share.
    #[default]
    Beside,
    /// In the page, compressed: one file to be sent to somebody, 1.9 MB and its data.
    Within,
}

/// The library's own statement in every version.
const MARK: &str = "plotly.js v";

impl Library {
    /// Puts the library into the folder of a page that needs it there.
    ///
    /// # Errors
    /// When a file of its name is another's, or cannot be written.
    pub fn put_beside(self, folder: &Path) -> Result<()> {
        if self == Library::Within {
            return Ok(());
        }
        let script = script()?;
        let path = folder.join(name(script));
        let is_there = std::fs::metadata(&path).is_ok_and(|there| there.len() == script.len() as u64);
        if is_there {
            return Ok(());
        }
        refuse_to_replace(&path, MARK)?;
        put(&path, script)
    }

    /// How the library comes into a page, and the text of a page without it.
    pub(super) fn element(self) -> Result<(String, String)> {
        let script = script()?;
        let name = name(script);
        let element = match self {
            Library::Beside => format!("<script src=\"{name}\"></script>\n"),
            Library::Within => packed("library", script)?,
        };
        let without =
            format!("The graphs need {name} beside this page; --single-file puts it into the page.");
        Ok((element, without))
    }
}

/// A text as an element of a page: compressed, and in letters.
pub(super) fn packed(id: &str, text: &str) -> Result<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(text.as_bytes())?;
    let letters = STANDARD.encode(encoder.finish()?);
    Ok(format!("<script type=\"application/gzip\" id=\"{id}\">{letters}</script>\n"))
}

/// The file of the library, with its version.
fn name(script: &str) -> String {
    let version = script.split_once(MARK).and_then(|(_, rest)| rest.split_whitespace().next());
    format!("plotly-{}.min.js", version.unwrap_or("library"))
}

/// The library, without the formula renderer that comes with it.
#[cfg(not(target_family = "wasm"))]
fn script() -> Result<&'static str> {
    use std::sync::LazyLock;
    static SCRIPT: LazyLock<Option<String>> = LazyLock::new(|| {
        let scripts = plotly::Plot::offline_js_sources();
        let script = scripts.split("</script>").find(|script| script.contains(MARK))?;
        let (_, script) = script.split_once('>')?;
        Some(script.trim().to_owned())
    });
    SCRIPT.as_deref().context("the plotting library has no script")
}

/// In a browser there are no files to write, so there is nothing to put into them.
#[cfg(target_family = "wasm")]
fn script() -> Result<&'static str> {
    None.context("a browser writes no pages")
}
