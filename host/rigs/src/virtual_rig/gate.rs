//! Admission to a virtual rig: programs that know its token stay, and callers without it never crowd them out.
//!
//! | | caller | may stay | at most |
//! |---|---|---|
//! | a caller without the token | [`GATE_WAIT`]; the one that waits longest leaves for a new one after [`HURRY`] | [`MAX_AT_GATE`] |
//! | a caller with a wrong token | unheard for [`PAUSE`](super::caller::PAUSE), then not at all | as those |
//! | a program | as long as it likes; beyond the limit the one that was silent longest leaves for a new one, but not the one that commands the drive | [`MAX_PROGRAMS`] |

use std::time::{Duration, Instant};

use super::caller::Caller;

/// Time in which a caller must show the token.
pub(super) const GATE_WAIT: Duration = Duration::from_secs(3);

/// Time that a caller has to show the token while others wait for its place.
pub(super) const HURRY: Duration = Duration::from_millis(100);

/// Callers without the token.
pub(super) const MAX_AT_GATE: usize = 32;

/// Programs that are let in.
pub(super) const MAX_PROGRAMS: usize = 64;

/// Sends away callers that have been at the gate for too long.
pub(super) fn send_away(callers: &mut Vec<Caller>, now: Instant) {
    callers.retain(|caller| caller.is_in() || now.duration_since(caller.came) < GATE_WAIT);
}

/// Makes room at the gate for another caller. Whether there is room.
pub(super) fn makes_room(callers: &mut Vec<Caller>, now: Instant) -> bool {
    if callers.iter().filter(|caller| !caller.is_in()).count() < MAX_AT_GATE {
        return true;
    }
    let waits = |caller: &&Caller| !caller.is_in() && now.duration_since(caller.came) >= HURRY;
    let Some(first) = callers.iter().filter(waits).map(|caller| caller.came).min() else { return false };
    remove(callers, |caller| !caller.is_in() && caller.came == first);
    true
}

/// Sends away programs beyond the limit, the longest silent first; never the one for which `commands` is true.
pub(super) fn shed(callers: &mut Vec<Caller>, commands: impl Fn(&Caller) -> bool) -> Vec<Caller> {
    let mut shed = Vec::new();
    while callers.iter().filter(|caller| caller.is_in()).count() > MAX_PROGRAMS {
        let idle = callers.iter().filter(|caller| caller.is_in() && !commands(caller));
        let Some(longest) = idle.map(|caller| caller.heard).min() else { break };
        let found = callers.iter().position(|caller| caller.heard == longest && !commands(caller));
        shed.extend(found.map(|at| callers.remove(at)));
    }
    shed
}

fn remove(callers: &mut Vec<Caller>, which: impl Fn(&Caller) -> bool) {
    if let Some(at) = callers.iter().position(which) {
        callers.remove(at);
    }
}
