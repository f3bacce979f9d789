//! The law "cascade" knows its drive by the rig file: what the keys say, in the integers of the law.
//!
//! Its units are counts of the encoder, samples, the supply pressure Ps, and the force Ps A_1
//! (`pneudrive_controller::law::cascade`). With T the period and c the length of a count:
//!
//! ```text
//! length of a chamber    V_i/(A_i c)                           flow           n R sqrt(T_0 Ts) rho_0 C T/(A_1 c)
//! acceleration           Ps A_1 T^2/(M c)                      viscous        B c/(T Ps A_1)
//! lag of the spool       K_D/K_S                               dead time      tau = delay + T/2 + lag/1.5, for the lag 4.5 T of a measured spool
//! sensors with a lag L   a = exp(-T/L), b = (1 - a) L/T
//! poles                  force 0.6/tau, position 0.24/tau, motion observer 1.0/tau, flow observer 0.35/tau
//! trajectories           half of the speed of the choked flow, 0.4 of the force, 0.4 of the flow (0.24 with a measured spool)
//! stepper              n: the first step whose rate of the force r_n >= 0.6/tau (Fc - T (r_1 + .. + r_n)),   r_i: of i steps from the null
//! ```
//!
//! A stepper opens a step a sample. When the friction changes by Fc the force loop asks for 0.6/tau of what the force lacks, and the valve
//! has opened so far after n samples; as it opens evenly it lags by half of that.
//!
//! Three keys of the rig file move these: `controller.cascade_dead_time_factor` multiplies tau, `controller.cascade_observer_factor`
//! the poles of the observers, and `controller.cascade_flow_share` is the 0.4 of the trajectories, whose speed has 1.25 times as much.

mod fixed;
mod paths;
mod spool;

use pneudrive_controller::parameters::id;

use crate::component::actuator::Actuator;
use crate::component::actuator::spring::ReturnSpring;
use crate::component::actuator::vent::VentedKind;
use crate::component::encoder::pulse;
use crate::component::load::Load;
use crate::component::operator::OperatorKind;
use crate::component::tubing::{TubingKind, has_flow_controls};
use crate::component::valve::discharge::DischargeKind;
use crate::component::valve::flow_force::FlowForceKind;
use crate::component::valve::iso6358::{Iso6358, REFERENCE_DENSITY, REFERENCE_TEMPERATURE};
use crate::component::valve::lands::CharacteristicKind as Characteristic;
use crate::component::valve::model::{WITH_CONDUCTANCES, WITH_NODES_AND_TUBES};
use crate::component::valve::spool_travel;
use crate::key::Choice;
use crate::keys;
use crate::values::{Findings, Rig};
use fixed::fixed;
use paths::Paths;
use spool::Spool;

/// Poles, in 1/tau.
const FORCE_POLE: f64 = 0.6;
const POSITION_POLE: f64 = 0.24;
const MOTION_POLE: f64 = 1.0;
const FLOW_POLE: f64 = 0.35;
/// The part of the largest speed that a trajectory of its own asks for, over that of the force and of its rate.
const TRAJECTORY_SPEED: f64 = 1.25;
/// The noise of a force, part of the exhaust pressure on area 1.
const FORCE_NOISE: f64 = 0.02;

/// What the law knows of a drive whose rig passes [`check`].
pub(super) fn values(rig: &Rig) -> Vec<(u16, i32)> {
    let drive = Drive::of(rig);
    [
        drive.cylinder(rig),
        drive.valve(rig),
        drive.load(rig),
        drive.spool.values(rig),
        drive.sensors(rig),
        drive.loops(rig),
    ]
    .concat()
}

/// What several lines of the table need, SI.
struct Drive {
    actuator: Actuator,
    load: Load,
    count: f64,
    period: f64,
    delay: f64,
    supply: f64,
    exhaust: f64,
    /// Ps A_1, N.
    force: f64,
    spool: Spool,
    paths: Paths,
    /// What its trajectories ask for, and how much longer tau and how much faster the observers are than usual.
    flow_share: f64,
    dead_time_factor: f64,
    observer_factor: f64,
}

