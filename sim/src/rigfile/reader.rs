//! Takes a rig file apart: every problem with its file, line and key.

use std::collections::{BTreeMap, BTreeSet};

use toml_edit::{ArrayOfTables, Item, Table, TableLike};

use super::origin::{Stated, stated};
use super::quantity;
use super::toml_file::TomlFile;
use super::value::{end_of, is_gauge, item_of, value_of, with_unit};
use crate::key::{Key, Kind};
use crate::keys;
use crate::rig::{Problem, all_keys, did_you_mean, find_key, key_of_stem, unknown_key};
use crate::schedule::MOVE_FORMS;
use crate::values::{Findings, Origin, Rig, Value};

/// The name of the command line's settings in messages.
const SETTING: &str = "--set";

/// The file that is being read, and the problems found so far.
pub(super) struct Reader<'a> {
    pub file: TomlFile<'a>,
    /// Lines of the keys that the file has.
    lines: BTreeMap<&'static str, Option<usize>>,
    /// Gauge pressures: they wait until the pressure of the surroundings is known.
    gauge: BTreeMap<&'static str, Entry>,
    /// Keys of the file that have no effect in its own rig.
    pub in_vain: BTreeSet<&'static str>,
}

/// The contents of a file that a reader keeps for later settings.
#[derive(Clone, Debug)]
pub(super) struct Noted {
    problems: Vec<Problem>,
    lines: BTreeMap<&'static str, Option<usize>>,
    gauge: BTreeMap<&'static str, Entry>,
    in_vain: BTreeSet<&'static str>,
}

/// The item at a key.
#[derive(Clone, Debug)]
struct Entry {
    key: &'static Key,
    /// As the file spells it: with its unit, or without it in front of a number with one.
    path: String,
    line: Option<usize>,
    stated: Stated,
}

impl<'a> Reader<'a> {
    /// Reads a file or settings for messages under the name `source`.
    pub fn new(source: &'a str, text: &'a str) -> Self {
        let file = TomlFile::new(source, text);
        Reader { file, lines: BTreeMap::new(), gauge: BTreeMap::new(), in_vain: BTreeSet::new() }
    }

    /// Goes on after a file that was read under the name `source`.
    pub fn resume(source: &'a str, noted: Noted) -> Self {
        let Noted { problems, lines, gauge, in_vain } = noted;
        let mut file = TomlFile::new(source, "");
        file.problems = problems;
        Reader { file, lines, gauge, in_vain }
    }

    /// The values found in the file.
    pub fn into_noted(self) -> Noted {
        let Reader { file, lines, gauge, in_vain } = self;
        Noted { problems: file.problems, lines, gauge, in_vain }
    }

    /// Notes a contradiction; lines are known for keys that the file has.
    pub fn note(&mut self, findings: Findings) {
        for (path, message) in findings.0 {
            let line = self.lines.get(path).copied().flatten();
            self.file.problem(line, path, message);
        }
    }

    pub fn top(&mut self, rig: &mut Rig, top: &Table) {
        for (name, item) in top.iter() {
            let line = self.file.line_of(top.key(name).and_then(toml_edit::Key::span));
            match item {
                Item::Table(table) => self.table(rig, name, table),
                Item::ArrayOfTables(tables) => self.tables(name, tables),
                Item::Value(toml_edit::Value::InlineTable(table)) => self.table(rig, name, table),
                item => self.item(rig, name, line, item),
            }
        }
    }

    fn table(&mut self, rig: &mut Rig, name: &str, table: &dyn TableLike) {
        let line = table.iter().next().and_then(|(first, _)| self.file.line_of(table.key(first)?.span()));
        if !all_keys().any(|key| key.is_in(name)) {
            let known = all_keys().map(Key::table).filter(|table| !table.is_empty());
            let message = format!("there is no table [{name}]{}", did_you_mean(name, known));
            self.file.problem(line, name, message);
            return;
        }
        for (entry, item) in table.iter() {
            let line = self.file.line_of(table.key(entry).and_then(toml_edit::Key::span));
            self.item(rig, &format!("{name}.{entry}"), line, item);
        }
    }

    fn tables(&mut self, name: &str, tables: &ArrayOfTables) {
        let line = self.file.line_of(tables.span());
        self.file.problem(line, name, format!("[{name}] is one table; write [{name}], not [[{name}]]"));
    }

