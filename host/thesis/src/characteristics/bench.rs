//! Parts of a rig on a bench: the valve between two pressures, and its operator without air.

use pneudrive_sim::Rig;
use pneudrive_sim::component::air::GasState;
use pneudrive_sim::component::dither::Dither;
use pneudrive_sim::component::gas::Gas;
use pneudrive_sim::component::operator::{GUARDS, Operator, OperatorKind, Request, SpoolState};
use pneudrive_sim::component::valve::Valve;
use pneudrive_sim::component::valve::speed_counts;
use pneudrive_sim::keys;
use pneudrive_sim::network::{Network, Node, PortFlow};
use pneudrive_solver::bracketed_root;
use pneudrive_solver::{Derivative, Event, IntegrationError, Integrator, Method, System};

/// A valve with gauges right at its ports: no tubes. The air comes to it through ports of the valve's
/// own bore, so that it has the speed there that the flow gives it.
#[derive(Clone, Debug)]
pub(super) struct ValveBench {
    pub gas: Gas,
    pub valve: Valve,
    network: Network,
    exhaust_pa: f64,
    supply_pa: f64,
}

impl ValveBench {
    /// The valve of a rig under a pressure (Pa) at its supply port.
    pub fn new(rig: &Rig, supply_pa: f64) -> ValveBench {
        ValveBench::with_approach(rig, supply_pa, speed_counts(rig))
    }

    /// The same, with or without the speed at which air approaches.
    pub fn with_approach(rig: &Rig, supply_pa: f64, approach: bool) -> ValveBench {
        let gas = Gas::of(rig);
        let valve = Valve::of(rig);
        let network = Network::without_tubes(rig, gas, supply_pa, approach.then(|| valve.port_area()));
        ValveBench { gas, valve, network, exhaust_pa: rig.get(&keys::exhaust::PRESSURE_PA), supply_pa }
    }

    /// The nodes with the spool at a place (m) and pressures (Pa) at the ports.
    pub fn nodes(&mut self, spool: f64, ports_pa: [f64; 2]) -> [Node; 2] {
        let temperature = self.network.supply().temperature;
        let ports = ports_pa.map(|pressure| GasState { exner: self.gas.exner(pressure), temperature });
        self.network.expect_jump();
        let mut nodes = self.network.flows(&self.valve, spool, &ports, &[PortFlow::Charging; 2]);
        // The direction affects only the temperature, so the second solution has the right signs.
        for _ in 0..2 {
            let directions = nodes.map(|node| match node.port_flow() >= 0.0 {
                true => PortFlow::Charging,
                false => PortFlow::Discharging,
            });
            self.network.expect_jump();
            nodes = self.network.flows(&self.valve, spool, &ports, &directions);
        }
        nodes
    }

    /// The pressures (Pa) of ports that nothing flows through; not a number where nothing can flow at all.
    pub fn blocked(&mut self, spool: f64) -> [f64; 2] {
        let (low, high) = (self.exhaust_pa, self.supply_pa);
        [0, 1].map(|port| {
            let mut flow = |pressure: f64| self.nodes(spool, [pressure; 2])[port].port_flow();
            let bracket = [(low, flow(low)), (high, flow(high))];
            if bracket[0].1 <= 0.0 || bracket[1].1 >= 0.0 {
                return if bracket[0].1 > 0.0 {
                    high
                } else if bracket[1].1 < 0.0 {
                    low
                } else {
                    f64::NAN
                };
            }
            bracketed_root(flow, bracket, 1e-6)
        })
    }
}

/// A rig's spool that nothing holds is an oscillator: `x'' + 2 a x' + k x`, with a in 1/s and k in 1/s^2. None of a spool
/// without a mass.
fn oscillator(rig: &Rig) -> Option<[f64; 2]> {
    match rig.get(&keys::operator::MODEL) {
        OperatorKind::Solenoid => {
            let mass = rig.get(&keys::solenoid::SPOOL_MASS_KG);
            let [damping, spring] = [&keys::solenoid::DAMPING_N_S_PER_M, &keys::solenoid::SPRING_N_PER_MM]
                .map(|key| rig.get(key));
            Some([damping / (2.0 * mass), 1e3 * spring / mass])
        }
        OperatorKind::Empirical => Some([
            rig.get(&keys::empirical::DAMPING_PER_S) / 2.0,
            rig.get(&keys::empirical::STIFFNESS_PER_MASS_PER_S2),
        ]),
        OperatorKind::Stepper | OperatorKind::OnOff => None,
    }
}

