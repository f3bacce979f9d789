//! The drive about a state as a linear system:
//!
//! ```text
//! x' = x0' + A (x - x0) + B (u - u0)
//! y  = y0  + C (x - x0) + D (u - u0)
//! ```
//!
//! u is the command. The air is in pressures and temperatures rather than in masses and Exner pressures. All modes stay
//! as they are: lands open or shut, stops, directions of flows. Dry friction is constant in a slip, so that a load that
//! is held is linearised as one that slips. What makes a spool no linear one is left out: hysteresis, dither, its
//! friction and stops, the limits of amplifier and travel.
//!
//! The slopes are central differences of the equations themselves, with flows to rounding error, extrapolated over two
//! step sizes: their error goes with the fourth power of the step.

use super::{Assembly, STATES, StateVector, slot};
use crate::component::air::ChamberAir;
use crate::component::friction::Contact;
use crate::component::operator::SpoolLaw;
use crate::number::Number;
use crate::snapshot::{QUANTITIES, Quantity, Snapshot};

/// Why there is no linear system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotLinear {
    /// The spool does not follow the command continuously.
    #[error(
        "there is no linear model of a spool that is stuck, or of an on-off valve, which has nothing between its three places"
    )]
    NoSpoolLaw,
    /// The spear of a cushion is in.
    #[error(
        "the load is in an end cushion, whose air is no state of the linear model: take it in front of the cushion, or with actuator.cushion = \"none\""
    )]
    InCushion,
    /// A slope is not a number.
    #[error("the equations have no slopes here: they are not numbers")]
    NoSlopes,
}

/// A linear system about a state. Units are in the names.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearModel {
    /// Names of x.
    pub states: Vec<&'static str>,
    /// Names of y.
    pub outputs: Vec<&'static str>,
    /// x0.
    pub state: Vec<f64>,
    /// x0': zero in an equilibrium.
    pub rates: Vec<f64>,
    /// u0, counts.
    pub command_counts: f64,
    /// y0.
    pub output: Vec<f64>,
    /// A, by rows.
    pub a: Vec<Vec<f64>>,
    /// B, of one column.
    pub b: Vec<f64>,
    /// C, by rows.
    pub c: Vec<Vec<f64>>,
    /// D, of one column.
    pub d: Vec<f64>,
}

/// A state: its name, its place, and its unit as a factor: how many of it make one of SI.
#[derive(Clone, Copy)]
struct State(&'static str, usize, f64);

const MOTION_AND_AIR: [State; 6] = [
    State("position_m", slot::POSITION, 1.0),
    State("velocity_m_s", slot::VELOCITY, 1.0),
    State("pressure_1_pa", PRESSURE[0], 1.0),
    State("pressure_2_pa", PRESSURE[1], 1.0),
    State("temperature_1_k", TEMPERATURE[0], 1.0),
    State("temperature_2_k", TEMPERATURE[1], 1.0),
];
const SPOOL: [State; 2] =
    [State("spool_mm", slot::SPOOL, 1e3), State("spool_velocity_mm_s", slot::SPOOL_VELOCITY, 1e3)];
const TUBES: [State; 3] = [
    State("supply_tube_ratio", slot::RATIO[0], 1.0),
    State("tube_1_ratio", slot::RATIO[1], 1.0),
    State("tube_2_ratio", slot::RATIO[2], 1.0),
];
const SENSORS: [State; 2] = [
    State("sensed_pressure_1_pa", slot::SENSED[0], 1.0),
    State("sensed_pressure_2_pa", slot::SENSED[1], 1.0),
];

const RECEIVER: [State; 2] = [
    State("receiver_pressure_pa", RECEIVER_PRESSURE, 1.0),
    State("receiver_temperature_k", RECEIVER_TEMPERATURE, 1.0),
];

/// Pressures (Pa) take the places of Exner pressures, and temperatures (K) those of masses.
const PRESSURE: [usize; 2] = slot::EXNER;
const TEMPERATURE: [usize; 2] = slot::MASS;
const RECEIVER_TEMPERATURE: usize = slot::RECEIVER[0];
const RECEIVER_PRESSURE: usize = slot::RECEIVER[1];

/// Quantities that no output has: both jump.
const NO_OUTPUT: [&str; 2] = ["spool_command_mm", "friction_n"];

/// The quantities of the outputs.
fn outputs() -> impl Iterator<Item = &'static Quantity> {
    QUANTITIES.iter().filter(|quantity| !NO_OUTPUT.contains(&quantity.name))
}

/// The larger step of the differences over the size of a state. A land bends within its clearance of micrometres, and
/// flows are exact to some 1e-13 of themselves.
const STEP: f64 = 1e-4;

