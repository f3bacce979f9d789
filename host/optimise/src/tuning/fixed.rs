//! Keys that a user fixes: no search changes them.

use anyhow::{Result, bail};
use pneudrive_sim::keys;
use pneudrive_sim::rigfile::value_of_setting;

use super::Task;

/// The keys that the step sets itself.
const OF_THE_STEP: [&str; 6] = [
    keys::test::MOVES.key.path,
    keys::test::MOVES_MM.key.path,
    keys::test::TARGETS.key.path,
    keys::test::TARGETS_MM.key.path,
    keys::test::DURATION_S.key.path,
    keys::test::POSITION_M.key.path,
];

/// The keys that are held.
#[must_use]
pub fn keys(task: &Task) -> Vec<String> {
    task.fixed.iter().map(|setting| key(setting).to_owned()).collect()
}

fn key(setting: &str) -> &str {
    setting.split_once('=').map_or(setting, |(key, _)| key).trim()
}

/// Whether all keys can be held.
///
/// # Errors
/// Which key cannot be fixed, why, and which can: an unknown key, one that the spread draws, one that the step sets.
pub fn check(task: &Task) -> Result<()> {
    for setting in &task.fixed {
        let (key, value) = setting.split_once('=').unwrap_or((setting, ""));
        let key = key.trim();
        if let Err(problem) = value_of_setting(key, value.trim()) {
            bail!("--fix {setting}: {problem}. {CAN_BE_FIXED}");
        }
        if task.spread.keys().any(|drawn| drawn == key) {
            bail!(
                "--fix {setting}: the spread draws {key}; give its value with --set and its spread as 0% (--load, --friction, --supply, --valve). {CAN_BE_FIXED}"
            );
        }
        if OF_THE_STEP.contains(&key) {
            bail!(
                "--fix {setting}: the step itself sets {key}; see --step, --lowest and --highest. {CAN_BE_FIXED}"
            );
        }
    }
    Ok(())
}

/// The keys that may be fixed.
const CAN_BE_FIXED: &str = "Of the keys that are searched, these can be fixed: controller.gain_profile (with its span), controller.profile_span_counts, controller.proportional_gain, controller.velocity_gain, controller.acceleration_gain, controller.velocity_window_samples, controller.acceleration_window_samples, controller.dead_band_counts, controller.null_offset_counts, operator.dither_mm, operator.dither_hz; of the law cascade controller.cascade_dead_time_factor, controller.cascade_flow_share, controller.cascade_observer_factor; and any other key of a rig";
