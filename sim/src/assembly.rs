//! The assembled drive (thesis 6.7): operator, valve, tubing, cylinder and load as one event-driven system for the
//! integrator.
//!
//! ```text
//! command -> amplifier, hysteresis, coil -> spool -> lands -> network of flows -> chambers -> piston -> load
//! ```
//!
//! State, in SI: position and velocity of the load, mass and Exner pressure of both chambers, the pressure ratios of
//! lagged tubes, position and velocity of the spool, the pressures of lagged sensors, the states of the load's
//! friction, and mass and Exner pressure of a receiver and of the pocket in front of a cushion's spear. The modes tell on which smooth piece of the equations the system is. EQUATIONS section 11 orders the
//! changes at one instant.

mod air;
pub(crate) mod build;
pub(crate) mod cushion;
mod disturbed;
mod following;
mod lag;
mod lands;
pub(crate) mod layout;
pub(crate) mod linear;
mod load;
mod next_event;
mod ports;
mod receiver;
mod sensed;
mod valve_state;

pub(crate) use cushion::Cushions;
pub(crate) use lag::Lag;
pub(crate) use layout::{END_GUARDS, GUARDS, STATES, StateVector, scale_of, slot};
pub(crate) use load::Effects;

use crate::component::actuator::Actuator;
use crate::component::air::GasState;
use crate::component::faults::Schedule;
use crate::component::friction::Contact;
use crate::component::gas::Gas;
use crate::component::load::Load;
use crate::component::operator::{Operator, Request, SpoolState};
use crate::component::stop::Side;
use crate::component::supply::receiver::Receiver;
use crate::component::valve::flow_force::{FlowForce, NodeFlows, Source, ValveFlows, path_area};
use crate::component::valve::{Restrictions, Valve};
use crate::continuous::ContinuousLaw;
use crate::network::{Network, Nodes};
use crate::number::Number;
use lands::Lands;
use layout::{CORE, LAGGED, USUAL, guard, spool_state};
use pneudrive_solver::{Derivative, Event, Integrator, StepLimit, System};
use ports::Ports;
pub use valve_state::ValveState;

/// The integration of an assembly.
pub(crate) type Integration = Integrator<STATES, GUARDS, END_GUARDS, CORE, USUAL>;

/// The physical drive and the modes that it is in.
#[derive(Clone, Debug)]
pub(crate) struct Assembly {
    pub parts: Parts,
    load_contact: Contact,
    load_side: Side,
    /// The end whose spear is in.
    spear: Option<usize>,
    restrictions: Restrictions,
    lands: Lands,
    ports: Ports,
    /// The next event of the spool, as long as no mode of it changes.
    next_spool_event: Option<StepLimit>,
    /// The last solution of the network, and the instant and state it belongs to.
    solved: Option<(f64, StateVector, Nodes)>,
}

/// The components that an assembly is made of.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    pub gas: Gas,
    pub valve: Valve,
    /// Speed of the valve's null, m/s (8.4).
    pub null_drift: f64,
    pub actuator: Actuator,
    pub cushions: Option<Cushions>,
    pub load: Load,
    pub operator: Operator,
    /// Of the supply, or of the line in front of its receiver, when nothing is wrong with it, Pa.
    pub supply_pressure: f64,
    pub receiver: Option<Receiver>,
    pub network: Network,
    pub flow_force: FlowForce,
    pub lag: Option<Lag>,
    /// Lag of the pressure sensors, s.
    pub sensor_lag: Option<f64>,
    pub continuous: Option<ContinuousLaw>,
    pub faults: Schedule,
}

impl Assembly {
    /// The drive at rest in the state `x` with a null command, its bodies tested for breakaway.
    pub fn new(parts: Parts, x: &StateVector) -> Assembly {
        let mut assembly = Assembly {
            load_contact: parts.friction_at_rest(x).0,
            load_side: parts.load.stops.side(x[slot::POSITION]),
            spear: parts.cushions.and_then(|own| own.cushion.spear_at(x[slot::POSITION])),
            restrictions: parts.valve.restrictions(&parts.gas),
            lands: Lands::at(&parts.valve, 0.0),
            ports: Ports::new(),
            next_spool_event: None,
            solved: None,
            parts,
        };
        assembly.lands = Lands::at(&assembly.parts.valve, assembly.spool_to_lands(0.0, x));
        assembly.find_port_directions(0.0, x);
        assembly.pass_faults(0.0, &mut { *x });
        assembly
    }

