//! The encoder while the slide is pushed out by hand: whether it counts, and in which direction.

use std::time::{Duration, Instant};

use anyhow::Result;

use super::{BringUp, Check};

/// The name of this check.
pub(super) const NAME: &str = "encoder by hand";

/// A slide that has moved this far was pushed, mm.
const PUSHED_MM: f64 = 2.0;

/// A slide that stays within [`STILL_MM`] for this long rests; longer than a pushing hand takes to turn round.
const STILL: Duration = Duration::from_millis(700);

/// How far a slide at rest may shake, mm.
const STILL_MM: f64 = 0.1;

/// The longest wait for the slide to come to rest.
const REST_WAIT: Duration = Duration::from_secs(10);

/// Time between two looks.
const LOOK: Duration = Duration::from_millis(5);

/// The advice for swapped tracks.
pub(super) const TURN_ENCODER: &str = "the encoder counts the wrong way: exchange its tracks A and B (on the Nucleo A0 and A1), or set `pneudrive device config set encoder.polarity` to the other sign; of a potentiometer exchange the wires of its ends, and of an encoder with SSI set its direction";

impl BringUp<'_> {
    /// Waits until the slide is pushed out. Returns the direction of the counts, if it was pushed.
    pub(super) fn check_hand(&mut self) -> Result<Option<i32>> {
        if self.options.push_wait.is_zero() {
            self.note(Check::left_out(NAME, "not asked for"));
            return Ok(None);
        }
        self.operator.tell(&format!(
            "Push the slide OUT by hand, a few mm (air off, or the valve shut). Waiting {:.0} s.",
            self.options.push_wait.as_secs_f64()
        ));
        let from = self.client.status()?.position;
        let pushed = self.wait_for_push(from)?;
        let did = "waited for the slide to be pushed out by hand, drive disabled";
        let must = "counts go up as the slide goes out";
        let moved = pushed.unwrap_or(0);
        let saw = format!("{moved:+} counts ({})", self.units.length(moved));
        match pushed {
            None => self.note(Check {
                saw: format!("no motion within {:.0} s", self.options.push_wait.as_secs_f64()),
                did: did.to_owned(),
                must: must.to_owned(),
                ..Check::left_out(NAME, "")
            }),
            Some(1..) => self.note(Check::of(NAME, did, saw, must, Vec::new())),
            Some(_) => self.note(Check::of(NAME, did, saw, must, vec![TURN_ENCODER.to_owned()])),
        }
        self.wait_for_rest()?;
        Ok(pushed.map(i32::signum))
    }

    fn wait_for_push(&mut self, from: i32) -> Result<Option<i32>> {
        let far = self.counts(PUSHED_MM);
        let begun = Instant::now();
        while begun.elapsed() < self.options.push_wait {
            let moved = self.look()?.position.wrapping_sub(from);
            if moved.unsigned_abs() >= far.unsigned_abs() {
                return Ok(Some(moved));
            }
            std::thread::sleep(LOOK);
        }
        Ok(None)
    }

    /// Waits until the slide rests, since a hand may still be on it.
    fn wait_for_rest(&mut self) -> Result<()> {
        let shake = self.counts(STILL_MM).unsigned_abs().max(2);
        let (begun, mut rests_since) = (Instant::now(), Instant::now());
        let mut at = self.client.status()?.position;
        while rests_since.elapsed() < STILL && begun.elapsed() < REST_WAIT {
            let now = self.look()?.position;
            if now.abs_diff(at) > shake {
                (at, rests_since) = (now, Instant::now());
            }
            std::thread::sleep(LOOK);
        }
        Ok(())
    }
}
