//! A recorded transient on a rig: its head, and its samples.

use anyhow::{Result, bail};
use pneudrive_protocol::{CHUNK_SAMPLES, RecordInfo, RecordedSample};

use crate::untrusted::{NAME, sanitised};

/// The most samples of a record: its chunks are identified by the 16-bit numbers of requests.
const MAX_SAMPLES: usize = u16::MAX as usize * CHUNK_SAMPLES;

/// The facts known of a record before its samples are downloaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordHead {
    /// Name of the test.
    pub test: String,
    /// Stored samples.
    pub samples: usize,
    /// Index of the oldest sample.
    pub first_index: i32,
    /// Every Nth sample was stored.
    pub decimation: u16,
    /// Samples from before the start.
    pub pre_trigger: u16,
    /// Mean interval of the samples by the board's clock, ns. It is still being measured after the record.
    pub measured_period_ns: u32,
    /// Mean of the spool channel, raw.
    pub mean_spool_raw: i16,
    /// CRC-32 of all samples.
    pub crc32: u32,
}

impl From<&RecordInfo<'_>> for RecordHead {
    fn from(info: &RecordInfo<'_>) -> RecordHead {
        RecordHead {
            test: sanitised(info.test, NAME),
            samples: info.samples as usize,
            first_index: info.first_index,
            decimation: info.decimation,
            pre_trigger: info.pre_trigger,
            measured_period_ns: info.measured_period_ns,
            mean_spool_raw: info.mean_spool_raw,
            crc32: info.crc32,
        }
    }
}

impl RecordHead {
    /// The message that carries it.
    #[must_use]
    pub fn info(&self) -> RecordInfo<'_> {
        RecordInfo {
            test: &self.test,
            samples: self.samples as u32,
            first_index: self.first_index,
            decimation: self.decimation,
            pre_trigger: self.pre_trigger,
            complete: true,
            measured_period_ns: self.measured_period_ns,
            mean_spool_raw: self.mean_spool_raw,
            crc32: self.crc32,
        }
    }

    /// Whether another head belongs to the same record: all but the measured period is equal.
    #[must_use]
    pub fn is_of_the_same_record(&self, other: &RecordHead) -> bool {
        let measured_period_ns = self.measured_period_ns;
        *self == RecordHead { measured_period_ns, ..other.clone() }
    }

    /// The index k of each sample: for those before the start as the recorder says, then from 0 on.
    pub fn indices(&self) -> impl Iterator<Item = i64> {
        let (step, first) = (usize::from(self.decimation.max(1)), i64::from(self.first_index));
        (first..0).step_by(step).chain((0..).step_by(step)).take(self.samples)
    }

    /// The index of its last sample.
    fn last_index(&self) -> i64 {
        let (step, first) = (i64::from(self.decimation.max(1)), i64::from(self.first_index));
        let before = (-first).max(0) as u64;
        let before = before.div_ceil(step as u64) as i64;
        let samples = self.samples as i64;
        if samples > before { (samples - before - 1) * step } else { first + (samples - 1) * step }
    }

    /// Checks that a rig with room for this many samples can have such a record, and that a file can hold it.
    ///
    /// # Errors
    /// With the reason why not.
    pub fn check(&self, capacity: usize) -> Result<()> {
        let RecordHead { samples, first_index, .. } = *self;
        if samples > capacity.min(MAX_SAMPLES) {
            bail!("it reports a record of {samples} samples, but room for {capacity}");
        }
        if first_index > 0 {
            bail!("it reports a record that begins with sample {first_index}, after the start of the run");
        }
        if self.last_index() > i64::from(i32::MAX) {
            bail!(
                "its record ends with sample {}, but files count only up to {}; record with a smaller test.decimation",
                self.last_index(),
                i32::MAX
            );
        }
        Ok(())
    }
}

/// A recorded transient with its facts.
#[derive(Clone, Debug)]
pub struct Record {
    /// Its facts.
    pub head: RecordHead,
    /// The samples, oldest first.
    pub samples: Vec<RecordedSample>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(samples: usize, decimation: u16, first_index: i32) -> RecordHead {
        let (test, pre_trigger, crc32) = (String::new(), 0, 0);
        let (measured_period_ns, mean_spool_raw) = (1_300_000, 0);
        RecordHead {
            test,
            samples,
            first_index,
            decimation,
            pre_trigger,
            measured_period_ns,
            mean_spool_raw,
            crc32,
        }
    }

    /// Once the index wrapped, at sample 32,769.
    #[test]
    fn a_record_that_goes_on_behind_what_files_count_to_is_refused() {
        let error = head(40_000, u16::MAX, 0).check(65_536).expect_err("too far").to_string();
        assert!(error.contains("ends with sample 2621334465"), "{error}");
        assert_eq!(head(40_000, u16::MAX, 0).indices().last(), Some(2_621_334_465));
        assert!(head(32_768, u16::MAX, 0).check(65_536).is_ok());
        assert!(head(32_770, u16::MAX, 0).check(65_536).is_err());
    }

    #[test]
    fn the_last_index_is_that_of_the_last_sample() {
        for (samples, decimation, first) in
            [(1, 1, 0), (5, 1, -2), (5, 3, -7), (5, 3, -15), (2, 3, -15), (4, 0, 0), (3, 9, i32::MIN)]
        {
            let head = head(samples, decimation, first);
            assert_eq!(head.indices().last(), Some(head.last_index()), "{samples} {decimation} {first}");
        }
    }

    #[test]
    fn a_record_that_no_rig_has_is_refused() {
        assert!(head(4390, 1, 0).check(4389).is_err(), "longer than the memory");
        assert!(head(usize::MAX, 1, 0).check(usize::MAX).is_err(), "more chunks than requests have numbers");
        assert!(head(5, 1, 1).check(4389).is_err(), "it begins after the start");
        assert!(head(4389, 1, -2000).check(4389).is_ok());
    }
}
