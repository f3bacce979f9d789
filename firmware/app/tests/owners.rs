//! Two hosts at one drive: the one that has armed it commands, the others read and stop.

use crate::bench::AppBench;
use pneudrive_controller::{Command, Fault, Mode, Refusal};
use pneudrive_protocol::{ReplyBody, RequestBody, code};

const ONE: u32 = 0xfeed_beef;
const OTHER: u32 = 1007;

/// A bench with a clock, whose drive the host `ONE` has armed for a test of 1000 samples.
fn armed_by_one() -> AppBench {
    let mut bench = AppBench::referenced();
    bench.board.host_clock_ms = Some(1000);
    bench.test(1000, 1, 0);
    bench.session = ONE;
    bench.done(RequestBody::Arm { host: "one" });
    bench
}

impl AppBench {
    fn is_owned(&mut self, body: RequestBody<'_>) {
        let refused = self.ask(body);
        assert!(refused.starts_with("Refused(Owned(") && refused.contains("host: \"one\""), "{refused}");
    }

    fn owner(&mut self) -> (String, u32, u32) {
        self.ask_for(RequestBody::Owner, |reply| match reply {
            ReplyBody::Owner(owner) => (format!("{:?}", owner.presence), owner.session, owner.silent_ms),
            other => panic!("{other:?}"),
        })
    }

    fn waits(&mut self, ms: u64) {
        self.board.host_clock_ms = self.board.host_clock_ms.map(|now| now + ms);
        self.samples(1);
    }
}

#[test]
fn while_its_owner_is_there_another_host_reads_and_stops_and_does_nothing_else() {
    let mut bench = armed_by_one();
    bench.session = OTHER;
    for body in [
        RequestBody::Disarm,
        RequestBody::Arm { host: "other" },
        RequestBody::TakeOver { host: "other" },
        bench.start_request(),
        RequestBody::Home,
        RequestBody::Reference { position_counts: 5 },
        RequestBody::ConfigSave,
        RequestBody::ChangePart { crc32: 0, first: 0, part: &[] },
        RequestBody::ChangeTake { crc32: 0 },
    ] {
        bench.is_owned(body);
    }
    assert_eq!(bench.mode(), Mode::Armed);
    for body in [
        RequestBody::Info,
        RequestBody::Status,
        RequestBody::ConfigGet { first_id: 1, count: 2 },
        RequestBody::RecordInfo,
        RequestBody::Motion,
        RequestBody::ConfigState,
        RequestBody::Events { first: 0, count: 1 },
        RequestBody::Timing,
        RequestBody::StreamBegin { every: 0, batch: 1 },
    ] {
        let reply = bench.ask(body);
        assert!(!reply.starts_with("Refused"), "{body:?}: {reply}");
    }
    bench.done(RequestBody::Leave);
    assert_eq!(bench.owner(), ("There".to_owned(), ONE, 0), "who does not own it cannot leave it");
    bench.done(RequestBody::Stop);
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop));
    assert_eq!(bench.owner(), ("Nobody".to_owned(), 0, 0), "a trip ends the ownership");
    bench.done(RequestBody::Arm { host: "other" });
    assert_eq!(bench.owner(), ("There".to_owned(), OTHER, 0));
}

#[test]
fn an_owner_that_leaves_or_falls_silent_can_be_disarmed_and_taken_over_but_not_started() {
    for leaves in [true, false] {
        for body in
            [RequestBody::Disarm, RequestBody::Arm { host: "other" }, RequestBody::TakeOver { host: "other" }]
        {
            let mut bench = armed_by_one();
            if leaves {
                bench.done(RequestBody::Leave);
            } else {
                bench.waits(501);
            }
            bench.session = OTHER;
            assert_eq!(bench.owner(), ("Gone".to_owned(), ONE, if leaves { 0 } else { 501 }));
            bench.is_owned(bench.start_request());
            bench.done(body);
            if body == RequestBody::Disarm {
                assert_eq!(bench.mode(), Mode::Disarmed);
            } else {
                assert_eq!(bench.owner(), ("There".to_owned(), OTHER, 0));
                bench.done(bench.start_request());
            }
        }
    }
}

#[test]
fn an_owner_that_was_only_silent_commands_again_unless_another_host_has_taken_over() {
    let mut bench = armed_by_one();
    bench.waits(501);
    bench.ask(RequestBody::Status);
    assert_eq!(bench.owner(), ("There".to_owned(), ONE, 0));
    bench.waits(501);
    bench.session = OTHER;
    bench.done(RequestBody::TakeOver { host: "other" });
    bench.session = ONE;
    let refused = bench.ask(bench.start_request());
    assert!(refused.contains("host: \"other\""), "{refused}");
}

/// The line had held the request back, and its program had given up: the drive moved for half a second until it missed it.
#[test]
fn a_start_that_comes_after_a_silence_of_its_host_moves_nothing_until_that_has_armed_or_taken_over_again() {
    for body in [armed_by_one().start_request(), RequestBody::Home] {
        for again in [RequestBody::Arm { host: "one" }, RequestBody::TakeOver { host: "one" }] {
            for heard_before in [false, true] {
                let mut bench = armed_by_one();
                bench.waits(501);
                if heard_before {
                    bench.ask(RequestBody::Status);
                }
                assert_eq!(
                    bench.ask(body),
                    format!("Refused(NotNow({}))", code::HOST_WAS_SILENT),
                    "{body:?}"
                );
                assert_eq!(bench.mode(), Mode::Armed);
                bench.done(again);
                bench.done(body);
            }
        }
    }
    let mut in_time = armed_by_one();
    in_time.waits(500);
    in_time.done(in_time.start_request());
}

