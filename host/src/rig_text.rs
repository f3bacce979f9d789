//! Rig files as text: other values in the places of old ones, and all comments kept.

use anyhow::{Context, Result, anyhow};
use toml_edit::{DocumentMut, Item, Table, Value};

/// The text with these settings, `key=value`, each with a comment on where it comes from.
///
/// # Errors
/// When the text is no TOML, or a setting is none.
pub fn with_settings(text: &str, settings: &[String], source: &str) -> Result<String> {
    let mut document: DocumentMut = text.parse().context("the rig file")?;
    for setting in settings {
        let (path, given) = setting.split_once('=').ok_or_else(|| anyhow!("{setting}: write KEY=VALUE"))?;
        let given = given.trim();
        let mut value: Value = given.parse().unwrap_or_else(|_| given.into());
        value.decor_mut().set_suffix(format!("  # {source}"));
        put(&mut document, path.trim(), Item::Value(value));
    }
    Ok(document.to_string())
}

/// Puts an item where a path such as `load.mass_kg` leads.
pub fn put(document: &mut DocumentMut, path: &str, item: Item) {
    let Some((table, name)) = path.split_once('.') else {
        document[path] = item;
        return;
    };
    let table = document.entry(table).or_insert(Item::Table(Table::new()));
    table[name] = item;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_takes_its_place_and_all_other_comments_stay() {
        let text =
            "# A rig.\nname = \"x\"\n\n[load]\nmass_kg = 1.6   # C(17)\nviscous_n_s_per_m = 30.0 # C(18)\n";
        let settings = ["load.mass_kg=2.5", "valve.model=flow-node"].map(str::to_owned);
        let with = with_settings(text, &settings, "measured").expect("TOML");
        assert_eq!(
            with,
            "# A rig.\nname = \"x\"\n\n[load]\nmass_kg = 2.5  # measured\nviscous_n_s_per_m = 30.0 # C(18)\n\n[valve]\nmodel = \"flow-node\"  # measured\n"
        );
        assert!(with_settings("[load", &settings, "measured").is_err());
        assert!(with_settings(text, &["load.mass_kg".to_owned()], "measured").is_err());
    }
}
