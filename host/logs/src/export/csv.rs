//! A header, then a line per sample: the time in s first. Numbers have all their digits; unknown ones are left empty.

use std::fmt::Write;

use crate::signals::Signals;

/// The text of the file.
pub fn file(signals: &Signals) -> String {
    let names = signals.signals.iter().map(|signal| format!(",{}", signal.name));
    let mut text = format!("time_s{}\n", names.collect::<String>());
    for (k, time) in signals.time_s.iter().enumerate() {
        let cells = signals.signals.iter().map(|signal| cell(signal.values[k]));
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{time}{}", cells.collect::<String>());
    }
    text
}

fn cell(value: f64) -> String {
    if value.is_finite() { format!(",{value}") } else { ",".to_owned() }
}
