//! The result of a drive's moves in one sentence, for its user.
//!
//! Each figure is one of the table's ([`super::table`]), over all moves and over the run and its perturbed runs: one value
//! where they agree in the digits shown, else the least and the most. Times in s, lengths in mm, air in litres (ANR).

use super::figures::{InRuns, endings, in_runs};
use super::{LimitCycle, Move};

/// A length below this is zero in the digits that are shown, mm.
const NONE_MM: f64 = 0.005;

/// A drive that ends within this of its target is said to be neither short of it nor beyond it, mm.
const NEAR_MM: f64 = 0.01;

/// The sentence: `settles within 0.05 mm after 0.148 s; overshoots by 0.01 mm; rests 0.02 mm short; 0.61 l of air a move`.
/// `runs` has the moves of the run and then those of each of its perturbed runs; `tolerance_mm` is that of their settling times.
#[must_use]
pub fn verdict(runs: &[Vec<Move>], tolerance_mm: f64) -> String {
    let mut moves: Vec<InRuns> = in_runs(runs).collect();
    let goes = |moves: &InRuns| own(moves).is_none_or(|one| !waits(one, tolerance_mm));
    if moves.iter().any(goes) {
        moves.retain(goes);
    }
    if moves.is_empty() {
        return "there is no move".to_owned();
    }
    let clauses = [commanded(&moves), follows(&moves), settles(&moves, tolerance_mm), overshoots(&moves)];
    let clauses = clauses.into_iter().chain([rests(&moves), swings(&moves), air(&moves)]);
    clauses.flatten().collect::<Vec<String>>().join("; ")
}

/// A figure over all moves and all runs that show it.
fn all(moves: &[InRuns], figure: impl Fn(&Move) -> Option<f64>) -> Vec<f64> {
    moves.iter().flatten().flatten().filter_map(|one| figure(one)).collect()
}

/// The least and the greatest value; None where there are no values.
fn ends(values: &[f64]) -> Option<[f64; 2]> {
    let each = values.iter().map(|value| [*value; 2]);
    each.reduce(|[least, most], [value, _]| [least.min(value), most.max(value)])
}

/// One value, or the least and the greatest.
fn span([least, most]: [f64; 2], decimals: usize) -> String {
    let [least, most] = [least, most].map(|value| format!("{value:.decimals$}"));
    if least == most { most } else { format!("{least} to {most}") }
}

/// The move in the run itself.
fn own<'a>(moves: &InRuns<'a>) -> Option<&'a Move> {
    moves.first().copied().flatten()
}

/// Whether a move begins at its target: the time before the first step of a test.
fn waits(one: &Move, tolerance_mm: f64) -> bool {
    one.tracking.is_none() && one.to_mm.is_some_and(|to| (to - one.from_mm).abs() <= tolerance_mm)
}

/// In open loop a move has no target.
fn commanded(moves: &[InRuns]) -> Option<String> {
    let is_open = moves.iter().filter_map(own).all(|one| one.to_mm.is_none());
    let [_, most] = ends(&all(moves, |one| Some(one.top_speed_mm_s)))?;
    is_open.then(|| format!("moves at up to {most:.0} mm/s, in open loop"))
}

fn follows(moves: &[InRuns]) -> Option<String> {
    let [_, most] = ends(&all(moves, |one| Some(one.tracking?.most_mm)))?;
    Some(format!("follows its profile within {most:.2} mm"))
}

fn settles(moves: &[InRuns], tolerance_mm: f64) -> Option<String> {
    // A profile whose setpoint leaves the range from its start to its end has no settling time.
    let is_asked = |one: &Move| one.to_mm.is_some() && (one.tracking.is_none() || one.settling_s.is_some());
    let asked = moves.iter().filter(|moves| own(moves).is_some_and(is_asked));
    let asked: Vec<InRuns> = asked.cloned().collect();
    let settled = |one: &Option<&Move>| one.is_some_and(|one| one.settling_s.is_some());
    let kept: Vec<InRuns> = asked.iter().filter(|runs| runs.iter().all(settled)).cloned().collect();
    let divided = asked.iter().filter(|runs| runs.iter().any(settled)).count() - kept.len();
    let after = ends(&all(&kept, |one| one.settling_s)).map(|ends| format!(" after {} s", span(ends, 3)));
    let after = after.unwrap_or_default();
    let often = match (kept.len(), divided, asked.len()) {
        (_, _, 0) => return None,
        (0, 0, _) => return Some(format!("settles nowhere within {tolerance_mm} mm")),
        (kept, _, all) if kept == all => String::new(),
        (kept, 0, all) => format!(", in {kept} of {all} moves"),
        (kept, divided, all) => {
            format!(", in {kept} of {all} moves, and in {divided} only in some of its runs")
        }
    };
    Some(format!("settles within {tolerance_mm} mm{after}{often}"))
}

