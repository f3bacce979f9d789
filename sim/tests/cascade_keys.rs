//! The keys that move the numbers of the law "cascade".

use pneudrive_controller::parameters::id;
use pneudrive_sim::Rig;
use pneudrive_sim::rigfile::builtin;

fn press(settings: &[&str]) -> Result<Rig, String> {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    let text = builtin("press").expect("a built-in rig");
    Rig::read_with("press", text, &settings).map_err(|problems| problems.to_string())
}

fn parameter(settings: &[&str], id: u16) -> f64 {
    f64::from(press(settings).expect("a rig").parameters().get(id).expect("a parameter"))
}

fn is_times(settings: &[&str], id: u16, factor: f64) {
    let (before, after) = (parameter(&[], id), parameter(settings, id));
    assert!(
        (after - factor * before).abs() <= 1.0 + 1e-6 * after.abs(),
        "{settings:?}: {before} and {after}"
    );
}

#[test]
fn a_longer_dead_time_makes_every_pole_slower() {
    let twice = ["controller.cascade_dead_time_factor=2.0"];
    is_times(&twice, id::CASCADE_DEAD_TIME, 2.0);
    is_times(&twice, id::CASCADE_FORCE_POLE, 0.5);
    is_times(&twice, id::CASCADE_POSITION_POLE, 0.5);
    let whole = 2.0_f64.powi(30);
    for id in [id::CASCADE_MOTION_DECAY, id::CASCADE_FLOW_DECAY] {
        let [before, after] = [parameter(&[], id), parameter(&twice, id)].map(|decay| (decay / whole).ln());
        assert!((after / before - 0.5).abs() < 1e-6, "{before} and {after}");
    }
}

#[test]
fn the_share_of_the_flow_scales_all_three_limits_of_a_trajectory() {
    let half = ["controller.cascade_flow_share=0.2"];
    for id in [id::CASCADE_WAY_SPEED, id::CASCADE_WAY_ACCELERATION, id::CASCADE_WAY_FLOW] {
        is_times(&half, id, 0.5);
    }
    is_times(&half, id::CASCADE_FORCE_POLE, 1.0);
}

#[test]
fn slower_observers_leave_the_loops_as_they_are() {
    let slow = ["controller.cascade_observer_factor=0.5"];
    let whole = 2.0_f64.powi(30);
    for id in [id::CASCADE_MOTION_DECAY, id::CASCADE_FLOW_DECAY] {
        let [before, after] = [parameter(&[], id), parameter(&slow, id)].map(|decay| (decay / whole).ln());
        assert!((after / before - 0.5).abs() < 1e-6, "{before} and {after}");
    }
    for id in [id::CASCADE_DEAD_TIME, id::CASCADE_FORCE_POLE, id::CASCADE_WAY_SPEED] {
        is_times(&slow, id, 1.0);
    }
}

/// Commands that do not open a valve fully open it as far as they go: 2048 counts are 0.9 of the travel.
#[test]
fn a_small_gain_of_the_amplifier_is_a_smaller_valve() {
    let small = ["operator.amplifier_gain=0.9", "valve.leakage_percent=2.0", "valve.underlap_mm=0.05"];
    let whole = ["valve.leakage_percent=2.0", "valve.underlap_mm=0.05"];
    let [lap, share] = [0.05 / 0.9 * 2048.0, 0.02 + 0.98 * 0.85 / 0.95];
    let of = |settings: &[&str], id| parameter(settings, id);
    let counts = |id| of(&small, id) / 65_536.0;
    assert!((counts(id::CASCADE_OVERLAP) - lap).abs() < 1e-4);
    assert!((counts(id::CASCADE_SPAN) - (2048.0 - lap)).abs() < 1e-4);
    for (id, factor) in [
        (id::CASCADE_FLOW_SUPPLY, share),
        (id::CASCADE_FLOW_EXHAUST, share),
        (id::CASCADE_WAY_SPEED, share),
        (id::CASCADE_LEAKAGE, 1.0 / share),
    ] {
        let (before, after) = (of(&whole, id), of(&small, id));
        assert!((after - factor * before).abs() <= 1.0, "{before} and {after}");
    }
    let refused = press(&["operator.amplifier_gain=0.02", "valve.underlap_mm=0.05"]).expect_err("shut");
    assert!(refused.contains("operator.amplifier_gain"), "{refused}");
}

#[test]
fn the_keys_of_a_law_are_refused_with_another() {
    let message = Rig::read_with(
        "servo-b",
        &format!("{}\n", builtin("servo-b").expect("a built-in rig")),
        &["controller.cascade_flow_share=2.0".to_owned()],
    );
    assert!(message.is_err(), "out of its range");
    let rig = Rig::builtin("servo-b").expect("a built-in rig");
    assert!(rig.get(&pneudrive_sim::keys::controller::CASCADE_FLOW_SHARE) == 0.4, "its preset");
    let with = rig.with_settings(&["controller.cascade_flow_share=0.3".to_owned()]).expect("a rig");
    assert!(with.written_in_vain().contains("controller.cascade_flow_share"));
}
