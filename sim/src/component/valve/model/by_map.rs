//! A spool valve by the measured flow of its paths ([`crate::component::valve::flow_map`]).

use super::{Facts, ValveKind, Opening, Paths, ValveModel};
use crate::component::valve::flow_law::FlowLaw;
use crate::component::valve::flow_map::FlowMap;
use crate::key::keys;
use crate::values::{Findings, Rig};

keys! {
    FLOW_MAP: Option<Vec<Vec<f64>>> = optional_rows("valve.flow_map", &["spool, %", "upstream, kPa", "downstream, kPa", "flow, l/min (ANR)", "standard deviation, l/min"], 1024, "measured; needed by flow-map", "", "Measured flows of the path to port 1 at 20 C: each place of the spool, in percent of its travel, with each ratio of absolute pressures.").of(&["flow-map"]);
    FLOW_MAP_SHIFT: f64 = number("valve.flow_map_shift", 0.0, -3.0, 3.0, "", "By how many of its standard deviations each flow of the map is taken higher.").of(&["flow-map"]);
}

/// Paths with a map.
pub struct ByMap;

/// Its word, for those who write rig files.
pub const MODEL: ValveKind = ValveKind::ByMap;

/// The map of a rig, if it has a sound one.
fn map(rig: &Rig) -> Option<FlowMap> {
    let rows = rig.get(&keys::FLOW_MAP)?;
    FlowMap::through(&rows, rig.get(&keys::FLOW_MAP_SHIFT)).ok()
}

impl ValveModel for ByMap {
    const FACTS: Facts = Facts { paths: Paths::Own, ..Facts::CONDUCTANCES };

    fn laws(rig: &Rig) -> [FlowLaw; 2] {
        let at_null = map(rig).map(|map| FlowLaw::Map([map.at(0.0); 2]));
        [at_null.unwrap_or(FlowLaw::Orifice); 2]
    }

    fn opening(rig: &Rig) -> Opening {
        map(rig).map_or(Opening::Areas, Opening::Map)
    }

    fn check(rig: &Rig, findings: &mut Findings) {
        match rig.get(&keys::FLOW_MAP) {
            None => findings.note(&keys::FLOW_MAP, "valve.model = \"flow-map\" needs it"),
            Some(rows) => {
                if let Err(message) = FlowMap::through(&rows, rig.get(&keys::FLOW_MAP_SHIFT)) {
                    findings.note(&keys::FLOW_MAP, message);
                }
            }
        }
    }
}