impl Drive {
    fn of(rig: &Rig) -> Drive {
        let actuator = Actuator::of(rig);
        let supply = rig.get(&keys::supply::PRESSURE_PA);
        let spool = Spool::of(rig);
        Drive {
            force: supply * actuator.area_1,
            actuator,
            load: Load::of(rig),
            count: pulse(rig),
            period: rig.get(&keys::controller::PERIOD_S),
            delay: rig.get(&keys::controller::DELAY_S),
            supply,
            exhaust: rig.get(&keys::exhaust::PRESSURE_PA),
            paths: Paths::of(rig, spool.reach),
            spool,
            flow_share: rig.get(&keys::controller::CASCADE_FLOW_SHARE),
            dead_time_factor: rig.get(&keys::controller::CASCADE_DEAD_TIME_FACTOR),
            observer_factor: rig.get(&keys::controller::CASCADE_OBSERVER_FACTOR),
        }
    }

    fn cylinder(&self, rig: &Rig) -> Vec<(u16, i32)> {
        let areas = [self.actuator.area_1, self.actuator.area_2];
        let lengths = [0, 1].map(|i| self.actuator.residual_volumes[i] / areas[i] / self.count);
        let [low, high] =
            [&keys::sensors::PRESSURE_MIN_PA, &keys::sensors::PRESSURE_MAX_PA].map(|key| rig.get(key));
        let full = f64::from((1_u32 << rig.get(&keys::sensors::BITS)) - 1);
        vec![
            (id::CASCADE_STROKE, fixed(self.actuator.stroke / self.count, 0)),
            (id::CASCADE_DEAD_LENGTH_1, fixed(lengths[0], 0)),
            (id::CASCADE_DEAD_LENGTH_2, fixed(lengths[1], 0)),
            (id::CASCADE_PRESSURE_OFFSET, fixed(low / self.supply, 24)),
            (id::CASCADE_PRESSURE_GAIN, fixed((high - low) / full / self.supply, 30)),
            (id::CASCADE_EXHAUST_PRESSURE, fixed(self.exhaust / self.supply, 24)),
            (id::CASCADE_AREA_RATIO, fixed(areas[1] / areas[0], 24)),
        ]
    }

    /// n R sqrt(T_0 Ts) rho_0 C T/(A_1 c), and 1/(1 - b).
    fn valve(&self, rig: &Rig) -> Vec<(u16, i32)> {
        let exponent = rig.get(&keys::gas::HEAT_CAPACITY_RATIO);
        let temperature = rig.get(&keys::supply::TEMPERATURE_K);
        let gas = exponent
            * rig.get(&keys::gas::GAS_CONSTANT_J_PER_KG_K)
            * (REFERENCE_TEMPERATURE * temperature).sqrt();
        let flow = |path: &Iso6358| {
            let volume = gas * REFERENCE_DENSITY * path.sonic_conductance;
            volume * self.period / self.actuator.area_1 / self.count
        };
        let paths = &self.paths;
        let [supply, exhaust] = &paths.open;
        let steepness = |path: &Iso6358| 1.0 / (1.0 - path.critical_ratio);
        let speed = TRAJECTORY_SPEED * self.flow_share * paths.kept * flow(exhaust) / exponent;
        let mut values = vec![
            (id::CASCADE_EXPONENT, fixed(exponent, 16)),
            (id::CASCADE_FLOW_SUPPLY, fixed(flow(supply), 16)),
            (id::CASCADE_FLOW_EXHAUST, fixed(flow(exhaust), 16)),
            (id::CASCADE_STEEPNESS_SUPPLY, fixed(steepness(supply), 16)),
            (id::CASCADE_STEEPNESS_EXHAUST, fixed(steepness(exhaust), 16)),
            (id::CASCADE_LEAKAGE, fixed(paths.leakage, 16)),
            // The choked flow that leaves the larger chamber.
            (id::CASCADE_WAY_SPEED, fixed(speed, 16)),
        ];
        if let Some(land) = &paths.land {
            values.push((id::CASCADE_PORT, self.spool.counts(land.port)));
            values.push((id::CASCADE_CLEARANCE, self.spool.counts(land.clearance)));
        }
        if let Some([supply, exhaust]) = paths.tubes {
            values.extend([
                (id::CASCADE_TUBE_SUPPLY_CHOKED, fixed(supply.choked, 16)),
                (id::CASCADE_TUBE_SUPPLY_SLIGHT, fixed(supply.slight, 16)),
                (id::CASCADE_TUBE_EXHAUST_CHOKED, fixed(exhaust.choked, 16)),
                (id::CASCADE_TUBE_EXHAUST_SLIGHT, fixed(exhaust.slight, 16)),
            ]);
        }
        values
    }

