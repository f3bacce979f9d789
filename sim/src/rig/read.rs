//! Reading a rig file: every problem with its file, line and key.

use toml_edit::{ArrayOfTables, Document, Item, Table, TableLike};

use super::keys::{self, Default, KEYS, Key, Kind};
use super::problem::{Problem, Problems, line_at};
use super::{Rig, Value, default_value};

/// What is being read, and what was found wrong so far.
pub(super) struct Reader<'a> {
    source: &'a str,
    text: &'a str,
    lines: Vec<Option<usize>>,
    problems: Vec<Problem>,
}

impl Rig {
    /// Reads a rig file; `source` is its name for messages.
    ///
    /// # Errors
    /// Every problem with its line and key.
    pub fn read(source: &str, text: &str) -> Result<Rig, Problems> {
        Rig::read_with(source, text, &[])
    }

    /// Reads a rig file and applies `key=value` settings, each in TOML syntax.
    ///
    /// # Errors
    /// Every problem with its line and key.
    pub fn read_with(source: &str, text: &str, settings: &[String]) -> Result<Rig, Problems> {
        let mut reader = Reader { source, text, lines: vec![None; KEYS.len()], problems: Vec::new() };
        let mut rig = Rig::defaults();
        match Document::parse(text) {
            Ok(document) => reader.top(&mut rig, document.as_table()),
            Err(error) => reader.problems.push(Problem::of_syntax(source, text, &error)),
        }
        for setting in settings {
            reader.setting(&mut rig, setting);
        }
        rig.suit_drive_stage();
        if reader.problems.is_empty() {
            reader.check(&rig);
        }
        if reader.problems.is_empty() { Ok(rig) } else { Err(Problems(reader.problems)) }
    }
}

impl Rig {
    /// What is counted in commands follows the drive stage where the file does not give it: the scale of
    /// the law (6.3.3), and the dead zone of the valve, 0.05 mm.
    fn suit_drive_stage(&mut self) {
        let of_stepper = [
            ("controller.scale", 65_536),
            ("controller.dead_zone_counts", 4),
            ("controller.homing_command_counts", -4),
        ];
        for (path, value) in of_stepper {
            let index = Rig::index(path);
            if self.word("operator.model") == "stepper" && !self.set[index] {
                self.values[index] = Some(Value::Integer(value));
            }
        }
    }

    /// This rig with `key=value` settings applied, each in TOML syntax.
    ///
    /// # Errors
    /// Every problem with its key.
    pub fn with_settings(&self, settings: &[String]) -> Result<Rig, Problems> {
        let source = self.name().to_owned();
        let mut reader =
            Reader { source: &source, text: "", lines: vec![None; KEYS.len()], problems: Vec::new() };
        let mut rig = self.clone();
        for setting in settings {
            reader.setting(&mut rig, setting);
        }
        let problems = reader.problems;
        if problems.is_empty() { rig.checked(&source) } else { Err(Problems(problems)) }
    }

    /// This rig with another test: that of the empty file with `key=value` settings applied.
    ///
    /// # Errors
    /// Every problem with its key.
    pub fn with_test(&self, settings: &[String]) -> Result<Rig, Problems> {
        let mut rig = self.clone();
        for (index, key) in KEYS.iter().enumerate().filter(|(_, key)| key.table() == "test") {
            (rig.values[index], rig.set[index]) = (default_value(&key.default), false);
        }
        rig.with_settings(settings)
    }

    /// The rig, if all that must hold between its keys does; `source` is for messages.
    pub(super) fn checked(self, source: &str) -> Result<Rig, Problems> {
        let mut reader = Reader { source, text: "", lines: vec![None; KEYS.len()], problems: Vec::new() };
        reader.check(&self);
        if reader.problems.is_empty() { Ok(self) } else { Err(Problems(reader.problems)) }
    }
}

