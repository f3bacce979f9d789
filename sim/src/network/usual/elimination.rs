//! Eliminates a node's unknowns from its three lines by Cramer's rule. The first line is divided by its slope over s:
//!
//! ```text
//! alpha dw +       ds         = -(rho + tau dM)
//! g dw     + sigma ds + b dm = -(r_2 + v_2 dM)
//! c dw     + p ds     + q dm = -(r_3 + v_3 dM)
//! ```

use super::Unknowns;
use super::lines::Line;
use crate::network::nodes::pair;
use crate::number::Pair;

/// The numerators of dw, ds and dm.
type Numerators = [Pair; 3];

/// The changes of both nodes, and of M. The determinants are below zero where air flows.
#[inline(always)]
pub(super) fn solve<const AT_REST: bool>([land, exhaust, port]: &[Line; 3]) -> (Unknowns, Pair) {
    let per_supply = pair(1.0) / land.by_supply;
    let [rho, alpha, tau] = [land.residual, land.by_exner, land.by_total].map(|part| part * per_supply);
    let (g, sigma, b) = (exhaust.by_exner, exhaust.by_supply, exhaust.by_flow);
    let (c, p, q) = (port.by_exner, port.by_supply, port.by_flow);
    // For air at rest the port does not depend on s: p is zero, and so are v_2 and v_3.
    let minors = match AT_REST {
        true => [sigma * q, g * q - b * c, -(sigma * c)],
        false => [sigma * q - b * p, g * q - b * c, g * p - sigma * c],
    };
    let determinant = alpha * minors[0] - minors[1];
    let inverse = pair(1.0) / determinant;
    let fixed = {
        let (r_2, r_3) = (exhaust.residual, port.residual);
        let into_node = r_2 * q - b * r_3;
        let along = if AT_REST { sigma * r_3 } else { sigma * r_3 - r_2 * p };
        numerators(rho, alpha, &minors, [into_node, alpha * along - (g * r_3 - r_2 * c)])
    };
    let by_total = match AT_REST {
        true => [tau * minors[0], -(tau * minors[1]), tau * minors[2]],
        false => {
            let (v_2, v_3) = (exhaust.by_total, port.by_total);
            let into_node = v_2 * q - b * v_3;
            let port = alpha * (sigma * v_3 - v_2 * p) - (g * v_3 - v_2 * c);
            numerators(tau, alpha, &minors, [into_node, port])
        }
    };
    // Times both determinants, so that no division waits for another one.
    let [one, two] = determinant.to_array();
    let other = Pair::new([two, one]);
    let sums = [fixed[1], by_total[1]].map(|part| (part * other).reduce_add());
    let total = pair(-sums[0] / (one * two + sums[1]));
    let [exner, supply, flow] = [0, 1, 2].map(|i| -(fixed[i] + by_total[i] * total) * inverse);
    (Unknowns { exner, supply, exhaust: flow - supply }, total)
}

/// The numerators for right sides: `first` of the first line, and the parts of the other two in w and m.
#[inline(always)]
fn numerators(first: Pair, alpha: Pair, minors: &[Pair; 3], [into_node, port]: [Pair; 2]) -> Numerators {
    [first * minors[0] - into_node, alpha * into_node - first * minors[1], first * minors[2] + port]
}
