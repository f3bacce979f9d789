//! The plant as a controller sees it: a command in, a sample out.
//!
//! One [`Plant::advance`] serves the simulator, the virtual rig and the emulated board alike, so that
//! all of them see the same samples in every bit. Time is whole microseconds; samples are read off
//! the dense output of the integrator and cost no step.

use pneudrive_controller::{Command, Config, Sample};

use crate::actuator::{Actuator, Air};
use crate::assembly::{Assembly, Effects, FLOW_GUARDS, GUARDS, Lag, Parts, SCALE, STATES, StateVector, slot};
use crate::continuous::ContinuousLaw;
use crate::dither::Dither;
use crate::flow_force::{DEFAULT_INLET, DEFAULT_OUTLET, FlowForce};
use crate::flow_law::FlowLaw;
use crate::friction::DryFriction;
use crate::gas::Gas;
use crate::integrator::{IntegrationError, Integrator, Method, Work};
use crate::iso6358::Iso6358;
use crate::leakage::Leakage;
use crate::load::Load;
use crate::network::{Laws, Network, NetworkWork, Station};
use crate::operator::empirical::{Empirical, EmpiricalParameters};
use crate::operator::on_off::OnOff;
use crate::operator::solenoid::{Solenoid, SolenoidParameters};
use crate::operator::stepper::Stepper;
use crate::operator::{Operator, Request};
use crate::rig::Rig;
use crate::sensors::Sensors;
use crate::stop::Stops;
use crate::tubing::Tube;
use crate::valve::Valve;

/// How exactly a plant is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// The method.
    pub method: Method,
    /// Allowed error of a step, relative to what counts as large in each state.
    pub tolerance: f64,
}

impl Default for Accuracy {
    /// Repeats the reference transients to a tenth of their tolerances, over the whole run.
    fn default() -> Self {
        Accuracy { method: Method::DormandPrince, tolerance: 1e-11 }
    }
}

/// A simulated rig without its controller.
#[derive(Clone, Debug)]
pub struct Plant {
    assembly: Assembly,
    integrator: Integrator<STATES, GUARDS, FLOW_GUARDS>,
    sensors: Sensors,
    period_us: u64,
    delay_us: u64,
    /// Request in force.
    request: Request,
    /// Request that takes effect at the output of the present sample, until it has.
    due: Option<Request>,
    /// Whether the command changed at the last output: then it will at the next one, as a rule, and
    /// a step beyond that would be wasted.
    restless: bool,
    /// Number of the sample taken last.
    k: u64,
}

/// What can be measured at one instant, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// Position, m.
    pub position: f64,
    /// Velocity, m/s.
    pub velocity: f64,
    /// Acceleration, m/s^2.
    pub acceleration: f64,
    /// Absolute chamber pressures, Pa.
    pub pressures: [f64; 2],
    /// Chamber temperatures, K.
    pub temperatures: [f64; 2],
    /// Spool position, m.
    pub spool: f64,
    /// Spool position that the command in force asks for, m.
    pub spool_command: f64,
    /// Mass flows into the chambers, kg/s.
    pub mass_flows: [f64; 2],
    /// Force of the cylinder, N.
    pub actuator_force: f64,
    /// Dry friction, N, positive against extension.
    pub friction: f64,
}

/// What a run has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlantWork {
    /// The integrator's part.
    pub integrator: Work,
    /// The network's part.
    pub network: NetworkWork,
}

/// The instant of a whole number of microseconds, s: rounded once.
pub(crate) fn seconds(microseconds: u64) -> f64 {
    microseconds as f64 / 1e6
}

impl Plant {
    /// The plant of a rig in the initial state of its test, at t = 0. `seed` is for sensor noise.
    #[must_use]
    pub fn new(rig: &Rig, accuracy: Accuracy, seed: u64) -> Plant {
        let gas = gas(rig);
        let actuator = actuator(rig);
        let x = initial_state(rig, &gas, &actuator);
        let parts = Parts {
            gas,
            valve: valve(rig),
            actuator,
            load: load(rig),
            operator: operator(rig),
            network: network(rig, gas),
            flow_force: flow_force(rig),
            lag: lag(rig, &gas),
            continuous: continuous(rig),
        };
        let assembly = Assembly::new(parts, &x);
        Plant {
            assembly,
            integrator: Integrator::new(accuracy.method, accuracy.tolerance, SCALE, x),
            sensors: Sensors::new(rig, seed),
            period_us: u64::from(rig.period_us().get()),
            delay_us: rig.microseconds("controller.delay_s"),
            request: Request::default(),
            due: None,
            restless: false,
            k: 0,
        }
    }

