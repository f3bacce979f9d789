//! The constraints on the moves of a test: order, number, profiles, and the stroke.

use pneudrive_controller::sequencer::MAX_MOVES;

use super::plan::Planned;
use super::{MOVE_FORMS, keys};
use crate::component::controller::{self, Loop};
use crate::component::{actuator, encoder, safety};
use crate::key::Key;
use crate::values::{Findings, Rig, whole_microseconds};

/// The constraints on the moves of a test by themselves and with its controller.
pub(super) fn check(rig: &Rig, findings: &mut Findings) {
    let planned = rig.planned();
    check_forms(rig, findings);
    check_moves(rig, &planned, findings);
    check_profiles(rig, &planned, findings);
    if rig.get(&controller::keys::LOOP) == Loop::Closed {
        check_setpoints(rig, &planned, findings);
    }
}

/// The forms that the moves are given in: none for those that every rig has.
fn given(rig: &Rig) -> impl DoubleEndedIterator<Item = &'static Key> {
    let is_given = |form: &&Key| match form.path == keys::MOVES.path {
        true => rig.is_set(form),
        false => rig.value(form.path).is_some(),
    };
    MOVE_FORMS.into_iter().filter(is_given)
}

/// The key that the moves come from.
fn source(rig: &Rig) -> &'static Key {
    given(rig).next_back().unwrap_or(&keys::MOVES)
}

fn check_forms(rig: &Rig, findings: &mut Findings) {
    let given: Vec<&Key> = given(rig).collect();
    if let [.., before, last] = given.as_slice() {
        findings.note(last, format!("give either {} or {}, not both", last.name(), before.name()));
    }
    if rig.get(&keys::MOVE).is_some() && rig.get(&keys::IMPULSE).is_some() {
        findings.note(&keys::IMPULSE, "goes with test.moves and test.targets, not with test.move");
    }
}

fn check_profiles(rig: &Rig, planned: &[Planned], findings: &mut Findings) {
    let key = source(rig);
    for (number, planned) in (1..).zip(planned) {
        if let Err(slip) = planned.profile {
            findings.note(key, format!("move {number}: {}", slip.advice()));
        }
    }
    let waits = rig.get(&controller::keys::EXIT_ON_DEAD_BAND);
    for (number, pair) in (2..).zip(planned.windows(2)).filter(|_| !waits) {
        let [before, next] = [pair[0], pair[1]];
        let over_s = rig.end_s(&before);
        if before.samples() > 0 && next.time_s < over_s {
            let message = format!(
                "move {number} begins at {} s, before the profile of the move before it is over, at {over_s} s: let it begin later, or raise the limits of that profile",
                next.time_s
            );
            findings.note(key, message);
        }
    }
    if waits {
        check_forced_exit(rig, planned, findings);
    }
    if planned.iter().any(|one| one.samples() > 0)
        && rig.get(&controller::keys::MODEL) != controller::ControllerKind::Sampled
    {
        findings.note(
            key,
            "profiles need controller.model = \"sampled\": the continuous controller knows steps alone",
        );
    }
}

fn check_forced_exit(rig: &Rig, planned: &[Planned], findings: &mut Findings) {
    let exit_s = rig.get(&controller::keys::FORCED_EXIT_S);
    let period_s = rig.get(&controller::keys::PERIOD_S);
    let longest_s = planned.iter().map(Planned::samples).max().unwrap_or(0) as f64 * period_s;
    if longest_s > exit_s {
        let message = format!("ends a move after {exit_s} s, but the longest profile takes {longest_s:.4} s");
        findings.note(&controller::keys::FORCED_EXIT_S, message);
    }
}

fn check_moves(rig: &Rig, planned: &[Planned], findings: &mut Findings) {
    let key = source(rig);
    let moves: Vec<(f64, i64)> = planned.iter().map(|one| (one.time_s, one.target)).collect();
    if moves.is_empty() || moves.len() > MAX_MOVES {
        findings.note(key, format!("must have 1 to {MAX_MOVES} moves, has {}", moves.len()));
    }
    if moves.iter().any(|(time, _)| whole_microseconds(*time).is_none_or(|us| us > u64::from(u32::MAX))) {
        findings.note(key, "times must be whole microseconds from 0 to 4294 s");
    }
    if moves.windows(2).any(|pair| pair[1].0 < pair[0].0) {
        findings.note(key, "must be in order of time");
    }
    let last = moves.last().map_or(0.0, |(time, _)| *time);
    // A whole sample between them, so that the last move is in force at one at least.
    let shortest = last + rig.get(&controller::keys::PERIOD_S);
    if rig.get(&keys::REPEAT_EVERY_S).is_some_and(|round| round < shortest) {
        let message = format!("must be a sample period longer than the time of the last move, {last} s");
        findings.note(&keys::REPEAT_EVERY_S, message);
    }
    if moves.iter().any(|(_, target)| i32::try_from(*target).is_err()) {
        findings.note(key, "counts must fit 32 bits");
    }
    if rig.get(&controller::keys::EXIT_ON_DEAD_BAND) && rig.targets().is_none() {
        let message = "needs test.targets: timed moves do not wait for the end of the one before";
        findings.note(&controller::keys::EXIT_ON_DEAD_BAND, message);
    }
}

/// A setpoint that the cylinder cannot reach is a slip of units as a rule.
fn check_setpoints(rig: &Rig, planned: &[Planned], findings: &mut Findings) {
    let mm_per_count = encoder::mm_per_count(rig);
    for (end, side) in [(&safety::keys::END_MIN_MM, -1.0), (&safety::keys::END_MAX_MM, 1.0)] {
        let Some(mm) = rig.get(end) else { continue };
        let beyond = |target: &i64| side * (*target as f64 * mm_per_count - mm) > 0.0;
        if let Some(target) = planned.iter().flat_map(Planned::extremes).find(beyond) {
            findings.note(end, format!("setpoint {target} lies beyond it"));
        }
    }
    let stroke = encoder::counts_of(rig, rig.get(&actuator::keys::STROKE_M));
    let outside = |target: &i64| *target < 0 || *target > stroke;
    for target in planned.iter().filter_map(|one| one.extremes().into_iter().find(outside)) {
        let message = format!("setpoint {target} is outside the stroke of 0 to {stroke} counts");
        findings.note(source(rig), message);
    }
}
