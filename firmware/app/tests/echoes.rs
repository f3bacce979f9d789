//! A line that is coupled into itself brings back to the rig what the rig has said. Nothing of it is a request.

use crate::bench::{ARM, AppBench};
use pneudrive_app::App;
use pneudrive_controller::{Fault, Mode};
use pneudrive_protocol::RequestBody;

/// Everything that the rig says comes back to it, and what it says to that, until it says nothing.
fn echoed(bench: &mut AppBench, body: RequestBody<'_>) {
    let frame = bench.frame(body);
    let mut said = bench.send(&frame);
    for _ in 0..10 {
        said = bench.send(&said);
        if said.is_empty() {
            return;
        }
    }
    panic!("the rig talks to itself after {body:?}");
}

#[test]
fn an_echo_of_its_own_replies_neither_arms_nor_starts_nor_stops_a_drive() {
    let mut bench = AppBench::referenced();
    bench.armed(100, 1, 0);
    bench.done(RequestBody::Disarm);
    echoed(&mut bench, RequestBody::RecordInfo);
    assert_eq!(bench.mode(), Mode::Disarmed, "not armed by its own record");
    bench.done(ARM);
    echoed(&mut bench, RequestBody::RecordRead { crc32: 0, first: 7, count: 1 });
    assert_eq!(bench.mode(), Mode::Armed, "not started by its own refusal");
    bench.done(bench.start_request());
    bench.samples(5);
    for body in [
        RequestBody::Motion,
        bench.read(0, 1),
        RequestBody::Info,
        RequestBody::Status,
        RequestBody::Timing,
        RequestBody::StreamBegin { every: 1, batch: 1 },
    ] {
        echoed(&mut bench, body);
        assert_eq!(bench.mode(), Mode::Running, "{body:?}");
    }
}

#[test]
fn rows_that_come_back_are_not_taken_for_the_host() {
    let mut bench = AppBench::referenced();
    bench.board.host_clock_ms = Some(1000);
    bench.done(RequestBody::StreamBegin { every: 1, batch: 1 });
    bench.done(RequestBody::StreamGrant { until: 1000 });
    bench.armed(1000, 1, 0);
    bench.done(bench.start_request());
    for _ in 0..6 {
        bench.board.host_clock_ms = bench.board.host_clock_ms.map(|ms| ms + 100);
        bench.samples(1);
        let app = &mut *bench.app;
        app.server.attend(&mut app.control);
        let mut rows = Vec::new();
        let Ok(()) = app.server.speak(&mut rows);
        if bench.mode() == Mode::Running {
            assert!(!rows.is_empty());
        }
        assert_eq!(bench.send(&rows), []);
    }
    assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent), "the host has gone, its line echoes");
}

/// A line may hold it back over the reset.
#[test]
fn what_a_rig_has_said_before_a_reset_neither_arms_nor_moves_it() {
    for (name, boot) in [("no record", 7), ("no numbers of boots", 0)] {
        let mut bench = AppBench::referenced();
        bench.board.store.boot = boot;
        bench.boot = boot;
        let said = [RequestBody::RecordInfo, RequestBody::Boot, bench.start_request()].map(|body| {
            let frame = bench.frame(body);
            bench.send(&frame)
        });
        *bench.app = App::default();
        bench.app.control.set_referenced().expect("a new drive is disarmed");
        bench.board.store.boot += u32::from(boot > 0);
        for frame in &said {
            bench.send(frame);
            assert_eq!(bench.mode(), Mode::Disarmed, "{name}");
        }
    }
}
