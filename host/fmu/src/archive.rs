//! The FMU as a file: a ZIP archive (FMI 3.0, 2.5.1; FMI 2.0, 2.3).
//!
//! ```text
//! modelDescription.xml
//! binaries/x86_64-linux/pneudrive_plant.so     the library: this crate; linux64 in FMI 2.0
//! resources/rig.toml                           the rig file, with what was set in it
//! ```

use std::io::{Cursor, Write};

use anyhow::{Context, Result, ensure};
use pneudrive_records::rig_text::with_settings;
use pneudrive_sim::Rig;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::description::model_description;
use crate::instance::RIG_FILE;
use crate::part::Part;
use crate::standard::Standard;

/// The name of the library beside the program.
#[must_use]
pub fn library_name() -> String {
    format!("{}pneudrive_fmu{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

/// The rig file of an FMU: the text of a rig with its settings, and the rig.
///
/// # Errors
/// When the text with the settings is not a valid rig, or differs from the rig with the settings.
pub fn rig_file(source: &str, text: &str, settings: &[String]) -> Result<(Rig, String)> {
    let rig = Rig::read_with(source, text, settings)?;
    let text = with_settings(text, settings, "set when the FMU was made")?;
    let read = Rig::read(RIG_FILE, &text)?;
    let same = read.entries().map(|(key, value)| (key.path, value));
    ensure!(
        same.eq(rig.entries().map(|(key, value)| (key.path, value))),
        "the settings cannot be written into the rig file; write them there yourself"
    );
    Ok((rig, text))
}

/// The bytes of an FMU: a part of a rig whose file is `rig_text`, with the library of this crate. The same in, the same out.
///
/// # Errors
/// When there is no such part of the rig, or the standard has no name for this system.
pub fn fmu(standard: Standard, part: Part, rig: &Rig, rig_text: &str, library: &[u8]) -> Result<Vec<u8>> {
    part.check(rig)?;
    let description = model_description(standard, part, rig, rig_text);
    let binary =
        format!("binaries/{}/{}{}", standard.platform()?, part.identifier(), std::env::consts::DLL_SUFFIX);
    let resource = format!("resources/{RIG_FILE}");
    let files = [
        ("modelDescription.xml", description.as_bytes()),
        (&binary, library),
        (&resource, rig_text.as_bytes()),
    ];
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        archive.start_file(name, options).context("the archive")?;
        archive.write_all(content).context("the archive")?;
    }
    Ok(archive.finish().context("the archive")?.into_inner())
}
