//! Lands that a spool opens: how the conductances of their paths follow it, as the data sheet of a rig's valve tells.
//! Without such a characteristic they are areas between spool and sleeve.

use super::characteristic::{Characteristic, check_table};
use super::flow_force;
use super::model::{Paths, WITH_LANDS};
use crate::key::{keys, words};
use crate::monotone::Monotone;
use crate::values::{Findings, Rig};

words! {
    /// How a conductance follows the spool.
    pub enum CharacteristicKind {
        /// As the areas of the lands, by the diameters of sleeve and spool.
        Lands = "lands",
        /// In proportion to the opening.
        Linear = "linear",
        /// By a table.
        Table = "table",
    }
}

keys! {
    CHARACTERISTIC: CharacteristicKind = choice("valve.characteristic", "", "How the conductance of a path follows the spool: as the area of a land, in proportion to the opening, or by a table; a valve by its areas has lands.").of(WITH_LANDS);
    LEAKAGE_PERCENT: f64 = number("valve.leakage_percent", 0.0, 0.0, 50.0, "", "Conductance of a shut path, of that of the open one.").chosen_by(&CHARACTERISTIC, &["linear"]);
    CHARACTERISTIC_TABLE: Option<Vec<Vec<f64>>> = optional_rows("valve.characteristic_table", &["spool, %", "conductance, %"], 64, "the data sheet's; needed by characteristic = \"table\"", "", "Conductance of path 1 over the spool, both in percent of their largest; -100 to 100 % of the spool, or as far as anything changes.").chosen_by(&CHARACTERISTIC, &["table"]);
}

/// The characteristic of a rig; None where its lands have areas.
pub(super) fn characteristic(rig: &Rig) -> Option<Characteristic> {
    match rig.get(&keys::CHARACTERISTIC) {
        CharacteristicKind::Lands => None,
        CharacteristicKind::Linear => {
            Some(Characteristic::Linear { leakage: 1e-2 * rig.get(&keys::LEAKAGE_PERCENT) })
        }
        CharacteristicKind::Table => {
            let rows = rig.get(&keys::CHARACTERISTIC_TABLE)?;
            let column = |i: usize| rows.iter().map(|row| 1e-2 * row[i]).collect();
            Some(Characteristic::Table(Monotone::through(column(0), column(1))))
        }
    }
}

/// The constraints on a characteristic.
pub(super) fn check(rig: &Rig, findings: &mut Findings) {
    let model = rig.get(&keys::CHARACTERISTIC);
    let facts = rig.get(&super::keys::MODEL).facts();
    if model != CharacteristicKind::Lands && facts.paths != Paths::Conductances {
        let message =
            "is one of a valve that is known by its conductance: choose such a valve.model, or leave it out";
        findings.note(&keys::CHARACTERISTIC, message);
    }
    let by_data_sheet = model != CharacteristicKind::Lands || !facts.has_lands();
    if by_data_sheet && rig.get(&flow_force::keys::FLOW_FORCE) != flow_force::FlowForceKind::None {
        let message = "comes from the areas of lands, and this valve has none: write flow_force = \"none\"";
        findings.note(&flow_force::keys::FLOW_FORCE, message);
    }
    if model == CharacteristicKind::Table {
        match rig.get(&keys::CHARACTERISTIC_TABLE) {
            None => findings.note(&keys::CHARACTERISTIC_TABLE, "valve.characteristic = \"table\" needs it"),
            Some(rows) => {
                if let Err(message) = check_table(&rows) {
                    findings.note(&keys::CHARACTERISTIC_TABLE, message);
                }
            }
        }
    }
}
