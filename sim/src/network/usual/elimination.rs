//! The elimination of a node's unknowns from its three lines.

use super::Unknowns;
use super::lines::Line;
use crate::network::nodes::pair;
use crate::number::{Number, Pair};

/// Both nodes' changes, and that of M. The determinants are below zero where air flows.
#[inline(always)]
pub(super) fn solve<const AT_REST: bool>([land, exhaust, port]: &[Line; 3]) -> (Unknowns, Pair) {
    let per_supply = pair(1.0) / land.by_supply;
    let rho = land.residual * per_supply;
    let alpha = land.by_exner * per_supply;
    let tau = land.by_total * per_supply;
    let without = |line: &Line| {
        let [residual, by_exner, by_total] = [rho, alpha, tau].map(|part| line.by_supply * part);
        (line.residual - residual, line.by_exner - by_exner, line.by_total - by_total)
    };
    let (r_2, g, v_2) = without(exhaust);
    let (r_3, c, v_3) = match AT_REST {
        true => (port.residual, port.by_exner, pair(0.0)),
        false => without(port),
    };
    let (b, q) = (exhaust.by_flow, port.by_flow);
    let determinant = g * q - b * c;
    let inverse = pair(1.0) / determinant;
    let into_node = r_2 * q - b * r_3;
    let (exner_by_total, flow_by_total) = match AT_REST {
        true => (v_2 * q, v_2 * c),
        false => (v_2 * q - b * v_3, v_2 * c - g * v_3),
    };
    // Times both determinants, so that no division waits for another one.
    let [one, two] = determinant.to_array();
    let other = Pair::new([two, one]);
    let fixed = ((alpha * into_node - rho * determinant) * other).reduce_add();
    let by_total = ((tau * determinant - alpha * exner_by_total) * other).reduce_add();
    let total = pair(fixed / (one * two + by_total));
    let exner = -(into_node + exner_by_total * total) * inverse;
    let supply = -(rho + alpha * exner + tau * total);
    let port_flow = (r_2 * c - g * r_3 + flow_by_total * total) * inverse;
    (Unknowns { exner, supply, exhaust: port_flow - supply }, total)
}