    fn load(&self, rig: &Rig) -> Vec<(u16, i32)> {
        let part = |force: f64| fixed(force / self.force, 24);
        let stiction =
            rig.get(&keys::friction::STATIC_EXTEND_N).min(rig.get(&keys::friction::STATIC_RETRACT_N));
        let per_force = self.force * self.period * self.period / self.load.mass / self.count;
        let pull =
            (1.0 - self.exhaust / self.supply) * (self.actuator.area_2 / self.actuator.area_1).min(1.0);
        vec![
            (id::CASCADE_ACCELERATION, fixed(per_force, 16)),
            (id::CASCADE_COULOMB_EXTEND, part(rig.get(&keys::friction::COULOMB_EXTEND_N))),
            (id::CASCADE_COULOMB_RETRACT, part(rig.get(&keys::friction::COULOMB_RETRACT_N))),
            (id::CASCADE_STICTION, part(stiction)),
            (id::CASCADE_VISCOUS, fixed(self.load.viscous * self.count / self.period / self.force, 30)),
            (id::CASCADE_WEIGHT, part(self.load.weight())),
            (id::CASCADE_STANDING_FORCE, part(self.standing_force(rig))),
            (id::CASCADE_WAY_ACCELERATION, fixed(self.flow_share * pull * per_force, 16)),
            (id::CASCADE_LEARNING_NOISE, part(FORCE_NOISE * self.exhaust * self.actuator.area_1)),
        ]
    }

    /// What stands against extension beside the weight, N. The law knows no force that depends on the position: a return spring counts
    /// with its force in the middle of the stroke, and the law learns the rest.
    fn standing_force(&self, rig: &Rig) -> f64 {
        let inside = ReturnSpring::of(rig);
        -(rig.get(&keys::load::CONSTANT_FORCE_N) + inside.force(0.5 * self.actuator.stroke))
    }

    fn sensors(&self, rig: &Rig) -> Vec<(u16, i32)> {
        let lag = rig.get(&keys::sensors::PRESSURE_LAG_S) / self.period;
        let decay = if lag > 0.0 { libm::exp(-1.0 / lag) } else { 0.0 };
        vec![
            (id::CASCADE_SENSOR_DECAY, fixed(decay, 30)),
            (id::CASCADE_SENSOR_GAIN, fixed((1.0 - decay) * lag, 30)),
        ]
    }

    /// Rate of the force with the spool at z (m) over that at its null, in the middle of the stroke, N/s: n R Ts (m_in/l_1 + m_out/l_2).
    fn rate(&self, rig: &Rig, z: f64) -> f64 {
        let gas = rig.get(&keys::gas::HEAT_CAPACITY_RATIO)
            * rig.get(&keys::gas::GAS_CONSTANT_J_PER_KG_K)
            * rig.get(&keys::supply::TEMPERATURE_K);
        let Actuator { area_1, area_2, stroke, residual_volumes, .. } = &self.actuator;
        let lengths = [residual_volumes[0] / area_1, residual_volumes[1] / area_2];
        let per_length = |(flow, dead): (f64, f64)| flow / (dead + 0.5 * stroke);
        gas * self.paths.more(z).into_iter().zip(lengths).map(per_length).sum::<f64>()
    }