    /// The same plant sampled at another period, and driven after another delay (microseconds).
    #[must_use]
    pub fn with_timing(mut self, period_us: u64, delay_us: u64) -> Plant {
        (self.period_us, self.delay_us) = (period_us, delay_us);
        self
    }

    /// The sensors at the present sample instant.
    pub fn sample(&mut self) -> Sample {
        let t = self.sample_time_of(self.k);
        let x = self.integrator.state(t);
        let pressures = slot::EXNER.map(|i| self.assembly.parts.gas.pressure(x[i]));
        self.sensors.read(x[slot::POSITION], pressures, self.assembly.spool(t, &x))
    }

    /// From sample k to sample k + 1, with `command` in force from the output in between.
    ///
    /// # Errors
    /// When the integration cannot go on.
    pub fn advance(&mut self, command: Command) -> Result<Sample, IntegrationError> {
        self.command(command);
        self.next_sample()?;
        Ok(self.sample())
    }

    /// Has `command` take effect at the output of the present sample.
    pub fn command(&mut self, command: Command) {
        self.due = Some(Request { counts: command.counts, step: command.step });
    }

    /// The target of a continuous controller changes at the present sample, in counts.
    pub fn set_target(&mut self, target: i32) {
        let at = self.sample_time_of(self.k);
        let assembly = &mut self.assembly;
        self.integrator.cut(at, |x| assembly.set_target(x, target));
    }

    /// The command of a continuous controller at the present sample, counts.
    pub fn continuous_command(&mut self) -> Option<f64> {
        let x = self.integrator.state(self.sample_time_of(self.k));
        self.assembly.follow(&x)
    }

    /// To sample k + 1.
    ///
    /// # Errors
    /// When the integration cannot go on.
    pub fn next_sample(&mut self) -> Result<(), IntegrationError> {
        self.run_to(self.sample_time_of(self.k + 1))?;
        self.k += 1;
        Ok(())
    }

    /// What can be measured at `t`, from the present sample on to the next. Looking changes nothing:
    /// the steps are the same without it.
    ///
    /// # Errors
    /// When the integration cannot go on.
    pub fn look(&mut self, t: f64) -> Result<Snapshot, IntegrationError> {
        self.run_to(t)?;
        Ok(self.snapshot(t))
    }

    /// To `t`, by way of the present sample's output if that is due. How far a step may reach beyond
    /// depends on the outputs alone, not on where the caller stops.
    fn run_to(&mut self, t: f64) -> Result<(), IntegrationError> {
        let output = self.output_time_of(self.k);
        if let Some(request) = self.due {
            let changes = self.changes(request);
            let horizon = if changes { output } else { f64::INFINITY };
            self.integrator.run_to(&mut self.assembly, t.min(output), horizon)?;
            if t < output {
                return Ok(());
            }
            self.drive(output, request);
        }
        let horizon = if self.restless { self.output_time_of(self.k + 1) } else { f64::INFINITY };
        self.integrator.run_to(&mut self.assembly, t, horizon)
    }

    fn changes(&self, request: Request) -> bool {
        request.counts != self.request.counts || request.step != 0
    }

    fn drive(&mut self, at: f64, request: Request) {
        self.due = None;
        self.restless = self.changes(request);
        if self.restless {
            self.request = request;
            let assembly = &mut self.assembly;
            self.integrator.cut(at, |x| assembly.drive(at, x, request));
        }
    }

    fn snapshot(&mut self, t: f64) -> Snapshot {
        let x = self.integrator.state(t);
        self.assembly.follow(&x);
        let Effects { air, nodes, actuator_force, friction_force, acceleration } =
            self.assembly.effects(t, &x);
        Snapshot {
            position: x[slot::POSITION],
            velocity: x[slot::VELOCITY],
            acceleration,
            pressures: air.map(|air| air.pressure),
            temperatures: air.map(|air| air.temperature),
            spool: self.assembly.spool(t, &x),
            spool_command: self.assembly.parts.operator.commanded(),
            mass_flows: nodes.map(|node| node.port_flow()),
            actuator_force,
            friction: friction_force,
        }
    }

    fn sample_time_of(&self, k: u64) -> f64 {
        seconds(k * self.period_us)
    }

    fn output_time_of(&self, k: u64) -> f64 {
        seconds(k * self.period_us + self.delay_us)
    }

