//! Tables, keys and plain values of a file, with their lines.

use pneudrive_sim::rig::nearest;
use pneudrive_sim::rigfile::TomlFile;
use toml_edit::{Item, Table, TableLike};

/// A sweep's file that is being read.
pub(super) struct Reader<'a> {
    pub(super) file: TomlFile<'a>,
}

/// A key and its value.
pub(super) struct Entry<'a> {
    /// Its table; "" at the top.
    table: &'a str,
    /// Its name in there.
    pub(super) name: String,
    pub(super) line: Option<usize>,
    pub(super) item: &'a Item,
}

impl<'t> Reader<'t> {
    pub(super) fn new(source: &'t str, text: &'t str) -> Reader<'t> {
        Reader { file: TomlFile::new(source, text) }
    }

    /// A result without its error, which is noted.
    pub(super) fn note<T>(&mut self, entry: &Entry<'_>, result: Result<T, String>) -> Option<T> {
        let key =
            [entry.table, &entry.name].iter().filter(|part| !part.is_empty()).copied().collect::<Vec<_>>();
        result.map_err(|message| self.file.problem(entry.line, &key.join("."), message)).ok()
    }

    /// The keys at the top.
    pub(super) fn entries<'a>(&self, top: &'a Table) -> Vec<Entry<'a>> {
        self.within(top, "")
    }

    /// A key at the top.
    pub(super) fn entry<'a>(&self, top: &'a Table, name: &str) -> Option<Entry<'a>> {
        self.entries(top).into_iter().find(|entry| entry.name == name)
    }

    /// The keys of a table at the top; none if it is not there.
    pub(super) fn section<'a>(&mut self, top: &'a Table, table: &'a str) -> Vec<Entry<'a>> {
        let Some(entry) = self.entry(top, table) else { return Vec::new() };
        let form = || format!("must be a table: [{table}]");
        let inner = entry.item.as_table_like().ok_or_else(form);
        self.note(&entry, inner).map_or_else(Vec::new, |inner| self.within(inner, table))
    }

    /// The same for a table of keys of the rig: `load.mass_kg` may stand there as such or under a table `load`.
    pub(super) fn rig_keys<'a>(&mut self, top: &'a Table, table: &'a str) -> Vec<Entry<'a>> {
        let entries = self.section(top, table);
        let inner = |entry: Entry<'a>| match entry.item {
            Item::Table(keys) => {
                let entries = self.within(keys, table).into_iter();
                let named =
                    |below: Entry<'a>| Entry { name: format!("{}.{}", entry.name, below.name), ..below };
                entries.map(named).collect()
            }
            _ => vec![entry],
        };
        entries.into_iter().flat_map(inner).collect()
    }

    fn within<'a>(&self, inner: &'a dyn TableLike, table: &'a str) -> Vec<Entry<'a>> {
        let line = |name: &str, item: &Item| {
            let span = inner.key(name).and_then(toml_edit::Key::span).or_else(|| item.span());
            self.file.line_of(span)
        };
        inner
            .iter()
            .map(|(name, item)| Entry { table, name: name.to_owned(), line: line(name, item), item })
            .collect()
    }

    /// A number at the top that is more than 0.
    pub(super) fn positive(&mut self, top: &Table, name: &str, without: f64) -> f64 {
        let Some(entry) = self.entry(top, name) else { return without };
        let more = |value: f64| if value > 0.0 { Ok(value) } else { Err("must be more than 0".to_owned()) };
        self.note(&entry, number(entry.item).and_then(more)).unwrap_or(without)
    }
}

/// Refuses a name that is not known.
pub(super) fn known(name: &str, names: &[&str]) -> Result<(), String> {
    if names.contains(&name) { Ok(()) } else { Err(format!("unknown key{}", nearest_of(name, names))) }
}

/// Refuses a table with a key that is not known.
pub(super) fn only(table: &dyn TableLike, names: &[&str]) -> Result<(), String> {
    let unknown = table.iter().map(|(name, _)| name).find(|name| !names.contains(name));
    unknown.map_or(Ok(()), |name| Err(format!("unknown key {name}{}", nearest_of(name, names))))
}

/// The intended or the possible names.
pub(super) fn nearest_of(name: &str, names: &[&str]) -> String {
    match nearest(name, names.iter().copied()) {
        Some(likely) => format!("; did you mean {likely}?"),
        None => format!("; there are {}", names.join(", ")),
    }
}

pub(super) fn text(item: &Item) -> Result<String, String> {
    item.as_str()
        .map(str::to_owned)
        .ok_or_else(|| format!("must be a text in quotes, not a {}", item.type_name()))
}

pub(super) fn number(item: &Item) -> Result<f64, String> {
    let value = item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64));
    let value = value.filter(|value| value.is_finite());
    value.ok_or_else(|| format!("must be a number, not {}", item.to_string().trim()))
}

pub(super) fn count(item: &Item, least: usize, most: usize) -> Result<usize, String> {
    let value = item.as_integer().and_then(|value| usize::try_from(value).ok());
    let value = value.filter(|value| (least..=most).contains(value));
    value.ok_or_else(|| {
        format!("must be a whole number from {least} to {most}, is {}", item.to_string().trim())
    })
}

/// Two numbers in a list.
pub(super) fn pair(item: &Item, form: &str) -> Result<[f64; 2], String> {
    let list = item.as_array().filter(|list| list.len() == 2).ok_or(form)?;
    let at = |index: usize| {
        list.get(index).map_or(Err(form.to_owned()), |value| number(&Item::Value(value.clone())))
    };
    Ok([at(0)?, at(1)?])
}