impl Reader<'_> {
    /// Notes a problem with a key of the file; its line is known if the file has the key.
    pub(super) fn problem_at_key(&mut self, path: &str, message: String) {
        let line = KEYS.iter().position(|key| key.path == path).and_then(|i| self.lines[i]);
        self.problem(line, path, message);
    }

    /// Whether nothing wrong was found so far.
    pub(super) fn is_clean(&self) -> bool {
        self.problems.is_empty()
    }

    pub(super) fn problem(&mut self, line: Option<usize>, key: &str, message: String) {
        self.problems.push(Problem { source: self.source.to_owned(), line, key: key.to_owned(), message });
    }

    pub(super) fn line_of(&self, span: Option<std::ops::Range<usize>>) -> Option<usize> {
        span.map(|span| line_at(self.text, span.start))
    }

    fn top(&mut self, rig: &mut Rig, top: &Table) {
        for (name, item) in top.iter() {
            let line = self.line_of(top.key(name).and_then(toml_edit::Key::span));
            match item {
                Item::Table(table) => self.table(rig, name, table),
                Item::ArrayOfTables(tables) => self.tables(name, tables),
                Item::Value(toml_edit::Value::InlineTable(table)) => self.table(rig, name, table),
                item => self.item(rig, name, line, item),
            }
        }
    }

    fn table(&mut self, rig: &mut Rig, name: &str, table: &dyn TableLike) {
        let line = table.iter().next().and_then(|(first, _)| self.line_of(table.key(first)?.span()));
        if !KEYS.iter().any(|key| key.table() == name) {
            let known = KEYS.iter().map(Key::table).filter(|table| !table.is_empty());
            let message = format!("there is no table [{name}]{}", did_you_mean(name, known));
            self.problem(line, name, message);
            return;
        }
        for (entry, item) in table.iter() {
            let line = self.line_of(table.key(entry).and_then(toml_edit::Key::span));
            self.item(rig, &format!("{name}.{entry}"), line, item);
        }
    }

    fn tables(&mut self, name: &str, tables: &ArrayOfTables) {
        let line = self.line_of(tables.span());
        self.problem(line, name, format!("[{name}] is one table; write [{name}], not [[{name}]]"));
    }

    fn item(&mut self, rig: &mut Rig, path: &str, line: Option<usize>, item: &Item) {
        let Some(index) = KEYS.iter().position(|key| key.path == path) else {
            self.problem(line, path, unknown_key(path));
            return;
        };
        self.lines[index] = line;
        if KEYS[index].kind == Kind::Events {
            rig.values[index] = self.events(line, item);
            rig.set[index] = true;
            return;
        }
        match value_of(&KEYS[index], item) {
            Ok(value) => {
                rig.values[index] = Some(value);
                rig.set[index] = true;
            }
            Err(message) => self.problem(line, path, message),
        }
    }

    /// One `key=value` of the command line.
    fn setting(&mut self, rig: &mut Rig, setting: &str) {
        let source = std::mem::replace(&mut self.source, "--set");
        let (path, text) = setting.split_once('=').unwrap_or((setting, ""));
        let (path, text) = (path.trim(), text.trim());
        if text.is_empty() {
            self.problem(None, path, "write key=value, such as --set load.mass_kg=2.5".to_owned());
        } else {
            self.item(rig, path, None, &item_of(text));
        }
        // What is typed last holds: targets replace the moves of the file.
        if path == "test.targets" {
            rig.set[Rig::index("test.moves")] = false;
        }
        self.source = source;
    }
}

/// A value as it is typed. A bare word is a text: --set valve.model=flow-node needs no quotes inside quotes.
fn item_of(text: &str) -> Item {
    Item::Value(text.parse().unwrap_or_else(|_| text.into()))
}

/// The value that a setting `path=text` gives a key, whatever the other keys are.
///
/// # Errors
/// What is wrong with key or value.
pub fn value_of_setting(path: &str, text: &str) -> Result<Value, String> {
    let key = KEYS.iter().find(|key| key.path == path).ok_or_else(|| unknown_key(path))?;
    value_of(key, &item_of(text))
}

/// What to say of a key that is not in the table: its unit, or a near miss.
fn unknown_key(path: &str) -> String {
    let (table, name) = path.split_once('.').unwrap_or(("", path));
    let (stem, given) = keys::unit(name);
    let same_stem = KEYS
        .iter()
        .find(|key| key.table() == table && !key.unit().is_empty() && keys::unit(key.name()).0 == stem);
    match same_stem {
        Some(key) if given.is_empty() => {
            format!("there is no such key; with its unit it is {} (in {})", key.name(), key.unit())
        }
        Some(key) => {
            format!("wrong unit: this key is {}, so give it in {} instead of {given}", key.name(), key.unit())
        }
        None => {
            let known = KEYS.iter().filter(|key| key.table() == table).map(Key::name);
            format!("unknown key{}", did_you_mean(name, known))
        }
    }
}

pub(super) fn did_you_mean<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
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

