//! From a rig to its components: every key of the plant, in SI, into the part that it belongs to.

use pneudrive_controller::Config;

use crate::assembly::{Lag, Parts, STATES, StateVector, slot};
use crate::component::actuator::Actuator;
use crate::component::actuator::leakage::Leakage;
use crate::component::actuator::walls::Walls;
use crate::component::air::{Air, Station};
use crate::component::dither::Dither;
use crate::component::faults::Schedule;
use crate::component::friction::DryFriction;
use crate::component::gas::Gas;
use crate::component::load::Load;
use crate::component::operator::Operator;
use crate::component::operator::empirical::{Empirical, EmpiricalParameters};
use crate::component::operator::on_off::OnOff;
use crate::component::operator::solenoid::{Solenoid, SolenoidParameters};
use crate::component::operator::stepper::Stepper;
use crate::component::stop::Stops;
use crate::component::tubing::Tube;
use crate::component::valve::Valve;
use crate::component::valve::flow_force::{DEFAULT_INLET, DEFAULT_OUTLET, FlowForce};
use crate::component::valve::flow_law::FlowLaw;
use crate::component::valve::iso6358::Iso6358;
use crate::continuous::ContinuousLaw;
use crate::network::{Laws, Network, Vessels};
use crate::rig::Rig;

/// The components of a rig, and the state in which its test begins.
pub(crate) fn drive(rig: &Rig) -> (Parts, StateVector) {
    let gas = gas(rig);
    let actuator = actuator(rig);
    let x = initial_state(rig, &gas, &actuator);
    let parts = Parts {
        gas,
        valve: valve(rig),
        actuator,
        load: load(rig),
        operator: operator(rig),
        supply_pressure: rig.number("supply.pressure_pa"),
        network: network(rig, gas),
        flow_force: flow_force(rig),
        lag: lag(rig, &gas),
        sensor_lag: Some(rig.number("sensors.pressure_lag_s")).filter(|lag| *lag > 0.0),
        continuous: continuous(rig),
        faults: Schedule::new(&rig.fault_events()),
    };
    (parts, x)
}

/// P_1 at which the load of a rig is in equilibrium at the start of its test, Pa.
pub(crate) fn equilibrium_pressure_1(rig: &Rig) -> f64 {
    let standing = load(rig).standing_force(rig.number("test.position_m"));
    actuator(rig).balancing_pressure_1(rig.number("test.pressure_2_pa"), -standing)
}

/// Whether the speed of the air in front of a restriction counts: where there are flow nodes. Lands alone have the
/// conventional flows of 6.39 to 6.46, without Mach numbers.
pub(crate) fn speed_counts(rig: &Rig) -> bool {
    rig.switch("valve.upstream_mach") && valve(rig).has_node
}

/// Whether the speed in the ports gives more pressure back behind a wide land than the tube from the
/// supply loses on the way: then the flow has no steady value near the supply's pressure.
///
/// A land of area A gives back 1 - (A_p / (C_d A))^2 of the dynamic pressure R T m^2 / (2 A_p^2 P). Told
/// by the slopes over the flow where the lands' clearance alone is fed. A supply without a tube is at
/// rest.
pub(crate) fn speed_outweighs_supply_tube(rig: &Rig) -> bool {
    let valve = valve(rig);
    let width = valve.discharge_supply * valve.edge_area(valve.travel - valve.lap) / valve.port_area();
    width > 1.0 && (1.0 - 1.0 / (width * width)) * speed_recovery(rig, &gas(rig), &valve) > 1.0
}

/// Pressure that the speed in a port gives back behind an infinitely wide land over what the tube from the supply
/// loses, both as slopes over the flow, where the lands' clearance alone is fed. 0 where no speed counts.
fn speed_recovery(rig: &Rig, gas: &Gas, valve: &Valve) -> f64 {
    let (tube, supply) = (tubes(rig, gas).0, station(rig, gas, "supply"));
    if !speed_counts(rig) || tube.is_none() {
        return 0.0;
    }
    let pressure = gas.pressure(supply.exner);
    let choked = gas.flow_constant() / supply.temperature * gas.flow_function(supply.exner, 0.0).value;
    let leak = (valve.discharge_supply * valve.edge_area(-1.0)).max(1e-3 * valve.port_area());
    let flow = leak * choked.sqrt();
    let far = tube.far_end(&supply, flow);
    let lost = -far.by_flow / (gas.exner_exponent() * far.exner);
    let density_of_flow = gas.gas_constant * supply.temperature / (valve.port_area() * pressure).powi(2);
    density_of_flow * flow / lost
}

