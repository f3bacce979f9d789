//! The trial of the watchdog: who may ask for it, and that nothing feeds the watchdog from then on.

use core::convert::Infallible;

use crate::bench::{ARM, AppBench, FakeBoard};
use embedded_io::{ErrorType, Write};
use pneudrive_app::runtime::talk::{Port, Served, Talk, Watchdog};
use pneudrive_app::{Control, Recorder};
use pneudrive_controller::{Command, Fault, Mode, Refusal};
use pneudrive_protocol::{RequestBody, code};
use rtic_core::Mutex;

/// A bench whose board has a watchdog.
fn watched() -> AppBench {
    let mut bench = AppBench::referenced();
    bench.board.has_watchdog = true;
    bench
}

fn not_now(code: u8) -> String {
    format!("Refused(NotNow({code}))")
}

#[test]
fn a_disarmed_drive_is_in_a_fault_while_its_watchdog_is_tried_and_arming_ends_that() {
    let mut bench = watched();
    assert!(bench.app.control.feeds_watchdog());
    bench.done(RequestBody::TryWatchdog);
    assert_eq!(bench.mode(), Mode::Fault(Fault::WatchdogTried));
    assert!(!bench.app.control.feeds_watchdog());
    bench.samples(3);
    assert!(bench.board.driven.iter().all(|command| *command == Command::OFF));
    bench.done(ARM);
    assert!(bench.app.control.feeds_watchdog(), "an enabled drive has a watchdog that is fed");
}

#[test]
fn a_board_without_a_watchdog_says_so_and_stays_as_it_is() {
    let mut bench = AppBench::referenced();
    assert_eq!(bench.ask(RequestBody::TryWatchdog), not_now(code::NO_WATCHDOG));
    assert_eq!(bench.mode(), Mode::Disarmed);
}

#[test]
fn an_enabled_drive_does_not_try_its_watchdog_nor_one_whose_fault_would_be_lost() {
    let mut bench = watched();
    bench.done(ARM);
    bench.refused(RequestBody::TryWatchdog, Refusal::NotDisarmed);
    assert_eq!(bench.mode(), Mode::Armed);
    bench.done(RequestBody::Stop);
    assert_eq!(bench.ask(RequestBody::TryWatchdog), not_now(code::IN_FAULT));
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop));
    assert!(bench.app.control.feeds_watchdog());
}

#[test]
fn the_watchdog_of_a_drive_that_another_host_commands_is_not_tried() {
    let mut bench = watched();
    bench.board.host_clock_ms = Some(1000);
    bench.session = 1007;
    bench.done(RequestBody::Arm { host: "one" });
    bench.session = 1008;
    let refused = bench.ask(RequestBody::TryWatchdog);
    assert!(refused.starts_with("Refused(Owned(") && refused.contains("host: \"one\""), "{refused}");
    assert_eq!(bench.mode(), Mode::Armed);
}

/// A copy that the line brings after the reset must not try it again.
#[test]
fn a_request_that_means_the_boot_before_is_refused() {
    let mut bench = watched();
    bench.board.store.boot = 4;
    (bench.session, bench.boot) = (1007, 3);
    assert_eq!(bench.ask(RequestBody::TryWatchdog), "Refused(OtherBoot { number: 4 })");
    assert_eq!(bench.mode(), Mode::Disarmed);
}

/// Nor must one that the line brings late within the boot, when the drive is disarmed once more.
#[test]
fn a_late_copy_within_a_boot_is_no_second_trial() {
    let mut bench = watched();
    bench.board.store.boot = 4;
    (bench.session, bench.boot) = (1007, 4);
    let trial = bench.frame(RequestBody::TryWatchdog);
    assert!(!bench.send(&trial).is_empty(), "it is answered");
    assert_eq!(bench.mode(), Mode::Fault(Fault::WatchdogTried));
    bench.done(RequestBody::Arm { host: "one" });
    bench.done(RequestBody::Disarm);
    assert!(bench.send(&trial).is_empty(), "a copy gets no answer");
    assert_eq!(bench.mode(), Mode::Disarmed);
    assert!(bench.app.control.feeds_watchdog());
    bench.done(RequestBody::TryWatchdog);
    assert_eq!(bench.mode(), Mode::Fault(Fault::WatchdogTried), "a request of its own is one");
}

/// A line on which nothing comes.
struct Silence;

impl ErrorType for Silence {
    type Error = Infallible;
}

impl Write for Silence {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl Port for Silence {
    fn is_free(&self) -> bool {
        true
    }

    fn read(&mut self) -> Option<u8> {
        None
    }

    fn has_collected(&self) -> bool {
        false
    }

    fn send(&mut self) {}

    fn clear_errors(&mut self) {}
}

/// How often it was fed.
#[derive(Default)]
struct Counted<'a>(Option<&'a core::cell::Cell<u32>>);

impl Watchdog for Counted<'_> {
    fn feed(&mut self) {
        if let Some(fed) = self.0 {
            fed.set(fed.get() + 1);
        }
    }
}

/// A drive whose control has run since the last round, whenever it is asked.
struct Shared {
    control: Control,
    board: FakeBoard,
    tidied: u32,
}

impl Served for Shared {
    type Board = FakeBoard;
    type Recorder = Recorder;

    fn parts(&mut self) -> (&mut Control, &mut FakeBoard) {
        (&mut self.control, &mut self.board)
    }

    fn has_run(&mut self) -> bool {
        true
    }

    fn has_time(&self) -> bool {
        true
    }

    fn keep_timing(&mut self) {}

    fn tidy_up(&mut self) -> bool {
        self.tidied += 1;
        true
    }
}

struct Locked(Shared);

impl Mutex for Locked {
    type T = Shared;

    fn lock<R>(&mut self, work: impl FnOnce(&mut Shared) -> R) -> R {
        work(&mut self.0)
    }
}

/// Writing flash feeds the watchdog of some boards, so that waits, too.
#[test]
fn the_idle_task_neither_feeds_a_watchdog_that_is_tried_nor_stores_anything() {
    let fed = core::cell::Cell::new(0);
    let mut talk = Talk::new(Silence, Counted(Some(&fed)));
    let mut drive = Locked(Shared { control: Control::default(), board: FakeBoard::default(), tidied: 0 });
    let mut rounds = |drive: &mut Locked, count: u32| {
        for _ in 0..count {
            talk.round(drive).expect("a flash that takes it");
        }
        (fed.get(), drive.0.tidied)
    };
    assert_eq!(rounds(&mut drive, 3), (3, 3));
    drive.0.control.trip(Fault::WatchdogTried);
    assert_eq!(rounds(&mut drive, 100), (3, 3));
    let Shared { control, board, .. } = &mut drive.0;
    control.arm(board).expect("it leaves the fault");
    assert_eq!(rounds(&mut drive, 2), (5, 5));
}
