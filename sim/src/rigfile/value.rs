//! The value of a key, as TOML has it.

use toml_edit::Item;

use super::origin::Stated;
use super::quantity::{self, Reading};
use crate::key::{Key, Kind, Preset, unit as stem};
use crate::keys;
use crate::rig::preset_value;
use crate::values::Value;

/// A value as it is typed. A bare word is a text: --set valve.model=flow-node needs no quotes inside quotes. Numbers may be
/// written as TOML does not have them: .5, 5., 08.
pub(super) fn item_of(text: &str) -> Item {
    let is_number = text.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first));
    let number = || text.parse::<f64>().ok().filter(|number| is_number && number.is_finite());
    let value = text.parse().ok().or_else(|| number().map(Into::into));
    Item::Value(value.unwrap_or_else(|| text.into()))
}

/// An item as its key takes it. If the path leaves the unit out, the text gives it with the number. A gauge pressure
/// counts from the pressure of the `surroundings`, Pa.
pub(super) fn with_unit(key: &Key, path: &str, item: &Item, surroundings: f64) -> Result<Item, String> {
    if path == key.path {
        return Ok(item.clone());
    }
    let text =
        item.as_str().ok_or_else(|| format!("must be a text with its unit, such as \"1 {}\"", key.unit()))?;
    absolute(pressure_that_says(key, text)?, surroundings).map(|number| Item::Value(number.into()))
}

/// An end of the range of a value: a number in the unit of its key, or a text with its own.
pub(super) fn end_of(key: &Key, item: &Item, surroundings: f64) -> Result<f64, String> {
    match (real(item), item.as_str()) {
        (Some(number), _) => Ok(number),
        (None, Some(text)) => absolute(pressure_that_says(key, text)?, surroundings),
        (None, None) => Err("low and high are numbers, or texts with a unit".to_owned()),
    }
}

/// Pressures that people state from that of the surroundings or from none: "6 bar" may be either, a bar apart.
static FROM_SOMEWHERE: [&Key; 6] = [
    &keys::supply::PRESSURE_PA.key,
    &keys::regulator::PRIMARY_PRESSURE_PA.key,
    &keys::sensors::PRESSURE_MIN_PA.key,
    &keys::sensors::PRESSURE_MAX_PA.key,
    &keys::test::PRESSURE_1_PA.key,
    &keys::test::PRESSURE_2_PA.key,
];

/// A number with its unit, which says from where such a pressure counts.
fn pressure_that_says(key: &Key, text: &str) -> Result<Reading, String> {
    let reading = quantity::read(text, key.unit())?;
    if FROM_SOMEWHERE.iter().any(|one| one.path == key.path) && !reading.says_from_where {
        return Err(format!("{text:?} may be gauge or absolute: write \"{text}(g)\" or \"{text}(a)\""));
    }
    Ok(reading)
}

fn absolute(reading: Reading, surroundings: f64) -> Result<f64, String> {
    let value = if reading.gauge { reading.value + surroundings } else { reading.value };
    if value.is_finite() { Ok(value) } else { Err("is too large".to_owned()) }
}

/// Whether a number with its unit is a gauge pressure.
pub(super) fn is_gauge(key: &Key, path: &str, stated: &Stated) -> bool {
    let text = stated.value.as_str().filter(|_| path != key.path);
    text.is_some_and(|text| quantity::read(text, key.unit()).is_ok_and(|reading| reading.gauge))
}

/// The value of a key, or the error in it.
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
        Kind::Integers { min, max, max_entries } => integers(key, item, min, max, max_entries),
        Kind::Numbers { least, most } => numbers(item, least, most),
        Kind::Rows { columns, max_rows } => rows(item, columns, max_rows),
        Kind::Moves => moves(item),
        Kind::DefaultOnly => default_only(key, item),
        Kind::Tables(_) => Err("must be a list of tables".to_owned()),
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
            unit if item.is_str() => format!(
                "must be a number in {unit} without the unit, not a string; with its unit write {} = {}",
                stem(key.name()).0,
                item.to_string().trim()
            ),
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
    let must = || {
        let known: Vec<String> = options.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        format!("must be one of {}", known.join(", "))
    };
    let word = item.as_str().ok_or_else(must)?.to_owned();
    match options.iter().find(|(name, _)| *name == word) {
        Some((_, true)) => Ok(Value::Word(word)),
        Some((_, false)) => {
            let built: Vec<&str> =
                options.iter().filter(|(_, built)| *built).map(|(name, _)| *name).collect();
            Err(format!("{} = \"{word}\" is not built yet; built: {}", key.path, built.join(", ")))
        }
        None => Err(format!("{}, is \"{word}\"", must())),
    }
}

fn integers(key: &Key, item: &Item, min: i64, max: i64, max_entries: usize) -> Result<Value, String> {
    let array = item.as_array().ok_or("must be a list of whole numbers, such as [8192, 4096]")?;
    if array.is_empty() || array.len() > max_entries {
        return Err(format!("must have 1 to {max_entries} entries, has {}", array.len()));
    }
    let values = array.iter().map(|value| whole(key, &Item::Value(value.clone()), min, max));
    values.collect::<Result<_, _>>().map(Value::Integers)
}

fn numbers(item: &Item, least: usize, most: usize) -> Result<Value, String> {
    let count = if least == most { most.to_string() } else { format!("{least} to {most}") };
    let message = || format!("must be a list of {count} numbers");
    let array = item.as_array().filter(|array| (least..=most).contains(&array.len())).ok_or_else(message)?;
    let finite = |value: &toml_edit::Value| real(&Item::Value(value.clone())).filter(|one| one.is_finite());
    let values = array.iter().map(|value| finite(value).ok_or_else(message));
    values.collect::<Result<_, _>>().map(Value::Numbers)
}

fn rows(item: &Item, columns: &[&str], max_rows: usize) -> Result<Value, String> {
    let form = || {
        format!(
            "must be a list of 1 to {max_rows} rows of {} numbers: [{}]",
            columns.len(),
            columns.join("; ")
        )
    };
    let array = item.as_array().filter(|array| (1..=max_rows).contains(&array.len())).ok_or_else(form)?;
    let row = |value: &toml_edit::Value| {
        let row = value.as_array().filter(|row| row.len() == columns.len()).ok_or_else(form)?;
        let number =
            |cell: &toml_edit::Value| real(&Item::Value(cell.clone())).filter(|cell| cell.is_finite());
        row.iter().map(|cell| number(cell).ok_or_else(form)).collect::<Result<Vec<f64>, String>>()
    };
    array.iter().map(row).collect::<Result<_, _>>().map(Value::Rows)
}

fn moves(item: &Item) -> Result<Value, String> {
    let form =
        "must be a list of [time in s, counts], such as [[0.0, 8192], [0.3, 16384]]; in mm write moves_mm";
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

/// A key that no equation has takes its default and nothing else.
fn default_only(key: &Key, item: &Item) -> Result<Value, String> {
    let given = match key.preset {
        Preset::Number(_) => real(item).map(Value::Number),
        Preset::Switch(_) => item.as_bool().map(Value::Switch),
        _ => None,
    };
    match given {
        Some(value) if Some(&value) == preset_value(&key.preset).as_ref() => Ok(value),
        _ => Err(format!("{} has no effect: leave it out", key.path)),
    }
}