#[test]
fn an_owner_that_has_left_must_take_over_as_anybody_else() {
    let mut bench = armed_by_one();
    bench.done(RequestBody::Leave);
    bench.is_owned(bench.start_request());
    bench.done(RequestBody::TakeOver { host: "one" });
    bench.done(bench.start_request());
}

#[test]
fn nobody_takes_over_what_nobody_has_armed() {
    let mut bench = AppBench::referenced();
    bench.session = OTHER;
    bench.refused(RequestBody::TakeOver { host: "other" }, Refusal::NotArmed);
    assert_eq!(bench.mode(), Mode::Disarmed);
}

/// A monitor kept a drive moving for fifteen seconds after its host had been killed.
#[test]
fn the_silence_of_the_owner_trips_a_run_whoever_else_talks() {
    let mut bench = armed_by_one();
    bench.done(bench.start_request());
    bench.session = OTHER;
    for _ in 0..5 {
        bench.waits(100);
        bench.ask(RequestBody::Status);
        assert_eq!(bench.mode(), Mode::Running);
    }
    bench.waits(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent));
}

#[test]
fn an_owner_that_leaves_while_its_drive_moves_is_missed_as_if_it_were_silent() {
    let mut bench = armed_by_one();
    bench.done(bench.start_request());
    bench.done(RequestBody::Leave);
    bench.waits(500);
    bench.ask(RequestBody::Status);
    assert_eq!(bench.mode(), Mode::Running);
    bench.waits(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent));
}

#[test]
fn a_name_of_a_host_that_is_too_long_is_cut() {
    let mut bench = AppBench::referenced();
    bench.done(RequestBody::Arm { host: &"n".repeat(60) });
    assert!(bench.ask(RequestBody::Owner).contains(&format!("\"{}\"", "n".repeat(32))));
}

/// An armed drive of `ONE`, its run over.
fn done_by_one() -> AppBench {
    let mut bench = armed_by_one();
    bench.done(bench.start_request());
    bench.samples(1002);
    assert_eq!(bench.mode(), Mode::Done);
    bench
}

#[test]
fn a_drive_that_holds_or_is_armed_is_disarmed_without_a_fault_a_minute_after_its_owner_is_gone() {
    for bench in [armed_by_one(), done_by_one()] {
        let mut silent = bench;
        let before = silent.mode();
        silent.session = OTHER;
        silent.waits(60_500);
        silent.ask(RequestBody::Status);
        assert_eq!(silent.mode(), before, "half a second of silence and a minute");
        silent.waits(1);
        assert_eq!(silent.mode(), Mode::Disarmed, "another host that looks on holds nothing");
        assert_eq!(silent.board.driven.last(), Some(&Command::OFF));
        assert_eq!(silent.ask(RequestBody::Events { first: 0, count: 1 }), NO_EVENTS);
    }
    let mut left = done_by_one();
    left.done(RequestBody::Leave);
    left.waits(60_000);
    assert_eq!(left.mode(), Mode::Done);
    left.waits(1);
    assert_eq!(left.mode(), Mode::Disarmed);
}

/// The log of a drive without a fault.
const NO_EVENTS: &str = "Events { total: 0, first: 0, events: [] }";

#[test]
fn a_drive_whose_owner_is_heard_holds_as_long_as_it_likes() {
    let mut bench = done_by_one();
    for _ in 0..1000 {
        bench.waits(400);
        bench.ask(RequestBody::Status);
    }
    assert_eq!(bench.mode(), Mode::Done, "for 400 s");
}

#[test]
fn a_drive_that_holds_and_is_pushed_at_a_wide_open_valve_without_moving_trips() {
    let mut bench = armed_by_one();
    bench.done(bench.start_request());
    bench.samples(1000);
    bench.board.stands = true;
    bench.samples(2);
    assert_eq!(bench.mode(), Mode::Done);
    bench.samples(600);
    assert_eq!(bench.mode(), Mode::Fault(Fault::NoMotion));
}

/// A gateway repeats what it has, byte for byte, again and again; the drive trips as if the line were silent.
#[test]
fn what_a_gateway_repeats_of_a_silent_owner_keeps_no_drive_moving() {
    for repeated in [1, 3] {
        let mut bench = armed_by_one();
        bench.done(bench.start_request());
        let frames: Vec<_> = (0..repeated).map(|_| bench.frame(RequestBody::Status)).collect();
        for frame in &frames {
            bench.waits(100);
            assert!(!bench.send(frame).is_empty(), "answered");
        }
        assert_eq!(bench.mode(), Mode::Running);
        for frame in frames.iter().cycle().take(6) {
            bench.waits(100);
            bench.send(frame);
        }
        assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent), "{repeated} repeated");
    }
}

#[test]
fn the_request_that_arms_is_no_sign_of_life_when_it_is_repeated() {
    let mut bench = armed_by_one();
    let arms = bench.frame(RequestBody::Arm { host: "one" });
    bench.send(&arms);
    bench.done(bench.start_request());
    for _ in 0..6 {
        bench.waits(100);
        bench.send(&arms);
    }
    assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent));
}

/// 65,536 requests are two minutes of polling.
#[test]
fn an_owner_whose_numbers_wrap_is_heard_on() {
    let mut bench = armed_by_one();
    bench.sequence = u16::MAX - 3;
    bench.done(RequestBody::Arm { host: "one" });
    bench.done(bench.start_request());
    for _ in 0..8 {
        bench.waits(400);
        let frame = bench.frame(RequestBody::Status);
        bench.send(&frame);
    }
    assert_eq!(bench.mode(), Mode::Running);
}
