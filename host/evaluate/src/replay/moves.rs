//! The moves of a record whose file does not have them.
//!
//! Closed loop: setpoint = position + error, and a move begins where it changes. The recorder stores the error in 16
//! bits. If the error is at their limit, the nearest sample before or after with a usable error gives the setpoint,
//! provided that the error fits it.
//!
//! Open loop: the moves are commands. A move begins where the command differs from the result of the move before at
//! this position (soft limits and the drive stage limit commands).

use pneudrive_controller::law::Loop;
use pneudrive_controller::{Config, Move, Sequence};
use pneudrive_protocol::RecordedSample;

use super::ReplayError;

/// A way in which the record may have come about.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The moves; the run has no end of its own.
    pub sequence: Sequence,
    /// Whether counts mean positions.
    pub referenced: bool,
    /// Samples whose setpoint was taken from another one.
    pub inferred: Vec<bool>,
}

/// The ways in which a record of a test may have come about: a closed loop is referenced, an open one may be.
#[must_use]
pub fn of_test(config: &Config, test: &Sequence, samples: usize) -> Vec<Plan> {
    let plan = |referenced| Plan { sequence: test.clone(), referenced, inferred: vec![false; samples] };
    match config.law.control_loop {
        Loop::Closed => vec![plan(true)],
        Loop::Open => [true, false].map(plan).into(),
    }
}

/// All ways in which the record may have come about; the likelier first.
///
/// # Errors
/// When the moves cannot be found.
pub fn plans(config: &Config, recorded: &[RecordedSample]) -> Result<Vec<Plan>, ReplayError> {
    match config.law.control_loop {
        Loop::Closed => closed_loop(config, recorded),
        Loop::Open => either([true, false].map(|referenced| open_loop(config, recorded, referenced))),
    }
}

/// The possible plans; if there is none, why the first one fails.
fn either(plans: [Result<Plan, ReplayError>; 2]) -> Result<Vec<Plan>, ReplayError> {
    let [first, second] = plans;
    match second {
        Ok(second) => Ok(first.ok().into_iter().chain([second]).collect()),
        Err(_) => Ok(vec![first?]),
    }
}

fn open_loop(config: &Config, recorded: &[RecordedSample], referenced: bool) -> Result<Plan, ReplayError> {
    let mut moves = Vec::new();
    let mut target = 0;
    for (at_sample, seen) in (0..).zip(recorded) {
        let limited = if referenced { config.limits.hold_back(target, seen.position) } else { target };
        if config.limits.command(limited) != seen.command {
            target = i32::from(seen.command);
            moves.push(Move::step(at_sample, target));
        }
    }
    let inferred = vec![false; recorded.len()];
    Ok(Plan { sequence: sequence(config, &moves, recorded.len())?, referenced, inferred })
}

/// Before the first move a drive holds the count of its first sample. A run that begins with that setpoint may have begun
/// with a move to it or not. That matters only where such a move ends at rest, and so teaches the null offset.
fn closed_loop(config: &Config, recorded: &[RecordedSample]) -> Result<Vec<Plan>, ReplayError> {
    let found = setpoints(recorded)?;
    let inferred: Vec<bool> = found.iter().map(|setpoint| setpoint.inferred).collect();
    let counts: Vec<i32> = found.iter().map(|setpoint| setpoint.counts).collect();
    let held_first =
        counts.first().copied().filter(|&first| recorded.first().is_some_and(|k| k.position == first));
    let plan = |moves: &[Move]| {
        let sequence = sequence(config, moves, recorded.len())?;
        Ok(Plan { sequence, referenced: true, inferred: inferred.clone() })
    };
    let moves = changes(held_first, &counts);
    let mut plans = vec![plan(&moves)?];
    let allowed = |target: &i32| (config.limits.soft_min..=config.limits.soft_max).contains(target);
    if let Some(target) = held_first.filter(allowed)
        && config.law.learning_gain > 0
    {
        plans.extend(plan(&[&[Move::step(0, target)], moves.as_slice()].concat()));
    }
    Ok(plans)
}

/// A move wherever the setpoint changes from the one held before.
fn changes(held_first: Option<i32>, setpoints: &[i32]) -> Vec<Move> {
    let before = std::iter::once(held_first).chain(setpoints.iter().copied().map(Some));
    let pairs = (0..).zip(before.zip(setpoints));
    let changed = pairs.filter(|(_, (before, now))| *before != Some(**now));
    changed.map(|(at_sample, (_, &target))| Move::step(at_sample, target)).collect()
}

/// The sequence of these moves. It ends with a move after the last sample, if there is room: with `on_arrival` a run
/// is over with its last move, and the file does not say which move that is.
fn sequence(config: &Config, moves: &[Move], samples: usize) -> Result<Sequence, ReplayError> {
    let mut sequence = Sequence::new(u32::MAX);
    for next in moves {
        sequence.push(*next).map_err(|_| ReplayError::TooManyMoves(next.at_sample as i32))?;
    }
    let target = 0.max(config.limits.soft_min).min(config.limits.soft_max);
    // If there is no room, there are no further moves either.
    let _ = sequence.push(Move::step(samples as u32, target));
    Ok(sequence)
}

/// The setpoint of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Setpoint {
    counts: i32,
    /// Whether it was taken from another sample.
    inferred: bool,
}