fn overshoots(moves: &[InRuns]) -> Option<String> {
    let [least, most] = ends(&all(moves, |one| one.overshoot_mm))?;
    Some(match [least, most] {
        [_, most] if most < NONE_MM => "does not overshoot".to_owned(),
        [least, _] if least < NONE_MM => format!("overshoots by up to {most:.2} mm"),
        ends => format!("overshoots by {} mm", span(ends, 2)),
    })
}

/// How far from its target it ends: positive is short of it, in the direction of the move.
fn short_mm(one: &Move) -> Option<f64> {
    Some(one.steady_error_mm.or(one.mean_error_mm)? * (one.to_mm? - one.from_mm).signum())
}

fn rests(moves: &[InRuns]) -> Option<String> {
    let ends = ends(&all(moves, short_mm))?;
    let is_steady = moves.iter().flatten().flatten().all(|one| one.steady_error_mm.is_some());
    let is_at_rest = moves.iter().all(|runs| endings(runs)[0] == runs.len());
    let swings = moves.iter().any(|runs| endings(runs)[1] > 0);
    let place = place(ends);
    Some(match (is_at_rest, is_steady, swings) {
        (true, ..) => format!("rests {place}"),
        (_, true, true) => format!("ends on average {place}"),
        (_, true, false) => format!("ends {place}, watched too briefly to say that it rests"),
        _ => format!("still moves at the end, on average {place}"),
    })
}

/// The final position of the drive, from the least and the greatest distance short of its target, mm.
fn place([least, most]: [f64; 2]) -> String {
    if least >= -NEAR_MM && most <= NEAR_MM {
        "within 0.01 mm of its target".to_owned()
    } else if least > -NONE_MM {
        format!("{} mm short", span([least.max(0.0), most], 2))
    } else if most < NONE_MM {
        format!("{} mm beyond its target", span([(-most).max(0.0), -least], 2))
    } else {
        format!("between {most:.2} mm short and {:.2} mm beyond its target", -least)
    }
}

fn swings(moves: &[InRuns]) -> Option<String> {
    let of = |figure: fn(&LimitCycle) -> Option<f64>| {
        ends(&all(moves, |one| figure(&one.limit_cycle).filter(|value| *value > 0.0)))
    };
    let (swing, hertz) = (of(LimitCycle::swing_mm)?, of(LimitCycle::frequency_hz)?);
    Some(format!("does not come to rest: it swings by {} mm at {} Hz", span(swing, 2), span(hertz, 1)))
}

fn air(moves: &[InRuns]) -> Option<String> {
    let litres = ends(&all(moves, |one| Some(one.air?.litres)))?;
    Some(format!("{} l of air a move", span(litres, 2)))
}

#[cfg(test)]
mod tests {
    use super::super::{Air, Doubt};
    use super::*;

    /// A move of 60 mm that settles and rests short of its target.
    fn settled(number: usize) -> Move {
        Move {
            number,
            is_cut: false,
            start_s: 0.0,
            from_mm: 40.0,
            to_mm: Some(100.0),
            end_mm: 99.98,
            rise_s: Some(0.08),
            overshoot_mm: Some(0.011),
            settling_s: Some(0.1482),
            steady_error_mm: Some(0.02),
            mean_error_mm: Some(0.02),
            range_mm: 0.0,
            tracking: None,
            limit_cycle: LimitCycle::None { below_mm: 0.02, for_s: 0.5 },
            top_speed_mm_s: 612.0,
            air: Some(Air { litres: 0.6102, least: 0.61, most: 0.6104 }),
        }
    }

