//! The drive of a rig: its components, and the state in which its test begins.

use super::{Cushions, Lag, Parts, STATES, StateVector, slot};
use crate::component::actuator::Actuator;
use crate::component::air::ChamberAir;
use crate::component::faults::Schedule;
use crate::component::gas::Gas;
use crate::component::load::Load;
use crate::component::operator::Operator;
use crate::component::supply::receiver::Receiver;
use crate::component::supply::regulator;
use crate::component::valve::Valve;
use crate::component::valve::flow_force::FlowForce;
use crate::continuous::ContinuousLaw;
use crate::keys;
use crate::network::Network;
use crate::number::Number;
use crate::start::{Start, receiver_pressure};
use crate::values::Rig;

/// The components of a rig, and the state in which its test begins.
pub(crate) fn drive(rig: &Rig) -> (Parts, StateVector) {
    let gas = Gas::of(rig);
    let actuator = Actuator::of(rig);
    let mut x = initial_state(rig, &gas, &actuator);
    let cushions = Cushions::of(rig, [actuator.area_1, actuator.area_2], actuator.residual_volumes);
    let parts = Parts {
        gas,
        valve: Valve::of(rig),
        null_drift: rig.get(&keys::valve::NULL_DRIFT_MM_PER_H) * 1e-3 / 3600.0,
        actuator,
        cushions,
        load: Load::of(rig),
        operator: Operator::of(rig),
        supply_pressure: rig.get(regulator::line_pressure(rig)),
        receiver: Receiver::of(rig),
        network: Network::of(rig, gas),
        flow_force: FlowForce::of(rig),
        lag: Lag::of(rig, &gas),
        sensor_lag: Some(rig.get(&keys::sensors::PRESSURE_LAG_S)).filter(|lag| *lag > 0.0),
        continuous: ContinuousLaw::of(rig),
        faults: Schedule::new(&rig.fault_events()).later_by(rig.microseconds(&keys::controller::START_S)),
    };
    if let Some(receiver) = &parts.receiver {
        let (pressure, temperature) = (receiver_pressure(rig), rig.get(&keys::supply::TEMPERATURE_K));
        [x[slot::RECEIVER[0]], x[slot::RECEIVER[1]]] = receiver.state_of(&gas, pressure, temperature);
    }
    for (place, state) in slot::FRICTION.into_iter().zip(parts.friction_at_rest(&x).1) {
        x[place] = state;
    }
    if let Some(cushions) = cushions {
        let volumes = parts.actuator.both_volumes(x[slot::POSITION], 0.0).volume;
        match cushions.cushion.spear_at(x[slot::POSITION]) {
            Some(end) => cushions.divide(end, volumes.lane(end), &mut x),
            None => cushions.places.into_iter().for_each(|place| x[place] = 0.0),
        }
    }
    (parts, x)
}

fn initial_state(rig: &Rig, gas: &Gas, actuator: &Actuator) -> StateVector {
    let Start { position, pressures, temperatures } = Start::of(rig);
    let volumes = actuator.volumes(position, 0.0);
    let mut x = [0.0; STATES];
    x[slot::POSITION] = position;
    for ratio in slot::RATIO {
        x[ratio] = 1.0;
    }
    for i in 0..2 {
        let [mass, exner] = ChamberAir::state_of(gas, pressures[i], temperatures[i], volumes[i].volume);
        x[slot::MASS[i]] = mass;
        x[slot::EXNER[i]] = exner;
        if rig.get(&keys::sensors::PRESSURE_LAG_S) > 0.0 {
            x[slot::SENSED[i]] = pressures[i];
        }
    }
    x
}