/// The size of each state, SI.
const SIZE: StateVector = {
    let mut size = [1.0; STATES];
    size[slot::POSITION] = 0.1;
    size[PRESSURE[0]] = 1e5;
    size[PRESSURE[1]] = 1e5;
    size[TEMPERATURE[0]] = 300.0;
    size[TEMPERATURE[1]] = 300.0;
    size[slot::SPOOL] = 1e-3;
    size[slot::SENSED[0]] = 1e5;
    size[slot::SENSED[1]] = 1e5;
    size
};

/// The same of a receiver: K and Pa.
const RECEIVER_SIZE: [f64; 2] = [300.0, 1e5];

/// Counts: the command is linear in everything, so that any step is exact.
const COMMAND_STEP: f64 = 1.0;

/// The equations about a point.
struct Equations {
    assembly: Assembly,
    spool_law: SpoolLaw,
    states: Vec<State>,
    t: f64,
    /// In the places of [`State`], SI.
    point: StateVector,
}

impl Assembly {
    /// The drive about its state `x` at `t`, under a command in counts.
    ///
    /// # Errors
    /// Where a command acts on nothing, a spear is in, or the equations have no slopes.
    pub fn linearise(&self, t: f64, x: &StateVector, command: f64) -> Result<LinearModel, NotLinear> {
        let mut equations = Equations::about(self.clone(), t, x)?;
        let n = equations.states.len();
        let mut here = equations.point_in_units();
        let state = here.clone();
        let mut rates = equations.evaluate(&here, command);
        let output = rates.split_off(n);

        if equations.assembly.load_contact == Contact::Stuck {
            equations.assembly.load_contact = Contact::Free;
        }
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for j in 0..n {
            let at = here[j];
            let step = equations.step(j);
            let column = extrapolated(step, |offset| {
                here[j] = at + offset;
                equations.evaluate(&here, command)
            });
            here[j] = at;
            columns.push(column);
        }
        let by_command = extrapolated(COMMAND_STEP, |offset| equations.evaluate(&here, command + offset));
        if columns.iter().chain([&by_command, &rates]).flatten().any(|slope| !slope.is_finite()) {
            return Err(NotLinear::NoSlopes);
        }
        let row = |i: usize| columns.iter().map(|column| column[i]).collect::<Vec<f64>>();
        let (b, d) = by_command.split_at(n);
        Ok(LinearModel {
            states: equations.states.iter().map(|state| state.0).collect(),
            outputs: outputs().map(|quantity| quantity.name).collect(),
            state,
            rates,
            command_counts: command,
            output,
            a: (0..n).map(row).collect(),
            b: b.to_vec(),
            c: (n..n + outputs().count()).map(row).collect(),
            d: d.to_vec(),
        })
    }
}

/// The slopes of a function of an offset at zero, by differences over a step and over half of it.
fn extrapolated(step: f64, mut of: impl FnMut(f64) -> Vec<f64>) -> Vec<f64> {
    let mut difference = |step: f64| {
        let (above, below) = (of(step), of(-step));
        above.iter().zip(below).map(|(above, below)| (above - below) / (2.0 * step)).collect::<Vec<f64>>()
    };
    let (whole, half) = (difference(step), difference(0.5 * step));
    half.iter().zip(whole).map(|(half, whole)| half + (half - whole) / 3.0).collect()
}

impl Equations {
    fn about(mut assembly: Assembly, t: f64, x: &StateVector) -> Result<Equations, NotLinear> {
        let spool_law = assembly.parts.operator.spool_law().ok_or(NotLinear::NoSpoolLaw)?;
        if assembly.is_cushioned() {
            return Err(NotLinear::InCushion);
        }
        let mut point = *x;
        (point[slot::SPOOL], point[slot::SPOOL_VELOCITY]) =
            (assembly.spool(t, x), assembly.spool_state_at(t, x).velocity);
        let air = assembly.air(x);
        for i in 0..2 {
            point[PRESSURE[i]] = air.pressure.lane(i);
            point[TEMPERATURE[i]] = air.temperature.lane(i);
        }
        if let Some(air) = assembly.air_of_receiver(x) {
            [point[RECEIVER_PRESSURE], point[RECEIVER_TEMPERATURE]] = [air.pressure, air.temperature];
        }
        assembly.parts.network.tighten(true);
        assembly.solved = None;
        let parts = &assembly.parts;
        let mut states = MOTION_AND_AIR.to_vec();
        if let Some(vent) = &parts.actuator.vent {
            // Its air has the state of the surroundings.
            let vented = [PRESSURE[vent.chamber], TEMPERATURE[vent.chamber]];
            states.retain(|State(_, place, _)| !vented.contains(place));
        }
        states.extend(SPOOL.iter().filter(|_| matches!(spool_law, SpoolLaw::Moves { .. })));
        states.extend(TUBES.iter().filter(|_| parts.lag.is_some()));
        states.extend(SENSORS.iter().filter(|_| parts.sensor_lag.is_some()));
        let bristles = slot::FRICTION.into_iter().zip(parts.load.friction.state_names());
        states.extend(bristles.map(|(place, name)| State(name, place, 1.0)));
        states.extend(RECEIVER.iter().filter(|_| parts.receiver.is_some()));
        Ok(Equations { assembly, spool_law, states, t, point })
    }