    /// n, the steps by which a stepper opens its valve when the running friction has to be made up for.
    fn opened(&self, rig: &Rig, step: f64) -> i64 {
        use keys::friction::{COULOMB_EXTEND_N, COULOMB_RETRACT_N};
        let mut left = 0.5 * (rig.get(&COULOMB_EXTEND_N) + rig.get(&COULOMB_RETRACT_N));
        let most = rig.get(&keys::stepper::MAX_STEPS);
        for n in 1..most {
            let rate = self.rate(rig, n as f64 * step);
            left -= rate * self.period;
            let tau = self.delay + 0.5 * (1 + n) as f64 * self.period;
            if rate >= FORCE_POLE / tau * left {
                return n;
            }
        }
        most
    }

    fn loops(&self, rig: &Rig) -> Vec<(u16, i32)> {
        let spool = self.spool.dead_time(|step| self.opened(rig, step));
        // Samples from one to what it does to the flow.
        let tau = self.dead_time_factor * (self.delay + 0.5 * self.period + spool) / self.period;
        let decay = |pole: f64| fixed(libm::exp(-pole * self.observer_factor / tau), 30);
        vec![
            (id::CASCADE_DEAD_TIME, fixed(tau, 16)),
            (id::CASCADE_FORCE_POLE, fixed(FORCE_POLE / tau, 16)),
            (id::CASCADE_POSITION_POLE, fixed(POSITION_POLE / tau, 16)),
            (id::CASCADE_MOTION_DECAY, decay(MOTION_POLE)),
            (id::CASCADE_FLOW_DECAY, decay(FLOW_POLE)),
            (id::CASCADE_WAY_FLOW, fixed(self.spool.flow() * self.flow_share, 16)),
        ]
    }
}

/// The drives that the law has a model of.
pub(in crate::rig) fn check(rig: &Rig, findings: &mut Findings) {
    use keys::controller::{LAW, LOOP};
    use pneudrive_controller::choice::{Law, Loop};
    if rig.get(&LAW) != Law::Cascade || rig.get(&LOOP) == Loop::Open {
        return;
    }
    let rig = &*rig.nominal();
    let of_kind = match rig.get(&keys::operator::MODEL) {
        OperatorKind::Stepper => of_stepper(rig),
        OperatorKind::Solenoid => [of_coil(rig), of_spring(rig)].concat(),
        _ => [of_coil(rig), of_proportional_valve(rig)].concat(),
    };
    for (_, what) in of_any_drive(rig).iter().chain(&of_kind).filter(|(met, _)| !met) {
        findings.note(&LAW, format!("\"cascade\" needs {what}"));
    }
}

/// Whether something is met, and what it is.
type Need = (bool, String);

fn of_any_drive(rig: &Rig) -> Vec<Need> {
    let needs: [(bool, &str); 5] = [
        (!has_flow_controls(rig), "tubing.flow_control = \"none\": a flow that the valve alone decides"),
        (
            rig.get(&keys::vent::VENTED) == VentedKind::None,
            "actuator.vented = \"none\": it knows the flows of both chambers by the valve",
        ),
        (
            rig.get(&keys::sensors::PRESSURE),
            "sensors.pressure = true: it is a loop of the force, which it knows by the pressures",
        ),
        (
            rig.get(&keys::sensors::PRESSURE_LAG_S) <= 5e-3,
            "sensors.pressure_lag_s of at most 0.005: a force that is known in time",
        ),
        (
            !rig.get(&keys::controller::LEARN_NULL_OFFSET),
            "controller.learn_null_offset = false: it leaves an error that friction holds",
        ),
    ];
    needs.map(|(met, what)| (met, what.to_owned())).into()
}

/// The command of a coil.
fn of_coil(rig: &Rig) -> Vec<Need> {
    let needs: [(bool, &str); 3] = [
        (
            Spool::of(rig).reach > 1e-3 * rig.get(&keys::valve::UNDERLAP_MM),
            "operator.amplifier_gain so large that a command goes beyond valve.underlap_mm: a valve that opens",
        ),
        (
            rig.get(&keys::dither::DITHER_MM) == 0.0,
            "operator.dither_mm = 0: its spool must be where it thinks it is",
        ),
        (
            1e-3 * rig.get(&keys::amplifier::SATURATION_MM) >= spool_travel(rig),
            "operator.saturation_mm of at least valve.spool_travel_mm: a command that opens the valve fully",
        ),
    ];
    needs.map(|(met, what)| (met, what.to_owned())).into()
}

