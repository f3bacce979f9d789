extern crate std;
use std::vec::Vec;

use super::*;
use crate::parameters::lookup;

/// Numbers of any size that look random and are the same everywhere (xorshift).
struct Draws(u64);

impl Draws {
    fn any(&mut self) -> i32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 as i32) >> (self.0 >> 59)
    }

    fn learned(&mut self) -> Learned {
        Learned {
            mass: self.any(),
            friction: self.any(),
            force: self.any(),
            viscous: self.any(),
            pace: self.any(),
            looseness: self.any(),
        }
    }
}

/// Parameters that keep it, which none outside its range can.
fn parameters_of(kept: &Kept) -> Parameters {
    let mut parameters = Parameters::default();
    for (id, value) in kept.values() {
        assert_eq!(parameters.set(id, value), Ok(()), "{:?}", lookup(id).map(|line| line.name));
    }
    parameters
}

/// The run that ends with these parts of mass, friction and pace, a force in stictions, and in no fault.
fn after(kept: Kept, [mass, friction, pace]: [f64; 3], stictions: i32) -> Kept {
    let part = |part: f64| (part * f64::from(ONE)) as i32;
    let run = Learned {
        mass: part(mass),
        friction: part(friction),
        pace: part(pace),
        force: stictions << 24,
        ..Learned::default()
    };
    kept.after(run, false, None)
}

#[test]
fn whatever_was_learned_is_kept_within_the_ranges_of_its_parameters() {
    let mut draws = Draws(0x9e37_79b9_7f4a_7c15);
    let mut kept = Kept::default();
    for round in 0..20_000 {
        let (run, at_bound) = (draws.learned(), round % 5 == 0);
        kept = kept.after(run, at_bound, None);
        assert_eq!(Kept::of(&parameters_of(&kept)), kept);
        let any = Kept { learned: run, armings: draws.any(), at_bound: draws.any(), changed: Changed::No };
        let _ = parameters_of(&any);
        assert!(any.learned.bounded() == any.learned.bounded().bounded());
    }
}

#[test]
fn the_ranges_of_the_parameters_are_the_bounds_of_what_is_learned() {
    let ends = [i32::MIN, i32::MAX].map(|end| Learned {
        mass: end,
        friction: end,
        force: end,
        viscous: end,
        pace: end,
        looseness: end,
    });
    let ranges = ends.map(|end| Kept { learned: end, ..Kept::default() }.values());
    for ((id, least), (_, most)) in ranges[0].iter().zip(&ranges[1]).take(6) {
        let line = lookup(*id).expect("in the table");
        assert_eq!((line.min, line.max), (*least, *most), "{}", line.name);
    }
    assert_eq!(Kept::of(&Parameters::default()), Kept::default(), "nothing is kept by default");
}

#[test]
fn what_each_run_finds_again_is_kept_at_seven_eighths_and_what_none_does_fades() {
    let same = after(after(Kept::default(), [1.8, 1.0, 1.0], 0), [1.8, 1.0, 1.0], 0);
    assert_eq!((same.learned.mass, same.armings), (ONE + (7 * ONE / 10), 2));
    let mut fading = same;
    let deviations: Vec<i32> = (0..5)
        .map(|_| {
            fading = fading.after(fading.learned, false, None);
            fading.learned.mass - ONE
        })
        .collect();
    let half = (same.learned.mass - ONE) / 2;
    assert!(deviations[3] > half && deviations[4] < half + half / 20, "{deviations:?}");
}

#[test]
fn the_lag_of_the_valve_is_followed_in_steps() {
    let paces = |from: Kept, pace: f64| {
        let mut kept = from;
        (0..30).for_each(|_| kept = after(kept, [1.0, 1.0, pace], 0));
        kept.learned.pace
    };
    let first = after(Kept::default(), [1.0, 1.0, 1.6], 0);
    assert_eq!(first.learned.pace, ONE + 7 * ONE / 64);
    assert_eq!(paces(first, 1.6), 104_857 - 39_321 / 8);
    assert!(paces(first, 3.0) < 15 * ONE / 8, "a step is what an arming takes back");
    assert_eq!(after(first, [1.0; 3], 0).learned.pace, ONE, "one that is wrong is soon forgotten");
}