    #[test]
    fn a_move_that_settles_says_when_and_where_it_rests() {
        let sentence = "settles within 0.05 mm after 0.148 s; overshoots by 0.01 mm; rests 0.02 mm short; 0.61 l of air a move";
        assert_eq!(verdict(&[vec![settled(1)]], 0.05), sentence);
    }

    #[test]
    fn a_move_that_settles_nowhere_says_how_far_from_its_target_it_rests() {
        let one = Move {
            settling_s: None,
            overshoot_mm: Some(0.0),
            steady_error_mm: Some(0.73),
            air: None,
            ..settled(1)
        };
        assert_eq!(
            verdict(&[vec![one]], 0.05),
            "settles nowhere within 0.05 mm; does not overshoot; rests 0.73 mm short"
        );
    }

    /// Backwards, what is short lies above the target.
    #[test]
    fn several_moves_and_perturbed_runs_give_the_least_and_the_most() {
        let back = Move {
            from_mm: 100.0,
            to_mm: Some(40.0),
            settling_s: Some(0.2),
            overshoot_mm: Some(0.0),
            steady_error_mm: Some(0.03),
            ..settled(2)
        };
        let runs =
            [vec![settled(1), back.clone()], vec![settled(1), Move { settling_s: Some(0.25), ..back }]];
        assert_eq!(
            verdict(&runs, 0.05),
            "settles within 0.05 mm after 0.148 to 0.250 s; overshoots by up to 0.01 mm; \
             rests between 0.02 mm short and 0.03 mm beyond its target; 0.61 l of air a move"
        );
    }

    #[test]
    fn a_move_that_only_some_runs_settle_is_not_counted_among_those_that_settle() {
        let lost = Move { settling_s: None, ..settled(2) };
        let runs = [vec![settled(1), settled(2)], vec![settled(1), lost.clone()]];
        let sentence = verdict(&runs, 0.05);
        assert!(
            sentence
                .starts_with("settles within 0.05 mm after 0.148 s, in 1 of 2 moves, and in 1 only in some"),
            "{sentence}"
        );
        let sentence = verdict(&[vec![settled(1), lost]], 0.05);
        assert!(
            sentence.starts_with("settles within 0.05 mm after 0.148 s, in 1 of 2 moves; "),
            "{sentence}"
        );
    }

    #[test]
    fn the_wait_before_the_first_step_is_no_move_of_the_sentence() {
        let wait = Move { from_mm: 40.0, to_mm: Some(40.0), settling_s: Some(0.0), air: None, ..settled(1) };
        assert_eq!(verdict(&[vec![wait, settled(2)]], 0.05), verdict(&[vec![settled(1)]], 0.05));
    }

    /// It stands while its pressures change: nothing says that it rests.
    #[test]
    fn only_a_drive_that_is_known_to_rest_is_said_to_rest() {
        let limit_cycle = LimitCycle::Undecided(Doubt::Sticking { kpa_s: 1.0, still_s: 2.0 });
        let stuck = Move { limit_cycle, ..settled(1) };
        assert!(
            verdict(&[vec![settled(1)], vec![stuck]], 0.05)
                .contains("; ends 0.02 mm short, watched too briefly to say that it rests; ")
        );
        let moving = Move {
            steady_error_mm: None,
            settling_s: None,
            limit_cycle: LimitCycle::Undecided(Doubt::Moving),
            ..settled(1)
        };
        assert!(
            verdict(&[vec![moving]], 0.05).contains("; still moves at the end, on average 0.02 mm short")
        );
    }

    #[test]
    fn a_move_in_open_loop_has_a_speed_and_no_target() {
        let open = Move {
            to_mm: None,
            overshoot_mm: None,
            settling_s: None,
            steady_error_mm: None,
            mean_error_mm: None,
            ..settled(1)
        };
        assert_eq!(
            verdict(&[vec![open]], 0.05),
            "moves at up to 612 mm/s, in open loop; 0.61 l of air a move"
        );
        assert_eq!(verdict(&[Vec::new()], 0.05), "there is no move");
    }
}
