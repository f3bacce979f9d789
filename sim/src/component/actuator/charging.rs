//! A rigid volume charged and discharged through a choked orifice, against the exact solutions.
//!
//! Discharge (adiabatic, T and P of the volume along an isentrope; Anderson, Modern Compressible Flow,
//! and any text on blow-down):
//!
//! ```text
//! P(t) = P_0 (1 + (n-1)/2 t/tau)^(-2n/(n-1)),   tau = V / (A c),
//! c = sqrt(n R T_0) (2/(n+1))^((n+1)/(2(n-1)))
//! ```
//!
//! Charge from a reservoir at T_s: the flow is constant, so the pressure rises along a straight line,
//! V dP/dt = n R T_s mdot.

use super::*;
use crate::component::air::GasState;
use pneudrive_solver::{Derivative, Event, Integrator, Method, System};

const VOLUME: f64 = 3e-4;
const AREA: f64 = 2e-6;

struct Vessel {
    gas: Gas,
    /// Upstream, of which the pressure stays; None for a discharge into a vacuum.
    reservoir: Option<GasState>,
}

impl Vessel {
    fn air(&self, x: &[f64; 2]) -> ChamberAir {
        ChamberAir::of_state(&self.gas, x[0], x[1], VOLUME)
    }

    /// Flow into the vessel and the temperature that it carries.
    fn flow(&self, air: &ChamberAir) -> (f64, f64) {
        let conductance = AREA * AREA * self.gas.flow_constant();
        let (up, down, sign) = match self.reservoir {
            Some(reservoir) => (reservoir, air.exner, 1.0),
            None => (air.station(), 0.0, -1.0),
        };
        let psi = self.gas.flow_function(up.exner, down).value;
        (sign * (conductance / up.temperature * psi).sqrt(), up.temperature)
    }
}

impl System<2, 0, 0> for Vessel {
    fn derivative(&mut self, _: f64, x: &[f64; 2]) -> [f64; 2] {
        let air = self.air(x);
        let volume = Volume { volume: VOLUME, rate: 0.0 };
        air.derivative(&self.gas, volume, [self.flow(&air), (0.0, 0.0), (0.0, 0.0)])
    }
    fn guards(&mut self, _: f64, _: &[f64; 2]) -> [f64; 0] {
        []
    }
    fn handle_event(&mut self, _: Event, _: f64, _: &mut [f64; 2]) -> Derivative {
        Derivative::Discontinuous
    }
}

/// Pressure and temperature at `until`, from `pressure` and 294 K.
fn after(vessel: &mut Vessel, pressure: f64, until: f64) -> ChamberAir {
    let start = ChamberAir::state_of(&vessel.gas, pressure, 294.0, VOLUME);
    let mut integrator = Integrator::<2, 0, 0>::new(Method::DormandPrince, 1e-12, [1e-5, 1.0], start);
    integrator.integrate_to(vessel, until, until).expect("smooth");
    vessel.air(integrator.state(until))
}

#[test]
fn a_volume_blows_down_through_a_choked_orifice_as_the_exact_solution_does() {
    for n in [1.4, 1.3] {
        let gas = Gas::new(n, 286.76);
        let mut vessel = Vessel { gas, reservoir: None };
        let speed = (n * 286.76 * 294.0_f64).sqrt() * (2.0 / (n + 1.0)).powf((n + 1.0) / (2.0 * (n - 1.0)));
        let tau = VOLUME / (AREA * speed);
        for until in [0.1, 0.5, 1.5] {
            let rest = 1.0 + (n - 1.0) / 2.0 * until / tau;
            let air = after(&mut vessel, 589e3, until);
            let (pressure, temperature) = (589e3 * rest.powf(-2.0 * n / (n - 1.0)), 294.0 / (rest * rest));
            assert!((air.pressure / pressure - 1.0).abs() < 1e-9, "n {n}, {until} s: {}", air.pressure);
            assert!((air.temperature / temperature - 1.0).abs() < 1e-9, "n {n}, {until} s");
        }
    }
}

#[test]
fn a_volume_is_charged_through_a_choked_orifice_along_a_straight_line() {
    let gas = Gas::new(1.4, 286.76);
    let reservoir = GasState { exner: gas.exner(589e3), temperature: 294.0 };
    let mut vessel = Vessel { gas, reservoir: Some(reservoir) };
    let (flow, _) = vessel.flow(&ChamberAir::of_state(&gas, 1e-4, gas.exner(50e3), VOLUME));
    for until in [0.02, 0.1] {
        let air = after(&mut vessel, 50e3, until);
        let expected = 50e3 + 1.4 * 286.76 * 294.0 * flow * until / VOLUME;
        assert!(expected < 0.528 * 589e3, "still choked");
        assert!((air.pressure / expected - 1.0).abs() < 1e-10, "{until} s: {} {expected}", air.pressure);
    }
}
