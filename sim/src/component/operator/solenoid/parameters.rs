//! The parameters of a solenoid, and its keys.

use crate::component::dither::Dither;
use crate::component::friction::DryFriction;
use crate::component::operator::{self, OperatorKind, amplifier, hysteresis, within_range};
use crate::component::play::Play;
use crate::component::stop::Stops;
use crate::component::valve::flow_force::FlowForce;
use crate::component::valve::spool_travel;
use crate::key::keys;
use crate::values::{Findings, Rig};

keys! {
    FORCE_GAIN_N_PER_MM: f64 = number("operator.force_gain_n_per_mm", 25.0, 1e-3, 1e5, "C(81)", "Force of the coil per mm of command.").of(&["solenoid"]).spread();
    SPRING_N_PER_MM: f64 = number("operator.spring_n_per_mm", 25.0, 1e-3, 1e5, "C(82)", "Stiffness of the spool's spring.").of(&["solenoid"]).spread();
    SPRING_PRELOAD_N: f64 = number("operator.spring_preload_n", 25.0, 0.0, 1e5, "C(83)", "Compression of the spring at mid-travel, which the mid-range of the coil balances.").of(&["solenoid"]);
    STATIC_FRICTION_N: f64 = number("operator.static_friction_n", 3.0, 0.0, 1e4, "C(84)", "Stiction of the spool.").of(&["solenoid"]).spread().vague();
    COULOMB_FRICTION_N: f64 = number("operator.coulomb_friction_n", 2.0, 0.0, 1e4, "C(85)", "Coulomb friction of the spool.").of(&["solenoid"]).spread().vague();
    SPOOL_MASS_KG: f64 = number("operator.spool_mass_kg", 0.023, 1e-5, 100.0, "C(86)", "Mass of the spool with the core.").of(&["solenoid"]).spread();
    DAMPING_N_S_PER_M: f64 = number("operator.damping_n_s_per_m", 2.3, 0.0, 1e5, "", "Viscous damping of the spool; not in the thesis, C(51) times C(86).").of(&["solenoid"]).spread();
    STOP_STIFFNESS_N_PER_M: f64 = number("operator.stop_stiffness_n_per_m", 100_000.0, 1.0, 1e10, "C(91)", "Stiffness of the spool's stops.").of(&["solenoid"]);
    STOP_REGION_M: f64 = number("operator.stop_region_m", 5e-5, 1e-9, 0.1, "", "Penetration at which the stops' damping is full.").of(&["solenoid"]);
    STOP_DAMPING_RATIO: f64 = number("operator.stop_damping_ratio", 0.5, 0.0, 10.0, "", "Damping ratio of the stops.").of(&["solenoid"]);
}

impl SolenoidParameters {
    /// The parameters of a rig, under a dither.
    pub(in crate::component::operator) fn of(rig: &Rig, dither: Dither) -> SolenoidParameters {
        let (spool_mass, travel) = (rig.get(&keys::SPOOL_MASS_KG), spool_travel(rig));
        SolenoidParameters {
            travel_per_count: travel / 2048.0,
            amplifier_gain: rig.get(&amplifier::keys::AMPLIFIER_GAIN),
            saturation: rig.get(&amplifier::keys::SATURATION_MM) * 1e-3,
            play: hysteresis::at_start(rig),
            dither,
            force_gain: rig.get(&keys::FORCE_GAIN_N_PER_MM) * 1e3,
            spring: rig.get(&keys::SPRING_N_PER_MM) * 1e3,
            spring_preload: rig.get(&keys::SPRING_PRELOAD_N),
            damping: rig.get(&keys::DAMPING_N_S_PER_M),
            spool_mass,
            friction: DryFriction::symmetric(
                rig.get(&keys::STATIC_FRICTION_N),
                rig.get(&keys::COULOMB_FRICTION_N),
            ),
            stops: Stops::new(
                -travel,
                travel,
                rig.get(&keys::STOP_STIFFNESS_N_PER_M),
                rig.get(&keys::STOP_REGION_M),
                rig.get(&keys::STOP_DAMPING_RATIO),
                spool_mass,
            ),
            feels_flow: FlowForce::of(rig) != FlowForce::None,
        }
    }
}

/// The constraints on the spool's friction, and on its stops: a coil that presses the spool through them has no valve.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    let why = "a body that slips must not be held more than one that sticks";
    findings.not_above(rig, &keys::COULOMB_FRICTION_N, &keys::STATIC_FRICTION_N, why);
    if rig.get(&operator::keys::MODEL) != OperatorKind::Solenoid {
        return;
    }
    let travel_mm = 1e3 * spool_travel(rig);
    let asked_mm = rig.get(&amplifier::keys::AMPLIFIER_GAIN) * travel_mm;
    let force = rig.get(&keys::FORCE_GAIN_N_PER_MM) * asked_mm.min(rig.get(&amplifier::keys::SATURATION_MM));
    let into_stop_mm = 1e3 * force / rig.get(&keys::STOP_STIFFNESS_N_PER_M);
    if into_stop_mm > travel_mm {
        let message = format!(
            "the coil presses the spool {into_stop_mm:.3} mm into its stop, more than its travel of {travel_mm} mm: give a stiffer stop, or a smaller operator.force_gain_n_per_mm"
        );
        findings.note(&keys::STOP_STIFFNESS_N_PER_M, message);
    }
}

/// The parameters of a solenoid, SI.
#[derive(Clone, Copy, Debug)]
pub struct SolenoidParameters {
    /// Spool travel of one command count, m.
    pub travel_per_count: f64,
    /// C(37).
    pub amplifier_gain: f64,
    /// C(38), m.
    pub saturation: f64,
    /// The hysteresis at the start, m.
    pub(crate) play: Play,
    /// Dither of the amplifier, m of spool travel.
    pub dither: Dither,
    /// G_s, N/m.
    pub force_gain: f64,
    /// K_sp, N/m.
    pub spring: f64,
    /// F_i, N.
    pub spring_preload: f64,
    /// K_d, N s/m.
    pub damping: f64,
    /// M_s, kg.
    pub spool_mass: f64,
    /// Stiction and Coulomb friction of the spool.
    pub friction: DryFriction,
    /// The ends of the spool's travel.
    pub stops: Stops,
    /// Whether a flow force acts on it.
    pub feels_flow: bool,
}

impl SolenoidParameters {
    /// The most that the amplifier passes on of a command in the range of the converter, m.
    pub fn limit(&self) -> f64 {
        (self.amplifier_gain * self.travel_per_count * within_range(f64::INFINITY)).min(self.saturation)
    }
}
