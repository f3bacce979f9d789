//! Samples for the page, on one time axis.
//!
//! During a test they are the samples of the rig's stream. Between tests they are looks at the rig, 20 a second. A
//! row without values marks missing samples, so that no line is drawn across the gap. A page that has not read for a
//! while still gets the last minute.

use std::collections::VecDeque;

use pneudrive_protocol::RecordedSample;
use pneudrive_records::units::Units;
use serde::Serialize;

/// Looks further apart than this have a gap between them, s.
const APART_S: f64 = 0.25;

/// A row for the page. Unknown values are NaN, null in JSON.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Setpoint, mm.
    pub setpoint: Option<f64>,
    /// Position, mm.
    pub position: Option<f64>,
    /// Pressures, kPa.
    pub pressures: [Option<f64>; 2],
    /// Spool position, mm.
    pub spool: Option<f64>,
    /// Error, counts.
    pub error: i32,
    /// Command, counts.
    pub command: i16,
}

impl Row {
    /// A sample of a test. Its error gives the setpoint, unless the error is at the limit of its bits or the loop is
    /// open.
    pub fn of_stream(sample: &RecordedSample, is_closed: bool, units: &Units) -> Row {
        let RecordedSample { position, error, .. } = *sample;
        let tells = is_closed && error != i16::MAX && error != i16::MIN;
        Row {
            setpoint: tells.then(|| units.millimetres(position.saturating_add(error.into()))).flatten(),
            position: units.millimetres(position),
            pressures: [sample.pressure_1, sample.pressure_2].map(|raw| units.kilopascals(raw)),
            spool: units.spool_millimetres(sample.spool),
            error: error.into(),
            command: sample.command,
        }
    }

    fn values(&self) -> [f32; CHANNELS] {
        let Row { setpoint, position, pressures: [one, two], spool, error, command } = *self;
        let [setpoint, position, one, two, spool] =
            [setpoint, position, one, two, spool].map(|value| value.unwrap_or(f64::NAN) as f32);
        [setpoint, position, one, two, spool, error as f32, f32::from(command)]
    }
}

/// Setpoint, position, both pressures, spool, error, command.
const CHANNELS: usize = 7;

/// Most rows kept: a minute of a fast stream.
const MAX_ROWS: usize = 60_000;

/// Rows that the page has not received yet, by channel.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Samples {
    /// Since the page took command, s.
    time: VecDeque<f64>,
    /// In the order of the channels.
    channels: [VecDeque<f32>; CHANNELS],
    /// The last row, received or not.
    #[serde(skip)]
    last: Option<f64>,
}

impl Samples {
    /// The time of the last row.
    pub fn last(&self) -> f64 {
        self.last.unwrap_or(0.0)
    }

    /// Adds a look. A look from before the last sample is skipped: a virtual rig may be ahead of the clock.
    pub fn look(&mut self, at_s: f64, row: &Row) {
        if self.last.is_none_or(|last| at_s > last) {
            self.add(at_s, row, self.is_apart(at_s));
        }
    }

    /// Whether this time is so long after the last sample that samples are missing.
    pub fn is_apart(&self, at_s: f64) -> bool {
        self.last.is_some_and(|last| at_s - last > APART_S)
    }

    /// Adds a row. `is_behind_gap`: samples before it are missing.
    pub fn add(&mut self, at_s: f64, row: &Row, is_behind_gap: bool) {
        if is_behind_gap {
            self.push(0.5 * (self.last() + at_s), [f32::NAN; CHANNELS]);
        }
        self.push(at_s, row.values());
    }

    fn push(&mut self, at_s: f64, values: [f32; CHANNELS]) {
        self.time.push_back((at_s * 1e6).round() / 1e6);
        self.channels.iter_mut().zip(values).for_each(|(channel, value)| channel.push_back(value));
        self.last = Some(at_s);
        if self.time.len() > MAX_ROWS {
            self.lose_first();
        }
    }

    /// Drops the first row. The next one loses its values, because it is now behind a gap.
    fn lose_first(&mut self) {
        self.time.pop_front();
        for channel in &mut self.channels {
            channel.pop_front();
            channel.iter_mut().take(1).for_each(|value| *value = f32::NAN);
        }
    }

    /// The rows that the page has not received; it receives them now.
    pub fn told(&mut self) -> Option<Samples> {
        let last = self.last;
        let told = std::mem::replace(self, Samples { last, ..Samples::default() });
        (!told.time.is_empty()).then_some(told)
    }
}

#[cfg(test)]
mod tests {
    use pneudrive_records::rig_info::RigParameters;
    use serde_json::json;

    use super::*;

    fn row(position: i32) -> Row {
        let sample = RecordedSample { position, error: 10, ..RecordedSample::default() };
        Row::of_stream(&sample, true, &Units::of(&RigParameters::default()))
    }

    #[test]
    fn what_is_missing_is_a_row_without_values_and_what_has_been_told_is_not_told_again() {
        let mut samples = Samples::default();
        samples.look(1.0, &row(100));
        samples.look(1.1, &row(100));
        samples.look(1.6, &row(200));
        samples.look(1.5, &row(300));
        let told = json!(samples.told().expect("some"));
        assert_eq!(told["time"], json!([1.0, 1.1, 1.35, 1.6]));
        assert_eq!(told["channels"][1], json!([1.205_f32, 1.205_f32, null, 2.41_f32]), "position, mm");
        assert!(samples.told().is_none());
        samples.add(1.7, &row(0), true);
        assert_eq!(json!(samples.told().expect("one"))["time"], json!([1.65, 1.7]));
    }

    #[test]
    fn a_page_that_does_not_read_finds_the_last_rows_behind_a_gap() {
        let (mut samples, row) = (Samples::default(), row(100));
        for k in 0..MAX_ROWS + 2 {
            samples.add(k as f64, &row, false);
        }
        let told = samples.told().expect("some");
        assert_eq!((told.time.len(), told.time[0]), (MAX_ROWS, 2.0));
        assert!(told.channels.iter().all(|channel| channel.len() == MAX_ROWS && channel[0].is_nan()));
        assert!((told.channels[1][1] - 1.205).abs() < 1e-6, "position, mm");
    }

    #[test]
    fn a_setpoint_is_told_where_error_and_position_do() {
        let units = Units::of(&RigParameters::default());
        let of = |error, is_closed| {
            Row::of_stream(&RecordedSample { error, ..RecordedSample::default() }, is_closed, &units).setpoint
        };
        assert_eq!(of(1000, true), units.millimetres(1000));
        assert_eq!([of(i16::MAX, true), of(1000, false)], [None, None]);
    }
}