/// The value of a key, or what is wrong with it.
pub(super) fn value_of(key: &Key, item: &Item) -> Result<Value, String> {
    match key.kind {
        Kind::Number { min, max } => number(key, item, min, max),
        Kind::Integer { min, max } => whole(key, item, min, max).map(Value::Integer),
        Kind::Switch => item.as_bool().map(Value::Switch).ok_or_else(|| "must be true or false".to_owned()),
        Kind::Text => text(item, "must be a text in quotes")
            .and_then(|text| {
                let one_line = !text.contains(char::is_control);
                one_line.then_some(text).ok_or_else(|| "must be one line".to_owned())
            })
            .map(Value::Word),
        Kind::Choice(options) => word(key, item, options),
        Kind::Integers { min, max, most } => integers(key, item, min, max, most),
        Kind::Numbers { count } => numbers(item, count),
        Kind::Moves => moves(item),
        Kind::NotBuilt => not_built(key, item),
        Kind::Events => Err("must be a list of tables".to_owned()),
    }
}

fn text(item: &Item, message: &str) -> Result<String, String> {
    item.as_str().map(str::to_owned).ok_or_else(|| message.to_owned())
}

fn real(item: &Item) -> Option<f64> {
    item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64))
}

fn number(key: &Key, item: &Item, min: f64, max: f64) -> Result<Value, String> {
    let with_unit = |value: f64| format!("{value} {}", key.unit()).trim_end().to_owned();
    let Some(value) = real(item) else {
        let kind = item.type_name();
        return Err(match key.unit() {
            "" => format!("must be a number, not a {kind}"),
            unit => format!("must be a number in {unit} without the unit, not a {kind}"),
        });
    };
    if (min..=max).contains(&value) {
        Ok(Value::Number(value))
    } else {
        let range = format!("must be between {} and {}", with_unit(min), with_unit(max));
        Err(format!("{range}, is {value}"))
    }
}

fn whole(key: &Key, item: &Item, min: i64, max: i64) -> Result<i64, String> {
    let value =
        item.as_integer().ok_or_else(|| format!("must be a whole number, not a {}", item.type_name()))?;
    if (min..=max).contains(&value) {
        Ok(value)
    } else {
        let unit = key.unit();
        Err(format!("must be between {min} and {max} {unit}").trim_end().to_owned()
            + &format!(", is {value}"))
    }
}

fn word(key: &Key, item: &Item, options: &[(&str, bool)]) -> Result<Value, String> {
    let known: Vec<String> = options.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    let known = known.join(", ");
    let word = text(item, &format!("must be one of {known}"))?;
    match options.iter().find(|(name, _)| *name == word) {
        Some((_, true)) => Ok(Value::Word(word)),
        Some((_, false)) => {
            let built: Vec<&str> =
                options.iter().filter(|(_, built)| *built).map(|(name, _)| *name).collect();
            Err(format!("{} = \"{word}\" is not built yet; built: {}", key.path, built.join(", ")))
        }
        None => Err(format!("must be one of {known}, is \"{word}\"")),
    }
}

fn integers(key: &Key, item: &Item, min: i64, max: i64, most: usize) -> Result<Value, String> {
    let array = item.as_array().ok_or("must be a list of whole numbers, such as [8192, 4096]")?;
    if array.is_empty() || array.len() > most {
        return Err(format!("must have 1 to {most} entries, has {}", array.len()));
    }
    let values = array.iter().map(|value| whole(key, &Item::Value(value.clone()), min, max));
    values.collect::<Result<_, _>>().map(Value::Integers)
}

fn numbers(item: &Item, count: usize) -> Result<Value, String> {
    let message = || format!("must be a list of {count} numbers");
    let array = item.as_array().filter(|array| array.len() == count).ok_or_else(message)?;
    let values = array.iter().map(|value| real(&Item::Value(value.clone())).ok_or_else(message));
    values.collect::<Result<_, _>>().map(Value::Numbers)
}

fn moves(item: &Item) -> Result<Value, String> {
    let form = "must be a list of [time in s, counts], such as [[0.0, 8192], [0.3, 16384]]";
    let array = item.as_array().ok_or(form)?;
    let one = |value: &toml_edit::Value| {
        let pair = value.as_array().filter(|pair| pair.len() == 2)?;
        let time = real(&Item::Value(pair.get(0)?.clone()))?;
        Some((time, pair.get(1)?.as_integer()?))
    };
    array
        .iter()
        .map(|value| one(value).ok_or_else(|| form.to_owned()))
        .collect::<Result<_, _>>()
        .map(Value::Moves)
}

/// A key that is not built yet takes its default and nothing else.
fn not_built(key: &Key, item: &Item) -> Result<Value, String> {
    let given = match key.default {
        Default::Number(_) => real(item).map(Value::Number),
        Default::Switch(_) => item.as_bool().map(Value::Switch),
        _ => None,
    };
    match given {
        Some(value) if Some(&value) == default_value(&key.default).as_ref() => Ok(value),
        _ => Err(format!("{} is not built yet; leave it out", key.path)),
    }
}
