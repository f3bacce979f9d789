//! The points at which a characteristic is measured, and the curve through them.

use pneudrive_report::Curve;
use pneudrive_sim::Rig;
use pneudrive_sim::keys;

/// Supply pressures of the thesis's families above that of the exhaust, Pa (Tab. 7.1). Read as gauge
/// pressures: at 0.1013 MPa absolute no air would flow.
pub const SUPPLY_FAMILY_PA: [f64; 5] = [506.5e3, 405.2e3, 303.9e3, 202.6e3, 101.3e3];

/// The rig's own supply pressure and those of the family, Pa; equal ones appear once.
pub(super) fn supplies(rig: &Rig) -> Vec<f64> {
    let own = rig.get(&keys::supply::PRESSURE_PA);
    let family = SUPPLY_FAMILY_PA.map(|above| rig.get(&keys::exhaust::PRESSURE_PA) + above);
    std::iter::once(own).chain(family.into_iter().filter(|supply| (supply - own).abs() > 50.0)).collect()
}

/// `intervals + 1` places from `from` to `to`.
pub(super) fn evenly(from: f64, to: f64, intervals: usize) -> Vec<f64> {
    (0..=intervals).map(|i| from + (to - from) * i as f64 / intervals as f64).collect()
}

/// What `y` gives at each x.
pub(super) fn over(name: &str, x: &[f64], y: impl FnMut(f64) -> f64) -> Curve {
    Curve::new(name, x.to_vec(), x.iter().copied().map(y).collect())
}
