//! `rig explain`: the meaning of a key.

use super::names::did_you_mean;
use super::problem::Problem;
use super::table::{all_keys, preset_value};
use super::thesis::{self, Name, THESIS};
use crate::key::{Key, Kind, Preset, Tables};
use crate::values::{Fields, Value};

/// The help text of a key, of all keys of a table, of a number of the thesis, such as C(46), of all its constants (C) or
/// flags (L), or of all keys (for an empty name).
///
/// # Errors
/// When there is no such key, table or number.
pub fn explain(name: &str) -> Result<String, Problem> {
    let exact: Vec<&Key> = all_keys()
        .chain(lists().flat_map(|list| list.fields))
        .filter(|key| key.path == name || key.name() == name)
        .collect();
    if !exact.is_empty() {
        return Ok(exact.iter().map(|key| in_full(key)).collect::<Vec<_>>().join("\n"));
    }
    if let Some(name) = thesis::named(name) {
        return Ok(of_thesis(name));
    }
    if ["C", "L"].contains(&name) {
        return Ok(THESIS.iter().filter(|entry| entry.number.starts_with(name)).map(line).collect());
    }
    let table: Vec<&Key> = all_keys().filter(|key| name.is_empty() || key.table() == name).collect();
    if table.is_empty() {
        let known = all_keys().flat_map(|key| [key.path, key.name(), key.table()]);
        let message = format!(
            "there is no such key or table, and no such number of the thesis{}",
            did_you_mean(name, known)
        );
        return Err(Problem { source: "rig explain".to_owned(), line: None, key: name.to_owned(), message });
    }
    Ok(table.iter().map(|key| format!("{:<38} {}\n", key.path, key.meaning)).collect())
}

/// A number of the thesis, and the keys that represent it.
fn of_thesis(name: &Name) -> String {
    let keys: Vec<String> = name.keys().map(in_full).collect();
    let here = if keys.is_empty() { format!("  no key     {}\n", name.instead) } else { keys.join("\n") };
    format!("{}: {}, {} in the thesis\n{here}", name.number, name.printed, name.default)
}

/// The same in a line.
fn line(name: &Name) -> String {
    let keys: Vec<&str> = name.keys().map(|key| key.path).collect();
    let here = if keys.is_empty() { format!("no key: {}", name.instead) } else { keys.join(", ") };
    format!("{:<6} {:<46} {here}\n", name.number, name.printed)
}

fn in_full(key: &Key) -> String {
    let mut lines = vec![key.path.to_owned(), format!("  {}", key.meaning)];
    let mut fact = |name: &str, value: String| {
        if !value.is_empty() {
            lines.push(format!("  {name:<10} {value}"));
        }
    };
    fact("unit", key.unit().to_owned());
    fact("range", range_in_words(&key.kind));
    fact("default", preset_in_words(&key.preset));
    fact("thesis", key.thesis.to_owned());
    let chooser = lists().find(|list| key.path.starts_with(list.path)).map_or("model", Tables::chooser);
    fact(&format!("{chooser}s"), key.models.join(", "));
    lines.push(String::new());
    let text = lines.join("\n");
    if let Kind::Tables(list) = key.kind { text + &entries(list) } else { text }
}

/// The lists of a rig file whose entries are tables.
fn lists() -> impl Iterator<Item = &'static Tables> {
    all_keys().filter_map(|key| if let Kind::Tables(list) = key.kind { Some(list) } else { None })
}

/// The words that an entry of a list may begin with, and its fields.
fn entries(list: &Tables) -> String {
    let words: String =
        list.words.iter().map(|(word, meaning)| format!("    {word:<14} {meaning}\n")).collect();
    let fields: Vec<String> = list.fields.iter().map(in_full).collect();
    format!("  {}s\n{words}\n{}", list.chooser(), fields.join("\n"))
}

/// The values that a key accepts: `0.001 to 1000`, the words of a choice.
#[must_use]
pub fn range_in_words(kind: &Kind) -> String {
    match kind {
        Kind::Number { min, max } => format!("{min} to {max}"),
        Kind::Integer { min, max } => format!("whole numbers from {min} to {max}"),
        Kind::Switch => "true, false".to_owned(),
        Kind::Choice(options) => {
            let word = |(name, built): &(&str, bool)| {
                if *built { (*name).to_owned() } else { format!("{name} (not built yet)") }
            };
            options.iter().map(word).collect::<Vec<_>>().join(", ")
        }
        Kind::Integers { min, max, max_entries } => {
            format!("1 to {max_entries} whole numbers from {min} to {max}")
        }
        Kind::Numbers { least, most } if least == most => format!("{most} numbers"),
        Kind::Numbers { least, most } => format!("{least} to {most} numbers"),
        Kind::Rows { columns, max_rows } => format!("1 to {max_rows} rows of [{}]", columns.join("; ")),
        Kind::Moves => "list of [time in s, counts] in order of time".to_owned(),
        Kind::Tables(list) => {
            let chooser = list.chooser();
            format!("tables [[{}]], each with {chooser}, at_s and the fields of its {chooser}", list.path)
        }
        Kind::Text => "text".to_owned(),
        Kind::DefaultOnly => "the default alone: no equation here has it".to_owned(),
    }
}

/// The value without a key; empty if there is none.
#[must_use]
pub fn preset_in_words(preset: &Preset) -> String {
    match preset {
        Preset::Absent(what) => format!("none: {what}"),
        other => preset_value(other).map(|value| value.to_string()).unwrap_or_default(),
    }
}

impl std::fmt::Display for Value {
    /// As TOML has it.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Value::Number(value) => write!(f, "{value}"),
            Value::Integer(value) => write!(f, "{value}"),
            Value::Switch(on) => write!(f, "{on}"),
            Value::Word(word) => write!(f, "{word:?}"),
            Value::Integers(values) => write!(f, "{values:?}"),
            Value::Numbers(values) => write!(f, "{values:?}"),
            Value::Rows(rows) => write!(f, "{rows:?}"),
            Value::Moves(moves) => {
                let moves: Vec<String> =
                    moves.iter().map(|(time, target)| format!("[{time}, {target}]")).collect();
                write!(f, "[{}]", moves.join(", "))
            }
            Value::Events(events) => {
                let one = |fields: &Fields| {
                    let fields = fields.iter().map(|(name, value)| format!("{name} = {value}"));
                    format!("{{ {} }}", fields.collect::<Vec<_>>().join(", "))
                };
                write!(f, "[{}]", events.iter().map(one).collect::<Vec<_>>().join(", "))
            }
        }
    }
}
