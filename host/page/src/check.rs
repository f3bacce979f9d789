//! Checks a rig against the table of keys while the user types.

use pneudrive_design::values;
use pneudrive_sim::Rig;
use pneudrive_sim::rig::{Value as RigValue, all_keys};
use serde_json::{Map, Value, json};

use crate::page_rig::PageRig;
use crate::refusal;

/// The problems of a rig, each at its key. For a valid rig: its values, their origins, and the keys that its models use.
#[must_use]
pub fn answer(asked: &PageRig) -> Value {
    match asked.rig() {
        Ok(rig) => of_rig(asked, &rig),
        Err(problems) => json!({ "problems": refusal::to_json(&problems) }),
    }
}

fn of_rig(asked: &PageRig, rig: &Rig) -> Value {
    let used: Vec<&str> = all_keys().filter(|key| rig.uses(key)).map(|key| key.path).collect();
    let values: Map<String, Value> =
        values::entries(rig).map(|entry| (entry.key.path.to_owned(), value(&entry))).collect();
    let counts = values::count(rig).into_iter().filter(|(_, count)| *count > 0);
    let counts: Vec<String> = counts.map(|(source, count)| format!("{count} {}", source.word())).collect();
    json!({
        "problems": [],
        "name": rig.name(),
        "used": used,
        "values": values,
        "origins": counts.join(", "),
        "command": asked.command_line(),
    })
}

fn value(entry: &values::Entry) -> Value {
    let number = match entry.value {
        RigValue::Number(number) => Some(*number),
        RigValue::Integer(number) => Some(*number as f64),
        _ => None,
    };
    let text = match entry.value {
        RigValue::Word(word) => word.clone(),
        other => other.to_string(),
    };
    json!({
        "text": text,
        "number": number,
        "origin": entry.origin.source.word(),
        "origin_in_words": values::origin_in_words(entry),
        "range": entry.origin.range,
    })
}
