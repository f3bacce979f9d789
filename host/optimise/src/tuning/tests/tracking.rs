//! Sines, and what limits how they are followed.

use super::*;
use crate::tuning::tracking::limit::{Following, Limit, common};
use crate::tuning::tracking::{Gains, Tracked, tracked};

const NONE: Following = Following {
    largest_mm: 2.0,
    rms_mm: 1.0,
    in_dead_band: 0.0,
    fully_open: 0.0,
    standing: 0.0,
    with_sine: 0.0,
    behind_s: 0.0,
};

#[test]
fn most_of_the_squared_error_names_the_limit_and_less_names_none() {
    let named = |run: Following| run.limit();
    assert_eq!(named(Following { in_dead_band: 0.6, ..NONE }), Some(Limit::Resolution));
    assert_eq!(named(Following { fully_open: 0.6, with_sine: 1.0, ..NONE }), Some(Limit::ValveFlow));
    assert_eq!(named(Following { standing: 0.6, ..NONE }), Some(Limit::Friction));
    assert_eq!(named(Following { with_sine: 0.9, ..NONE }), Some(Limit::Law));
    assert_eq!(named(Following { with_sine: 0.3, ..NONE }), None, "it moves, but not with the sine");
    assert_eq!(named(Following { fully_open: 0.4, standing: 0.4, with_sine: 0.9, ..NONE }), None);
}

#[test]
fn a_drive_is_limited_by_what_limits_all_of_its_runs() {
    let [law, valve] = [Following { with_sine: 0.9, ..NONE }, Following { fully_open: 0.9, ..NONE }];
    assert_eq!(common(&[Ok(law), Ok(law)]), Some(Limit::Law));
    assert_eq!(common(&[Ok(law), Ok(valve)]), None);
    assert_eq!(common(&[Ok(law), Err("a trip".to_owned())]), None);
    assert_eq!(common(&[]), None);
}

/// The sines of a rig with the gains of its file.
fn sines(settings: &[&str]) -> Vec<Tracked> {
    let task = task("servo-b-tuned", settings);
    let task = Task { budget: Budget { generations: 0, ..task.budget }, draws: 2, ..task };
    let tuned = tune(&task, |_| {}, CancelToken::NEVER).expect("figures");
    tracked(&task, &tuned, |_| {}, CancelToken::NEVER).expect("runs")
}

/// Its figures at both frequencies are those of docs/howto/profiles.md, over other swings of the same sine.
#[test]
fn without_feed_forward_the_law_is_behind_a_sine_and_with_it_less_so() {
    let all = sines(&[]);
    let rms = |one: &Tracked| one.runs[0].as_ref().expect("a run").rms_mm;
    let gains: Vec<Gains> = all.iter().map(|one| one.gains).collect();
    assert_eq!(gains, [Gains::OfFile, Gains::FeedForward, Gains::OfFile, Gains::FeedForward]);
    assert!(
        (all[0].sine.amplitude_mm() - 60.0).abs() < 0.01 && (all[0].sine.middle_mm() - 150.0).abs() < 0.02
    );
    for (one, published) in [(&all[0], 9.02), (&all[2], 19.0)] {
        assert_eq!((one.runs.len(), one.draws.len(), common(&one.runs)), (8, 2, Some(Limit::Law)));
        assert!((rms(one) / published - 1.0).abs() < 0.05, "{} mm", rms(one));
    }
    assert!(rms(&all[1]) < 0.5 * rms(&all[0]) && rms(&all[3]) < 0.5 * rms(&all[2]));
}

#[test]
fn a_valve_that_is_too_small_limits_a_drive_by_its_flow_and_a_dead_band_by_itself() {
    let small = sines(&["valve.port_diameter_mm=2.0"]);
    assert_eq!(common(&small[0].runs), Some(Limit::Law), "{:?}", small[0].runs);
    assert_eq!(common(&small[3].runs), Some(Limit::ValveFlow), "{:?}", small[3].runs);
    let wide = sines(&["controller.dead_band_counts=8000"]);
    assert_eq!(common(&wide[0].runs), Some(Limit::Resolution), "{:?}", wide[0].runs);
    let forwards = sines(&["controller.velocity_feed_forward=2000"]);
    assert_eq!(forwards.len(), 2, "what the file feeds forward is not replaced");
}
