//! Gains to begin with: a position loop that is slow against the air in the cylinder.
//!
//! ```text
//! w^2 = n P (A_1^2/V_1 + A_2^2/V_2)/M          the load on its two air springs at mid-stroke, P the mean pressure
//! v   = C p_s (rho_0 R T)/(P A_1)              full valve: the choked flow fills the chamber at its pressure
//! k   = K_p/scale v/2048 / pulse               loop gain, 1/s; a third-order loop is stable below 2 zeta w
//! ```
//!
//! With zeta = 0.05, the least that a cylinder without much friction has, half of that limit is k = 0.05 w.

use pneudrive_sim::keys;

use super::Cylinder;
use super::air::supply;
use crate::question::{Answers, Refusal};
use crate::rig_file::RigFile;

/// Share of the supply pressure that stands in the chambers of a drive that rests.
const MEAN_PRESSURE: f64 = 0.6;
/// k over w.
const SHARE: f64 = 0.05;
/// n, and rho_0 R T of air at the reference atmosphere, Pa.
const HEAT_CAPACITY_RATIO: f64 = 1.4;
const REFERENCE: f64 = 1e5;
/// Commands of the full valve, and the scale of the law.
const FULL: f64 = 2048.0;
const SCALE: f64 = 4096.0;

pub(super) fn write(
    file: &mut RigFile,
    answers: &Answers,
    cylinder: &Cylinder,
    sonic_conductance: f64,
) -> Result<(), Refusal> {
    let mass = answers.required("mass")?;
    let pressure = MEAN_PRESSURE * supply(answers)?.value;
    let [first, second] = cylinder.areas();
    let half = cylinder.stroke / 2.0;
    let springs = HEAT_CAPACITY_RATIO * pressure * (first + second) / half;
    let natural = (springs / mass).sqrt();
    let speed = sonic_conductance * supply(answers)?.value * REFERENCE / (pressure * first);
    let pulse = 1e-3 * answers.number("resolution")?.unwrap_or(super::RESOLUTION_MM);
    let gain = (SHARE * natural * SCALE * FULL * pulse / speed).round().clamp(1.0, 65_535.0);
    let why = format!(
        "a loop of {:.2} 1/s: a twentieth of the load on its air springs, {:.1} Hz; `pneudrive tune` finds better ones",
        gain * speed / (SCALE * FULL * pulse),
        natural / std::f64::consts::TAU
    );
    file.text(&keys::controller::GAIN_PROFILE, format!("[{gain}]"), &why);
    file.integer(&keys::controller::SCALE, SCALE as i64, "fine enough for a gain of a few counts");
    for key in [&keys::controller::VELOCITY_GAIN, &keys::controller::ACCELERATION_GAIN] {
        file.integer(key, 0, "none to begin with");
    }
    Ok(())
}
