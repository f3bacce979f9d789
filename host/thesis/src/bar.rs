//! The bar that compares a printed number with ours: the tolerance shaded, the printed number as a tick, ours as a dot on
//! its range.

use super::number::value_of;
use super::{Agreement, Entry, Found, Printed, Reading};

/// The bar, pixels.
const WIDTH: f64 = 150.0;
const MARGIN: f64 = 8.0;

/// The bar of an entry; nothing where one of both has no number.
pub(super) fn bar(entry: &Entry, reading: &Reading) -> String {
    let Printed::Number { text, within, .. } = entry.printed else { return String::new() };
    let (value, [low, high]) = match reading.found {
        Found::Figure { value, range, .. } | Found::SizeOnly { value, range, .. } => (value, range),
        Found::TakenOver { value, .. } => (value, [value; 2]),
        _ => return String::new(),
    };
    let printed = value_of(text);
    let [least, most] = [printed - within, printed + within];
    let [from, to] = [low.min(least), high.max(most)];
    let place = |value: f64| MARGIN + (value - from) / (to - from) * (WIDTH - 2.0 * MARGIN);
    let class = match reading.agreement(entry) {
        Agreement::Agrees => "agrees",
        Agreement::InPart => "part",
        Agreement::Differs => "differs",
        Agreement::Open | Agreement::TakenOver => "open",
    };
    let shade = if class == "open" {
        String::new()
    } else {
        let [left, right] = [place(least), place(most)];
        format!(
            "<rect class=\"printed\" x=\"{left:.1}\" y=\"2\" width=\"{:.1}\" height=\"14\"/>",
            right - left
        )
    };
    let [at, low, high, dot] = [printed, low, high, value].map(place);
    format!(
        "<svg class=\"bar {class}\" viewBox=\"0 0 {WIDTH} 18\"><path class=\"axis\" d=\"M{MARGIN} 9H{}\"/>{shade}<path class=\"tick\" d=\"M{at:.1} 1V17\"/><path class=\"range\" d=\"M{low:.1} 9H{high:.1}\"/><circle cx=\"{dot:.1}\" cy=\"9\" r=\"3.6\"/></svg>",
        WIDTH - MARGIN
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_shows_printed_and_found_to_scale() {
        let entry = Entry::number("a", "a", ["10", "N"], 1.0, "one digit");
        let drawn = bar(&entry, &Reading::read("a", 13.0, 1.0, 1, ""));
        // From 9 to 14 over 134 pixels: 10 at 34.8, 13 at 115.2.
        assert!(drawn.contains("M34.8 1V17") && drawn.contains("cx=\"115.2\""), "{drawn}");
        assert!(drawn.contains("bar differs"), "{drawn}");
        assert_eq!(bar(&entry, &Reading::nothing("a", "lost")), "");
        assert_eq!(bar(&Entry::sentence("a", "It moves."), &Reading::exact("a", 1.0, 0, "")), "");
    }
}
