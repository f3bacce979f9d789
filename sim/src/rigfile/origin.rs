//! The origin of a value, as a rig file states it: `{ typical = 20.0, low = 8.0, high = 40.0, from = "..." }`.

use toml_edit::{InlineTable, Item};

use crate::values::Source;

/// Words under which a rig file gives a value together with where it comes from.
const SOURCES: [(&str, Source); 4] = [
    ("given", Source::Given),
    ("computed", Source::Computed),
    ("typical", Source::Typical),
    ("unknown", Source::Unknown),
];

/// A value as a file states it.
#[derive(Clone, Debug)]
pub(super) struct Stated {
    pub value: Item,
    /// None where the file gives the bare value.
    pub origin: Option<StatedOrigin>,
}

/// Where the file says that it comes from.
#[derive(Clone, Debug)]
pub(super) struct StatedOrigin {
    pub source: Source,
    /// The ends of the range in which the value lies.
    pub range: Option<[Item; 2]>,
    pub from: String,
}

/// The value of a key, from the item after its equals sign.
///
/// # Errors
/// The problems of a table that states an origin.
pub(super) fn stated(item: &Item) -> Result<Stated, String> {
    let Some(table) = item.as_inline_table() else {
        return Ok(Stated { value: item.clone(), origin: None });
    };
    let mut found = SOURCES.iter().filter_map(|(word, source)| Some((table.get(word)?, *source)));
    let (value, source) = match (found.next(), found.next()) {
        (Some(one), None) => one,
        _ => return Err("has one of given, computed, typical and unknown, which is the value".to_owned()),
    };
    for (name, _) in table.iter() {
        if !SOURCES.iter().any(|(word, _)| *word == name) && !["low", "high", "from"].contains(&name) {
            return Err(format!(
                "{name} is not one of given, computed, typical, unknown, low, high and from"
            ));
        }
    }
    let range = range(table)?;
    if source == Source::Unknown && range.is_none() {
        return Err("an unknown value needs low and high, between which it lies".to_owned());
    }
    let from = table.get("from").map_or(Some(""), toml_edit::Value::as_str);
    let from = from.ok_or("from must be a text in quotes")?.to_owned();
    Ok(Stated { value: Item::Value(value.clone()), origin: Some(StatedOrigin { source, range, from }) })
}

fn range(table: &InlineTable) -> Result<Option<[Item; 2]>, String> {
    match (table.get("low"), table.get("high")) {
        (Some(low), Some(high)) => Ok(Some([low, high].map(|end| Item::Value(end.clone())))),
        (None, None) => Ok(None),
        _ => Err("low and high go together".to_owned()),
    }
}
