//! `[[faults.event]]`: the one list of a rig file whose entries are tables.
//!
//! [`FIELDS`] is its table of keys, made and read like that of the file; `models` of a field are the
//! kinds that have it.

use toml_edit::{Item, TableLike};

use super::keys::{COUNT, Default, Key, Kind, choice, integer, key, number};
use super::read::{Reader, did_you_mean, value_of};
use super::{Rig, Value, default_value, whole_microseconds};
use crate::component::faults::{FaultEvent, FaultKind, OpenSensor};
use crate::positive_gain::SWITCHES;

/// The fields of an event, in the order of `FIELDS`, with their values.
pub type Fields = Vec<(&'static str, Value)>;

/// The key of the list.
pub(super) const PATH: &str = "faults.event";

/// Every kind, and what it does.
#[rustfmt::skip]
pub(super) const KINDS: &[(&str, &str)] = &[
    ("swapped-tubes", "the tubes of chambers 1 and 2 are on each other's port of the valve"),
    ("stuck-spool", "the spool stays where it is"),
    ("supply-dip", "the supply has another pressure for a while"),
    ("leak", "a hole leads from a chamber to the surroundings"),
    ("encoder-loss", "the count stays that of the sample before"),
    ("encoder-jump", "the count is off by a number"),
    ("sensor-open", "a sensor reads raw 0"),
];

#[rustfmt::skip]
const KIND: Kind = Kind::Choice(&[
    ("swapped-tubes", true), ("stuck-spool", true), ("supply-dip", true), ("leak", true),
    ("encoder-loss", true), ("encoder-jump", true), ("sensor-open", true),
]);

const SENSORS: &[(&str, bool)] = &[("pressure-1", true), ("pressure-2", true), ("spool", true)];

/// Every field of an event.
#[rustfmt::skip]
pub static FIELDS: &[Key] = &[
    key("faults.event.kind", KIND, Default::Absent("must be given"), "", "What goes wrong."),
    key("faults.event.at_s", Kind::Number { min: 0.0, max: 4000.0 }, Default::Absent("must be given"), "", "When, from the start of the test on; whole microseconds."),
    key("faults.event.pressure_pa", Kind::Number { min: 1e4, max: 5e6 }, Default::Absent("midway between exhaust.pressure_pa and supply.pressure_pa"), "", "Absolute supply pressure during the dip.").of(&["supply-dip"]),
    number("faults.event.duration_s", 0.5, 1e-6, 4000.0, "", "How long the dip lasts; whole microseconds.").of(&["supply-dip"]),
    integer("faults.event.chamber", 1, 1, 2, "", "The chamber that leaks.").of(&["leak"]),
    number("faults.event.diameter_mm", 1.0, 1e-3, 10.0, "", "Bore of the hole, as that of an ideal nozzle that passes as much; a sharp hole passes 0.6 to 0.8 of it.").of(&["leak"]),
    integer("faults.event.counts", 1000, -COUNT, COUNT, "", "By how much the count is off.").of(&["encoder-jump"]),
    choice("faults.event.sensor", SENSORS, "", "The sensor that comes off.").of(&["sensor-open"]),
];

fn name_of(field: &Key) -> &'static str {
    field.path.rsplit('.').next().unwrap_or(field.path)
}

/// The fields that a kind has.
fn fields_of(kind: &str) -> impl Iterator<Item = &'static Key> {
    FIELDS.iter().filter(move |field| field.models.is_empty() || field.models.contains(&kind))
}

fn value<'a>(event: &'a Fields, name: &str) -> Option<&'a Value> {
    event.iter().find(|(field, _)| *field == name).map(|(_, value)| value)
}

