//! The law that knows its drive: three numbers.

use super::*;

fn space(fixed: &[&str]) -> Space {
    let fixed: Vec<String> = fixed.iter().map(|&key| key.to_owned()).collect();
    Space::of(&rig("press", &[]), GOAL.settled_mm, &fixed).expect("numbers to tune")
}

#[test]
fn a_law_that_knows_its_drive_has_three_numbers_each_with_its_key() {
    let keys = |settings: Vec<String>| -> Vec<String> {
        settings.iter().map(|one| one.split('=').next().unwrap_or_default().to_owned()).collect()
    };
    let all = space(&[]);
    assert_eq!(
        keys(all.settings(&[0.5; 3])),
        [
            "controller.cascade_dead_time_factor",
            "controller.cascade_flow_share",
            "controller.cascade_observer_factor"
        ]
    );
    let held = space(&["controller.cascade_flow_share"]);
    assert_eq!(
        keys(held.settings(&[0.5; 2])),
        ["controller.cascade_dead_time_factor", "controller.cascade_observer_factor"]
    );
}

#[test]
fn every_corner_of_what_is_searched_is_a_rig() {
    let space = space(&[]);
    for corner in 0..8 {
        let shares = [0, 1, 2].map(|bit| f64::from(u8::from(corner >> bit & 1 == 1)));
        let settings = space.settings(&shares);
        let rig = rig("press", &settings);
        assert_eq!(
            rig.number_at("controller.cascade_flow_share"),
            Some(if shares[1] == 0.0 { 0.2 } else { 0.8 })
        );
    }
}

#[test]
fn a_valve_is_drawn_by_its_conductance_and_none_without_one_is() {
    let press = rig("press", &[]);
    let variant = Variant { valve: 1.2, ..Variant::NOMINAL };
    let of_file = press.number_at("valve.sonic_conductance_m3_per_s_pa").expect("a conductance");
    assert_eq!(
        variant.settings(&press),
        [format!("valve.sonic_conductance_m3_per_s_pa={:?}", 1.2 * of_file)]
    );
    let drawn = Relative { load: 0.3, friction: 0.3, supply: 0.05, valve: 0.2 };
    let known = Relative { valve: 0.0, ..drawn };
    for (of, without) in [
        (spread::tuned_on(&drawn, 3), spread::tuned_on(&known, 3)),
        (spread::fresh(&drawn, 3, 40), spread::fresh(&known, 3, 40)),
    ] {
        let least = of.iter().map(|one| one.valve).fold(f64::MAX, f64::min);
        let most = of.iter().map(|one| one.valve).fold(0.0, f64::max);
        assert!((0.8..0.84).contains(&least) && (1.16..=1.2).contains(&most), "{least} to {most}");
        let rest: Vec<Variant> = of.into_iter().map(|one| Variant { valve: 1.0, ..one }).collect();
        assert_eq!(rest, without, "all else is drawn as ever");
    }
    assert!(drawn.check(&press).is_ok());
    let refusal = drawn.check(&rig("servo-b", &[])).expect_err("no conductance").to_string();
    assert!(refusal.contains("no conductance to draw"), "{refusal}");
}

#[test]
fn a_drive_by_its_data_sheet_is_tuned() {
    let task = Task {
        goal: Goal { settled_mm: 0.05, time_s: 0.6, ..GOAL },
        draws: 6,
        budget: Budget { population: 3, generations: 1, seed: 1 },
        ..task("press", &[])
    };
    let tuned = tune(&task, |_| {}, CancelToken::NEVER).expect("tuned");
    let settles = |found: &Found| found.fresh.iter().filter(|one| one.settling_s.is_some()).count();
    assert!(settles(&tuned.after) >= 5, "{:?}", tuned.after.fresh);
    assert!(tuned.after.cost(&task.goal) <= tuned.before.cost(&task.goal));
}