/// How long it takes until such a spool has lost all but 1/e of its motion, s; of one that nothing damps ten seconds.
pub(super) fn decay_s(rig: &Rig) -> f64 {
    let slowest = |[a, k]: [f64; 2]| if a * a < k { a } else { a - (a * a - k).sqrt() };
    oscillator(rig).map_or(0.0, |oscillator| (1.0 / slowest(oscillator)).min(10.0))
}

/// How often it swings without damping, Hz.
pub(super) fn natural_hz(rig: &Rig) -> f64 {
    oscillator(rig).map_or(0.0, |[_, k]| k.sqrt() / (2.0 * std::f64::consts::PI))
}

/// The operator of a rig with no air in its valve, so that no flow pushes the spool.
#[derive(Clone, Debug)]
pub(super) struct SpoolBench {
    on_bench: OnBench,
    integrator: Integrator<2, GUARDS, 0>,
    counts: i16,
    at: f64,
}

#[derive(Clone, Debug)]
struct OnBench(Operator);

/// As parts of a state's scale, a tenth of a millimetre in a tenth of a second: far below the resolution of a reading.
const TOLERANCE: f64 = 1e-8;
const SCALE: [f64; 2] = [1e-4, 1e-2];

impl SpoolBench {
    /// The operator of a rig, with another dither if one is given.
    pub fn new(rig: &Rig, dither: Option<Dither>) -> SpoolBench {
        SpoolBench {
            on_bench: OnBench(Operator::with_steps(rig, dither.unwrap_or_else(|| Dither::of(rig)))),
            integrator: Integrator::new(Method::DormandPrince, TOLERANCE, SCALE, [0.0; 2]),
            counts: 0,
            at: 0.0,
        }
    }

    /// A command, counts (of a stepper: steps), takes effect now.
    pub fn drive(&mut self, counts: i16) {
        let pulses = match self.on_bench.0 {
            Operator::Stepper(_) => i32::from(counts - self.counts).unsigned_abs(),
            _ => 1,
        };
        let step = (counts - self.counts).signum() as i8;
        let at = self.at;
        self.integrator.interrupt(&mut self.on_bench, at, |on_bench, x| {
            on_bench.settle(at, x);
            for _ in 0..pulses {
                on_bench.0.drive(at, spool_state(x), Request { counts, step }, 0.0);
            }
            Derivative::Discontinuous
        });
        self.counts = counts;
    }

    /// Advances to `t` and returns the spool position, m.
    pub fn spool_at(&mut self, t: f64) -> Result<f64, IntegrationError> {
        self.integrator.integrate_to(&mut self.on_bench, t, t)?;
        self.at = t;
        let x = self.integrator.state(t);
        Ok(self.on_bench.0.position(t, self.on_bench.spool_state_at(t, x)))
    }

    /// Advances by `duration` and returns the spool position at `samples` instants of it, m, each in the middle of its part.
    pub fn watch(&mut self, duration: f64, samples: usize) -> Result<Vec<f64>, IntegrationError> {
        let from = self.at;
        let seen: Result<Vec<f64>, _> = (0..samples)
            .map(|i| self.spool_at(from + duration * (i as f64 + 0.5) / samples as f64))
            .collect();
        self.spool_at(from + duration)?;
        seen
    }
}

impl OnBench {
    fn spool_state_at(&self, t: f64, x: &[f64; 2]) -> SpoolState {
        self.0.state(t, spool_state(x))
    }

    /// Brings the integrator's state of the spool to where it is, before a mode of it changes.
    fn settle(&self, t: f64, x: &mut [f64; 2]) {
        let SpoolState { position, velocity } = self.spool_state_at(t, x);
        *x = [position, velocity];
    }
}

impl System<2, GUARDS, 0> for OnBench {
    fn derivative(&mut self, t: f64, x: &[f64; 2]) -> [f64; 2] {
        self.0.derivative(t, spool_state(x), 0.0)
    }

    fn guards(&mut self, t: f64, x: &[f64; 2]) -> [f64; GUARDS] {
        self.0.guards(t, self.spool_state_at(t, x), 0.0)
    }

    fn next_time_event(&self, t: f64) -> f64 {
        self.0.next_time_event(t)
    }

    fn max_step(&self) -> f64 {
        self.0.max_step()
    }

    fn handle_event(&mut self, event: Event, t: f64, x: &mut [f64; 2]) -> Derivative {
        self.settle(t, x);
        let mut spool = spool_state(x);
        match event {
            Event::Guard(guard) => self.0.cross(guard, t, &mut spool, 0.0),
            Event::Time | Event::EndGuard(_) => self.0.pass_instant(t, spool, 0.0),
        }
        x[1] = spool.velocity;
        Derivative::Discontinuous
    }
}

fn spool_state(x: &[f64; 2]) -> SpoolState {
    SpoolState { position: x[0], velocity: x[1] }
}
