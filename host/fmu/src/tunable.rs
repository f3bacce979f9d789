//! The keys that may change while an FMU runs.

use pneudrive_sim::key::Typed;
use pneudrive_sim::keys;
use pneudrive_sim::rig::Key;

/// Keys of the plant that may change while it runs.
pub(crate) const OF_RUNNING_PLANT: [&Typed<f64>; 9] = [
    &keys::supply::PRESSURE_PA,
    &keys::load::MASS_KG,
    &keys::load::VISCOUS_N_S_PER_M,
    &keys::load::CONSTANT_FORCE_N,
    &keys::load::SPRING_N_PER_M,
    &keys::friction::STATIC_EXTEND_N,
    &keys::friction::COULOMB_EXTEND_N,
    &keys::friction::STATIC_RETRACT_N,
    &keys::friction::COULOMB_RETRACT_N,
];

/// Keys of the controller that may change while it runs.
pub(crate) const GAINS: [&Key; 5] = [
    &keys::controller::PROPORTIONAL_GAIN.key,
    &keys::controller::INTEGRAL_GAIN.key,
    &keys::controller::VELOCITY_GAIN.key,
    &keys::controller::ACCELERATION_GAIN.key,
    &keys::controller::PRESSURE_FEEDBACK_GAIN.key,
];