impl Reader<'_> {
    /// The list of events: tables, or a list of tables in one line.
    pub(super) fn events(&mut self, line: Option<usize>, item: &Item) -> Option<Value> {
        let Some(tables) = tables(item) else {
            let message = "write each event as a table: [[faults.event]] with its kind and at_s below it";
            self.problem(line, PATH, message.to_owned());
            return None;
        };
        let events = tables.into_iter().filter_map(|(table, span)| {
            let line = self.line_of(span).or(line);
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
            if table.contains_key(name_of(field)) || default_value(&field.default).is_none() {
                event.extend(self.field(line, table, field).map(|value| (name_of(field), value)));
            } else {
                event.extend(default_value(&field.default).map(|value| (name_of(field), value)));
            }
        }
        event.insert(0, ("kind", kind));
        Some(event)
    }

    /// The value of a field that is there, or must be.
    fn field(&mut self, line: Option<usize>, table: &dyn TableLike, field: &Key) -> Option<Value> {
        let name = name_of(field);
        let Some(item) = table.get(name) else {
            if field.default == Default::Absent("must be given") {
                self.problem(line, field.path, format!("every event needs its {name}"));
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
        let at = self.line_of(table.key(name).and_then(toml_edit::Key::span)).or(line);
        read.map_err(|message| self.problem(at, field.path, message)).ok()
    }

    /// Notes a field that no event of this kind has.
    fn refuse_stray(&mut self, table: &dyn TableLike, kind: &str, name: &str) {
        if fields_of(kind).any(|field| name_of(field) == name) {
            return;
        }
        let message = match FIELDS.iter().find(|field| name_of(field) == name) {
            Some(field) => format!("a fault of the kind {kind} has none; {} has", field.models.join(", ")),
            None => format!("unknown key{}", did_you_mean(name, fields_of(kind).map(name_of))),
        };
        let line = self.line_of(table.key(name).and_then(toml_edit::Key::span));
        self.problem(line, &format!("{PATH}.{name}"), message);
    }

    /// What must hold between events and the rest of a rig.
    pub(super) fn check_faults(&mut self, rig: &Rig) {
        let (low, high) = (rig.number("exhaust.pressure_pa"), rig.number("supply.pressure_pa"));
        for event in rig.fault_events() {
            if let FaultKind::SupplyDip { pressure, .. } = event.kind
                && !(low < pressure && pressure < high)
            {
                self.problem_at_key(PATH, format!("pressure_pa = {pressure} is no dip: it must be between exhaust.pressure_pa = {low} and supply.pressure_pa = {high}"));
            }
        }
        for switch in SWITCHES {
            self.check_positive_gain(rig, switch);
        }
    }

    fn check_positive_gain(&mut self, rig: &Rig, switch: &'static str) {
        if !rig.switch(switch) {
            return;
        }
        let refused = match rig.word("controller.law") {
            _ if switch == SWITCHES[1] && rig.switch(SWITCHES[0]) => {
                "there is one bug: take one of its readings"
            }
            _ if rig.word("controller.model") != "sampled" => "it is a bug of the sampled controller",
            _ if rig.word("controller.loop") != "closed" => "an open loop has no gain",
            "gain-profile" => return,
            _ if switch == SWITCHES[1] => "it is for the law gain-profile",
            "proportional" => return,
            _ => "it is for the laws gain-profile and proportional",
        };
        self.problem_at_key(switch, refused.to_owned());
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

impl Rig {
    /// What goes wrong, in the order of the file.
    #[must_use]
    pub fn fault_events(&self) -> Vec<FaultEvent> {
        match self.value(PATH) {
            Some(Value::Events(events)) => events.iter().map(|event| self.fault_event(event)).collect(),
            _ => Vec::new(),
        }
    }

    fn fault_event(&self, event: &Fields) -> FaultEvent {
        let number = |name: &str| match value(event, name) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        };
        let integer = |name: &str| match value(event, name) {
            Some(Value::Integer(integer)) => *integer,
            _ => panic!("an event of its kind has {name}"),
        };
        let word = |name: &str| match value(event, name) {
            Some(Value::Word(word)) => word.as_str(),
            _ => panic!("an event of its kind has {name}"),
        };
        let microseconds = |name: &str| number(name).and_then(whole_microseconds).unwrap_or(0);
        let midway = || 0.5 * (self.number("exhaust.pressure_pa") + self.number("supply.pressure_pa"));
        let kind = match word("kind") {
            "swapped-tubes" => FaultKind::SwappedTubes,
            "stuck-spool" => FaultKind::StuckSpool,
            "supply-dip" => FaultKind::SupplyDip {
                pressure: number("pressure_pa").unwrap_or_else(midway),
                duration_us: microseconds("duration_s"),
            },
            "leak" => FaultKind::Leak {
                chamber: usize::from(integer("chamber") == 2),
                diameter: number("diameter_mm").unwrap_or(0.0) * 1e-3,
            },
            "encoder-loss" => FaultKind::EncoderLoss,
            "encoder-jump" => FaultKind::EncoderJump { counts: integer("counts") as i32 },
            _ => FaultKind::SensorOpen(match word("sensor") {
                "pressure-1" => OpenSensor::Pressure1,
                "pressure-2" => OpenSensor::Pressure2,
                _ => OpenSensor::Spool,
            }),
        };
        FaultEvent { at_us: microseconds("at_s"), kind }
    }
}

#[cfg(test)]
mod tests;
