//! The drive put together (thesis 6.7): operator, valve, tubing, cylinder and load as one
//! event-driven system for the integrator.
//!
//! ```text
//! command -> amplifier, hysteresis, coil -> spool -> lands -> network of flows -> chambers -> piston -> load
//! ```
//!
//! State, in SI: position and velocity of the load, mass and Exner pressure of both chambers,
//! position and velocity of the spool. The modes say on which smooth piece of the equations the
//! system is; the order of what happens at one instant is EQUATIONS section 11.

use crate::actuator::{Actuator, Air};
use crate::friction::Contact;
use crate::gas::Gas;
use crate::integrator::{Event, Hybrid};
use crate::load::Load;
use crate::network::{Network, Node, PortFlow};
use crate::operator::Solenoid;
use crate::play::Play;
use crate::stop::Side;
use crate::valve::Valve;

/// Number of states.
pub(crate) const STATES: usize = 8;
/// Guards read from the state: stiction and stops of the load, stiction and stops of the spool.
pub(crate) const GUARDS: usize = 4;
/// Guards that need the flows: the direction of the air in each port.
pub(crate) const FLOW_GUARDS: usize = 2;

/// The state vector.
pub(crate) type StateVector = [f64; STATES];

/// Places in the state vector.
pub(crate) mod slot {
    pub const POSITION: usize = 0;
    pub const VELOCITY: usize = 1;
    pub const MASS: [usize; 2] = [2, 4];
    pub const EXNER: [usize; 2] = [3, 5];
    pub const SPOOL: usize = 6;
    pub const SPOOL_VELOCITY: usize = 7;
}

/// What counts as large in each state, for the integrator's tolerance: m, m/s, kg and w (relative
/// to themselves, hence small), m, m/s.
pub(crate) const SCALE: StateVector = [0.1, 1.0, 1e-5, 1.0, 1e-5, 1.0, 1e-3, 1.0];

const LOAD_FRICTION: usize = 0;
const LOAD_STOPS: usize = 1;
const SPOOL_FRICTION: usize = 2;
const SPOOL_STOPS: usize = 3;

/// The physical drive and the modes that it is in.
#[derive(Clone, Debug)]
pub(crate) struct Assembly {
    pub gas: Gas,
    pub valve: Valve,
    pub actuator: Actuator,
    pub load: Load,
    pub operator: Solenoid,
    pub network: Network,
    play: Play,
    load_contact: Contact,
    load_side: Side,
    spool_contact: Contact,
    spool_side: Side,
    ports: [PortFlow; 2],
    /// The last solution of the network and the state it belongs to.
    solved: Option<(StateVector, [Node; 2])>,
}

/// Everything that follows from a state at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effects {
    pub air: [Air; 2],
    pub nodes: [Node; 2],
    pub actuator_force: f64,
    pub friction_force: f64,
    pub acceleration: f64,
}

impl Assembly {
    /// The drive at rest in the state `x` with a null command, its bodies tested for breakaway.
    pub fn new(
        gas: Gas,
        valve: Valve,
        actuator: Actuator,
        load: Load,
        operator: Solenoid,
        network: Network,
        x: &StateVector,
    ) -> Assembly {
        let mut assembly = Assembly {
            play: operator.play_at_rest(0.0),
            load_contact: Contact::Stuck,
            load_side: load.stops.side(x[slot::POSITION]),
            spool_contact: Contact::Stuck,
            spool_side: operator.stops.side(x[slot::SPOOL]),
            ports: [PortFlow::Charging; 2],
            solved: None,
            gas,
            valve,
            actuator,
            load,
            operator,
            network,
        };
        assembly.load_contact = assembly.load.friction.at_rest(assembly.applied_to_load(x));
        assembly.spool_contact = assembly.operator.friction.at_rest(assembly.applied_to_spool(0.0, x));
        assembly.find_port_directions(x);
        assembly
    }

    /// The command jumps to `command` (m) at `t`.
    pub fn drive(&mut self, t: f64, x: &StateVector, command: f64) {
        self.operator.drive(&mut self.play, t, command);
        self.break_spool_away(t, x);
    }

    /// A stuck spool is tested for breakaway after a jump of its force; a slipping one keeps its
    /// mode (EQUATIONS section 11 rule 2).
    fn break_spool_away(&mut self, t: f64, x: &StateVector) {
        if self.spool_contact == Contact::Stuck {
            self.spool_contact = self.operator.friction.at_rest(self.applied_to_spool(t, x));
        }
    }

    fn find_port_directions(&mut self, x: &StateVector) {
        // The direction decides only the temperature, so the second solution has the right signs.
        for _ in 0..2 {
            self.ports = self.nodes(x).map(|node| direction(node.port_flow()));
            self.solved = None;
        }
    }

    fn air(&self, x: &StateVector) -> [Air; 2] {
        let volumes = self.actuator.volumes(x[slot::POSITION], x[slot::VELOCITY]);
        [0, 1].map(|i| Air::of_state(&self.gas, x[slot::MASS[i]], x[slot::EXNER[i]], volumes[i].volume))
    }

    /// The flows at a state; solved once for each.
    fn nodes(&mut self, x: &StateVector) -> [Node; 2] {
        match &self.solved {
            Some((solved, nodes)) if solved == x => *nodes,
            _ => {
                let stations = self.air(x).map(|air| air.station());
                let conductances = self.valve.conductances(&self.gas, x[slot::SPOOL]);
                let nodes = self.network.solve(&conductances, &stations, &self.ports);
                self.solved = Some((*x, nodes));
                nodes
            }
        }
    }

