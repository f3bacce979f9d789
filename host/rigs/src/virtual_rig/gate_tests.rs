//! Callers without a token hold up nobody who has it.

use std::time::Instant;

use pneudrive_protocol::RequestBody;
use pneudrive_sim::Rig;

use super::caller::{Caller, PAUSE, Token};
use super::gate::{GATE_WAIT, HURRY, MAX_AT_GATE, MAX_PROGRAMS, makes_room, send_away, shed};
use super::test_line::Line;
use super::{Pace, VirtualRig};

const SECRET: &str = "correct horse battery staple";

fn caller() -> (Line, Caller) {
    let line = Line::default();
    (line.clone(), Caller::new(line, Some(Token::new(SECRET).expect("long enough"))))
}

fn rig() -> VirtualRig {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    VirtualRig::new(rig, 0, Pace { fast: false, live: false }).expect("a rig")
}

/// A caller that has shown the token.
fn program(rig: &mut VirtualRig) -> Caller {
    let (line, caller) = caller();
    line.ask(1, RequestBody::Token { token: SECRET });
    let mut one = vec![caller];
    rig.hear(&mut one);
    one.pop().filter(Caller::is_in).expect("it knows the token")
}

#[test]
fn who_shows_no_token_leaves_after_a_while_and_a_program_stays() {
    let mut rig = rig();
    let mut callers = vec![program(&mut rig), caller().1];
    send_away(&mut callers, Instant::now());
    assert_eq!(callers.len(), 2);
    send_away(&mut callers, Instant::now() + GATE_WAIT);
    assert!(callers.len() == 1 && callers[0].is_in());
}

#[test]
fn a_full_gate_makes_room_by_the_one_that_waits_longest_and_never_by_a_program() {
    let mut rig = rig();
    let mut callers = vec![program(&mut rig)];
    while callers.len() <= MAX_AT_GATE {
        let now = Instant::now();
        assert!(makes_room(&mut callers, now));
        callers.push(caller().1);
    }
    let first = callers[1].came;
    assert!(!makes_room(&mut callers, first), "each has a moment to show the token");
    let next = callers[2].came;
    assert!(makes_room(&mut callers, Instant::now() + HURRY));
    assert_eq!(callers.len(), MAX_AT_GATE);
    assert!(callers[0].is_in() && callers[1].came == next, "the first stranger has left");
}

#[test]
fn a_wrong_token_is_kept_waiting_and_then_sent_away_and_no_second_one_is_heard() {
    let mut rig = rig();
    let (line, caller) = caller();
    let mut callers = vec![caller];
    line.ask(1, RequestBody::Token { token: "correct horse battery stapler" });
    rig.hear(&mut callers);
    line.ask(1, RequestBody::Token { token: SECRET });
    rig.hear(&mut callers);
    assert!(callers.len() == 1 && !callers[0].is_in(), "it is not heard any more");
    std::thread::sleep(PAUSE);
    rig.hear(&mut callers);
    assert!(callers.is_empty());
}

#[test]
fn programs_beyond_the_limit_leave_the_one_that_commands_alone() {
    let mut rig = rig();
    let mut callers: Vec<Caller> = (0..MAX_PROGRAMS + 2).map(|_| program(&mut rig)).collect();
    let (owner, idle) = (callers[0].heard, callers[1].heard);
    let gone = shed(&mut callers, |caller| caller.heard == owner);
    assert_eq!((gone.len(), callers.len()), (2, MAX_PROGRAMS));
    assert!(callers[0].heard == owner && gone[0].heard == idle);
}