/// The larger part of its dead volume that a piston takes up as it rests on its stop under the highest
/// pressure, for chambers 1 and 2.
pub(crate) fn dead_volume_taken_up(rig: &Rig) -> [f64; 2] {
    let (actuator, load) = (actuator(rig), load(rig));
    let test =
        ["test.pressure_1_pa", "test.pressure_2_pa"].map(|key| rig.optional_number(key).unwrap_or(0.0));
    let highest = test.into_iter().fold(rig.number("supply.pressure_pa"), f64::max);
    let standing = [0.0, actuator.stroke].map(|end| load.standing_force(end));
    let outside = actuator.ambient_pressure * actuator.rod_area;
    let pushes = [
        highest * actuator.area_2 + outside - standing[0],
        highest * actuator.area_1 + standing[1] - outside,
    ];
    let areas = [actuator.area_1, actuator.area_2];
    std::array::from_fn(|i| {
        areas[i] * pushes[i].max(0.0) / load.stops.stiffness / actuator.residual_volumes[i]
    })
}

pub(crate) fn gas(rig: &Rig) -> Gas {
    Gas::new(rig.number("gas.heat_capacity_ratio"), rig.number("gas.gas_constant_j_per_kg_k"))
}

pub(crate) fn valve(rig: &Rig) -> Valve {
    let metres = |path: &str| rig.number(path) * 1e-3;
    Valve {
        null_offset: metres("valve.null_offset_mm"),
        lap: metres("valve.underlap_mm"),
        sleeve_diameter: metres("valve.sleeve_diameter_mm"),
        spool_diameter: metres("valve.spool_diameter_mm"),
        port_diameter: metres("valve.port_diameter_mm"),
        has_node: matches!(rig.word("valve.model"), "flow-node" | "multiple-flow-node"),
        land_law: land_law(rig),
        travel: spool_travel(rig),
        rod_diameter: metres("valve.spool_rod_diameter_mm"),
        discharge_supply: rig.number("valve.discharge_supply"),
        discharge_exhaust: rig.number("valve.discharge_exhaust"),
    }
}

fn land_law(rig: &Rig) -> FlowLaw {
    let number = |path: &str| rig.optional_number(path).unwrap_or(0.0);
    match (rig.word("valve.model"), rig.word("valve.discharge_model")) {
        ("iso-6358", _) => FlowLaw::Iso6358(Iso6358 {
            sonic_conductance: number("valve.sonic_conductance_m3_per_s_pa"),
            critical_ratio: number("valve.critical_ratio"),
        }),
        (_, "perry") => FlowLaw::Perry,
        _ => FlowLaw::Orifice,
    }
}

pub(crate) fn flow_force(rig: &Rig) -> FlowForce {
    match rig.word("valve.flow_force") {
        "analytical" => FlowForce::Analytical,
        "experimental" => FlowForce::Experimental {
            inlet: rig.polynomial("valve.flow_force_inlet").unwrap_or(DEFAULT_INLET),
            outlet: rig.polynomial("valve.flow_force_outlet").unwrap_or(DEFAULT_OUTLET),
        },
        _ => FlowForce::None,
    }
}

fn continuous(rig: &Rig) -> Option<ContinuousLaw> {
    let pulse = rig.number("encoder.mm_per_count") * 1e-3;
    (rig.word("controller.model") == "continuous").then(|| {
        let config = Config::new(&rig.parameters()).expect("a checked rig has a consistent controller");
        ContinuousLaw::new(&config, pulse)
    })
}

fn lag(rig: &Rig, gas: &Gas) -> Option<Lag> {
    let time = rig.number("tubing.lag_s");
    let (supply_tube, cylinder_tube) = tubes(rig, gas);
    (time > 0.0).then(|| {
        let recovery = speed_recovery(rig, gas, &valve(rig));
        Lag { time, supply: station(rig, gas, "supply"), supply_tube, cylinder_tube, recovery }
    })
}

/// Supply or exhaust.
fn station(rig: &Rig, gas: &Gas, table: &str) -> Station {
    Station {
        exner: gas.exner(rig.number(&format!("{table}.pressure_pa"))),
        temperature: rig.number(&format!("{table}.temperature_k")),
    }
}

/// The tube from the supply, and those to the cylinder. With the multiple flow node a restriction at
/// the cylinder stands for the tube (6.55 to 6.60), and the supply has none.
pub(crate) fn tubes(rig: &Rig, gas: &Gas) -> (Tube, Tube) {
    if rig.word("valve.model") == "multiple-flow-node" {
        let bore = rig.number("tubing.diameter_mm") * 1e-3;
        return (Tube::none(), Tube::connector(gas, rig.number("valve.discharge_supply"), bore));
    }
    let tube = match rig.word("tubing.model") {
        "none" => Tube::none(),
        "analytical" => Tube::analytical(
            gas,
            rig.number("tubing.length_m"),
            rig.number("tubing.diameter_mm") * 1e-3,
            rig.number("tubing.friction_factor"),
        ),
        _ => Tube::empirical(gas, rig.number("tubing.drop_slope"), rig.number("tubing.reference_flow_kg_s")),
    };
    (tube, tube)
}

