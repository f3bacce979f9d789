//! The answer to a pulse, from its record.
//!
//! ```text
//! moved     the position furthest from the first one, minus the first one
//! pressure  mean over the pulse, less the mean before it; the same of the spool
//! ```

use pneudrive_records::record::Record;

/// The answer to a pulse.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Response {
    /// Largest distance of the slide, counts.
    pub moved: i32,
    /// Changes of the pressures, raw.
    pub pressures: [f64; 2],
    /// Change of the spool, raw (steps of a stepper).
    pub spool: f64,
}

/// The samples during which the command was given.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// Its first sample.
    pub from: i64,
    /// The first one after it.
    pub until: i64,
}

impl Response {
    /// The answer in a record to a command within this window.
    pub fn of(record: &Record, window: Window) -> Response {
        let samples: Vec<_> = record.head.indices().zip(&record.samples).collect();
        let channel = |read: fn(&pneudrive_protocol::RecordedSample) -> i16| {
            let mean = |from: i64, until: i64| {
                let within = samples.iter().filter(|(k, _)| (from..until).contains(k));
                let values: Vec<f64> = within.map(|(_, sample)| f64::from(read(sample))).collect();
                values.iter().sum::<f64>() / values.len().max(1) as f64
            };
            mean(window.from, window.until) - mean(0, window.from)
        };
        let first = samples.first().map_or(0, |(_, sample)| sample.position);
        let travels = samples.iter().map(|(_, sample)| sample.position.wrapping_sub(first));
        Response {
            moved: travels.max_by_key(|travel| travel.unsigned_abs()).unwrap_or(0),
            pressures: [channel(|sample| sample.pressure_1), channel(|sample| sample.pressure_2)],
            spool: channel(|sample| sample.spool),
        }
    }
}

/// The answers to a command and to its negative. Their common part, such as a hanging load, cancels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pair {
    /// To the positive command.
    pub out: Response,
    /// To the negative one.
    pub back: Response,
}

impl Pair {
    /// Half of the difference of the distances, counts.
    pub fn counts(&self) -> f64 {
        0.5 * (f64::from(self.out.moved) - f64::from(self.back.moved))
    }

    /// Half of the difference of each pressure, raw.
    pub fn pressures(&self) -> [f64; 2] {
        [0, 1].map(|i| 0.5 * (self.out.pressures[i] - self.back.pressures[i]))
    }

    /// The same of the spool.
    pub fn spool(&self) -> f64 {
        0.5 * (self.out.spool - self.back.spool)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_protocol::RecordedSample;
    use pneudrive_records::record::RecordHead;

    /// Ten samples at rest, ten with a command that moves the slide by 5 counts a sample, ten on its way back.
    fn record() -> Record {
        let position = |k: i32| match k {
            ..10 => 100,
            10..20 => 100 - 5 * (k - 9),
            _ => 50,
        };
        let sample = |k: i32| RecordedSample {
            position: position(k),
            pressure_1: if (10..20).contains(&k) { 900 } else { 1000 },
            pressure_2: if (10..20).contains(&k) { 1050 } else { 1000 },
            ..RecordedSample::default()
        };
        let head = RecordHead {
            test: String::new(),
            samples: 30,
            first_index: 0,
            decimation: 1,
            pre_trigger: 0,
            measured_period_ns: 1_300_000,
            mean_spool_raw: 0,
            crc32: 0,
        };
        Record { head, samples: (0..30).map(sample).collect() }
    }

    #[test]
    fn the_answer_is_the_furthest_way_and_the_changes_while_the_command_was_there() {
        let response = Response::of(&record(), Window { from: 10, until: 20 });
        assert_eq!(response, Response { moved: -50, pressures: [-100.0, 50.0], spool: 0.0 });
    }

    #[test]
    fn a_drift_that_is_the_same_both_ways_drops_out() {
        let out = Response { moved: 70, pressures: [5.0, 1.0], spool: 3.0 };
        let back = Response { moved: 50, pressures: [3.0, 1.0], spool: -3.0 };
        let pair = Pair { out, back };
        assert_eq!((pair.counts(), pair.pressures(), pair.spool()), (10.0, [1.0, 0.0], 3.0));
    }
}
