//! Times with a date, and times of day (ISO 8601).

use jiff::Timestamp;
use jiff::civil::{DateTime, Time};
use jiff::tz::Offset;

/// ns from some instant, the same for all times of a kind; None if the text is not a time.
pub fn nanoseconds(cell: &str) -> Option<i128> {
    // A number is not a time: 2026 is not a year here, and 20260101 is not a day.
    if !cell.contains(':') || !cell.starts_with(|first: char| first.is_ascii_digit()) {
        return None;
    }
    let cell = cell.replacen(',', ".", 1);
    let in_zone = || cell.parse::<Timestamp>().ok().map(Timestamp::as_nanosecond);
    let with_date = || {
        let civil: DateTime = cell.parse().ok()?;
        Some(Offset::UTC.to_timestamp(civil).ok()?.as_nanosecond())
    };
    let of_day = || {
        let time: Time = cell.parse().ok()?;
        let seconds =
            3600 * i64::from(time.hour()) + 60 * i64::from(time.minute()) + i64::from(time.second());
        Some(1_000_000_000 * i128::from(seconds) + i128::from(time.subsec_nanosecond()))
    };
    if cell.contains('-') { in_zone().or_else(with_date) } else { of_day() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_to_the_nanosecond() {
        let from = nanoseconds("2026-01-01T10:00:00").expect("a time");
        for (cell, later) in [
            ("2026-01-01T10:00:00.001300", 1_300_000),
            ("2026-01-01 10:00:00,0013", 1_300_000),
            ("2026-01-01T10:00:00.001300Z", 1_300_000),
            ("2026-01-01T11:00:01+01:00", 1_000_000_000),
            ("2026-01-02 10:00:00", 86_400_000_000_000),
        ] {
            assert_eq!(nanoseconds(cell).map(|time| time - from), Some(later), "{cell}");
        }
        assert_eq!(nanoseconds("10:00:00.5"), Some(36_000_500_000_000));
        for cell in ["2026", "20260101", "10", "-5", "1.5", "01.02.2026 10:00:00", "10:61:00", "a:b", ""] {
            assert_eq!(nanoseconds(cell), None, "{cell}");
        }
    }
}