pub(crate) fn network(rig: &Rig, gas: Gas) -> Network {
    // Lagged tubes are states of the assembly, not part of the network.
    let (supply_tube, cylinder_tube) = match lag(rig, &gas) {
        Some(_) => (Tube::none(), Tube::none()),
        None => tubes(rig, &gas),
    };
    let port_area = speed_counts(rig).then(|| valve(rig).port_area());
    let law = land_law(rig);
    let laws = Laws { land: law, port: law };
    let network = Network::new(
        gas,
        station(rig, &gas, "supply"),
        station(rig, &gas, "exhaust"),
        supply_tube,
        cylinder_tube,
        laws,
        port_area,
    );
    network.beside(vessels(rig, &gas))
}

/// Which ends no tube joins to the valve. A lagged tube is one.
fn vessels(rig: &Rig, gas: &Gas) -> Vessels {
    let (supply, cylinder) = tubes(rig, gas);
    Vessels { supply: supply.is_none(), chambers: cylinder.is_none() }
}

/// The valve's lands and ports between gauges right at them: another pressure (Pa) at the supply port, no
/// tubes, and `port_area` (m^2) where air approaches at its own speed.
pub(crate) fn network_without_tubes(rig: &Rig, gas: Gas, supply_pa: f64, port_area: Option<f64>) -> Network {
    let law = land_law(rig);
    let supply = Station { exner: gas.exner(supply_pa), ..station(rig, &gas, "supply") };
    let laws = Laws { land: law, port: law };
    Network::new(gas, supply, station(rig, &gas, "exhaust"), Tube::none(), Tube::none(), laws, port_area)
}

/// The cylinder of a rig.
#[must_use]
pub fn actuator(rig: &Rig) -> Actuator {
    let rod_diameter = rig.number("actuator.rod_diameter_m");
    let [blind, rod_side, rod] = Actuator::areas(rig.number("actuator.bore_m"), rod_diameter);
    let symmetric = rig.word("actuator.model") == "symmetric";
    Actuator {
        stroke: rig.number("actuator.stroke_m"),
        area_1: if symmetric { rod_side } else { blind },
        area_2: rod_side,
        rod_area: if symmetric { 0.0 } else { rod },
        residual_volumes: [
            rig.number("actuator.residual_volume_1_m3"),
            rig.number("actuator.residual_volume_2_m3"),
        ],
        ambient_pressure: rig.number("exhaust.pressure_pa"),
        leakage: leakage(rig),
        walls: walls(rig, [if symmetric { rod_side } else { blind }, rod_side], symmetric),
    }
}

fn walls(rig: &Rig, areas: [f64; 2], symmetric: bool) -> Option<Walls> {
    let coefficient = rig.number("actuator.heat_transfer_w_per_m2_k");
    let rod = rig.number("actuator.rod_diameter_m");
    let rods = [if symmetric { rod } else { 0.0 }, rod];
    let [temperature, bore] = ["actuator.wall_temperature_k", "actuator.bore_m"].map(|key| rig.number(key));
    (coefficient > 0.0).then(|| Walls::new(coefficient, temperature, areas, bore, rods))
}

fn leakage(rig: &Rig) -> Leakage {
    match rig.word("actuator.leakage") {
        "laminar" => Leakage::Laminar { coefficient: rig.number("actuator.leakage_coefficient") },
        "adiabatic" => Leakage::Adiabatic {
            resistance: rig.number("actuator.passage_resistance"),
            clearance: rig.number("actuator.passage_clearance_m"),
            bore: rig.number("actuator.bore_m"),
        },
        _ => Leakage::None,
    }
}

fn load(rig: &Rig) -> Load {
    let mass = rig.number("load.mass_kg");
    Load {
        mass,
        viscous: rig.number("load.viscous_n_s_per_m"),
        constant_force: rig.number("load.constant_force_n"),
        spring: rig.number("load.spring_n_per_m"),
        uphill: libm::sin(rig.number("load.incline_deg").to_radians()),
        friction: DryFriction {
            static_extend: rig.number("load.static_extend_n"),
            coulomb_extend: rig.number("load.coulomb_extend_n"),
            static_retract: rig.number("load.static_retract_n"),
            coulomb_retract: rig.number("load.coulomb_retract_n"),
        },
        stops: Stops::new(
            0.0,
            rig.number("actuator.stroke_m"),
            rig.number("load.stop_stiffness_n_per_m"),
            rig.number("load.stop_region_m"),
            rig.number("load.stop_damping_ratio"),
            mass,
        ),
    }
}