    /// A request to the operator takes effect at `t`. A spool that jumps takes the flows with it.
    pub fn drive(&mut self, t: f64, x: &mut StateVector, request: Request) -> Derivative {
        let closed_form = self.parts.operator.has_closed_form();
        self.next_spool_event = None;
        self.parts.operator.catch_up(t);
        self.settle(t, x);
        let flow_force = self.flow_force(t, x);
        let before = self.spool(t, x);
        self.parts.operator.drive(t, spool_state(x), request, flow_force);
        let spool = self.spool(t, x);
        if spool != before {
            self.solved = None;
            self.lands = Lands::at(&self.parts.valve, self.spool_to_lands(t, x));
            self.parts.network.jump();
            self.find_port_directions(t, x);
        }
        self.derivative_after(closed_form && spool == before)
    }

    /// The effect of an event of the spool on dx/dt, with `closed_form` before it. If the spool has a closed form
    /// before and after, only its position acts on the other states, and that does not jump.
    fn derivative_after(&self, closed_form: bool) -> Derivative {
        if closed_form && self.parts.operator.has_closed_form() {
            Derivative::Continuous
        } else {
            Derivative::Discontinuous
        }
    }

    /// Brings the integrator's state of the spool to where it is, before a mode of it changes.
    fn settle(&self, t: f64, x: &mut StateVector) {
        let SpoolState { position, velocity } = self.spool_state_at(t, x);
        [x[slot::SPOOL], x[slot::SPOOL_VELOCITY]] = [position, velocity];
    }

    /// Where the spool is, m.
    #[inline]
    pub fn spool(&self, t: f64, x: &StateVector) -> f64 {
        self.parts.operator.position(t, self.spool_state_at(t, x))
    }

    /// Where the spool is as the lands have it, m: a null that drifts leaves it behind.
    fn spool_to_lands(&self, t: f64, x: &StateVector) -> f64 {
        self.beside_null(t, self.spool(t, x))
    }

    fn beside_null(&self, t: f64, spool: f64) -> f64 {
        spool - self.parts.null_drift * t
    }

    /// Position and velocity of a moving spool.
    fn spool_state_at(&self, t: f64, x: &StateVector) -> SpoolState {
        self.parts.operator.state(t, spool_state(x))
    }

    /// Force of the flow on the spool, N, by the flows at this very state (EQUATIONS section 11
    /// rule 7).
    fn flow_force(&mut self, t: f64, x: &StateVector) -> f64 {
        if self.parts.flow_force == FlowForce::None {
            return 0.0;
        }
        let nodes = self.nodes_found(t, x);
        let ends = self.ends_at_valve(x, &self.at_ports(x));
        let behind = self.parts.network.exner_behind_ports(&nodes, &ends, &self.ports.directions);
        let each = nodes.each();
        let spool = self.spool_to_lands(t, x);
        let pressure = |exner| self.parts.gas.pressure(exner);
        let flows = ValveFlows {
            supply: Source {
                pressure: pressure(self.parts.network.exner_at_lands(&nodes)),
                temperature: self.parts.network.supply().temperature,
            },
            exhaust: Source {
                pressure: pressure(self.parts.network.exhaust().exner),
                temperature: self.parts.network.exhaust().temperature,
            },
            nodes: [0, 1].map(|i| NodeFlows {
                supply: each[i].supply_flow,
                exhaust: each[i].exhaust_flow,
                pressure: pressure(each[i].exner),
                port_pressure: pressure(behind.lane(i)),
            }),
            land_areas: self.parts.valve.land_areas(spool),
            path_area: path_area(self.parts.valve.spool_diameter, self.parts.valve.rod_diameter),
            opening: (spool - self.parts.valve.null_offset) / self.parts.valve.travel,
        };
        self.parts.flow_force.force(&self.parts.gas, &flows)
    }
}

