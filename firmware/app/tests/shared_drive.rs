//! The control goes on between the pieces of a request: what a request reads is of one state, and what it changes is whole.

use crate::bench::{ARM, AppBench, FakeBoard};
use pneudrive_app::{Control, Recorder, SharedDrive};
use pneudrive_controller::choice::{Adapt, Law};
use pneudrive_controller::law::cascade::kept::Changed;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Config, Fault, Mode};
use pneudrive_protocol::change::Entry;
use pneudrive_protocol::{RequestBody, Values};

/// A drive whose control runs before each piece of work.
struct Interrupted<'a> {
    control: &'a mut Control,
    board: &'a mut FakeBoard,
    pieces: u32,
    /// Before this piece it trips.
    trips_at: Option<u32>,
}

impl SharedDrive for Interrupted<'_> {
    type Recorder = Recorder;
    type Board = FakeBoard;

    fn lock<T>(&mut self, work: impl FnOnce(&mut Control, &mut FakeBoard) -> T) -> T {
        self.control.on_sample(self.board);
        self.control.on_output(self.board);
        self.board.now_us += 1300;
        if self.trips_at == Some(self.pieces) {
            self.control.trip(Fault::LateSample);
        }
        self.pieces += 1;
        work(self.control, self.board)
    }
}

/// The replies to a request between whose pieces samples come, and how many pieces it has.
fn interrupted(bench: &mut AppBench, body: RequestBody<'_>) -> (Vec<u8>, u32) {
    tripping(bench, body, None)
}

/// The same of a drive that trips before one of them.
fn tripping(bench: &mut AppBench, body: RequestBody<'_>, trips_at: Option<u32>) -> (Vec<u8>, u32) {
    let (frame, mut replies) = (bench.frame(body), Vec::new());
    let (control, board) = (&mut bench.app.control, &mut bench.board);
    let mut drive = Interrupted { control, board, pieces: 0, trips_at };
    let Ok(()) = bench.app.server.receive_beside(&frame, &mut drive, &mut replies);
    (replies, drive.pieces)
}

fn set(bench: &mut AppBench, first_id: u16, value: i32) {
    let mut room = [0; 4];
    bench.done(RequestBody::ConfigSet { first_id, values: Values::fill(&mut room, [value]).expect("room") });
}

/// A drive that has run and holds.
fn holding(samples: u32) -> AppBench {
    let mut bench = AppBench::referenced();
    bench.board.stands = true;
    bench.armed(samples, 1, 0);
    bench.done(bench.start_request());
    bench.samples(samples + 2);
    assert_eq!(bench.mode(), Mode::Done);
    bench
}

#[test]
fn a_record_and_parameters_are_read_between_samples_as_without_them() {
    for body in [
        RequestBody::RecordInfo,
        holding(200).read(7, 32),
        RequestBody::ConfigGet { first_id: id::GAIN_PROFILE, count: 64 },
        RequestBody::ConfigState,
    ] {
        let [mut alone, mut beside] = [holding(200), holding(200)];
        let frame = alone.frame(body);
        let (replies, pieces) = interrupted(&mut beside, body);
        assert_eq!(replies, alone.send(&frame), "{body:?}");
        assert!(pieces > 1, "{body:?} is of one piece");
        assert_eq!(beside.mode(), Mode::Done);
    }
}

/// What was learned is prepared in a piece and put in force in another.
#[test]
fn an_arm_between_samples_puts_in_force_what_was_learned_and_nothing_else() {
    let mut bench = AppBench::referenced();
    set(&mut bench, id::LEARNING_GAIN, 256);
    bench.board.stands = true;
    let test = Entry::Test { name: "learn", last_sample: 9, round: 0, decimation: 1, pre_trigger: 0 };
    bench.takes(&[test, Entry::Move { at_sample: 0, target: 500 }, Entry::Move { at_sample: 4, target: 7 }]);
    bench.done(ARM);
    bench.done(bench.start_request());
    bench.samples(11);
    let learned = bench.app.control.state().learned_null_offset();
    assert_ne!(learned, 0);
    let mut expected = bench.app.control.parameters().clone();
    expected.set(id::NULL_OFFSET_COUNTS, learned).expect("in range");

    let (_, pieces) = interrupted(&mut bench, ARM);
    assert!(pieces > 3, "{pieces}");
    let control = &bench.app.control;
    assert_eq!((bench.mode(), control.state().learned_null_offset()), (Mode::Armed, 0));
    assert_eq!(control.parameters(), &expected);
    assert_eq!(control.config(), &Config::new(&expected).expect("they go together"));
    let hash = pneudrive_app::storage::configuration_hash(&expected);
    assert_eq!(control.configuration().hash(), hash, "what the host compares before a start");
}

/// A drive that keeps what it learns and has kept twice the mass, so many samples after the start of a run of ten.
fn keeping(samples: u32) -> AppBench {
    let mut bench = AppBench::referenced();
    for (id, value) in [
        (id::CASCADE_STROKE, 25_000),
        (id::LAW, Law::Cascade as i32),
        (id::ADAPT, Adapt::Kept as i32),
        (id::KEPT_MASS, 131_072),
    ] {
        set(&mut bench, id, value);
    }
    bench.board.stands = true;
    let test = Entry::Test { name: "keep", last_sample: 9, round: 0, decimation: 1, pre_trigger: 0 };
    bench.takes(&[test, Entry::Move { at_sample: 0, target: 0 }]);
    bench.done(ARM);
    bench.done(bench.start_request());
    bench.samples(samples);
    bench
}

fn parameter(bench: &AppBench, id: u16) -> i32 {
    bench.app.control.parameters().get(id).expect("a parameter")
}

/// It was lost if the run ended between the two pieces of the arming.
#[test]
fn an_arm_that_comes_as_a_run_ends_keeps_what_that_has_learned() {
    let mut armed = 0;
    for samples in 1..=12 {
        let mut bench = keeping(samples);
        let _ = interrupted(&mut bench, ARM);
        if bench.mode() == Mode::Armed {
            assert_eq!(parameter(&bench, id::KEPT_ARMINGS), 1, "after {samples} samples");
            armed += 1;
        }
    }
    assert!((2..12).contains(&armed), "{armed}");
}

/// It was kept all the same if the drive tripped between the two pieces of the arming.
#[test]
fn what_has_tripped_a_drive_while_it_was_armed_again_is_not_kept() {
    let (_, pieces) = interrupted(&mut keeping(12), ARM);
    for piece in 0..pieces {
        let mut bench = keeping(12);
        let _ = tripping(&mut bench, ARM, Some(piece));
        if bench.mode() != Mode::Armed {
            // It has tripped behind the arming: the next one tells.
            bench.done(ARM);
        }
        let kept = [id::KEPT_MASS, id::KEPT_CHANGED].map(|id| parameter(&bench, id));
        assert_eq!(kept, [65_536, Changed::Tripped as i32], "before piece {piece} of {pieces}");
    }
}

#[test]
fn a_stop_takes_effect_at_the_output_behind_its_piece() {
    let mut bench = AppBench::referenced();
    bench.armed(100, 1, 0);
    bench.done(bench.start_request());
    bench.samples(3);
    let _ = interrupted(&mut bench, RequestBody::Stop);
    bench.samples(1);
    assert_eq!(bench.board.driven.last().map(|command| command.drive_enable), Some(false));
}
