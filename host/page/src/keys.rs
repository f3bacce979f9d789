//! The table of keys as JSON, the same as `rig explain` prints.

use pneudrive_sim::rig::{Key, Kind, all_keys, chooser, preset_in_words, range_in_words, unit};
use serde_json::{Value, json};

use crate::first_keys;

/// Every key, in the order of `rig explain`.
#[must_use]
pub fn table() -> Value {
    all_keys().map(one).collect()
}

fn one(key: &'static Key) -> Value {
    let (stem, unit) = unit(key.name());
    let table = key.table();
    json!({
        "path": key.path,
        "table": table,
        "name": stem.replace('_', " "),
        // With another unit after the number, a key is written without its own.
        "stem": if table.is_empty() { stem.to_owned() } else { format!("{table}.{stem}") },
        "unit": unit,
        "meaning": key.meaning,
        "thesis": key.thesis,
        "range": range_in_words(&key.kind),
        "preset": preset_in_words(&key.preset),
        "kind": kind(&key.kind),
        "models": key.models,
        "chooser": chooser(key).map(|chooser| chooser.path),
        // Its place among the keys of the controller that are set first, by the law.
        "first": first_keys::places(key),
    })
}

fn kind(kind: &Kind) -> Value {
    match kind {
        Kind::Number { min, max } => json!({ "type": "number", "min": min, "max": max }),
        Kind::Integer { min, max } => json!({ "type": "integer", "min": min, "max": max }),
        Kind::Switch => json!({ "type": "switch" }),
        Kind::Choice(options) => {
            let built = options.iter().filter(|(_, built)| *built).map(|(word, _)| *word);
            json!({ "type": "choice", "options": built.collect::<Vec<_>>() })
        }
        Kind::Text => json!({ "type": "text" }),
        Kind::Integers { .. } | Kind::Numbers { .. } | Kind::Rows { .. } | Kind::Moves | Kind::Tables(_) => {
            json!({ "type": "list" })
        }
        Kind::DefaultOnly => json!({ "type": "default-only" }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_has_every_key_with_the_words_of_rig_explain() {
        let table = table();
        assert_eq!(table.as_array().map(Vec::len), Some(all_keys().count()));
        let mass = table.as_array().expect("a list").iter().find(|key| key["path"] == "load.mass_kg");
        let mass = mass.expect("load.mass_kg");
        let explained = pneudrive_sim::rig::explain("load.mass_kg").expect("a key");
        for fact in ["unit", "range", "preset", "meaning", "thesis"] {
            let words = mass[fact].as_str().expect("a text");
            assert!(!words.is_empty() && explained.contains(words), "{fact}: {words} in {explained}");
        }
        assert_eq!(mass["stem"], "load.mass");
    }
}
