//! Columns of numbers as bytes, for an `ArrayBuffer` on the page.
//!
//! ```text
//! u32   length of the head, little-endian, as all numbers here
//! head  JSON, filled up with spaces to the next multiple of 8 bytes of the whole
//! f64   the first column, the time: exact
//! f32   the others, one after the other: 24 bits, more than any screen shows
//! ```

use serde_json::{Value, json};

/// Numbers over time, with their description.
#[derive(Clone, Debug)]
pub struct Columns {
    /// Times, s.
    pub time: Vec<f64>,
    /// Name, unit and numbers of each other column.
    pub columns: Vec<Column>,
}

/// A channel over time.
#[derive(Clone, Debug)]
pub struct Column {
    /// The page's name for it.
    pub name: &'static str,
    /// The displayed unit.
    pub unit: &'static str,
    /// The values: one for each time.
    pub values: Vec<f32>,
}

impl Columns {
    /// The bytes. `head` is an object; the list of columns is added to it.
    #[must_use]
    pub fn to_bytes(&self, mut head: Value) -> Vec<u8> {
        head["rows"] = json!(self.time.len());
        let described = self.columns.iter().map(|column| json!({ "name": column.name, "unit": column.unit }));
        head["columns"] = described.collect();
        let mut text = head.to_string();
        while !(4 + text.len()).is_multiple_of(8) {
            text.push(' ');
        }
        let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
        bytes.extend_from_slice(text.as_bytes());
        bytes.extend(self.time.iter().flat_map(|time| time.to_le_bytes()));
        let values = self.columns.iter().flat_map(|column| &column.values);
        bytes.extend(values.flat_map(|value| value.to_le_bytes()));
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_begin_on_a_multiple_of_eight_and_come_in_order() {
        let position = Column { name: "position", unit: "mm", values: vec![1.5, 2.5] };
        let columns = Columns { time: vec![0.0, 0.1], columns: vec![position] };
        let bytes = columns.to_bytes(json!({ "note": "a" }));
        let length = u32::from_le_bytes(bytes[..4].try_into().expect("4 bytes")) as usize;
        let head: Value = serde_json::from_slice(&bytes[4..4 + length]).expect("JSON");
        assert_eq!(
            head,
            json!({ "note": "a", "rows": 2, "columns": [{ "name": "position", "unit": "mm" }] })
        );
        let data = &bytes[4 + length..];
        assert_eq!((4 + length) % 8, 0);
        assert_eq!(data.len(), 2 * 8 + 2 * 4);
        assert_eq!(f64::from_le_bytes(data[8..16].try_into().expect("8 bytes")), 0.1);
        assert_eq!(f32::from_le_bytes(data[20..24].try_into().expect("4 bytes")), 2.5);
    }
}