impl Assembly {
    /// The rates of all but the spool: of load, air and lagged tubes. No command is in them.
    #[inline(always)]
    fn rates_but_spool(&mut self, t: f64, x: &StateVector) -> StateVector {
        if self.spear.is_none() { self.rates_with(None, t, x) } else { self.rates_in_cushion(t, x) }
    }

    #[cold]
    #[inline(never)]
    fn rates_in_cushion(&mut self, t: f64, x: &StateVector) -> StateVector {
        self.rates_with(self.spear, t, x)
    }

    /// The same with a spear that is in, or none.
    #[inline(always)]
    fn rates_with(&mut self, spear: Option<usize>, t: f64, x: &StateVector) -> StateVector {
        let volumes = self.volumes_with(spear, x);
        let air = self.air_in(volumes.volume, x);
        let at_ports = self.air_at_ports(spear, x, &air);
        let nodes = self.nodes_of(t, x, &at_ports);
        let gas = &self.parts.gas;
        let flows = self.joined(nodes.port_flow());
        let carried = self.carried(&nodes, &at_ports);
        let entering = self.entering_chambers(spear, x, &air, (flows, carried));
        let leak = self.parts.actuator.leak(gas, &air).entering();
        let holes = self.through_holes(&air);
        let [mut masses, mut exners] = air.derivative(gas, volumes, [entering, leak, holes]);
        if let Some(rate) =
            self.parts.actuator.exner_rate_of_heat(gas, x[slot::POSITION], volumes.volume, &air)
        {
            exners += rate;
        }
        if let Some(vent) = &self.parts.actuator.vent {
            [masses, exners] = vent.hold(gas, &volumes, [masses, exners]);
        }
        let mut slope = [0.0; STATES];
        for i in 0..2 {
            slope[slot::MASS[i]] = masses.lane(i);
            slope[slot::EXNER[i]] = exners.lane(i);
        }
        if self.parts.receiver.is_some() {
            self.fill_receiver(x, &nodes, &mut slope);
        }
        let [one, two] = self.acting(spear, x, air.pressure.to_array());
        let force = self.parts.actuator.force(one, two);
        self.follow_pressures(air.pressure.to_array(), x, &mut slope);
        self.move_load(force, x, &mut slope);
        if let Some(lag) = &self.parts.lag {
            let in_tubes = GasState { temperature: carried, ..at_ports };
            let returning = self.parts.network.returning_temperature(&nodes);
            let rates = lag.derivative(gas, x, (nodes.supply.reduce_add(), returning), (&in_tubes, flows));
            for (place, rate) in slot::RATIO.into_iter().zip(rates) {
                slope[place] = rate;
            }
        }
        // Last, as its places are those of others.
        if spear.is_some() {
            self.fill_pocket(x, (flows, carried), entering, &mut slope);
        }
        slope
    }
}

impl System<STATES, GUARDS, END_GUARDS> for Assembly {
    #[inline(never)]
    fn derivative(&mut self, t: f64, x: &StateVector) -> StateVector {
        let mut slope = self.rates_but_spool(t, x);
        self.follow(x);
        let flow_force = self.flow_force(t, x);
        let [spool, spool_velocity] = self.parts.operator.derivative(t, spool_state(x), flow_force);
        slope[slot::SPOOL] = spool;
        slope[slot::SPOOL_VELOCITY] = spool_velocity;
        slope
    }

    fn guards(&mut self, t: f64, x: &StateVector) -> [f64; GUARDS] {
        let mut guards = [1.0; GUARDS];
        guards[guard::LOAD_FRICTION] = self.friction_guard(x);
        guards[guard::LOAD_STOPS] = self.travel_guard(x[slot::POSITION]);
        if let Some(law) = &self.parts.continuous {
            [guards[guard::PROFILE[0]], guards[guard::PROFILE[1]]] = law.guards(x[slot::POSITION]);
        }
        if !self.parts.operator.has_closed_form() {
            self.follow(x);
            self.follow_rate(t, x);
            let flow_force = self.flow_force(t, x);
            guards[guard::SPOOL..].copy_from_slice(&self.spool_guards(t, x, flow_force));
        }
        guards
    }

