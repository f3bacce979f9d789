//! The FMU as a file: a ZIP archive (FMI 3.0, 2.5.1; FMI 2.0, 2.3).
//!
//! ```text
//! modelDescription.xml
//! documentation/index.html                     what its variables are
//! terminalsAndIcons/icon.svg, icon.png         model.png in FMI 2.0
//! binaries/x86_64-linux/pneudrive_plant.so     the library, once for each system; linux64 in FMI 2.0
//! resources/rig.toml                           the rig file, with what was set in it
//! ```

use std::io::{Cursor, Write};

use anyhow::{Context, Result, ensure};
use pneudrive_records::rig_text::with_settings;
use pneudrive_sim::Rig;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::description::model_description;
use crate::documentation::documentation;
use crate::instance::RIG_FILE;
use crate::library::Library;
use crate::part::Part;
use crate::standard::Standard;

/// The name of the library beside the program (host/fmu/library).
#[must_use]
pub fn library_name() -> String {
    format!("{}pneudrive_fmu_library{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

/// A cylinder with its valve.
const ICON_SVG: &[u8] = include_bytes!("icon.svg");
/// The same by `rsvg-convert --width 128`.
const ICON: &[u8] = include_bytes!("icon.png");

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

/// The bytes of an FMU: a part of a rig whose file is `rig_text`, with its libraries, one for each system.
/// The same in, the same out.
///
/// # Errors
/// When there is no such part of the rig, or the standard has no name for a system.
pub fn fmu(
    standard: Standard,
    part: Part,
    rig: &Rig,
    rig_text: &str,
    libraries: &[Library],
) -> Result<Vec<u8>> {
    part.check(rig)?;
    let description = model_description(standard, part, rig, rig_text);
    let binary = |library: &Library| {
        Ok(format!("binaries/{}/{}{}", standard.platform(library)?, part.identifier(), library.suffix))
    };
    let binaries = libraries.iter().map(binary).collect::<Result<Vec<String>>>()?;
    let resource = format!("resources/{RIG_FILE}");
    let page = documentation(part, rig);
    let mut files = vec![
        ("modelDescription.xml", description.as_bytes()),
        ("documentation/index.html", page.as_bytes()),
        (&resource, rig_text.as_bytes()),
    ];
    files.extend(binaries.iter().zip(libraries).map(|(name, library)| (name.as_str(), &*library.bytes)));
    match standard {
        Standard::Fmi2 => files.push(("model.png", ICON)),
        Standard::Fmi3 => {
            files.extend([("terminalsAndIcons/icon.png", ICON), ("terminalsAndIcons/icon.svg", ICON_SVG)]);
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_library_goes_into_the_folder_of_its_system() {
        let (rig, text) = rig_file("servo-b", "", &[]).expect("a rig");
        let library = |system, suffix| Library { system, suffix, bytes: vec![1, 2, 3] };
        let two = [library(["x86_64", "linux"], ".so"), library(["x86_64", "windows"], ".dll")];
        for (standard, places) in [
            (Standard::Fmi2, ["binaries/linux64/pneudrive_plant.so", "binaries/win64/pneudrive_plant.dll"]),
            (
                Standard::Fmi3,
                ["binaries/x86_64-linux/pneudrive_plant.so", "binaries/x86_64-windows/pneudrive_plant.dll"],
            ),
        ] {
            let bytes = fmu(standard, Part::Plant, &rig, &text, &two).expect("an FMU");
            let archive = zip::ZipArchive::new(Cursor::new(bytes)).expect("an archive");
            let names: Vec<_> = archive.file_names().map(|name| name.expect("a name")).collect();
            assert!(places.iter().all(|place| names.iter().any(|name| name == place)), "{names:?}");
        }
        let arm = [library(["aarch64", "linux"], ".so")];
        let refused = fmu(Standard::Fmi2, Part::Plant, &rig, &text, &arm).expect_err("no name").to_string();
        assert!(refused.contains("FMI 2.0 has no name for aarch64-linux"), "{refused}");
    }
}
