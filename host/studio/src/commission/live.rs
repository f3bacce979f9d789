//! The stream of the running test, for the page.

use anyhow::Result;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_link::stream::Arrivals;
use pneudrive_protocol::StreamedSample;
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;

use super::samples::{Row, Samples};

/// Most samples per second: a page can draw a minute of them.
const MAX_HZ: f64 = 1000.0;

/// The stream of one test.
#[derive(Debug)]
pub struct Live {
    arrivals: Arrivals,
    every: u32,
    period_s: f64,
    is_closed: bool,
    /// When the test began, s on the page's time axis.
    began_s: f64,
    /// Index of the last sample received.
    last: Option<u32>,
}

/// The sample period of a drive, s, and the decimation of its stream.
fn rate_of(parameters: &RigParameters) -> (f64, u16) {
    let period_s = f64::from(parameters.values.get(id::PERIOD_US).unwrap_or(1300).max(1)) / 1e6;
    (period_s, (1.0 / period_s / MAX_HZ).ceil().max(1.0) as u16)
}

impl Live {
    /// Begins a stream for the next test.
    ///
    /// # Errors
    /// When the firmware has no streams, or does not answer.
    pub fn begin(client: &mut Client, parameters: &RigParameters) -> Result<Live> {
        let (period_s, every) = rate_of(parameters);
        client.stream_begin(every, 1.0 / period_s)?;
        let is_closed = parameters.values.get(id::OPEN_LOOP) != Some(1);
        let arrivals = Arrivals::default();
        Ok(Live { arrivals, every: every.into(), period_s, is_closed, began_s: 0.0, last: None })
    }

    /// The test begins now.
    pub fn begins(&mut self, at_s: f64) {
        self.began_s = at_s;
    }

    /// Samples per second in a stream of this drive.
    pub fn rate_hz(parameters: &RigParameters) -> f64 {
        let (period_s, every) = rate_of(parameters);
        1.0 / (period_s * f64::from(every))
    }

    /// The samples since the last call; None once the test is over and all of them have arrived.
    ///
    /// # Errors
    /// As [`Client::stream_take`].
    pub fn take(&mut self, client: &mut Client, is_over: bool) -> Result<Option<Vec<StreamedSample>>> {
        let rows = client.stream_take(&mut self.arrivals, is_over)?;
        Ok((!is_over || !rows.is_empty()).then_some(rows))
    }

    /// Adds the new samples to `samples`.
    pub fn put(&mut self, rows: &[StreamedSample], samples: &mut Samples, units: &Units) {
        for StreamedSample { index, sample } in rows {
            let at_s = self.began_s + f64::from(*index) * self.period_s;
            let is_behind_gap = match self.last {
                Some(last) => index - last > self.every,
                // Between the last look and the start the drive is armed, and perhaps its test is downloaded.
                None => *index > 0 || samples.is_apart(at_s),
            };
            samples.add(at_s, &Row::of_stream(sample, self.is_closed, units), is_behind_gap);
            self.last = Some(*index);
        }
    }
}

#[cfg(test)]
mod tests {
    use pneudrive_protocol::RecordedSample;
    use serde_json::{Value, json};

    use super::*;

    /// The times of the samples when a look at 1 s is followed by a test that begins at 1.1 s or later.
    fn told(began_s: f64, first: u32) -> Value {
        let units = Units::of(&RigParameters::default());
        let sample = RecordedSample::default();
        let mut samples = Samples::default();
        samples.look(1.0, &Row::of_stream(&sample, true, &units));
        let arrivals = Arrivals::default();
        let mut live = Live { arrivals, every: 1, period_s: 0.1, is_closed: true, began_s: 0.0, last: None };
        live.begins(began_s);
        let rows = [first, first + 1].map(|index| StreamedSample { index, sample });
        live.put(&rows, &mut samples, &units);
        let mut told = json!(samples.told().expect("some"));
        told["time"].take()
    }

    #[test]
    fn nothing_is_drawn_across_what_is_missing_before_the_first_sample() {
        assert_eq!(told(1.1, 0), json!([1.0, 1.1, 1.2]));
        assert_eq!(told(2.0, 0), json!([1.0, 1.5, 2.0, 2.1]), "it took a second to start");
        assert_eq!(told(1.1, 1), json!([1.0, 1.1, 1.2, 1.3]), "the first sample was lost");
    }
}
