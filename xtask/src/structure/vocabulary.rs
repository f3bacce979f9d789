//! Words that have one home: names and keys of the controller's parameters in their table, words of the laws in their list. Other
//! code takes them from there.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Context, Result};
use quote::ToTokens;

use super::module::Modules;

const TABLE: &str = "shared/controller/src/parameters/table.rs";
const LAWS: &str = "shared/controller/src/choice.rs";

/// Modules of the controller that the words are spelled in, and this one.
const HOMES: [&str; 3] = ["choice", "parameters::table", "structure::vocabulary"];

/// Words that a module spells for something else: the valve's operator of that name.
const OTHERS: [(&str, &str); 2] =
    [("on-off", "component::operator"), ("on-off", "component::operator::on_off")];

/// The words, as the sources have them.
///
/// # Errors
/// When a source cannot be read.
pub fn words(root: &Path) -> Result<BTreeSet<String>> {
    let read = |file: &str| std::fs::read_to_string(root.join(file)).with_context(|| file.to_owned());
    let mut words: BTreeSet<String> = of_table(&read(TABLE)?).collect();
    words.extend(read(LAWS)?.lines().filter_map(|line| of_law(line.trim())));
    Ok(words)
}

/// Names of more than a word, and keys, of the lines of the table.
fn of_table(text: &str) -> impl Iterator<Item = String> {
    let mut section = "";
    text.lines().map(str::trim).flat_map(move |line| {
        section = line.strip_suffix(" {").filter(|word| !word.contains(' ')).unwrap_or(section);
        let own = line.starts_with(|c: char| c.is_ascii_digit()).then(|| quoted(line)).flatten();
        let key = line.split_once("] (").and_then(|(_, behind)| behind.split_once(' '));
        let of_key = key.filter(|(first, rest)| !first.contains(')') && rest.starts_with('"'));
        let of_key = of_key.map_or(own, |(_, rest)| quoted(rest));
        let has_keys = ["controller", "safety"].contains(&section);
        let path = of_key.filter(|_| own.is_some() && has_keys).map(|name| format!("{section}.{name}"));
        own.filter(|name| name.contains('_')).map(str::to_owned).into_iter().chain(path)
    })
}

/// The word of a line of the list.
fn of_law(line: &str) -> Option<String> {
    (line.starts_with('"') && line.contains("::")).then(|| quoted(line)).flatten().map(str::to_owned)
}

fn quoted(text: &str) -> Option<&str> {
    text.split('"').nth(1)
}

/// Where the modules of a crate spell one of the words.
pub fn spelled_again(modules: &Modules, words: &BTreeSet<String>) -> Vec<String> {
    let mut found = Vec::new();
    for (name, module) in &modules.0 {
        let name = name.join("::");
        if HOMES.contains(&name.as_str()) {
            continue;
        }
        let text: String = module.items.iter().map(|item| item.to_token_stream().to_string()).collect();
        let again = literals(&text).into_iter().filter(|literal| words.contains(*literal));
        let again = again.filter(|word| !OTHERS.contains(&(word, &name)));
        found.extend(
            again.map(|word| format!("{name} spells {word:?}, which has its home in the controller")),
        );
    }
    found
}

/// The texts of the string literals in Rust code.
fn literals(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find('"') {
        let (before, behind) = (&rest[..at], &rest[at + 1..]);
        let raw = before.len() - before.trim_end_matches('#').len();
        let length = if before.ends_with('\'') && behind.starts_with('\'') {
            0
        } else if raw > 0 && before.trim_end_matches('#').ends_with('r') {
            behind.find(&format!("\"{}", "#".repeat(raw))).unwrap_or(behind.len())
        } else {
            end_of(behind)
        };
        found.push(&behind[..length]);
        rest = behind.get(length + 1..).unwrap_or("");
    }
    found
}

/// Where a literal ends: at the first quote that is not escaped.
fn end_of(text: &str) -> usize {
    let mut escaped = false;
    let closes = |(_, c): &(usize, char)| {
        let ends = *c == '"' && !escaped;
        escaped = *c == '\\' && !escaped;
        ends
    };
    text.char_indices().find(closes).map_or(text.len(), |(at, _)| at)
}
