//! Rigs at the edge of what anybody builds: they run, or the run ends by the name of what it went beyond.

use std::time::{Duration, Instant};

use pneudrive_sim::{Accuracy, IntegrationError, Rig, run};

use crate::extreme::{self, every_key};

/// Seeds of rigs that take no long time; the example `campaign` of pneudrive-design draws more.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=24;
const EVERY_KEY: std::ops::RangeInclusive<u64> = 2..=20;

#[test]
fn a_drawn_rig_at_the_edge_runs_or_is_refused_by_key_or_ends_by_what_its_piston_ran_through() {
    let mut ran = 0;
    for seed in SEEDS {
        let rig = match extreme::rig(seed) {
            Ok(rig) => rig,
            Err(problems) => {
                assert!(problems.0.iter().all(|problem| problem.key.contains('.')), "{seed}: {problems}");
                continue;
            }
        };
        match run(&rig, Accuracy::of(&rig)) {
            Ok(run) => {
                assert!(run.rows.iter().all(|row| row.values().iter().all(|value| value.is_finite())));
                ran += 1;
            }
            Err(IntegrationError::BeyondModel { why, .. }) => assert!(why.contains("actuator."), "{why}"),
            Err(error) => panic!("{seed}: {error}"),
        }
    }
    assert!(ran > 12, "{ran}");
}

/// Drawn key by key. That such rigs also run is shown by the example `campaign`, which stops each after a minute.
#[test]
fn a_rig_of_which_any_key_lies_anywhere_in_its_range_is_taken_or_refused_by_key() {
    for seed in EVERY_KEY {
        let every_key::Drawn { name, settings, refused, .. } = every_key::rig(seed);
        assert!(refused.iter().all(|problem| problem.contains('.')), "{seed}: {refused:?}");
        assert!(!settings.is_empty(), "{seed}: nothing of {name} is drawn");
    }
}

/// Its piston of 5 kg arrives at 2.4 m/s, and its stop gives way by more than the dead volume is long. Once the run ended as
/// "too stiff", after a fifth of a million steps.
#[test]
fn a_piston_that_runs_through_its_end_cover_is_said_to_soon() {
    let rig = Rig::read("too_stiff.toml", include_str!("extreme/too_stiff.toml"));
    let rig = rig.unwrap_or_else(|problems| panic!("{problems}"));
    let since = Instant::now();
    let ended = run(&rig, Accuracy::of(&rig)).expect_err("no air is left");
    assert!(since.elapsed() < Duration::from_secs(5), "{:?}", since.elapsed());
    let IntegrationError::BeyondModel { at_s, why } = ended else { panic!("{ended}") };
    assert!((0.08..0.082).contains(&at_s), "{at_s}");
    assert!(
        why.contains("actuator.residual_volume_2_m3") && why.contains("load.stop_stiffness_n_per_m"),
        "{why}"
    );
}
