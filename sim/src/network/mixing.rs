//! Air that comes together.

/// Appendix VI as one rule: the mean stagnation temperature of what flows in, by mass. None if
/// nothing does.
pub(super) fn mean_of_inflows(inflows: &[(f64, f64)]) -> Option<f64> {
    let (mut mass, mut heat) = (0.0, 0.0);
    for (flow, temperature) in inflows.iter().filter(|(flow, _)| *flow > 0.0) {
        mass += flow;
        heat += flow * temperature;
    }
    (mass > 0.0).then(|| heat / mass)
}
