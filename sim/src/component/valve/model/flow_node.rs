//! The flow node (6.47 to 6.51): each port has a small volume between its lands and its bore, whose pressure balances
//! the flows through both.

use super::{Facts, ValveModel};
use crate::key::keys;

/// Lands and ports by their areas.
pub struct FlowNode;

keys! {}

impl ValveModel for FlowNode {
    const FACTS: Facts = Facts { has_node: true, ..Facts::AREAS };
}
