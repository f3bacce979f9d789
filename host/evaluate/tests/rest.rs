//! A drive that is judged to rest does not move later.

use pneudrive_evaluate::evaluation::{Doubt, LimitCycle};
use pneudrive_evaluate::transient::Transient;
use pneudrive_sim::Rig;

use crate::watched::{self, Kind, MOVES_MM, STEP_S, WATCHED_S, moves_later_mm, stepping, verdict};

fn case(name: &str, text: &str) -> Transient {
    let duration = format!("test.duration_s={:?}", STEP_S + WATCHED_S);
    let rig = Rig::read_with(name, text, &[duration]).expect("a valid rig");
    watched::watched(&rig).expect("it does not trip")
}

/// It stands for seconds, while the pressure of a chamber rises ever more slowly until it breaks away.
#[test]
fn a_drive_that_stands_until_its_pressures_make_it_jump_is_not_judged_to_rest() {
    for (name, text) in
        [("rest7207", include_str!("cases/rest7207.toml")), ("rest7250", include_str!("cases/rest7250.toml"))]
    {
        let drive = case(name, text);
        for seconds in [1.0, 2.0, 3.0] {
            let LimitCycle::Undecided(Doubt::Sticking { still_s, .. }) = verdict(&drive, seconds) else {
                panic!("{name}, {seconds} s: {:?}", verdict(&drive, seconds))
            };
            assert!(moves_later_mm(&drive, seconds) > MOVES_MM, "{name} jumps after {seconds} s");
            assert!((1.0..=10.0).contains(&still_s), "{name}, {seconds} s: watch for {still_s} s more");
        }
    }
}

/// A record shows no friction: its pressures alone say it.
#[test]
fn a_record_of_such_a_drive_says_it_by_its_pressures() {
    let mut drive = case("rest7250", include_str!("cases/rest7250.toml"));
    drive.grip = None;
    let found = verdict(&drive, 2.0);
    assert!(matches!(found, LimitCycle::Undecided(Doubt::Sticking { .. })), "{found:?}");
}

#[test]
fn drawn_own_drives_that_are_judged_to_rest_stay_where_they_are_for_12_seconds() {
    let mut rests = 0;
    for seed in 0..12 {
        for kind in [Kind::Dry, Kind::Bristles, Kind::BristlesFlowNode] {
            let Some(drive) = watched::watched(&stepping(seed, kind)) else { continue };
            let is_judged = |seconds: &f64| matches!(verdict(&drive, *seconds), LimitCycle::None { .. });
            let Some(first) = [1.0, 2.0, 3.0].into_iter().find(is_judged) else { continue };
            let moves_mm = moves_later_mm(&drive, first);
            assert!(
                moves_mm <= MOVES_MM,
                "own {seed} {kind:?} rests after {first} s and moves by {moves_mm} mm"
            );
            rests += 1;
        }
    }
    assert!(rests >= 5, "only {rests} were judged to rest");
}