fn operator(rig: &Rig) -> Operator {
    match (rig.word("operator.model"), rig.word("controller.model")) {
        ("solenoid", "continuous") => {
            Operator::Solenoid(Solenoid::with_moving_command(solenoid_parameters(rig, dither(rig))))
        }
        _ => stepped_operator(rig, dither(rig)),
    }
}

/// The operator of a rig for commands that come in steps, under a dither.
pub(crate) fn stepped_operator(rig: &Rig, dither: Dither) -> Operator {
    match rig.word("operator.model") {
        "solenoid-empirical" => Operator::Empirical(empirical(rig, dither)),
        "stepper" => Operator::Stepper(Stepper::new(rig.number("operator.mm_per_step") * 1e-3)),
        "on-off" => Operator::OnOff(OnOff::new(spool_travel(rig), rig.number("operator.switch_time_s"))),
        _ => Operator::Solenoid(Solenoid::new(solenoid_parameters(rig, dither))),
    }
}

/// X_max, m.
fn spool_travel(rig: &Rig) -> f64 {
    rig.number("valve.spool_travel_mm") * 1e-3
}

/// Half of the hysteresis loop, m: the loop is `hysteresis_percent` of the spool's range wide, from end to end.
fn hysteresis_half_width(rig: &Rig) -> f64 {
    rig.number("operator.hysteresis_percent") / 100.0 * spool_travel(rig)
}

pub(crate) fn dither(rig: &Rig) -> Dither {
    Dither {
        amplitude: rig.number("operator.dither_mm") * 1e-3,
        frequency_hz: rig.number("operator.dither_hz"),
        phase_cycles: rig.number("operator.dither_phase_deg") / 360.0,
    }
}

fn empirical(rig: &Rig, dither: Dither) -> Empirical {
    Empirical::new(EmpiricalParameters {
        travel_per_count: spool_travel(rig) / 2048.0,
        amplifier_gain: rig.number("operator.amplifier_gain"),
        saturation: rig.number("operator.saturation_mm") * 1e-3,
        stiffness_per_mass: rig.number("operator.stiffness_per_mass_per_s2"),
        damping_per_mass: rig.number("operator.damping_per_s"),
        hysteresis_half_width: hysteresis_half_width(rig),
        dither,
        travel: spool_travel(rig),
    })
}

fn solenoid_parameters(rig: &Rig, dither: Dither) -> SolenoidParameters {
    let spool_mass = rig.number("operator.spool_mass_kg");
    SolenoidParameters {
        travel_per_count: spool_travel(rig) / 2048.0,
        amplifier_gain: rig.number("operator.amplifier_gain"),
        saturation: rig.number("operator.saturation_mm") * 1e-3,
        hysteresis_half_width: hysteresis_half_width(rig),
        dither,
        force_gain: rig.number("operator.force_gain_n_per_mm") * 1e3,
        spring: rig.number("operator.spring_n_per_mm") * 1e3,
        spring_preload: rig.number("operator.spring_preload_n"),
        damping: rig.number("operator.damping_n_s_per_m"),
        spool_mass,
        friction: DryFriction::symmetric(
            rig.number("operator.static_friction_n"),
            rig.number("operator.coulomb_friction_n"),
        ),
        stops: Stops::new(
            -spool_travel(rig),
            spool_travel(rig),
            rig.number("operator.stop_stiffness_n_per_m"),
            rig.number("operator.stop_region_m"),
            rig.number("operator.stop_damping_ratio"),
            spool_mass,
        ),
        feels_flow: rig.word("valve.flow_force") != "none",
    }
}

fn initial_state(rig: &Rig, gas: &Gas, actuator: &Actuator) -> StateVector {
    let position = rig.number("test.position_m");
    let pressure_1 = rig.optional_number("test.pressure_1_pa").unwrap_or_else(|| equilibrium_pressure_1(rig));
    let pressures = [pressure_1, rig.number("test.pressure_2_pa")];
    let temperatures = [rig.number("test.temperature_1_k"), rig.number("test.temperature_2_k")];
    let volumes = actuator.volumes(position, 0.0);
    let mut x = [0.0; STATES];
    x[slot::POSITION] = position;
    for ratio in slot::RATIO {
        x[ratio] = 1.0;
    }
    for i in 0..2 {
        let [mass, exner] = Air::state_of(gas, pressures[i], temperatures[i], volumes[i].volume);
        x[slot::MASS[i]] = mass;
        x[slot::EXNER[i]] = exner;
        if rig.number("sensors.pressure_lag_s") > 0.0 {
            x[slot::SENSED[i]] = pressures[i];
        }
    }
    x
}