    fn end_guards(&mut self, t: f64, x: &StateVector) -> [f64; END_GUARDS] {
        let nodes = self.nodes_found(t, x);
        self.ports.guards(&nodes)
    }

    fn tighten(&mut self, tight: bool) {
        if self.parts.network.tighten(tight) {
            self.solved = None;
        }
    }

    fn begin_step(&mut self, h: f64) {
        self.parts.network.begin_step(h);
    }

    fn n_moving(&self) -> usize {
        let last = self.parts.cushions.as_ref().map_or(0, |own| own.places[1]);
        if !self.parts.load.friction.scale().is_empty() || last >= slot::FRICTION[0] {
            STATES
        } else if self.parts.sensor_lag.is_some() || last >= slot::SENSED[0] {
            slot::FRICTION[0]
        } else if !self.parts.operator.has_closed_form() {
            USUAL
        } else if self.parts.lag.is_some() || self.parts.receiver.is_some() || last > 0 {
            LAGGED
        } else {
            CORE
        }
    }

    /// A spool with a closed form has no guards, and a gain profile is one of the continuous controller.
    fn n_guards(&self) -> usize {
        match (self.parts.operator.has_closed_form(), &self.parts.continuous) {
            (true, None) => guard::PROFILE[0],
            (true, Some(_)) => guard::SPOOL,
            (false, _) => GUARDS,
        }
    }

    fn oscillates(&self) -> bool {
        self.parts.operator.max_step().is_finite()
    }

    fn max_step(&self) -> f64 {
        self.parts.operator.max_step()
    }

    fn next_time_event(&self, t: f64) -> f64 {
        self.parts.operator.next_time_event(t).min(self.parts.faults.next_time_event())
    }

    fn step_limit(&mut self, t: f64, x: &StateVector) -> StepLimit {
        self.find_step_limit(t, x)
    }

    fn beyond_model(&self, x: &StateVector) -> Option<&'static str> {
        let position = x[slot::POSITION];
        let of_cushion = || self.parts.cushions.as_ref()?.cushion.used_up(self.spear, position);
        self.parts.actuator.used_up(position).or_else(of_cushion).or_else(|| self.parts.network.jumps())
    }

    fn handle_event(&mut self, event: Event, t: f64, x: &mut StateVector) -> Derivative {
        let mut closed_form = self.parts.operator.has_closed_form();
        self.next_spool_event = None;
        self.parts.operator.catch_up(t);
        if matches!(event, Event::Time | Event::Guard(guard::FIRST_OF_OPERATOR..)) {
            self.settle(t, x);
        }
        match event {
            Event::Time => {
                closed_form &= !self.pass_faults(t, x);
                let flow_force = self.flow_force(t, x);
                self.parts.operator.pass_instant(t, spool_state(x), flow_force);
            }
            Event::Guard(index @ guard::SPOOL..guard::FIRST_OF_OPERATOR) => {
                let spool = self.spool_to_lands(t, x);
                self.lands.pass(index - guard::SPOOL, &self.parts.valve, spool);
            }
            Event::Guard(index @ ..guard::SPOOL) => {
                self.cross_load(index, t, x);
                closed_form = false;
            }
            Event::Guard(index) => {
                self.follow(x);
                self.follow_rate(t, x);
                let flow_force = self.flow_force(t, x);
                let mut spool = spool_state(x);
                self.parts.operator.cross(index - guard::FIRST_OF_OPERATOR, t, &mut spool, flow_force);
                x[slot::SPOOL_VELOCITY] = spool.velocity;
            }
            Event::EndGuard(port) => {
                self.ports.turn(port, t);
                closed_form = false;
            }
        }
        let derivative = self.derivative_after(closed_form);
        if derivative == Derivative::Discontinuous {
            self.solved = None;
            self.parts.network.expect_jump();
        }
        derivative
    }
}
