//! Takes a rig file apart: every problem with its file, line and key.

use std::collections::BTreeMap;

use toml_edit::{ArrayOfTables, Item, Table, TableLike};

use super::names::{did_you_mean, unknown_key};
use super::table::{all_keys, find_key};
use super::toml_file::TomlFile;
use super::value::{item_of, value_of};
use crate::key::{Key, Kind};
use crate::keys;
use crate::values::{Findings, Rig};

/// What is being read, and what was found wrong so far.
pub(super) struct Reader<'a> {
    pub file: TomlFile<'a>,
    /// Lines of the keys that the file has.
    lines: BTreeMap<&'static str, Option<usize>>,
}

impl<'a> Reader<'a> {
    /// Reads a file or settings for messages under the name `source`.
    pub fn new(source: &'a str, text: &'a str) -> Self {
        Reader { file: TomlFile::new(source, text), lines: BTreeMap::new() }
    }

    /// Notes what does not go together; the lines are known of keys that the file has.
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
        if !all_keys().any(|key| key.table() == name) {
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
        let Some(key) = find_key(path) else {
            self.file.problem(line, path, unknown_key(path));
            return;
        };
        self.lines.insert(key.path, line);
        if key.kind == Kind::Events {
            rig.put(key.path, self.events(line, item));
            rig.set.insert(key.path);
            return;
        }
        match value_of(key, item) {
            Ok(value) => {
                rig.put(key.path, Some(value));
                rig.set.insert(key.path);
            }
            Err(message) => self.file.problem(line, path, message),
        }
    }

    /// One `key=value` of the command line.
    pub fn setting(&mut self, rig: &mut Rig, setting: &str) {
        let source = std::mem::replace(&mut self.file.source, "--set");
        let (path, text) = setting.split_once('=').unwrap_or((setting, ""));
        let (path, text) = (path.trim(), text.trim());
        if text.is_empty() {
            self.file.problem(None, path, "write key=value, such as --set load.mass_kg=2.5".to_owned());
        } else {
            self.item(rig, path, None, &item_of(text));
        }
        // What is typed last holds: targets replace the moves of the file.
        if path == keys::test::TARGETS.path {
            rig.set.remove(keys::test::MOVES.path);
        }
        self.file.source = source;
    }
}