    /// What the run has cost so far.
    #[must_use]
    pub fn work(&self) -> PlantWork {
        PlantWork { integrator: self.integrator.work, network: self.assembly.parts.network.work }
    }
}

/// P_1 at which the load of a rig is in equilibrium at the start of its test, Pa.
pub(crate) fn equilibrium_pressure_1(rig: &Rig) -> f64 {
    let standing = load(rig).standing_force(rig.number("test.position_m"));
    actuator(rig).balancing_pressure_1(rig.number("test.pressure_2_pa"), -standing)
}

fn gas(rig: &Rig) -> Gas {
    Gas::new(rig.number("gas.heat_capacity_ratio"), rig.number("gas.gas_constant_j_per_kg_k"))
}

fn valve(rig: &Rig) -> Valve {
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

fn flow_force(rig: &Rig) -> FlowForce {
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
    let config = Config::new(&rig.parameters()).expect("a checked rig has a consistent controller");
    let pulse = rig.number("encoder.mm_per_count") * 1e-3;
    (rig.word("controller.model") == "continuous").then(|| ContinuousLaw::new(&config, pulse))
}

fn lag(rig: &Rig, gas: &Gas) -> Option<Lag> {
    let time = rig.number("tubing.lag_s");
    let (supply_tube, cylinder_tube) = tubes(rig, gas);
    (time > 0.0).then_some(Lag { time, supply: station(rig, gas, "supply"), supply_tube, cylinder_tube })
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
fn tubes(rig: &Rig, gas: &Gas) -> (Tube, Tube) {
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

fn network(rig: &Rig, gas: Gas) -> Network {
    // Lagged tubes are states of the assembly, not part of the network.
    let (supply_tube, cylinder_tube) = match lag(rig, &gas) {
        Some(_) => (Tube::none(), Tube::none()),
        None => tubes(rig, &gas),
    };
    let port_area = rig.switch("valve.upstream_mach").then(|| valve(rig).port_area());
    let law = land_law(rig);
    let laws = Laws { land: law, port: law };
    Network::new(
        gas,
        station(rig, &gas, "supply"),
        station(rig, &gas, "exhaust"),
        supply_tube,
        cylinder_tube,
        laws,
        port_area,
    )
}

fn actuator(rig: &Rig) -> Actuator {
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
    }
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
        incline: rig.number("load.incline_deg").to_radians(),
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
    match rig.word("operator.model") {
        "solenoid-empirical" => Operator::Empirical(empirical(rig)),
        "stepper" => Operator::Stepper(Stepper::new(rig.number("operator.mm_per_step") * 1e-3)),
        "on-off" => Operator::OnOff(OnOff::new(spool_travel(rig), rig.number("operator.switch_time_s"))),
        _ => Operator::Solenoid(solenoid(rig)),
    }
}

/// X_max, m.
fn spool_travel(rig: &Rig) -> f64 {
    rig.number("valve.spool_travel_mm") * 1e-3
}

/// Half of the hysteresis loop, m: the loop is `hysteresis_percent` of the 2 mm range wide.
fn hysteresis_half_width(rig: &Rig) -> f64 {
    rig.number("operator.hysteresis_percent") / 100.0 * 1e-3
}

fn dither(rig: &Rig) -> Dither {
    Dither {
        amplitude: rig.number("operator.dither_mm") * 1e-3,
        frequency_hz: rig.number("operator.dither_hz"),
        phase_cycles: rig.number("operator.dither_phase_deg") / 360.0,
    }
}

fn empirical(rig: &Rig) -> Empirical {
    Empirical::new(EmpiricalParameters {
        travel_per_count: spool_travel(rig) / 2048.0,
        amplifier_gain: rig.number("operator.amplifier_gain"),
        saturation: rig.number("operator.saturation_mm") * 1e-3,
        stiffness_per_mass: rig.number("operator.stiffness_per_mass_per_s2"),
        damping_per_mass: rig.number("operator.damping_per_s"),
        hysteresis_half_width: hysteresis_half_width(rig),
        dither: dither(rig),
        travel: spool_travel(rig),
    })
}

fn solenoid(rig: &Rig) -> Solenoid {
    let spool_mass = rig.number("operator.spool_mass_kg");
    Solenoid::new(SolenoidParameters {
        travel_per_count: spool_travel(rig) / 2048.0,
        amplifier_gain: rig.number("operator.amplifier_gain"),
        saturation: rig.number("operator.saturation_mm") * 1e-3,
        hysteresis_half_width: hysteresis_half_width(rig),
        dither: dither(rig),
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
    })
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
    }
    x
}
