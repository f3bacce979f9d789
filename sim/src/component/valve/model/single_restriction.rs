//! The single restriction (6.39 to 6.46): the lands are all there is between supply, exhaust and ports.

use super::{Facts, ValveModel};
use crate::key::keys;

/// Lands by their areas.
pub struct SingleRestriction;

keys! {}

impl ValveModel for SingleRestriction {
    const FACTS: Facts = Facts::AREAS;
}
