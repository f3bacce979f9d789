//! Libraries that one module of a crate knows: the rest of the crate does without them.

use std::path::Path;

use anyhow::Result;
use quote::ToTokens;

use super::module::Modules;
use super::paths::shown;

/// A crate, a library, and the module of the crate that alone imports it.
const HOMES: [(&str, &str, &str); 2] = [("sim", "toml_edit", "rigfile"), ("sim", "uom", "rigfile")];

/// Where crates name a library outside of its module.
///
/// # Errors
/// When a source cannot be read.
pub fn named_elsewhere(root: &Path) -> Result<Vec<String>> {
    let mut broken = Vec::new();
    for (folder, library, home) in HOMES {
        let modules = Modules::read(&root.join(folder).join("src"))?;
        let found = in_crate(&modules, library, home);
        broken.extend(found.into_iter().map(|text| format!("{folder}: {text}")));
    }
    Ok(broken)
}

/// The modules that name a library and do not stand in its home.
pub fn in_crate(modules: &Modules, library: &str, home: &str) -> Vec<String> {
    let outside = modules.0.iter().filter(|(name, _)| name.first().is_none_or(|first| first != home));
    let naming = outside.filter(|(_, module)| {
        let mut words = module.items.iter().map(|item| item.to_token_stream().to_string());
        words.any(|text| text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == library))
    });
    naming.map(|(name, _)| format!("{} names {library}, which is for {home} alone", shown(name))).collect()
}
