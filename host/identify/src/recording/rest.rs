//! The rest that a record begins with: it shows the noise, and the state that a fit starts from.

use std::error::Error;
use std::fmt;

use anyhow::Result;
use pneudrive_protocol::RecordedSample;
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder::pulse;
use pneudrive_sim::component::friction::{Friction, FrictionModel};

/// Fewest samples at rest under an unchanged command that a record begins with.
pub(crate) const FEWEST_AT_REST: usize = 16;

/// How far the seals give way under a load that rests, m: as pressures change, long before it slides, by some hundredths of a
/// millimetre.
const YIELDS_M: f64 = 3e-5;

/// How far a load at rest may move, counts. One whose friction has states, as bristles do, moves by one on any encoder.
pub(super) fn counts_of_yield(rig: &Rig) -> i32 {
    let has_states = !Friction::of(rig).scale().is_empty();
    ((YIELDS_M / pulse(rig)).round() as i32).max(has_states.into())
}

/// How many samples a record begins with before the drive moves by more than `counts` or its command changes.
pub(super) fn samples_at_rest(recorded: &[RecordedSample], counts: i32) -> Result<usize> {
    let first = &recorded[0];
    let rests = |sample: &&RecordedSample| {
        sample.position.abs_diff(first.position) <= counts.unsigned_abs() && sample.command == first.command
    };
    let rest = recorded.iter().take_while(rests).count();
    if rest < FEWEST_AT_REST { Err(NotAtRest(rest).into()) } else { Ok(rest) }
}

/// A record that begins with so few samples at rest.
#[derive(Debug)]
pub(crate) struct NotAtRest(usize);

impl fmt::Display for NotAtRest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "it begins with {} samples at rest under an unchanged command; a fit needs at least {FEWEST_AT_REST}, to know the noise and the state that it starts from",
            self.0
        )
    }
}

impl Error for NotAtRest {}
