//! Whether a transient can belong to a rig.

use anyhow::{Result, bail};
use pneudrive_sim::Rig;
use pneudrive_sim::component::encoder::mm_per_count;
use pneudrive_sim::keys;

use crate::transient::{POSITION, Transient};

/// A stop gives way by less, mm.
const STOP_GIVES_MM: f64 = 3.0;

/// Refuses a rig that a transient cannot be of.
///
/// # Errors
/// When its encoder counts otherwise, or the drive was where the rig has no stroke.
pub fn refuse_other_rig(transient: &Transient, rig: &Rig) -> Result<()> {
    let [counted, counts] = [transient.mm_per_count, mm_per_count(rig)];
    let (name, test) = (rig.name(), &transient.name);
    if (counted / counts - 1.0).abs() > 1e-6 {
        bail!("{test} does not belong to {name}: its encoder has {counted} mm per count, not {counts}");
    }
    let stroke = 1e3 * rig.get(&keys::actuator::STROKE_M);
    let [low, high] = [f64::min, f64::max].map(|of| transient.channels[POSITION].iter().copied().reduce(of));
    let (low, high) = (low.unwrap_or(0.0), high.unwrap_or(0.0));
    if low < -STOP_GIVES_MM || high > stroke + STOP_GIVES_MM {
        bail!(
            "{test} does not belong to {name}: it goes from {low:.1} to {high:.1} mm, but the stroke of {name} is {stroke:.1} mm"
        );
    }
    Ok(())
}
