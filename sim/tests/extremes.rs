//! Rigs at the edge of what anybody builds: they run, or the run ends by the name of what it went beyond.

use std::time::{Duration, Instant};

use pneudrive_controller::Command;
use pneudrive_sim::continuous::ContinuousLaw;
use pneudrive_sim::follow::{Followed, Timing, follow_within};
use pneudrive_sim::{Accuracy, IntegrationError, Rig, run};

use crate::extreme::{self, every_key};

/// Seeds of rigs that take no long time; the example `campaign` of pneudrive-design draws more.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=24;
const EVERY_KEY: std::ops::RangeInclusive<u64> = 2..=25;

const TIMING: Timing = Timing { period_us: 1000, delay_us: 500 };

/// Evaluations of the right-hand side after which a rig need not run on.
const MOST_EVALUATIONS: u64 = 100_000;

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
            Err(IntegrationError::BeyondModel { why, .. }) => assert!(names_a_key(why), "{why}"),
            Err(error) => panic!("{seed}: {error}"),
        }
    }
    assert!(ran > 12, "{ran}");
}

/// Drawn key by key. Its valve opens one way and then the other, whatever its controller would do, until a run has cost enough.
/// A continuous controller takes no commands: the example `campaign` runs such rigs.
#[test]
fn a_rig_of_which_any_key_lies_anywhere_in_its_range_runs_or_is_refused_by_key() {
    let mut to_the_end = 0;
    for seed in EVERY_KEY {
        let every_key::Drawn { name, settings, refused, rig, .. } = every_key::rig(seed);
        assert!(refused.iter().all(|problem| problem.contains('.')), "{seed}: {refused:?}");
        assert!(!settings.is_empty(), "{seed}: nothing of {name} is drawn");
        if ContinuousLaw::of(&rig).is_some() {
            continue;
        }
        let Followed { readings, failed, .. } =
            follow_within(&rig, Accuracy::of(&rig), TIMING, &opened_either_way(), MOST_EVALUATIONS);
        match failed {
            None => to_the_end += u32::from(readings.len() == opened_either_way().len()),
            Some(IntegrationError::BeyondModel { why, .. }) => assert!(names_a_key(why), "{seed}: {why}"),
            Some(error) => panic!("{seed}: {error}: {name} {}", settings.join(" ")),
        }
        for reading in &readings {
            let [one, two] = reading.pressures;
            assert!((reading.position + one + two + reading.spool).is_finite(), "{seed}: {reading:?}");
        }
    }
    assert!(to_the_end > 12, "{to_the_end}");
}

/// Fully open either way, a tenth of a second each.
fn opened_either_way() -> Vec<Command> {
    [(2047, 1), (-2047, -1)]
        .into_iter()
        .flat_map(|(counts, step)| [Command { counts, step, drive_enable: true }; 100])
        .collect()
}

/// Whether the end of a run names what it went beyond.
fn names_a_key(why: &str) -> bool {
    why.contains("actuator.") || why.contains("valve.upstream_mach")
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
