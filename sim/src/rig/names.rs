//! Messages about a name that no key has.

use super::table::{all_keys, find_key};
use crate::key::{Key, unit};

/// The key of a path, spelled with its unit or without: `load.mass_kg`, `load.mass`.
#[must_use]
pub fn key_of(path: &str) -> Option<&'static Key> {
    find_key(path).or_else(|| key_of_stem(path))
}

/// The key that a path without a unit means: `actuator.stroke` is actuator.stroke_m. Case does not matter.
pub(crate) fn key_of_stem(path: &str) -> Option<&'static Key> {
    let (table, name) = path.split_once('.').unwrap_or(("", path));
    all_keys().find(|key| {
        key.table() == table && !key.unit().is_empty() && unit(key.name()).0.eq_ignore_ascii_case(name)
    })
}

/// The message about a key that is not in the table: its unit, or a near miss.
pub(crate) fn unknown_key(path: &str) -> String {
    let (table, name) = path.split_once('.').unwrap_or(("", path));
    let (stem, given) = unit(name);
    let same_stem =
        all_keys().find(|key| key.table() == table && !key.unit().is_empty() && unit(key.name()).0 == stem);
    match same_stem {
        Some(key) if given.is_empty() => format!(
            "there is no such key; with its unit it is {} (in {}); or write the unit with the number, in quotes",
            key.name(),
            key.unit()
        ),
        Some(key) => {
            format!("wrong unit: this key is {}, so give it in {} instead of {given}", key.name(), key.unit())
        }
        // Of a table that does not exist, the whole path is compared.
        None if all_keys().all(|key| key.table() != table) => {
            format!("unknown key{}", did_you_mean(path, all_keys().map(|key| key.path)))
        }
        None => {
            let known = all_keys().filter(|key| key.table() == table).map(Key::name);
            format!("unknown key{}", did_you_mean(name, known))
        }
    }
}

pub(crate) fn did_you_mean<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    nearest(name, known)
        .map(|candidate| format!("; did you mean {candidate}?"))
        .unwrap_or_else(|| "; `pneudrive rig explain` lists the keys".to_owned())
}

/// The known name that is most like a name, if one is.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(likeness, _)| *likeness > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}
