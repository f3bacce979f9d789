//! Whether a run advances, and its early end.

use std::time::Duration;

use anyhow::{Result, bail};
use pneudrive_protocol::{Status, UNTIL_STOPPED};
use pneudrive_records::rig_info::RigParameters;
use pneudrive_records::units::Units;

use super::Client;
use crate::failure::Failure;

/// How long a run may go without a new sample.
const STALLED: Duration = Duration::from_secs(5);

/// The furthest sample of a run, and when it was reached.
pub(super) struct Advance {
    furthest: Option<u32>,
    at: Duration,
}

impl Advance {
    pub fn since(now: Duration) -> Advance {
        Advance { furthest: None, at: now }
    }

    /// Checks that a run advances, and not past the last sample of its test.
    pub fn check(&mut self, status: &Status, last_sample: Option<u32>, now: Duration) -> Result<()> {
        let end = last_sample.unwrap_or(UNTIL_STOPPED);
        if status.index > end {
            bail!("it reports sample {} of a run that ends at sample {end}; a stop was sent", status.index);
        }
        if Some(status.index) > self.furthest {
            *self = Advance { furthest: Some(status.index), at: now };
        } else if now > self.at + STALLED {
            bail!(
                "the run has been stuck at sample {} for {} s; a stop was sent",
                status.index,
                STALLED.as_secs()
            );
        }
        Ok(())
    }
}

impl Client {
    /// The position in a run, also in s if the rig's period is known.
    pub(super) fn index_in_run(&self, index: u32) -> String {
        let after =
            |(_, parameters): &(u32, RigParameters)| format!(", after {}", Units::of(parameters).time(index));
        format!("at sample {index}{}", self.known.as_ref().map_or_else(String::new, after))
    }

    /// Ends a run early.
    pub(super) fn end_early(&mut self, last: Option<Status>) -> Result<Status> {
        if last.is_some_and(|status| status.duration_samples == UNTIL_STOPPED) {
            self.disarm()?;
            return self.status();
        }
        self.stop()?;
        Err(Failure::Interrupted
            .error(format!("{}: stopped on request; `pneudrive device arm` clears the fault", self.name)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(index: u32) -> Status {
        Status { index, ..Status::default() }
    }

    #[test]
    fn a_run_that_stands_still_or_goes_back_and_forth_is_noticed_after_its_time() {
        for indices in [[3, 3, 3], [3, 0, 2]] {
            let mut advance = Advance::since(Duration::ZERO);
            for index in indices {
                advance.check(&at(index), None, STALLED).expect("not long enough");
            }
            let error =
                advance.check(&at(1), None, 2 * STALLED + Duration::from_millis(1)).expect_err("too long");
            assert!(error.to_string().contains("stuck at sample 1"), "{error}");
            advance.check(&at(4), None, 3 * STALLED).expect("it goes on");
        }
    }

    #[test]
    fn a_run_may_reach_its_last_sample_and_none_behind_it() {
        let mut advance = Advance::since(Duration::ZERO);
        advance.check(&at(38), Some(38), Duration::ZERO).expect("the last one");
        assert!(advance.check(&at(39), Some(38), Duration::ZERO).is_err());
    }
}
