//! Every value of a rig, with where it comes from: as a rig file in SI, and as JSON.

use pneudrive_sim::Rig;
use pneudrive_sim::keys;
use pneudrive_sim::rig::{Key, Origin, Source, Value};
use pneudrive_sim::schedule::MOVE_FORMS;
use serde_json::{Map, Value as Json, json};

/// A key that a rig uses, its value, and where that comes from.
#[derive(Clone, Debug)]
pub struct Entry<'a> {
    /// The key.
    pub key: &'static Key,
    /// The value, in the unit of the key.
    pub value: &'a Value,
    /// Where it comes from.
    pub origin: Origin,
}

/// Every key that a rig uses and that has a value, in the order of `rig explain`.
pub fn entries(rig: &Rig) -> impl Iterator<Item = Entry<'_>> {
    let is_told = |(key, _): &(&'static Key, &Value)| rig.uses(key) && !has_other_moves(rig, key);
    rig.entries().filter(is_told).map(|(key, value)| Entry { key, value, origin: rig.origin(key) })
}

/// Whether a key has the default moves of a rig that gives its moves in another form.
fn has_other_moves(rig: &Rig, key: &Key) -> bool {
    let own = keys::test::MOVES.path;
    key.path == own && MOVE_FORMS.iter().any(|form| form.path != own && rig.value(form.path).is_some())
}

/// The rig file with every value in SI, each with its origin as a comment: it is the same rig.
#[must_use]
pub fn to_toml(rig: &Rig) -> String {
    let (mut text, mut table) = (String::new(), "");
    for entry in entries(rig) {
        if entry.key.table() != table {
            table = entry.key.table();
            text.push_str(&format!("\n[{table}]\n"));
        }
        let line = format!("{} = {}", entry.key.name(), written(entry.value));
        text.push_str(&format!("{line:<44} # {}\n", origin_in_words(&entry)));
    }
    text.trim_start().to_owned()
}

/// A value in TOML: a whole real number keeps its point.
fn written(value: &Value) -> String {
    match value {
        Value::Number(number) => format!("{number:?}"),
        other => other.to_string(),
    }
}

/// "typical, 20 to 100 N: a book".
#[must_use]
pub fn origin_in_words(entry: &Entry) -> String {
    let Origin { source, range, from } = &entry.origin;
    let range = range.map_or(String::new(), |[low, high]| {
        format!(", {low} to {high} {}", entry.key.unit()).trim_end().to_owned()
    });
    let from = if from.is_empty() { String::new() } else { format!(": {from}") };
    format!("{}{range}{from}", source.word())
}

/// `{"load.mass_kg": {"value": 8.0, "unit": "kg", "origin": "given", "low": ..., "high": ..., "from": ...}}`; low, high and
/// from stand there where the file says them.
#[must_use]
pub fn to_json(rig: &Rig) -> Json {
    let one = |entry: Entry| (entry.key.path.to_owned(), entry_to_json(&entry));
    Json::Object(entries(rig).map(one).collect())
}

fn entry_to_json(entry: &Entry) -> Json {
    let mut fields = Map::new();
    fields.insert("value".to_owned(), value_to_json(entry.value));
    fields.insert("unit".to_owned(), json!(entry.key.unit()));
    fields.insert("origin".to_owned(), json!(entry.origin.source.word()));
    if let Some([low, high]) = entry.origin.range {
        fields.insert("low".to_owned(), json!(low));
        fields.insert("high".to_owned(), json!(high));
    }
    if !entry.origin.from.is_empty() {
        fields.insert("from".to_owned(), json!(entry.origin.from));
    }
    Json::Object(fields)
}

/// A value of a key.
#[must_use]
pub fn value_to_json(value: &Value) -> Json {
    match value {
        Value::Number(number) => json!(number),
        Value::Integer(number) => json!(number),
        Value::Switch(on) => json!(on),
        Value::Word(word) => json!(word),
        Value::Integers(numbers) => json!(numbers),
        Value::Numbers(numbers) => json!(numbers),
        Value::Rows(rows) => json!(rows),
        Value::Moves(moves) => json!(moves),
        Value::Events(events) => {
            let one = |fields: &pneudrive_sim::rig::Fields| -> Json {
                Json::Object(
                    fields.iter().map(|(name, value)| ((*name).to_owned(), value_to_json(value))).collect(),
                )
            };
            Json::Array(events.iter().map(one).collect())
        }
    }
}

/// The number of values of a rig by origin, in one line: given, computed, typical, unknown, default.
#[must_use]
pub fn count(rig: &Rig) -> [(Source, usize); 5] {
    let sources = [Source::Given, Source::Computed, Source::Typical, Source::Unknown, Source::Default];
    sources.map(|source| (source, entries(rig).filter(|entry| entry.origin.source == source).count()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "name = \"own\"\n[load]\nmass = \"8 kg\"\nstatic_extend_n = { typical = 70.0, low = 20, high = 100, from = \"a book\" }\n[[faults.event]]\nkind = \"leak\"\nat_s = 1.0\nchamber = 2\ndiameter_mm = 3\n";

    fn rig(text: &str) -> Rig {
        Rig::read("own.toml", text).unwrap_or_else(|problems| panic!("{problems}"))
    }

    #[test]
    fn the_resolved_file_is_the_same_rig() {
        for (name, text) in pneudrive_sim::rigfile::BUILTIN {
            let (rig, again) = (rig(text), rig_of_resolved(text));
            assert!(
                rig.entries()
                    .filter(|(key, _)| rig.uses(key))
                    .all(|(key, value)| again.value(key.path) == Some(value)),
                "{name}"
            );
        }
    }

    fn rig_of_resolved(text: &str) -> Rig {
        rig(&to_toml(&rig(text)))
    }

    #[test]
    fn every_value_says_where_it_comes_from() {
        let text = to_toml(&rig(FILE));
        let line = |key: &str| text.lines().find(|line| line.starts_with(key)).expect(key).to_owned();
        assert_eq!(line("mass_kg"), format!("{:<44} # given", "mass_kg = 8.0"));
        assert!(line("static_extend_n").ends_with("# typical, 20 to 100 N: a book"));
        assert!(line("viscous_n_s_per_m").ends_with("# default"));
        assert!(
            text.lines().all(|line| line.is_empty() || line.starts_with('[') || line.contains(" # ")),
            "{text}"
        );
    }

    #[test]
    fn json_has_value_unit_and_origin() {
        let json = to_json(&rig(FILE));
        assert_eq!(json["load.mass_kg"], json!({"value": 8.0, "unit": "kg", "origin": "given"}));
        assert_eq!(json["load.static_extend_n"]["high"], json!(100.0));
        assert_eq!(json["load.static_extend_n"]["from"], json!("a book"));
    }

    #[test]
    fn keys_that_the_models_do_not_use_are_left_out() {
        let rig = rig("[operator]\nmodel = \"solenoid\"\n");
        assert!(entries(&rig).all(|entry| entry.key.path != "operator.max_steps"));
    }

    #[test]
    fn sources_are_counted() {
        let [given, .., default] = count(&rig(FILE));
        assert!(given.1 >= 3 && default.1 > 50, "{given:?} {default:?}");
    }
}
