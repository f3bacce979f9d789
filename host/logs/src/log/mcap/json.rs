//! Numbers of messages in JSON, named by the path of their fields.

use serde_json::Value;

/// The numbers of a message with the names of their fields.
pub(super) fn of_json(path: &str, value: &Value, numbers: &mut Vec<(String, f64)>) {
    match value {
        Value::Number(number) => numbers.extend(number.as_f64().map(|number| (path.to_owned(), number))),
        Value::Bool(switch) => numbers.push((path.to_owned(), f64::from(u8::from(*switch)))),
        Value::Object(fields) => {
            fields.iter().for_each(|(name, value)| of_json(&below(path, name), value, numbers))
        }
        Value::Array(values) => {
            let parts = values.iter().enumerate();
            parts.for_each(|(place, value)| of_json(&below(path, &place.to_string()), value, numbers));
        }
        Value::Null | Value::String(_) => {}
    }
}

/// The name of a field of a field.
pub(super) fn below(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}
