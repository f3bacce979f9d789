//! A lagged tube tends to the one without lag as its lag goes to zero (EQUATIONS section 12), whether the speed of the
//! air in front of the valve counts or not, and however wide the lands are open.

use pneudrive_sim::{Accuracy, Rig, Run, run};

/// An open-loop test with the valve opened by `counts` to both sides, with a lag in s.
fn opened(rig: &str, counts: i32, approach: bool, lag_s: f64) -> Run {
    let settings = [
        "controller.loop=open".to_owned(),
        format!("test.moves=[[0.0, 0], [0.1, {counts}], [1.0, -{counts}]]"),
        "test.duration_s=1.6".to_owned(),
        format!("valve.upstream_mach={approach}"),
        format!("tubing.lag_s={lag_s}"),
    ];
    let text = pneudrive_sim::rigfile::builtin(rig).expect("a built-in rig");
    let rig = Rig::read_with(rig, text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
    run(&rig, Accuracy::of(&rig)).unwrap_or_else(|error| panic!("lag {lag_s} s: {error}"))
}

/// The largest distance between the positions of two runs, m.
fn apart(one: &Run, other: &Run) -> f64 {
    assert_eq!(one.rows.len(), other.rows.len());
    let pairs = one.rows.iter().zip(&other.rows);
    pairs.map(|(one, other)| (one.plant.position - other.plant.position).abs()).fold(0.0, f64::max)
}

#[test]
fn a_lag_of_10_microseconds_changes_a_transient_by_micrometres_and_a_tenth_of_what_100_do() {
    // Servo-drive A by 0.15 and 0.5 mm, B by 0.3 and 1 mm, where the lands are three times as wide as the ports.
    for (rig, counts) in [("servo-a", 12), ("servo-a", 40), ("servo-b", 600), ("servo-b", 2048)] {
        for approach in [false, true] {
            let settled = opened(rig, counts, approach, 0.0);
            let [long, short] =
                [1e-4, 1e-5].map(|lag_s| apart(&settled, &opened(rig, counts, approach, lag_s)));
            let what =
                format!("{rig} by {counts}, upstream Mach numbers {approach}: {long:e} and {short:e} m");
            assert!(short < 5e-6, "{what}");
            assert!(short < 0.2 * long, "{what}");
        }
    }
}

/// What the thesis varied (7.2.1), wide open and into the stops.
#[test]
fn lags_of_the_thesis_run_through_full_openings_without_a_search_for_flows_at_every_step() {
    for lag_s in [0.001, 0.01] {
        let run = opened("servo-b", 2048, true, lag_s);
        let steps = run.work.integrator.n_steps;
        assert!(run.work.network.bracketed < steps / 100, "{lag_s} s: {:?}", run.work);
    }
}

/// At the outlet of a vessel the air is at rest, of the supply and of the chambers alike.
#[test]
fn without_tubes_no_air_has_a_speed_in_front_of_the_valve() {
    let opened = |approach: bool| {
        let settings = [
            "controller.loop=open".to_owned(),
            "test.moves=[[0.0, 0], [0.1, 40], [0.5, -40]]".to_owned(),
            "test.duration_s=0.9".to_owned(),
            "tubing.model=none".to_owned(),
            format!("valve.upstream_mach={approach}"),
        ];
        let text = pneudrive_sim::rigfile::builtin("servo-a").expect("a built-in rig");
        let rig = Rig::read_with("servo-a", text, &settings).unwrap_or_else(|problems| panic!("{problems}"));
        run(&rig, Accuracy::of(&rig)).expect("a transient")
    };
    assert_eq!(apart(&opened(false), &opened(true)), 0.0);
}