    fn point_in_units(&self) -> Vec<f64> {
        self.states.iter().map(|State(_, place, units)| units * self.point[*place]).collect()
    }

    /// The step of a state in its unit.
    fn step(&self, index: usize) -> f64 {
        let State(_, place, units) = self.states[index];
        let bristles = slot::FRICTION.into_iter().zip(self.assembly.parts.load.friction.scale());
        let size = bristles.fold(SIZE[place], |size, (at, scale)| if at == place { *scale } else { size });
        let of_receiver = self.assembly.parts.receiver.is_some() && slot::RECEIVER.contains(&place);
        STEP * units * if of_receiver { RECEIVER_SIZE[place - slot::RECEIVER[0]] } else { size }
    }

    /// The rates of the states, then the outputs, in their units.
    fn evaluate(&mut self, states: &[f64], command: f64) -> Vec<f64> {
        let mut point = self.point;
        for (State(_, place, units), value) in self.states.iter().zip(states) {
            point[*place] = value / units;
        }
        if let SpoolLaw::Follows { per_count } = self.spool_law {
            point[slot::SPOOL] = per_count * command;
        }
        let t = self.t;
        let assembly = &mut self.assembly;
        assembly.parts.operator.hold(point[slot::SPOOL]);
        let volumes = assembly.parts.actuator.both_volumes(point[slot::POSITION], point[slot::VELOCITY]);
        let mut x = point;
        for i in 0..2 {
            let (pressure, temperature) = (point[PRESSURE[i]], point[TEMPERATURE[i]]);
            let gas = &assembly.parts.gas;
            [x[slot::MASS[i]], x[slot::EXNER[i]]] =
                ChamberAir::state_of(gas, pressure, temperature, volumes.volume.lane(i));
        }
        if let Some(receiver) = &assembly.parts.receiver {
            let (pressure, temperature) = (point[RECEIVER_PRESSURE], point[RECEIVER_TEMPERATURE]);
            [x[slot::RECEIVER[0]], x[slot::RECEIVER[1]]] =
                receiver.state_of(&assembly.parts.gas, pressure, temperature);
        }
        assembly.parts.network.expect_jump();
        let mut rates = assembly.rates_but_spool(t, &x);
        let nodes = assembly.nodes(t, &x);
        let flows = assembly.joined(nodes.port_flow());
        let force = assembly.parts.actuator.force(point[PRESSURE[0]], point[PRESSURE[1]]);
        if let SpoolLaw::Moves { per_count, stiffness_per_mass, damping_per_mass, mass } = self.spool_law {
            rates[slot::SPOOL] = point[slot::SPOOL_VELOCITY];
            rates[slot::SPOOL_VELOCITY] = stiffness_per_mass * (per_count * command - point[slot::SPOOL])
                - damping_per_mass * point[slot::SPOOL_VELOCITY]
                - assembly.flow_force(t, &x) / mass;
        }
        for i in 0..2 {
            let (mass, mass_rate) = (x[slot::MASS[i]], rates[slot::MASS[i]]);
            let pressure_rate = assembly.parts.gas.pressure_rate(x[slot::EXNER[i]], rates[slot::EXNER[i]]);
            let growth = volumes.rate.lane(i) / volumes.volume.lane(i);
            rates[PRESSURE[i]] = pressure_rate;
            // T = P V / (m R)
            rates[TEMPERATURE[i]] =
                point[TEMPERATURE[i]] * (pressure_rate / point[PRESSURE[i]] + growth - mass_rate / mass);
        }
        if let Some((receiver, air)) = assembly.parts.receiver.as_ref().zip(assembly.air_of_receiver(&x)) {
            let pressure_rate = assembly.parts.gas.pressure_rate(air.exner, rates[slot::RECEIVER[1]]);
            rates[RECEIVER_TEMPERATURE] =
                receiver.temperature_rate(&air, rates[slot::RECEIVER[0]], pressure_rate);
            rates[RECEIVER_PRESSURE] = pressure_rate;
        }
        let seen = Snapshot {
            position: point[slot::POSITION],
            velocity: point[slot::VELOCITY],
            acceleration: rates[slot::VELOCITY],
            pressures: PRESSURE.map(|place| point[place]),
            temperatures: TEMPERATURE.map(|place| point[place]),
            spool: point[slot::SPOOL],
            spool_command: f64::NAN,
            mass_flows: flows.to_array(),
            actuator_force: force,
            friction: f64::NAN,
        };
        let rates = self.states.iter().map(|State(_, place, units)| units * rates[*place]);
        rates.chain(outputs().map(|quantity| (quantity.of)(&seen))).collect()
    }
}

#[cfg(test)]
mod tests;
