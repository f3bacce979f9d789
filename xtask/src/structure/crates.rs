//! Layers of crates: a crate depends on crates of lower layers only.

use std::path::Path;

use anyhow::{Context, Result};
use toml_edit::{DocumentMut, Item};

/// The crates, from the lowest layer up, with their folders. Those of one layer do not know each other.
const LAYERS: [&[(&str, &str)]; 10] = [
    &[("pneudrive-controller", "shared/controller"), ("pneudrive-solver", "sim/solver")],
    &[
        ("pneudrive-protocol", "shared/protocol"),
        ("pneudrive-sim", "sim"),
        ("pneudrive-tables", "host/tables"),
    ],
    &[
        ("pneudrive-app", "firmware/app"),
        ("pneudrive-records", "host/records"),
        ("pneudrive-design", "host/design"),
    ],
    &[
        ("pneudrive-interfaces", "firmware/interfaces"),
        ("pneudrive-plan", "firmware/plan"),
        ("pneudrive-link", "host/link"),
        ("pneudrive-analysis", "host/analysis"),
    ],
    &[
        ("pneudrive-rigs", "host/rigs"),
        ("pneudrive-logs", "host/logs"),
        ("pneudrive-page", "host/page"),
        ("pneudrive-fmu", "host/fmu"),
        ("pneudrive-link-states", "hil-tests/link-states"),
    ],
    &[("pneudrive-studio", "host/studio"), ("pneudrive-python", "host/python")],
    &[("pneudrive", "host")],
    &[("xtask", "xtask")],
    &[("pneudrive-hil-tests", "hil-tests"), ("pneudrive-fuzz", "fuzz")],
    &[("pneudrive-flashed-image", "hil-tests/flashed-image")],
];

/// Dependencies that do not go down.
///
/// # Errors
/// When a manifest cannot be read.
pub fn upward(root: &Path) -> Result<Vec<String>> {
    let mut broken = Vec::new();
    for (layer, crates) in LAYERS.iter().enumerate() {
        for (name, folder) in *crates {
            let file = root.join(folder).join("Cargo.toml");
            let text = std::fs::read_to_string(&file).with_context(|| file.display().to_string())?;
            broken.extend(not_below(name, layer, &text).with_context(|| file.display().to_string())?);
        }
    }
    Ok(broken)
}

/// Dependencies of a manifest of this layer that are not of a lower one.
pub fn not_below(name: &str, layer: usize, manifest: &str) -> Result<Vec<String>> {
    let document: DocumentMut = manifest.parse()?;
    let dependencies = document.get("dependencies").and_then(Item::as_table);
    let named = dependencies.into_iter().flat_map(|table| table.iter()).map(|(key, _)| key.to_owned());
    let above =
        |key: &String| LAYERS[layer..].iter().flat_map(|crates| crates.iter()).any(|(other, _)| other == key);
    Ok(named
        .filter(above)
        .map(|key| format!("{name} depends on {key}, which is not a layer below it"))
        .collect())
}
