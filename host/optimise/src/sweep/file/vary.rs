//! The values of a varied key.
//!
//! | written | means |
//! |---|---|
//! | `[1.0, 2.0, 4.0]` | these values; also words and switches |
//! | `{ from = 1.0, to = 4.0, steps = 7 }` | even steps, both ends included |
//! | `{ from = 1.0, to = 4.0, steps = 7, spacing = "log" }` | even ratios |
//! | `{ uniform = [1.0, 4.0] }` | drawn evenly between these |
//! | `{ normal = [2.0, 0.1] }` | drawn with this mean and standard deviation |
//!
//! With `scale = ["load.static_extend_n", ...]` the name is free, and its values are factors on the values of these keys
//! in the rig; a list is then `{ values = [0.7, 1.0, 1.3], scale = [...] }`.

use pneudrive_sim::Rig;
use pneudrive_sim::rig::{Key, Kind, all_keys, unit};
use pneudrive_sim::rigfile::{read_quantity, value_of_setting};
use toml_edit::{Array, Item, TableLike, Value};

use super::super::axis::{Axis, Distribution, Draw, Range};
use super::fields::{count, nearest_of, number, only, pair, text};
use super::names::plain_name;

const FORM: &str = "must be a list of values, { from = 1.0, to = 4.0, steps = 7 }, { uniform = [low, high] } or { normal = [mean, deviation] }";
const FIELDS: [&str; 8] = ["values", "from", "to", "steps", "spacing", "uniform", "normal", "scale"];

/// Most steps of a range.
const MAX_STEPS: usize = 100_000;

/// The values of a key, before they are drawn.
enum Spread {
    Listed(Vec<String>),
    Range(Range),
    Distribution(Distribution),
}

/// Reads the value of a key, the `number`th that varies.
pub(super) fn axis(
    name: &str,
    item: &Item,
    rig: &Rig,
    draw: Option<Draw>,
    number: u64,
) -> Result<Axis, String> {
    let scaled = item.as_table_like().and_then(|table| table.get("scale")).map_or(Ok(Vec::new()), scaled)?;
    let (name, spread) = in_key_units(name, spread(item)?)?;
    let name = name.as_str();
    let whole = if scaled.is_empty() {
        matches!(variable(name)?.kind, Kind::Integer { .. })
    } else {
        plain_name(name)?;
        scaled.iter().try_for_each(|key| has_number(rig, key))?;
        false
    };
    let written = |value: f64| if whole { format!("{value:.0}") } else { format!("{value:?}") };
    let levels = match &spread {
        Spread::Listed(levels) => levels.clone(),
        Spread::Range(range) => range.values().into_iter().map(written).collect(),
        Spread::Distribution(distribution) => {
            let draw = draw.ok_or("a distribution needs a table [draw] with count = ...")?;
            draw.shares(number).into_iter().map(|share| written(distribution.quantile(share))).collect()
        }
    };
    let axis = Axis {
        name: name.to_owned(),
        scaled,
        levels,
        drawn: matches!(spread, Spread::Distribution(_)),
        logarithmic: matches!(spread, Spread::Range(Range { logarithmic: true, .. })),
    };
    // A tail of a normal distribution may be out of range: that is a failure of its point alone.
    if !matches!(spread, Spread::Distribution(Distribution::Normal { .. })) {
        axis.levels.iter().try_for_each(|level| check(&axis, rig, level))?;
    }
    Ok(axis)
}

/// The key of a name without its unit, `load.mass`, and the values of its list, `["1 kg"]`, in the unit of the key.
fn in_key_units(name: &str, spread: Spread) -> Result<(String, Spread), String> {
    let Some(key) = all_keys().find(|key| is_without_unit(key, name)) else {
        return Ok((name.to_owned(), spread));
    };
    let Spread::Listed(levels) = spread else {
        return Err(format!("has no unit here; write {}", key.path));
    };
    let in_unit = |level: &String| match read_quantity(level, key.unit())? {
        reading if reading.gauge => Err(format!(
            "{level} counts from exhaust.pressure_pa, which a sweep may vary; write it as absolute"
        )),
        reading => Ok(format!("{:?}", reading.value)),
    };
    let levels = levels.iter().map(in_unit).collect::<Result<_, String>>()?;
    Ok((key.path.to_owned(), Spread::Listed(levels)))
}

/// Whether a name is a key's without its unit.
fn is_without_unit(key: &Key, name: &str) -> bool {
    let (stem, unit) = unit(key.name());
    let table = key.path.strip_suffix(key.name()).unwrap_or_default();
    !unit.is_empty() && matches!(key.kind, Kind::Number { .. }) && name.strip_prefix(table) == Some(stem)
}

impl Axis {
    /// The keys of the rig that it changes.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        let own = self.scaled.is_empty().then_some(self.name.as_str());
        own.into_iter().chain(self.scaled.iter().map(String::as_str))
    }
}