/// A spool that follows its command, and a valve by its conductance at the cylinder.
fn of_proportional_valve(rig: &Rig) -> Vec<Need> {
    let by_conductance = format!("valve.model = \"{}\": a known flow", WITH_CONDUCTANCES.join("\" or \""));
    let needs: [(bool, &str); 6] = [
        (
            rig.get(&keys::operator::MODEL) == OperatorKind::Empirical,
            "operator.model = \"solenoid-empirical\" or \"solenoid\": a spool that follows its command",
        ),
        (rig.get(&keys::valve::UNDERLAP_MM) >= 0.0, "valve.underlap_mm of at least 0: one path at a time"),
        (
            Paths::of(rig, spool_travel(rig)).open.iter().all(|path| path.subsonic_index == 0.5),
            "valve.subsonic_index = 0.5: the ellipse of ISO 6358",
        ),
        (WITH_CONDUCTANCES.contains(&rig.get(&keys::valve::MODEL).word()), &by_conductance),
        (
            rig.get(&keys::lands::CHARACTERISTIC) == Characteristic::Linear,
            "valve.characteristic = \"linear\": a flow in proportion to the spool",
        ),
        (
            rig.get(&keys::tubing::MODEL) == TubingKind::None,
            "tubing.model = \"none\": the valve at the cylinder",
        ),
    ];
    needs.map(|(met, what)| (met, what.to_owned())).into()
}

/// The spool on a spring of the thesis.
fn of_spring(rig: &Rig) -> Vec<Need> {
    let alone = (
        rig.get(&keys::flow_force::FLOW_FORCE) == FlowForceKind::None,
        "valve.flow_force = \"none\": a spool that feels its spring alone".to_owned(),
    );
    [behind_ports_and_tubes(rig, "its spool swings"), vec![alone]].concat()
}

/// The spool of the thesis that a stepper moves.
fn of_stepper(rig: &Rig) -> Vec<Need> {
    let within = (
        Spool::of(rig).reach <= spool_travel(rig),
        "operator.max_steps within valve.spool_travel_mm: steps that open the valve".to_owned(),
    );
    [behind_ports_and_tubes(rig, "it goes a step a sample"), vec![within]].concat()
}

/// The valve of the thesis with its ports and tubes, by an operator that needs a short period.
fn behind_ports_and_tubes(rig: &Rig, why_short: &str) -> Vec<Need> {
    let operator = rig.get(&keys::operator::MODEL).word();
    let [supply, exhaust] =
        [&keys::valve::DISCHARGE_SUPPLY, &keys::valve::DISCHARGE_EXHAUST].map(|key| rig.get(key));
    let short =
        format!("controller.period_s of at most 0.0005 with operator.model = \"{operator}\": {why_short}");
    let by_nodes = format!(
        "valve.model = \"{}\" with operator.model = \"{operator}\": a land and a port in series",
        WITH_NODES_AND_TUBES.join("\" or \"")
    );
    let by_tubes =
        format!("tubing.model = \"empirical\" with operator.model = \"{operator}\": tubes that it knows");
    let needs: [(bool, &str); 6] = [
        (rig.get(&keys::controller::PERIOD_S) <= 5e-4, &short),
        (WITH_NODES_AND_TUBES.contains(&rig.get(&keys::valve::MODEL).word()), &by_nodes),
        (rig.get(&keys::valve::UNDERLAP_MM) == 0.0, "valve.underlap_mm = 0 with lands: one path at a time"),
        (
            supply == exhaust && rig.get(&keys::discharge::DISCHARGE_MODEL) == DischargeKind::Constant,
            "valve.discharge_model = \"constant\" and valve.discharge_exhaust as valve.discharge_supply: a known flow",
        ),
        (rig.get(&keys::tubing::MODEL) == TubingKind::Empirical, &by_tubes),
        (rig.get(&keys::tubing::LAG_S) == 0.0, "tubing.lag_s = 0: flows that follow the pressures at once"),
    ];
    needs.map(|(met, what)| (met, what.to_owned())).into()
}
