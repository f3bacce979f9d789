//! Compares two rigs key by key, as `rig diff` does.

use pneudrive_design::difference::{Difference, differences};
use pneudrive_design::values::value_to_json;
use pneudrive_sim::Rig;
use pneudrive_sim::rig::Value as RigValue;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::page_rig::PageRig;
use crate::refusal::HttpRefusal;
use crate::rigs::Opened;

/// The rig of the page, and another one.
#[derive(Debug, Deserialize)]
pub struct Differing {
    #[serde(flatten)]
    asked: PageRig,
    other: Opened,
}

/// The keys that differ, in the order of `rig explain`.
///
/// # Errors
/// Every problem of the rig that is not valid.
pub fn answer(Differing { asked, other }: &Differing) -> Result<Value, HttpRefusal> {
    let rig = asked.rig()?;
    let other = Rig::read(&other.name, &other.text)?;
    let found = differences(&rig, &other);
    Ok(json!({
        "names": [rig.name(), other.name()],
        "differences": found.iter().map(to_json).collect::<Vec<_>>(),
    }))
}

fn to_json(difference: &Difference<'_>) -> Value {
    let text = |value: &RigValue| match value {
        RigValue::Word(word) => word.clone(),
        other => other.to_string(),
    };
    json!({
        "key": difference.key.path,
        "unit": difference.key.unit(),
        "values": difference.values.map(|value| value.map(value_to_json)),
        "texts": difference.values.map(|value| value.map(text)),
        "percent": difference.percent(),
    })
}
