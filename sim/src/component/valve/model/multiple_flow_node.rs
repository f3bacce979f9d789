//! The multiple flow node (6.55 to 6.60): a flow node at each port, and a restriction at the cylinder in place of each tube.

use super::{Facts, ValveModel};
use crate::key::keys;
use crate::values::Rig;

keys! {
    CONNECTOR_DIAMETER_MM: Option<f64> = optional_number("valve.connector_diameter_mm", 0.1, 500.0, "tubing.diameter_mm", "C(63)", "Bore of the connectors: the restrictions at the cylinder.").of(&["multiple-flow-node"]);
}

/// Lands, ports and connectors by their areas.
pub struct MultipleFlowNode;

impl ValveModel for MultipleFlowNode {
    const FACTS: Facts = Facts { has_node: true, replaces_tubes: true, ..Facts::AREAS };

    fn connector_bore(rig: &Rig) -> Option<f64> {
        Some(rig.get(&keys::CONNECTOR_DIAMETER_MM)? * 1e-3)
    }
}
