//! `[[faults.event]]`: the one list of a rig file whose entries are tables.
//!
//! Its fields are declared in [`crate::component::faults`] and read like the keys of the file.

use toml_edit::{Item, TableLike};

use super::names::did_you_mean;
use super::reader::Reader;
use super::table::preset_value;
use super::value::value_of;
use crate::component::faults::{FIELDS, PATH};
use crate::key::{Key, Preset};
use crate::values::{Fields, Value, whole_microseconds};

fn name_of(field: &Key) -> &'static str {
    field.path.rsplit('.').next().unwrap_or(field.path)
}

/// The fields that a kind has.
fn fields_of(kind: &str) -> impl Iterator<Item = &'static Key> {
    FIELDS.iter().filter(move |field| field.models.is_empty() || field.models.contains(&kind))
}

impl Reader<'_> {
    /// The list of events: tables, or a list of tables in one line.
    pub(super) fn events(&mut self, line: Option<usize>, item: &Item) -> Option<Value> {
        let Some(tables) = tables(item) else {
            let message = "write each event as a table: [[faults.event]] with its kind and at_s below it";
            self.file.problem(line, PATH, message.to_owned());
            return None;
        };
        let events = tables.into_iter().filter_map(|(table, span)| {
            let line = self.file.line_of(span).or(line);
            self.event(line, table)
        });
        Some(Value::Events(events.collect()))
    }

    /// One event, which begins at `line`.
    fn event(&mut self, line: Option<usize>, table: &dyn TableLike) -> Option<Fields> {
        let mut event = Fields::new();
        let kind = self.field(line, table, &FIELDS[0])?;
        let Value::Word(word) = &kind else { return None };
        for (name, _) in table.iter() {
            self.refuse_stray(table, word, name);
        }
        for field in fields_of(word).skip(1) {
            if table.contains_key(name_of(field)) || preset_value(&field.preset).is_none() {
                event.extend(self.field(line, table, field).map(|value| (name_of(field), value)));
            } else {
                event.extend(preset_value(&field.preset).map(|value| (name_of(field), value)));
            }
        }
        event.insert(0, ("kind", kind));
        Some(event)
    }

    /// The value of a field that is there, or must be.
    fn field(&mut self, line: Option<usize>, table: &dyn TableLike, field: &Key) -> Option<Value> {
        let name = name_of(field);
        let Some(item) = table.get(name) else {
            if field.preset == Preset::Absent("must be given") {
                self.file.problem(line, field.path, format!("every event needs its {name}"));
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

    /// Notes a field that no event of this kind has.
    fn refuse_stray(&mut self, table: &dyn TableLike, kind: &str, name: &str) {
        if fields_of(kind).any(|field| name_of(field) == name) {
            return;
        }
        let message = match FIELDS.iter().find(|field| name_of(field) == name) {
            Some(field) => {
                format!("does not belong to a fault of the kind {kind}, but to {}", field.models.join(", "))
            }
            None => format!("unknown key{}", did_you_mean(name, fields_of(kind).map(name_of))),
        };
        let line = self.file.line_of(table.key(name).and_then(toml_edit::Key::span));
        self.file.problem(line, &format!("{PATH}.{name}"), message);
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
