//! The inputs of a model.

use crate::signal::Value;

/// The whole number at a place of the inputs; 0 where the model has no such input.
pub fn integer<T: TryFrom<i64> + Default>(inputs: &[Value], place: usize) -> T {
    match inputs.get(place) {
        Some(Value::Integer(value)) => T::try_from(*value).unwrap_or_default(),
        _ => T::default(),
    }
}

/// Whether the switch at a place of the inputs is on.
pub fn switch(inputs: &[Value], place: usize) -> bool {
    matches!(inputs.get(place), Some(Value::Switch(true)))
}