    fn actuator_force(&self, x: &StateVector) -> f64 {
        let [p1, p2] = slot::EXNER.map(|i| self.gas.pressure(x[i]));
        self.actuator.force(p1, p2)
    }

    fn applied_to_load(&self, x: &StateVector) -> f64 {
        let force = self.actuator_force(x);
        self.load.applied_force(force, self.load_side, x[slot::POSITION], x[slot::VELOCITY])
    }

    fn applied_to_spool(&self, t: f64, x: &StateVector) -> f64 {
        let (position, velocity) = (x[slot::SPOOL], x[slot::SPOOL_VELOCITY]);
        self.operator.applied_force(&self.play, self.spool_side, t, position, velocity)
    }

    /// Everything that follows from a state.
    pub fn effects(&mut self, x: &StateVector) -> Effects {
        let applied = self.applied_to_load(x);
        Effects {
            air: self.air(x),
            nodes: self.nodes(x),
            actuator_force: self.actuator_force(x),
            friction_force: self.load.friction.force(self.load_contact, applied),
            acceleration: self.load.acceleration(applied, self.load_contact),
        }
    }

    /// The temperature that the air in port `i` carries into or out of its chamber: the node's when
    /// charging (the tube is adiabatic, EQUATIONS section 3), else the chamber's own.
    fn carried(&self, i: usize, node: &Node, air: &Air) -> f64 {
        match self.ports[i] {
            PortFlow::Charging => node.temperature,
            PortFlow::Discharging => air.temperature,
        }
    }
}

fn direction(port_flow: f64) -> PortFlow {
    if port_flow >= 0.0 { PortFlow::Charging } else { PortFlow::Discharging }
}

impl Hybrid<STATES, GUARDS, FLOW_GUARDS> for Assembly {
    fn derivative(&mut self, t: f64, x: &StateVector) -> StateVector {
        let volumes = self.actuator.volumes(x[slot::POSITION], x[slot::VELOCITY]);
        let air = self.air(x);
        let nodes = self.nodes(x);
        let mut slope = [0.0; STATES];
        for i in 0..2 {
            let carried = self.carried(i, &nodes[i], &air[i]);
            let [mass, exner] = air[i].derivative(&self.gas, volumes[i], nodes[i].port_flow(), carried);
            slope[slot::MASS[i]] = mass;
            slope[slot::EXNER[i]] = exner;
        }
        let force = self.actuator.force(air[0].pressure, air[1].pressure);
        let (position, velocity) = (x[slot::POSITION], x[slot::VELOCITY]);
        let applied = self.load.applied_force(force, self.load_side, position, velocity);
        slope[slot::POSITION] = velocity;
        slope[slot::VELOCITY] = self.load.acceleration(applied, self.load_contact);
        let applied = self.applied_to_spool(t, x);
        slope[slot::SPOOL] = x[slot::SPOOL_VELOCITY];
        slope[slot::SPOOL_VELOCITY] = self.operator.acceleration(applied, self.spool_contact);
        slope
    }

    fn guards(&self, t: f64, x: &StateVector) -> [f64; GUARDS] {
        let on_load = self.applied_to_load(x);
        let on_spool = self.applied_to_spool(t, x);
        [
            self.load.friction.guard(self.load_contact, on_load, x[slot::VELOCITY]),
            self.load.stops.guard(self.load_side, x[slot::POSITION]),
            self.operator.friction.guard(self.spool_contact, on_spool, x[slot::SPOOL_VELOCITY]),
            self.operator.stops.guard(self.spool_side, x[slot::SPOOL]),
        ]
    }

    fn flow_guards(&mut self, _: f64, x: &StateVector) -> [f64; FLOW_GUARDS] {
        let nodes = self.nodes(x);
        std::array::from_fn(|i| match self.ports[i] {
            PortFlow::Charging => nodes[i].port_flow(),
            PortFlow::Discharging => -nodes[i].port_flow(),
        })
    }

    fn next_instant(&self, t: f64) -> f64 {
        self.operator.next_kink(&self.play, t)
    }

    fn cross(&mut self, event: Event, t: f64, x: &mut StateVector) {
        match event {
            Event::Instant => self.pass_kink(t, x),
            Event::Guard(LOAD_FRICTION) => {
                if self.load_contact != Contact::Stuck {
                    x[slot::VELOCITY] = 0.0;
                }
                self.load_contact = self.load.friction.after(self.load_contact, self.applied_to_load(x));
            }
            Event::Guard(LOAD_STOPS) => {
                self.load_side = self.load.stops.after(self.load_side, x[slot::POSITION]);
            }
            Event::Guard(SPOOL_FRICTION) => {
                if self.spool_contact != Contact::Stuck {
                    x[slot::SPOOL_VELOCITY] = 0.0;
                }
                let applied = self.applied_to_spool(t, x);
                self.spool_contact = self.operator.friction.after(self.spool_contact, applied);
            }
            Event::Guard(SPOOL_STOPS) => {
                self.spool_side = self.operator.stops.after(self.spool_side, x[slot::SPOOL]);
            }
            Event::Guard(_) => {}
            Event::FlowGuard(port) => {
                self.ports[port] = match self.ports[port] {
                    PortFlow::Charging => PortFlow::Discharging,
                    PortFlow::Discharging => PortFlow::Charging,
                };
            }
        }
        self.solved = None;
    }
}

impl Assembly {
    /// A kink of the magnetic force: of the hysteresis if it is its time, else where the coil runs
    /// out of current, which needs no change of mode.
    fn pass_kink(&mut self, t: f64, x: &StateVector) {
        self.operator.pass_kink(&mut self.play, t);
        self.break_spool_away(t, x);
    }
}
