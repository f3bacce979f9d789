//! The keys of the controller that one sets first, under each of its laws.

use pneudrive_sim::component::controller::Law;
use pneudrive_sim::keys::{controller, safety};
use pneudrive_sim::rig::Key;
use serde_json::{Value, json};

/// Their paths, in the order of importance; ten at most.
#[must_use]
pub fn of(law: Law) -> Vec<&'static str> {
    let limits = [&controller::TOLERANCE_COUNTS.key, &safety::END_MIN_MM.key, &safety::END_MAX_MM.key];
    let of_law = [&controller::LAW.key].into_iter().chain(gains(law));
    of_law.chain(limits).chain([&controller::PERIOD_S.key]).map(|key| key.path).collect()
}

/// What shapes the motion: gains; of the law that has a model of its drive, the numbers that are free
/// (docs/explanation/control.md).
fn gains(law: Law) -> Vec<&'static Key> {
    use controller::*;
    match law {
        Law::Cascade => vec![
            &CASCADE_DEAD_TIME_FACTOR.key,
            &CASCADE_FLOW_SHARE.key,
            &CASCADE_OBSERVER_FACTOR.key,
            &DELAY_S.key,
            &safety::NO_MOTION_S.key,
        ],
        Law::GainProfile => vec![
            &GAIN_PROFILE.key,
            &PROFILE_SPAN_COUNTS.key,
            &VELOCITY_GAIN.key,
            &ACCELERATION_GAIN.key,
            &DEAD_BAND_COUNTS.key,
        ],
        Law::Pid => vec![
            &PROPORTIONAL_GAIN.key,
            &INTEGRAL_GAIN.key,
            &INTEGRAL_BAND_COUNTS.key,
            &VELOCITY_GAIN.key,
            &DEAD_BAND_COUNTS.key,
        ],
        Law::OnOff => vec![
            &DEAD_BAND_COUNTS.key,
            &RELAY_HYSTERESIS_COUNTS.key,
            &PRESSURE_FEEDBACK_GAIN.key,
            &VELOCITY_GAIN.key,
        ],
        _ => vec![
            &PROPORTIONAL_GAIN.key,
            &DEAD_ZONE_COUNTS.key,
            &VELOCITY_GAIN.key,
            &ACCELERATION_GAIN.key,
            &DEAD_BAND_COUNTS.key,
        ],
    }
}

/// The rank of a key in that list, from 0, for each law by name; a law whose list lacks the key is left out.
#[must_use]
pub fn places(key: &Key) -> Value {
    let place =
        |law: &Law| Some((law.word().to_owned(), json!(of(*law).iter().position(|one| *one == key.path)?)));
    Value::Object(Law::ALL.iter().filter_map(place).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_sim::Rig;
    use pneudrive_sim::rig::all_keys;

    use crate::press;

    /// The page does not show a key that has no effect.
    #[test]
    fn each_law_has_ten_keys_at_most_and_uses_nearly_all_of_them() {
        let press = Rig::read("press.toml", &press::text()).expect("a rig");
        for law in Law::ALL {
            let first = of(*law);
            assert!(first.len() <= 10, "{}: {first:?}", law.word());
            let rig = press.with_settings(&[format!("controller.law={}", law.word())]).expect("a rig");
            let idle = all_keys().filter(|key| first.contains(&key.path) && !rig.uses(key));
            let idle: Vec<&str> = idle.map(|key| key.path).collect();
            assert!(idle.len() <= 1, "{}: {idle:?}", law.word());
        }
    }
}
