//! Whether the lag of a rig's tubes is long enough to have an effect.
//!
//! The pressure behind a tube follows the flow, and the flow through the valve follows that pressure. With a lag T, a valve that
//! passes m_v where nothing is lost before and behind it, and tubes that lose half of the pressure at m_t, that pressure settles
//! within
//!
//! ```text
//! T / (1 + (m_v/m_t)^2)
//! ```
//!
//! because both drops go with the square of the flow, or nearly so. Beside a valve that passes far more than its tubes nothing
//! lags any more: the pressure behind a tube is that of the chamber or of the supply but for a small difference, which
//! the least error of either turns into a flow. Such a run takes steps of nanoseconds.
//!
//! A valve that opens towards an empty chamber has m_v at once. The pressure in front of the chamber's tube then rises as if it
//! were to settle at r times that of the chamber, the ratio that the tube needs for m_v, and has the pressure of the supply
//! within T / r. With the empirical tube r is 2^(m_v/m_t).

use crate::component::air::GasState;
use crate::component::gas::Gas;
use crate::component::supply::SupplyKind;
use crate::component::tubing::{Tube, tubes};
use crate::component::valve::Valve;
use crate::component::{exhaust, supply};
use crate::key::Choice;
use crate::keys;
use crate::network::{Network, PortFlow};
use crate::values::{Findings, Rig};

/// The least of these times, s: a tenth of a microsecond, in which time is counted here.
const LEAST_S: f64 = 1e-7;

/// The least of T / r, s: a hundred times the shortest step of the solver.
const LEAST_RISE_S: f64 = 1e-11;

/// Flows between which that of a tube is searched for, kg/s.
const FLOWS: [f64; 2] = [1e-12, 1e6];

/// The longest lag that a rig may have, s.
const MAX_LAG_S: f64 = 1.0;

pub(super) fn check(rig: &Rig, findings: &mut Findings) {
    let lag = rig.get(&keys::tubing::LAG_S);
    let supply = || rig.get(&keys::supply::MODEL);
    if lag > 0.0 && supply() != SupplyKind::Ideal {
        let message = format!(
            "must be 0 beside supply.model = {:?}: tubes lag behind an ideal supply alone",
            supply().word()
        );
        findings.note(&keys::tubing::LAG_S, message);
        return;
    }
    let Some(Tubes { times, ratio }) = (lag > 0.0).then(|| Tubes::of(rig)).flatten() else { return };
    let least = (LEAST_S * (1.0 + times * times)).max(LEAST_RISE_S * ratio);
    if lag < least {
        // Rounded, it is still enough.
        let longer = 1.05 * least;
        let remedy = if longer <= MAX_LAG_S { format!("0 or at least {longer:.1e}") } else { "0".to_owned() };
        let message = format!(
            "the valve passes {times:.3} times the flow at which the tubes lose half of the pressure, so behind them it settles as if nothing lagged: write {remedy}, or give wider tubes or a smaller valve"
        );
        findings.note(&keys::tubing::LAG_S, message);
    }
}

/// Beside the valve's largest flow m_v.
struct Tubes {
    /// m_v/m_t.
    times: f64,
    /// r.
    ratio: f64,
}

impl Tubes {
    /// None without tubes.
    fn of(rig: &Rig) -> Option<Tubes> {
        let gas = Gas::of(rig);
        let (from_supply, to_cylinder) = tubes(rig, &gas);
        let tube = if from_supply.is_none() { to_cylinder } else { from_supply };
        if tube.is_none() {
            return None;
        }
        let (most, empty) = (largest_flow(rig, gas), exhaust::station(rig, &gas));
        Some(Tubes {
            times: most / flow_at_half(&gas, &tube, &supply::station(rig, &gas)),
            ratio: gas.pressure(to_cylinder.far_exner(&empty, -most)) / gas.pressure(empty.exner),
        })
    }
}

/// m_v, kg/s: into an empty chamber or out of a full one, with the spool at either end.
fn largest_flow(rig: &Rig, gas: Gas) -> f64 {
    let valve = Valve::of(rig);
    let (full, empty) = (supply::station(rig, &gas), exhaust::station(rig, &gas));
    let ends = [-valve.travel, valve.travel].map(|spool| {
        [(empty, PortFlow::Charging), (full, PortFlow::Discharging)].map(|(chamber, port)| {
            let nodes = Network::of(rig, gas).flows(&valve, spool, &[chamber; 2], &[port; 2]);
            nodes.map(|node| node.port_flow().abs()).into_iter().fold(0.0, f64::max)
        })
    });
    ends.into_iter().flatten().fold(0.0, f64::max)
}

/// m_t, kg/s.
fn flow_at_half(gas: &Gas, tube: &Tube, known: &GasState) -> f64 {
    let half = known.exner * gas.exner_ratio(0.5);
    let [mut low, mut high] = FLOWS;
    for _ in 0..80 {
        let middle = (low * high).sqrt();
        if tube.far_exner(known, middle) > half { low = middle } else { high = middle }
    }
    high
}
