//! The lists of a rig file whose entries are tables: `[[faults.event]]` ([`crate::component::faults`]) and
//! `[[test.move]]` ([`crate::schedule`]). Their fields are read like the keys of the file. The first field chooses
//! among the others.

use toml_edit::{Item, TableLike};

use super::reader::Reader;
use super::value::value_of;
use crate::key::{Key, Preset, Tables};
use crate::rig::{did_you_mean, preset_value};
use crate::values::{Fields, Value, whole_microseconds};

fn name_of(field: &Key) -> &'static str {
    field.path.rsplit('.').next().unwrap_or(field.path)
}

/// The fields that an entry with this word has.
fn fields_of(list: &'static Tables, word: &str) -> impl Iterator<Item = &'static Key> {
    list.fields.iter().filter(move |field| field.models.is_empty() || field.models.contains(&word))
}

impl Reader<'_> {
    /// A list: tables, or a list of tables in one line.
    pub(super) fn list(&mut self, list: &'static Tables, line: Option<usize>, item: &Item) -> Option<Value> {
        let Some(tables) = tables(item) else {
            let Tables { path, entry, fields, .. } = list;
            let message = format!(
                "write each {entry} as a table: [[{path}]] with its {} and at_s below it",
                name_of(&fields[0])
            );
            self.file.problem(line, path, message);
            return None;
        };
        let entries = tables.into_iter().filter_map(|(table, span)| {
            let line = self.file.line_of(span).or(line);
            self.list_entry(list, line, table)
        });
        Some(Value::Events(entries.collect()))
    }

    /// One entry, which begins at `line`.
    fn list_entry(
        &mut self,
        list: &'static Tables,
        line: Option<usize>,
        table: &dyn TableLike,
    ) -> Option<Fields> {
        let mut entry = Fields::new();
        let chosen = self.field(list, line, table, &list.fields[0])?;
        let Value::Word(word) = &chosen else { return None };
        for (name, _) in table.iter() {
            self.refuse_stray(list, table, word, name);
        }
        for field in fields_of(list, word).skip(1) {
            if table.contains_key(name_of(field)) || preset_value(&field.preset).is_none() {
                entry.extend(self.field(list, line, table, field).map(|value| (name_of(field), value)));
            } else {
                entry.extend(preset_value(&field.preset).map(|value| (name_of(field), value)));
            }
        }
        entry.insert(0, (name_of(&list.fields[0]), chosen));
        Some(entry)
    }

    /// The value of a field that is there, or must be.
    fn field(
        &mut self,
        list: &Tables,
        line: Option<usize>,
        table: &dyn TableLike,
        field: &Key,
    ) -> Option<Value> {
        let name = name_of(field);
        let Some(item) = table.get(name) else {
            if field.preset == Preset::Absent("must be given") {
                self.file.problem(line, field.path, format!("every {} needs its {name}", list.entry));
            }
            return None;
        };
        let whole = |value: &Value| match value {
            Value::Number(seconds) if field.unit() == "s" => whole_microseconds(*seconds).is_some(),
            _ => true,
        };
        let read = value_of(field, item).and_then(|value| match whole(&value) {
            true => Ok(value),
            false => Err("must be a whole number of microseconds".to_owned()),
        });
        let at = self.file.line_of(table.key(name).and_then(toml_edit::Key::span)).or(line);
        read.map_err(|message| self.file.problem(at, field.path, message)).ok()
    }

    /// Notes a field that no entry with this word has.
    fn refuse_stray(&mut self, list: &'static Tables, table: &dyn TableLike, word: &str, name: &str) {
        if fields_of(list, word).any(|field| name_of(field) == name) {
            return;
        }
        let message = match list.fields.iter().find(|field| name_of(field) == name) {
            Some(field) => {
                format!("does not belong to {} {word}, but to {}", list.entry_with, field.models.join(", "))
            }
            None => format!("unknown key{}", did_you_mean(name, fields_of(list, word).map(name_of))),
        };
        let line = self.file.line_of(table.key(name).and_then(toml_edit::Key::span));
        self.file.problem(line, &format!("{}.{name}", list.path), message);
    }
}

type Span = Option<std::ops::Range<usize>>;

fn tables(item: &Item) -> Option<Vec<(&dyn TableLike, Span)>> {
    match item {
        Item::ArrayOfTables(list) => {
            Some(list.iter().map(|table| (table as &dyn TableLike, table.span())).collect())
        }
        Item::Value(toml_edit::Value::Array(list)) => {
            let table = |value: &toml_edit::Value| value.as_inline_table().is_some();
            let inline = list.iter().filter_map(toml_edit::Value::as_inline_table);
            list.iter()
                .all(table)
                .then(|| inline.map(|table| (table as &dyn TableLike, table.span())).collect())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests;
