//! A spool valve by its conductances ([`crate::component::valve::iso6358`]).
//!
//! It has two kinds of path, from the supply to its ports (1 to 2 and 4) and from these to the exhaust (to 3 and 5), each
//! with figures of its own. What the ports themselves lose is in them, so there is no port besides.

use super::{Facts, ValveKind, ValveModel};
use crate::component::valve::flow_law::FlowLaw;
use crate::component::valve::iso6358::Iso6358;
use crate::key::keys;
use crate::values::{Findings, Rig};

keys! {
    SONIC_CONDUCTANCE_M3_PER_S_PA: Option<f64> = optional_number("valve.sonic_conductance_m3_per_s_pa", 1e-12, 1e-6, "the data sheet's; needed by iso-6358", "", "Sonic conductance of the path from the supply to a port, fully open.").of(&["iso-6358"]);
    CRITICAL_RATIO: Option<f64> = optional_number("valve.critical_ratio", 0.0, 0.9, "the data sheet's; needed by iso-6358", "", "Critical pressure ratio of that path.").of(&["iso-6358"]);
    EXHAUST_SONIC_CONDUCTANCE_M3_PER_S_PA: Option<f64> = optional_number("valve.exhaust_sonic_conductance_m3_per_s_pa", 1e-12, 1e-6, "that of the path from the supply", "", "Sonic conductance of the path from a port to the exhaust, fully open.").of(&["iso-6358"]);
    EXHAUST_CRITICAL_RATIO: Option<f64> = optional_number("valve.exhaust_critical_ratio", 0.0, 0.9, "that of the path from the supply", "", "Critical pressure ratio of that path.").of(&["iso-6358"]);
    SUBSONIC_INDEX: f64 = number("valve.subsonic_index", 0.5, 0.3, 0.8, "", "Exponent of the flow above the critical ratio, of all paths; 0.5 is the ellipse.").of(&["iso-6358"]);
}

/// Lands by their conductances.
pub struct ByConductance;

/// Its word, for those who write rig files.
pub const MODEL: ValveKind = ValveKind::ByConductance;

impl ValveModel for ByConductance {
    const FACTS: Facts = Facts::CONDUCTANCES;

    /// Of zeros where the figures are absent, which `check` refuses.
    fn laws(rig: &Rig) -> [FlowLaw; 2] {
        let subsonic_index = rig.get(&keys::SUBSONIC_INDEX);
        let [sonic, ratio] = [&keys::SONIC_CONDUCTANCE_M3_PER_S_PA, &keys::CRITICAL_RATIO]
            .map(|key| rig.get(key).unwrap_or(0.0));
        let supply = Iso6358 { sonic_conductance: sonic, critical_ratio: ratio, subsonic_index };
        let exhaust = Iso6358 {
            sonic_conductance: rig.get(&keys::EXHAUST_SONIC_CONDUCTANCE_M3_PER_S_PA).unwrap_or(sonic),
            critical_ratio: rig.get(&keys::EXHAUST_CRITICAL_RATIO).unwrap_or(ratio),
            subsonic_index,
        };
        [supply, exhaust].map(FlowLaw::Iso6358)
    }

    fn check(rig: &Rig, findings: &mut Findings) {
        for key in [&keys::SONIC_CONDUCTANCE_M3_PER_S_PA, &keys::CRITICAL_RATIO] {
            if rig.get(key).is_none() {
                findings.note(key, "valve.model = \"iso-6358\" needs it; the data sheet has it");
            }
        }
    }
}
