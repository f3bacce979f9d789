//! Copies of requests that come after a reset of the drive: none may arm, move or change it.

use crate::bench::AppBench;
use pneudrive_app::App;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Command, Mode};
use pneudrive_protocol::{RequestBody, Values};

/// A referenced drive in its first boot, and a host that means it.
fn first_boot() -> AppBench {
    let mut bench = AppBench::referenced();
    bench.board.store.boot = 1;
    bench.boot = 1;
    bench
}

impl AppBench {
    /// The drive begins anew, with its axis referenced.
    fn reset(&mut self) {
        *self.app = App::default();
        self.app.control.set_referenced().expect("a new drive is disarmed");
        self.board.store.boot += 1;
    }

    /// The same, and the host has connected to it again.
    fn reset_and_met(&mut self) {
        self.reset();
        self.boot = self.board.store.boot;
    }

    /// Carries out a request, and tells the frame that it came in.
    fn done_in(&mut self, body: RequestBody<'_>) -> Vec<u8> {
        let frame = self.frame(body);
        assert!(!self.send(&frame).is_empty(), "{body:?}");
        frame
    }
}

#[test]
fn a_drive_tells_its_boot() {
    let mut bench = first_boot();
    assert_eq!(bench.ask(RequestBody::Boot), "Boot { number: 1 }");
    bench.reset();
    assert_eq!(bench.ask(RequestBody::Boot), "Boot { number: 2 }", "whatever boot the host means");
}

#[test]
fn copies_of_arming_and_homing_from_before_a_reset_do_not_move_the_drive() {
    let mut bench = first_boot();
    let arm = bench.done_in(RequestBody::Arm { host: "one" });
    let home = bench.done_in(RequestBody::Home);
    assert_eq!(bench.mode(), Mode::Homing);
    bench.reset();
    bench.send(&arm);
    bench.send(&home);
    bench.samples(3);
    assert_eq!(bench.mode(), Mode::Disarmed);
    assert!(bench.board.driven.iter().rev().take(3).all(|command| *command == Command::OFF));
}

#[test]
fn a_copy_of_homing_does_not_move_a_drive_that_its_host_has_armed_again_since() {
    let mut bench = first_boot();
    bench.done(RequestBody::Arm { host: "one" });
    let home = bench.done_in(RequestBody::Home);
    bench.reset_and_met();
    bench.done(RequestBody::Arm { host: "one" });
    bench.send(&home);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Armed);
}

#[test]
fn a_request_for_another_boot_is_refused_with_the_number_of_this_one_and_changes_nothing() {
    let mut room = [0; 4];
    let values = Values::fill(&mut room, [7]).expect("room");
    let set = RequestBody::ConfigSet { first_id: id::VELOCITY_GAIN, values };
    let mut bench = first_boot();
    bench.reset();
    for body in [
        set,
        RequestBody::Arm { host: "one" },
        RequestBody::TakeOver { host: "one" },
        RequestBody::Leave,
        RequestBody::Start { crc32: 0 },
        RequestBody::Home,
        RequestBody::Reference { position_counts: 5 },
        RequestBody::ChangeTake { crc32: 0 },
        RequestBody::ConfigSave,
        RequestBody::StreamBegin { every: 1, batch: 1 },
    ] {
        let before = bench.app.control.clone();
        assert_eq!(bench.ask(body), "Refused(OtherBoot { number: 2 })", "{body:?}");
        assert!(bench.app.control == before, "{body:?}");
    }
}

#[test]
fn stopping_disarming_and_reading_count_in_any_boot() {
    let mut bench = first_boot();
    bench.reset_and_met();
    bench.done(RequestBody::Arm { host: "one" });
    bench.boot = 1;
    assert!(bench.ask(RequestBody::Status).starts_with("Status"));
    bench.done(RequestBody::Disarm);
    bench.done(RequestBody::Stop);
}

#[test]
fn a_copy_from_before_a_reset_is_no_sign_that_its_host_is_there() {
    let mut bench = first_boot();
    bench.board.host_clock_ms = Some(0);
    let status = bench.done_in(RequestBody::Status);
    bench.reset_and_met();
    bench.done(RequestBody::Arm { host: "one" });
    bench.done(RequestBody::Home);
    for _ in 0..4 {
        bench.board.host_clock_ms = bench.board.host_clock_ms.map(|now| now + 200);
        bench.send(&status);
        bench.samples(1);
    }
    assert!(matches!(bench.mode(), Mode::Fault(_)), "nobody was heard for 800 ms");
}

/// It has told no host of a boot, so a request that names one is from an earlier boot.
#[test]
fn a_drive_that_cannot_tell_its_boots_apart_refuses_requests_that_name_one() {
    let mut bench = first_boot();
    let arm = bench.done_in(RequestBody::Arm { host: "one" });
    bench.reset();
    bench.board.store.boot = 0;
    bench.send(&arm);
    assert_eq!(bench.mode(), Mode::Disarmed, "the flash has failed since");
    assert_eq!(bench.ask(RequestBody::Arm { host: "one" }), "Refused(OtherBoot { number: 0 })");
    bench.boot = 0;
    assert_eq!(bench.ask(RequestBody::Boot), "Boot { number: 0 }");
    bench.done(RequestBody::Arm { host: "one" });
}

#[test]
fn copies_from_before_a_reset_do_not_make_the_drive_forget_what_it_has_carried_out_since() {
    let mut bench = first_boot();
    let stale: Vec<_> = (0..8).map(|_| bench.done_in(RequestBody::Leave)).collect();
    bench.reset_and_met();
    let arm = bench.done_in(RequestBody::Arm { host: "one" });
    bench.done(RequestBody::Disarm);
    for copy in &stale {
        bench.send(copy);
    }
    assert_eq!(bench.send(&arm), [], "a copy of what was carried out in this boot");
    assert_eq!(bench.mode(), Mode::Disarmed);
}