    fn item(&mut self, rig: &mut Rig, path: &str, line: Option<usize>, item: &Item) {
        let by_stem = || key_of_stem(path).filter(|_| item.is_str() || item.is_inline_table());
        let Some(key) = find_key(path).or_else(by_stem) else {
            let number = item.as_float().or_else(|| item.as_integer().map(|number| number as f64));
            let likely = number.and_then(|number| {
                Some(format!(": {:?}?", quantity::likely(number, key_of_stem(path)?.unit())))
            });
            self.file.problem(line, path, unknown_key(path) + &likely.unwrap_or_default());
            return;
        };
        let former = self.lines.insert(key.path, line);
        if former.is_some() && self.file.source != SETTING {
            let message = format!("{} is given twice, with and without its unit", key.path);
            self.file.problem(line, path, message);
            return;
        }
        if let Kind::Tables(list) = key.kind {
            rig.put(key.path, self.list(list, line, item));
            rig.set.insert(key.path);
            return;
        }
        match stated(item) {
            Ok(stated) => self.entry(rig, Entry { key, path: path.to_owned(), line, stated }),
            Err(message) => self.file.problem(line, path, message),
        }
    }

    /// Takes an entry, or puts it aside until the pressure of the surroundings is known.
    fn entry(&mut self, rig: &mut Rig, entry: Entry) {
        self.gauge.remove(entry.key.path);
        if is_gauge(entry.key, &entry.path, &entry.stated) {
            self.gauge.insert(entry.key.path, entry);
        } else {
            self.put(rig, &entry);
        }
    }

    fn put(&mut self, rig: &mut Rig, entry: &Entry) {
        match value_and_origin(entry, rig.get(&keys::exhaust::PRESSURE_PA)) {
            Ok((value, origin)) => {
                rig.put(entry.key.path, Some(value));
                rig.set.insert(entry.key.path);
                match origin {
                    Some(origin) => rig.origins.insert(entry.key.path, origin),
                    None => rig.origins.remove(entry.key.path),
                };
            }
            Err(message) => self.file.problem(entry.line, &entry.path, message),
        }
    }

    /// Accepts the values that have waited for the pressure of the surroundings.
    pub fn finish(&mut self, rig: &mut Rig) {
        for entry in std::mem::take(&mut self.gauge).into_values() {
            if entry.key.path == keys::exhaust::PRESSURE_PA.path {
                let message = "the surroundings are what gauge pressures count from: give it as absolute";
                self.file.problem(entry.line, &entry.path, message.to_owned());
            } else {
                self.put(rig, &entry);
            }
        }
    }

    /// The last setting holds: moves in another form replace those of the file.
    fn replace_moves(&mut self, rig: &mut Rig, path: &str) {
        if !MOVE_FORMS.iter().any(|form| form.path == path) {
            return;
        }
        for other in MOVE_FORMS.iter().filter(|form| form.path != path) {
            rig.set.remove(other.path);
            if other.path != keys::test::MOVES.path {
                rig.put(other.path, None);
            }
        }
    }

    /// One `key=value` of the command line.
    pub fn setting(&mut self, rig: &mut Rig, setting: &str) {
        let source = std::mem::replace(&mut self.file.source, SETTING);
        let (path, text) = setting.split_once('=').unwrap_or((setting, ""));
        let (path, text) = (path.trim(), text.trim());
        if text.is_empty() {
            self.file.problem(None, path, "write key=value, such as --set load.mass_kg=2.5".to_owned());
        } else {
            self.item(rig, path, None, &item_of(text));
        }
        self.replace_moves(rig, path);
        self.file.source = source;
    }
}

/// The value of an entry in the unit of its key, and where it comes from.
fn value_and_origin(entry: &Entry, surroundings: f64) -> Result<(Value, Option<Origin>), String> {
    let Entry { key, path, stated, .. } = entry;
    let value = value_of(key, &with_unit(key, path, &stated.value, surroundings)?)?;
    let origin = match &stated.origin {
        None => None,
        Some(origin) => {
            let range = match &origin.range {
                None => None,
                Some([low, high]) => {
                    Some(within(&value, [end_of(key, low, surroundings)?, end_of(key, high, surroundings)?])?)
                }
            };
            Some(Origin { source: origin.source, range, from: origin.from.clone() })
        }
    };
    Ok((value, origin))
}

/// The range, if the value lies in it.
fn within(value: &Value, range: [f64; 2]) -> Result<[f64; 2], String> {
    let number = match value {
        Value::Number(number) => *number,
        Value::Integer(number) => *number as f64,
        _ => return Err("cannot have low and high: it is not a number".to_owned()),
    };
    let [low, high] = range;
    if (low..=high).contains(&number) {
        Ok(range)
    } else {
        Err(format!("must lie between its low, {low}, and its high, {high}, is {number}"))
    }
}
