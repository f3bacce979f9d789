//! The bound against a constant force, and on drives of which it is known.

use pneudrive_design::six_drives::rig_file_of;

use super::*;

/// A constant acceleration until the switch and the same against it afterwards: the piston stands after twice that time.
fn constant(acceleration: f64, period_s: f64) -> impl FnMut(u32) -> Result<Stop> {
    move |samples| {
        let switch_s = f64::from(samples) * period_s;
        Ok(Stop { at_s: 2.0 * switch_s, travel_m: acceleration * switch_s * switch_s })
    }
}

/// The largest error over many distances, against 2 sqrt(D/a).
fn largest_error(period_s: f64) -> f64 {
    let acceleration = 25.0;
    let error = |mm: u32| {
        let travel = 1e-3 * f64::from(mm);
        let (_, time_s) =
            switched(travel, constant(acceleration, period_s)).expect("a motion").expect("a switch");
        (time_s - 2.0 * (travel / acceleration).sqrt()).abs()
    };
    (40..90).map(error).fold(0.0, f64::max)
}

#[test]
fn the_bound_of_a_constant_force_is_met_to_the_square_of_the_sample_period() {
    let errors = [2e-3, 1e-3, 0.5e-3].map(largest_error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.3).contains(&order), "order {order}: {errors:?}");
    }
    // A chord of the root is off by T^2/(2 t_e) at most; t_e is 80 ms at least.
    assert!(errors[1] <= 1e-6 / (2.0 * 0.08), "{errors:?}");
}

#[test]
fn the_switch_of_a_constant_force_is_halfway_in_time() {
    let (switch, time_s) = switched(0.06, constant(25.0, 1e-3)).expect("a motion").expect("a switch");
    assert!((2e-3 * switch - time_s).abs() < 1e-9, "{switch} {time_s}");
}

#[test]
fn a_way_that_one_sample_exceeds_has_no_bound_and_one_that_is_never_made_is_an_error() {
    assert!(switched(1e-6, constant(25.0, 1e-3)).expect("a motion").is_none());
    let stands = |_| Ok(Stop { at_s: 0.0, travel_m: 0.0 });
    assert!(switched(0.06, stands).is_err());
}

fn drive(name: &str) -> Rig {
    Rig::read(name, &rig_file_of(name).expect("one of the six"))
        .unwrap_or_else(|problems| panic!("{problems}"))
}

fn both_directions(rig: &Rig, step_mm: f64) -> [Bound; 2] {
    [true, false].map(|extends| bound(rig, step_mm, extends).expect("it runs").expect("a bound"))
}

/// A prototype of another program found 96 to 98 ms for this drive.
#[test]
fn the_drive_of_the_readme_makes_60_mm_in_95_to_99_ms_at_best() {
    for bound in both_directions(&drive("32x250"), 60.0) {
        assert!((0.095..0.099).contains(&bound.time_s), "{bound:?}");
        assert!((0.4..0.8).contains(&(bound.switch_s / bound.time_s)), "{bound:?}");
    }
}

/// The switch at the whole sample before the bound ends short of the target, that after it beyond.
#[test]
fn the_step_ends_between_the_switches_at_the_two_samples_around_the_bound() {
    let rig = drive("50x400");
    let bound = bound(&rig, 60.0, true).expect("it runs").expect("a bound");
    let steps = Steps::of(&rig, 60.0, Place { along: 0.5, extends: true }).expect("it fits");
    let nominal = open_loop(&rig).expect("a rig");
    let before = (bound.switch_s / 1e-3).floor() as u32;
    let [short, far] =
        [before, before + 1].map(|samples| stop(&nominal, steps, samples, 1e-3).expect("a stop"));
    assert!(short.travel_m <= 0.06 && 0.06 < far.travel_m, "{short:?} {far:?}");
    assert!((short.at_s..far.at_s).contains(&bound.time_s), "{short:?} {bound:?} {far:?}");
}

#[test]
fn a_vertical_drive_is_faster_downwards_and_a_longer_step_takes_longer() {
    let rig = drive("32x250-up");
    let [up, down] = both_directions(&rig, 60.0);
    assert!(down.time_s < up.time_s, "{down:?} {up:?}");
    let [longer, _] = both_directions(&rig, 120.0);
    assert!(longer.time_s > 1.2 * up.time_s, "{longer:?} {up:?}");
}

/// The valves of the thesis sampled every 0.5 ms, extending and retracting; a prototype of another program found the same
/// ranges. A stepper opens by one step a sample, so that longer periods cost it time.
#[test]
fn the_valves_of_the_thesis_make_60_mm_in_the_times_that_their_flow_allows() {
    let fast = ["controller.period_s=0.0005", "controller.delay_s=0.0002"].map(str::to_owned);
    for (name, range) in
        [("servo-a", [0.146, 0.167]), ("servo-b", [0.138, 0.158]), ("servo-c", [0.086, 0.099])]
    {
        let rig = Rig::builtin(name).expect("a built-in rig").with_settings(&fast).expect("valid");
        for bound in both_directions(&rig, 60.0) {
            assert!((range[0]..range[1]).contains(&bound.time_s), "{name}: {bound:?}");
        }
    }
    let [at_1_3_ms, _] = both_directions(&Rig::builtin("servo-a").expect("a built-in rig"), 60.0);
    assert!(at_1_3_ms.time_s > 0.155, "{at_1_3_ms:?}");
}
