//! A hole from a chamber to the surroundings, of an effective area A.
//!
//! ```text
//! mdot = A sqrt(2n/((n-1) R T_u) psi(w_u, w_d))               P_d <= b P_u   (V.9, V.10)
//! mdot = (1 - P_d/P_u)/(1 - b) mdot at b,   b = 0.999          P_d > b P_u
//! ```
//!
//! u is the side of the higher pressure; psi is the flow function of [`crate::component::gas`]. The air takes mass,
//! and the enthalpy of its source. Near equal pressures the flow of a hole is laminar, usually from a ratio of 0.999
//! on; the root alone would have an infinite slope there.

use crate::component::air::GasState;
use crate::component::gas::Gas;

/// b.
const LAMINAR_FROM: f64 = 0.999;

/// The flow into the chamber through a hole of `area` m^2, kg/s (negative: out of it), and the
/// temperature that it carries.
pub(crate) fn through_hole(gas: &Gas, area: f64, chamber: &GasState, surroundings: &GasState) -> (f64, f64) {
    if area == 0.0 {
        return (0.0, chamber.temperature);
    }
    if chamber.exner >= surroundings.exner {
        (-area * flux(gas, chamber, surroundings), chamber.temperature)
    } else {
        (area * flux(gas, surroundings, chamber), surroundings.temperature)
    }
}

/// mdot / A, kg/(s m^2).
fn flux(gas: &Gas, up: &GasState, down: &GasState) -> f64 {
    let turbulent =
        |exner: f64| (gas.flow_constant() / up.temperature * gas.flow_function(up.exner, exner).value).sqrt();
    let pressure = gas.pressure(up.exner);
    let ratio = gas.pressure(down.exner) / pressure;
    if ratio <= LAMINAR_FROM {
        turbulent(down.exner)
    } else {
        (1.0 - ratio) / (1.0 - LAMINAR_FROM) * turbulent(gas.exner(LAMINAR_FROM * pressure))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gas() -> Gas {
        Gas::new(1.4, 286.76)
    }

    fn station(pressure: f64, temperature: f64) -> GasState {
        GasState { exner: gas().exner(pressure), temperature }
    }

    fn flow(chamber: f64, surroundings: f64) -> f64 {
        through_hole(&gas(), 1e-6, &station(chamber, 350.0), &station(surroundings, 294.0)).0
    }

    /// Choked: mdot = A P_u sqrt(n/(R T_u)) (2/(n+1))^((n+1)/(2(n-1))).
    #[test]
    fn a_choked_hole_passes_what_the_textbook_says_out_of_the_chamber() {
        let expected = 1e-6 * 5e5 * (1.4 / (286.76 * 350.0_f64)).sqrt() * (2.0 / 2.4_f64).powi(3);
        assert!((flow(5e5, 1e5) + expected).abs() < 1e-12 * expected + 1e-15, "{}", flow(5e5, 1e5));
    }

    #[test]
    fn air_carries_the_temperature_of_the_side_that_it_comes_from() {
        let (warm, cold) = (station(2e5, 350.0), station(1e5, 294.0));
        assert_eq!(through_hole(&gas(), 1e-6, &warm, &cold).1, 350.0);
        let (flow, temperature) = through_hole(&gas(), 1e-6, &cold, &warm);
        assert!(flow > 0.0 && temperature == 350.0, "into a chamber below its surroundings");
    }

    #[test]
    fn near_equal_pressures_the_flow_is_linear_and_joins_the_rest_without_a_jump() {
        let half = flow(1e5, 0.9995e5) / flow(1e5, 0.999e5);
        assert!((half - 0.5).abs() < 1e-9, "{half}");
        let (below, above) = (flow(1e5, 0.999e5 - 1e-4), flow(1e5, 0.999e5 + 1e-4));
        assert!((below / above - 1.0).abs() < 1e-5, "{below} {above}");
        assert_eq!(flow(1e5, 1e5), 0.0);
    }

    #[test]
    fn a_chamber_without_a_hole_loses_nothing() {
        assert_eq!(through_hole(&gas(), 0.0, &station(5e5, 294.0), &station(1e5, 294.0)).0, 0.0);
    }
}