#[test]
fn a_run_that_finds_another_drive_is_told_and_the_next_one_begins_afresh() {
    let kept = after(Kept::default(), [1.0; 3], 0);
    for (parts, stictions) in [
        ([1.51, 1.0, 1.0], 0),
        ([0.66, 1.0, 1.0], 0),
        ([1.0, 0.49, 1.0], 0),
        ([1.0, 2.1, 1.0], 0),
        ([1.0; 3], 5),
    ] {
        let changed = after(kept, parts, stictions);
        assert_eq!(changed, Kept { changed: Changed::Jumped, ..Kept::default() }, "{parts:?}");
    }
    for (parts, stictions) in [
        ([1.49, 1.0, 1.0], 0),
        ([0.67, 1.0, 1.0], 0),
        ([1.0, 1.9, 1.0], 0),
        ([1.0, 1.0, 2.9], 0),
        ([1.0; 3], 4),
    ] {
        assert_eq!(after(kept, parts, stictions).changed, Changed::No, "{parts:?}");
    }
    let first = after(Kept::default(), [2.4, 1.9, 2.5], 7);
    assert_eq!((first.changed, first.armings), (Changed::No, 1), "a rig file that is wrong is no change");
}

#[test]
fn a_change_is_told_until_eight_armings_in_a_row_were_alike() {
    let mut kept = after(after(Kept::default(), [1.0; 3], 0), [2.0, 1.0, 1.0], 0);
    for _ in 0..7 {
        kept = after(kept, [2.0, 1.0, 1.0], 0);
        assert_eq!(kept.changed, Changed::Jumped, "{}", kept.armings);
    }
    assert_eq!(after(kept, [2.0, 1.0, 1.0], 0).changed, Changed::No);
}

#[test]
fn three_runs_in_a_row_that_end_at_a_bound_are_a_change() {
    let at_bound = |kept: Kept| kept.after(Learned::default(), true, None);
    let twice = at_bound(at_bound(Kept::default()));
    assert_eq!((twice.at_bound, twice.changed), (2, Changed::No));
    assert_eq!(at_bound(twice), Kept::afresh(Changed::AtBound));
    assert_eq!(at_bound(at_bound(after(twice, [1.0; 3], 0))).changed, Changed::No, "not in a row");
}

#[test]
fn a_drive_that_has_tripped_begins_afresh_unless_somebody_has_stopped_it() {
    let kept = after(Kept::default(), [1.2, 1.0, 1.0], 0);
    for fault in Fault::ALL {
        let after = kept.after(Learned { mass: ONE, ..kept.learned }, false, Some(fault));
        let expected = match fault {
            Fault::Stop | Fault::HostSilent | Fault::CommandWhileDisarmed | Fault::WatchdogTried => {
                kept.after(Learned { mass: ONE, ..kept.learned }, false, None)
            }
            Fault::ModelAtBound => Kept::afresh(Changed::AtBound),
            _ => Kept::afresh(Changed::Tripped),
        };
        assert_eq!(after, expected, "{fault:?}");
    }
}

#[test]
fn each_eighth_arming_takes_a_doubling_of_the_distance_back_however_many_there_were() {
    for armings in [0, MOST / PULL * PULL] {
        let learned = Learned { looseness: 2, ..Learned::default() };
        let mut kept = Kept { learned, armings, ..Kept::default() };
        let looseness: Vec<i32> = (0..17)
            .map(|_| {
                kept = kept.after(kept.learned, false, None);
                kept.learned.looseness
            })
            .collect();
        assert_eq!(looseness, [2, 2, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0], "behind {armings}");
    }
}

#[test]
fn what_is_stored_of_a_drive_that_begins_afresh_is_forgotten() {
    let stored = after(Kept::default(), [1.4, 1.0, 1.0], 0);
    let tripped = stored.after(stored.learned, false, Some(Fault::EncoderStep));
    assert!(tripped.changed == Changed::Tripped && tripped.is_worth_storing(&stored.learned));
    let again = Kept { changed: Changed::Tripped, ..stored };
    assert!(!again.is_worth_storing(&Learned::default()), "it has changed of late");
}
