//! Newton's method where the air comes to rest.
//!
//! A shut chamber that fills has no flow in the end. There the square is flat: from a flow m towards a far smaller
//! flow m*, Newton's method can only halve m, and beyond zero it jumps. Let t = sign sqrt(K/T psi) be the flow that
//! the present pressures drive. The secant
//! ```text
//! (m|m| - t|t|) / (m - t) = |m| + |t|                       same direction
//!                           (m^2 + t^2) / (|m| + |t|)       opposite directions
//! ```
//!
//! leads to t at once, through zero as well, and at the solution it is the tangent 2|m|. The pressure of a node can
//! come no closer to its neighbours than its last digit: this rounding amounts to flows of 1e-10 kg/s.
//!
//! If the valve leaks, air still flows past a chamber at rest from supply to exhaust, and this flow follows the
//! pressure with a finite slope. Beside a land that is shut nothing flows in the end, and the slope would be
//! infinite. So a small flow through such a land is laminar (EQUATIONS section 3):
//!
//! ```text
//! m sqrt(m^2 + m_l^2) = K/T psi,   m_l a thousandth of the land's choked flow from its supply or exhaust
//! ```

use super::nodes::{BoundaryConditions, Nodes};
use super::{GasState, Network};
use crate::component::valve::flow_law::FlowLaw;

/// The slope of a square over its flow that Newton's method uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slope {
    /// Tangents: starting from the last solution.
    Tangent,
    /// Secants towards the flow that the present pressures drive: where flows come to rest.
    Secant,
}

/// kg^2/s^2: the uncertainty of a squared flow from the last digits of the pressures. The ports of drives choke at
/// 1e-2 kg/s.
const ROUNDING: f64 = 1e-20;

/// m_l^2 over the square of the land's choked flow.
const CREEPING: f64 = 1e-6;

impl Slope {
    /// Newton takes about 4 iterations from the last solution; many more mean a bad start.
    pub fn max_iterations(self) -> u32 {
        match self {
            Slope::Tangent => 20,
            Slope::Secant => 60,
        }
    }
}

/// Slope of m|m| over m. `value` is the m|m| to be reached.
#[inline]
pub(super) fn square_slope(slopes: Slope, flow: f64, value: f64) -> f64 {
    let size = flow.abs();
    let driven = value.abs().sqrt();
    match slopes {
        Slope::Tangent => 2.0 * size,
        Slope::Secant if flow * value >= 0.0 => (size + driven).max(f64::MIN_POSITIVE.sqrt()),
        Slope::Secant => (size * size + driven * driven) / (size + driven),
    }
}

/// Residual of a land whose pressures give the signed square `value`, and its slope over the flow. For a land that is
/// shut (a spool without clearance) the residual is the flow itself, because a square would leave Newton's method
/// without a pivot.
#[inline]
pub(super) fn land_line(conductance: f64, flow: f64, value: f64, creeping: f64, slopes: Slope) -> (f64, f64) {
    if conductance == 0.0 {
        (flow, 1.0)
    } else if creeping == 0.0 {
        (flow * flow.abs() - value, square_slope(slopes, flow, value))
    } else {
        let size = (flow * flow + creeping).sqrt();
        (flow * size - value, size + flow * flow / size)
    }
}

impl Network {
    /// m_l^2 of a land beside a shut one, kg^2/s^2.
    pub(super) fn creeping(&self, law: &FlowLaw, conductance: f64, source: &GasState) -> f64 {
        let choked = law.flow_function(&self.gas, source.exner, 0.0).value;
        CREEPING * conductance / source.temperature * choked
    }

    /// Newton's method: by tangents from the predicted or the last solution, else by secants.
    #[inline(always)]
    pub(super) fn by_newton(&mut self, boundary: &BoundaryConditions) -> bool {
        let mut nodes = self.predictor.predict(&self.nodes, boundary);
        let found =
            self.newton(boundary, &mut nodes, Slope::Tangent) || self.newton_from_last(boundary, &mut nodes);
        if found {
            self.nodes = nodes;
            self.predictor.note(&nodes, boundary);
        }
        found
    }

    /// The same from the last solution.
    #[cold]
    #[inline(never)]
    fn newton_from_last(&mut self, boundary: &BoundaryConditions, nodes: &mut Nodes) -> bool {
        [Slope::Tangent, Slope::Secant].into_iter().any(|slopes| {
            *nodes = self.nodes;
            self.newton(boundary, nodes, slopes)
        })
    }
}

/// Whether a correction near rest is only rounding.
pub(super) fn is_rounding(correction: f64) -> bool {
    correction * correction < ROUNDING
}