/// The setpoint of each sample.
fn setpoints(recorded: &[RecordedSample]) -> Result<Vec<Setpoint>, ReplayError> {
    let mut known = Vec::with_capacity(recorded.len());
    for (k, seen) in (0..).zip(recorded) {
        known.push(setpoint_of(k, seen)?);
    }
    let mut end = 0;
    for gap in known.clone().chunk_by(|a, b| a.is_some() == b.is_some()) {
        let begin = end;
        end += gap.len();
        if gap[0].is_none() {
            fill(&mut known, recorded, begin, end)?;
        }
    }
    Ok(known.into_iter().flatten().collect())
}

/// The setpoint by position and error; None if the error is at a limit of its 16 bits.
fn setpoint_of(k: i32, seen: &RecordedSample) -> Result<Option<Setpoint>, ReplayError> {
    if matches!(seen.error, i16::MIN | i16::MAX) {
        return Ok(None);
    }
    let counts = seen.position.checked_add(i32::from(seen.error)).ok_or(ReplayError::NoSetpoint(k))?;
    Ok(Some(Setpoint { counts, inferred: false }))
}

/// Whether an error at a limit of its 16 bits can belong to this setpoint.
fn fits(setpoint: Setpoint, seen: &RecordedSample) -> bool {
    let error = i64::from(setpoint.counts) - i64::from(seen.position);
    error.clamp(i64::from(i16::MIN), i64::from(i16::MAX)) == i64::from(seen.error)
}

/// Gives the samples from `begin` to `end` the setpoint behind them as far back as it fits, and the one before
/// them up to there: an error gets large where a move begins, and smaller while it lasts.
fn fill(
    known: &mut [Option<Setpoint>],
    recorded: &[RecordedSample],
    begin: usize,
    end: usize,
) -> Result<(), ReplayError> {
    let inferred = |setpoint: Setpoint| Setpoint { inferred: true, ..setpoint };
    let after = known.get(end).copied().flatten().map(inferred);
    let before = begin.checked_sub(1).and_then(|k| known[k]).map(inferred);
    let fit =
        |setpoint: Option<Setpoint>, k: usize| setpoint.filter(|setpoint| fits(*setpoint, &recorded[k]));
    let backward = (begin..end).rev().take_while(|&k| fit(after, k).is_some()).count();
    let turn = end - backward;
    known[turn..end].fill(after);
    if let Some(first) = (begin..turn).find(|&k| fit(before, k).is_none()) {
        return Err(ReplayError::SetpointUnknown { first: first as i32, last: turn as i32 - 1 });
    }
    known[begin..turn].fill(before);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(position: i32, setpoint: i32) -> RecordedSample {
        let error = (setpoint - position).clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16;
        RecordedSample { position, error, ..RecordedSample::default() }
    }

    fn found(samples: &[(i32, i32)]) -> Result<Vec<i32>, ReplayError> {
        let recorded: Vec<RecordedSample> = samples.iter().map(|&(p, s)| at(p, s)).collect();
        setpoints(&recorded).map(|found| found.iter().map(|setpoint| setpoint.counts).collect())
    }

    #[test]
    fn an_error_within_its_bits_tells_the_setpoint() {
        assert_eq!(found(&[(0, 0), (5, 30_000), (10, -32_757)]), Ok(vec![0, 30_000, -32_757]));
    }

    #[test]
    fn a_long_step_has_the_setpoint_that_it_comes_to() {
        let step = [(0, 0), (0, 90_000), (40_000, 90_000), (60_000, 90_000), (60_000, -50_000), (0, -50_000)];
        assert_eq!(
            found(&[&step[..], &[(-30_000, -50_000)]].concat()),
            Ok(vec![0, 90_000, 90_000, 90_000, -50_000, -50_000, -50_000])
        );
    }

    #[test]
    fn a_drive_that_is_pushed_far_away_keeps_its_setpoint() {
        assert_eq!(found(&[(0, 100), (-40_000, 100), (-50_000, 100)]), Ok(vec![100; 3]));
        assert_eq!(found(&[(0, 100), (-40_000, 100), (0, -9000)]), Ok(vec![100, 100, -9000]));
    }

    #[test]
    fn a_move_without_a_sample_near_its_setpoint_is_named() {
        let far = [(0, 0), (0, 90_000), (9, 90_000), (20, 10)];
        assert_eq!(found(&far), Err(ReplayError::SetpointUnknown { first: 1, last: 2 }));
        assert_eq!(found(&far[..3]), Err(ReplayError::SetpointUnknown { first: 1, last: 2 }));
        assert_eq!(found(&far[1..3]), Err(ReplayError::SetpointUnknown { first: 0, last: 1 }));
    }

    #[test]
    fn what_is_no_setpoint_is_named() {
        let beyond = RecordedSample { position: i32::MAX, error: 1, ..RecordedSample::default() };
        assert_eq!(setpoints(&[beyond]), Err(ReplayError::NoSetpoint(0)));
    }

    #[test]
    fn a_move_begins_where_the_setpoint_is_another_one_than_before() {
        let setpoints = [9, 9, 7, 7, 9];
        let behind = [Move::step(2, 7), Move::step(4, 9)];
        assert_eq!(changes(Some(9), &setpoints), behind, "9 was held");
        let first = Move::step(0, 9);
        assert_eq!(changes(None, &setpoints), [first, behind[0], behind[1]]);
    }
}