fn check(axis: &Axis, rig: &Rig, level: &str) -> Result<(), String> {
    if !axis.scaled.is_empty() && level.parse::<f64>().is_err() {
        return Err(format!("a factor must be a number, is {level}"));
    }
    axis.settings(rig, level).try_for_each(|setting| {
        let (key, value) = setting.split_once('=').unwrap_or((&setting, ""));
        value_of_setting(key, value).map(drop).map_err(|message| match axis.scaled.as_slice() {
            [] => message,
            _ => format!("{key} times {level}: {message}"),
        })
    })
}

/// A key with values that can be written into a cell.
fn variable(name: &str) -> Result<&'static Key, String> {
    let names: Vec<&str> = all_keys().map(|key| key.path).collect();
    let key = all_keys().find(|key| key.path == name);
    let unknown = || match pneudrive_sim::rig::nearest(name, names.iter().copied()) {
        Some(likely) => format!("the rig has no such key; did you mean {likely}?"),
        None => "the rig has no such key; `pneudrive rig explain` lists them".to_owned(),
    };
    match key.ok_or_else(unknown)? {
        key if matches!(
            key.kind,
            Kind::Number { .. } | Kind::Integer { .. } | Kind::Switch | Kind::Choice(_)
        ) =>
        {
            Ok(key)
        }
        _ => Err("cannot be varied; numbers, words and switches can".to_owned()),
    }
}

fn has_number(rig: &Rig, key: &str) -> Result<(), String> {
    match variable(key).map_err(|message| format!("{key}: {message}"))?.kind {
        Kind::Number { .. } if rig.number_at(key).is_some() => Ok(()),
        Kind::Number { .. } => Err(format!("{key} has no value in the rig; give it one under [set]")),
        _ => Err(format!("{key} is not a real number; only real numbers can be scaled")),
    }
}

fn scaled(item: &Item) -> Result<Vec<String>, String> {
    let form = "scale must be a list of keys of the rig";
    let list = item.as_array().filter(|list| !list.is_empty()).ok_or(form)?;
    list.iter().map(|key| key.as_str().map(str::to_owned).ok_or_else(|| form.to_owned())).collect()
}

fn spread(item: &Item) -> Result<Spread, String> {
    if let Some(list) = item.as_array() {
        return listed(list).map(Spread::Listed);
    }
    let table = item.as_table_like().ok_or(FORM)?;
    only(table, &FIELDS)?;
    let kinds = ["values", "from", "uniform", "normal"];
    let mut given = kinds.iter().filter(|kind| table.contains_key(kind));
    match (given.next(), given.next()) {
        (Some(_), Some(_)) | (None, _) => Err(FORM.to_owned()),
        (Some(&"from"), None) => range(table).map(Spread::Range),
        (Some(kind), None) => {
            let extra = ["to", "steps", "spacing"].into_iter().find(|name| table.contains_key(name));
            extra.map_or(Ok(()), |extra| Err(format!("{extra} does not go with {kind}")))?;
            match table.get("values") {
                Some(values) => listed(values.as_array().ok_or(FORM)?).map(Spread::Listed),
                None => distribution(table).map(Spread::Distribution),
            }
        }
    }
}

fn listed(list: &Array) -> Result<Vec<String>, String> {
    let level = |value: &Value| match value {
        Value::Integer(whole) => Ok(whole.value().to_string()),
        Value::Float(real) if real.value().is_finite() => Ok(format!("{:?}", real.value())),
        Value::Boolean(on) => Ok(on.value().to_string()),
        Value::String(word) => Ok(word.value().clone()),
        other => Err(format!("{} is not a number, word or switch", other.to_string().trim())),
    };
    if list.is_empty() { Err("the list is empty".to_owned()) } else { list.iter().map(level).collect() }
}

fn range(table: &dyn TableLike) -> Result<Range, String> {
    let field = |name: &str| {
        table.get(name).ok_or_else(|| format!("a range has from, to and steps; {name} is missing"))
    };
    let logarithmic = match table.get("spacing").map(text).transpose()?.as_deref() {
        None | Some("linear") => false,
        Some("log") => true,
        Some(other) => {
            return Err(format!(
                "spacing must be \"linear\" or \"log\"{}",
                nearest_of(other, &["linear", "log"])
            ));
        }
    };
    let (from, to) = (number(field("from")?)?, number(field("to")?)?);
    let steps = count(field("steps")?, 2, MAX_STEPS).map_err(|message| format!("steps {message}"))?;
    if logarithmic && !(from > 0.0 && to > 0.0) {
        return Err("a logarithmic range needs from and to above 0".to_owned());
    }
    Ok(Range { from, to, steps, logarithmic })
}

fn distribution(table: &dyn TableLike) -> Result<Distribution, String> {
    if let Some(item) = table.get("uniform") {
        let [low, high] = pair(item, "uniform must be [low, high]")?;
        return if low < high {
            Ok(Distribution::Uniform { low, high })
        } else {
            Err(format!("uniform must be [low, high], the lower one first; is [{low}, {high}]"))
        };
    }
    let item = table.get("normal").ok_or(FORM)?;
    let [mean, deviation] = pair(item, "normal must be [mean, standard deviation]")?;
    if deviation > 0.0 {
        Ok(Distribution::Normal { mean, deviation })
    } else {
        Err(format!("the standard deviation must be more than 0, is {deviation}"))
    }
}
