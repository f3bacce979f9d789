//! The table of flows of a rig with `valve.table`: what it cannot be made for, and the table itself, which is
//! built when the rig is checked, so that a rig that exists has it.

use std::sync::Arc;

use super::keys::KEYS;
use super::read::Reader;
use super::{Rig, Value};
use crate::build;
use crate::faults::FaultKind;
use crate::network::TableQuality;
use crate::network::table::Table;

const KEY: &str = "valve.table";

/// Tables of keys that the flows depend on.
const DEPENDS_ON: [&str; 5] = ["gas", "supply", "exhaust", "valve", "tubing"];

/// A table, and the values that it was built for.
#[derive(Clone, Debug)]
pub(super) struct Tabulated {
    of: Vec<Option<Value>>,
    table: Arc<Table>,
}

/// The same values give the same table.
impl PartialEq for Tabulated {
    fn eq(&self, other: &Tabulated) -> bool {
        self.of == other.of
    }
}

impl Rig {
    /// How good the table of the flows is, if there is one.
    #[must_use]
    pub fn table_quality(&self) -> Option<TableQuality> {
        self.table.as_ref().map(|tabulated| tabulated.table.quality())
    }

    pub(crate) fn flow_table(&self) -> Option<Arc<Table>> {
        self.table.as_ref().map(|tabulated| tabulated.table.clone())
    }

    /// The values that the flows depend on.
    fn values_of_flows(&self) -> Vec<Option<Value>> {
        let keys = KEYS.iter().zip(&self.values);
        keys.filter(|(key, _)| DEPENDS_ON.contains(&key.table())).map(|(_, value)| value.clone()).collect()
    }

    /// What a table cannot do that this rig needs, and the key that asks for it.
    fn refuses_table(&self) -> Option<(&'static str, &'static str)> {
        let clearance = self.number("valve.sleeve_diameter_mm") - self.number("valve.spool_diameter_mm");
        let dips = self.fault_events().iter().any(|event| matches!(event.kind, FaultKind::SupplyDip { .. }));
        let refusals = [
            (
                self.word("valve.model") != "flow-node",
                "valve.model",
                "a table is of flow nodes; write \"flow-node\"",
            ),
            (
                self.switch("valve.upstream_mach"),
                "valve.upstream_mach",
                "a table has air at rest in front of each restriction; write upstream_mach = false",
            ),
            (
                self.word("valve.flow_force") != "none",
                "valve.flow_force",
                "a table does not know the pressures in the nodes, which the force needs; write flow_force = \"none\"",
            ),
            (
                clearance == 0.0,
                "valve.spool_diameter_mm",
                "a table needs a clearance: lands that shut tight leave a node without a pressure",
            ),
            (
                self.number("valve.underlap_mm").abs() >= self.number("valve.spool_travel_mm"),
                "valve.underlap_mm",
                "a table needs the edges of the lands within the spool's travel",
            ),
            (
                self.number("tubing.lag_s") > 0.0,
                "tubing.lag_s",
                "a table has tubes without lag; write lag_s = 0",
            ),
            (
                self.word("tubing.model") == "analytical",
                "tubing.model",
                "a table has empirical tubes or none: those of a pipe depend on the temperature as well",
            ),
            (dips, "faults.event", "a table is for one supply pressure; leave the supply-dip out"),
        ];
        refusals.into_iter().find(|(applies, ..)| *applies).map(|(_, key, why)| (key, why))
    }
}

impl Reader<'_> {
    /// Gives the rig its table if it asks for one, or notes why it cannot have it.
    pub(super) fn tabulate(&mut self, rig: &mut Rig) {
        if !rig.switch(KEY) {
            rig.table = None;
            return;
        }
        if let Some((key, why)) = rig.refuses_table() {
            self.problem_at_key(key, format!("{KEY} = true: {why}, or {KEY} = false"));
            return;
        }
        let of = rig.values_of_flows();
        if rig.table.as_ref().is_some_and(|tabulated| tabulated.of == of) {
            return;
        }
        match Table::build(&build::network(rig, build::gas(rig)), &build::valve(rig)) {
            Ok(table) => rig.table = Some(Tabulated { of, table: Arc::new(table) }),
            Err(refusal) => {
                self.problem_at_key(KEY, format!("no table for this valve: {refusal}; write {KEY} = false"));
            }
        }
    }
}
