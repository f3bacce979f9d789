//! A board whose plant is at a line: it greets, works in lock step, and notices silence.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use pneudrive_app::fault_log::MEMORY_BYTES;
use pneudrive_app::lock_step::Stopwatch;
use pneudrive_app::plant_bus::{HELLO, Inputs, Next, Outputs, Tempo};
use pneudrive_app::plant_link::{Line, PATIENCE_MS, PlantLink};
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::store::{FlashStore, Store};
use pneudrive_app::{Board, Control, LockStep};
use pneudrive_controller::{Fault, Mode, Sample};
use pneudrive_protocol::change::Entry;

type Kept = FlashStore<RamFlash, [u8; MEMORY_BYTES]>;

/// What goes over the line; the test is the plant.
#[derive(Default)]
struct Wire {
    said: Vec<Vec<u8>>,
    awaited: usize,
    come: Vec<u8>,
}

#[derive(Clone, Default)]
struct FakeLine(Rc<RefCell<Wire>>);

impl Line for FakeLine {
    fn ask<const N: usize>(&mut self, bytes: [u8; N], answer_bytes: usize) {
        let mut wire = self.0.borrow_mut();
        wire.said.push(bytes.to_vec());
        wire.come.clear();
        wire.awaited = answer_bytes;
    }

    fn answer<const N: usize>(&mut self) -> Option<[u8; N]> {
        let wire = self.0.borrow();
        assert_eq!(wire.awaited, N, "the answer that was asked for");
        wire.come.get(..N)?.try_into().ok()
    }
}

/// A clock of 10 ticks a millisecond, about to wrap, that the test turns.
#[derive(Clone)]
struct FakeWatch(Rc<Cell<u32>>);

const TICKS_PER_MS: u32 = 10;

impl Stopwatch for FakeWatch {
    fn now(&self) -> u32 {
        self.0.get()
    }
    fn since(&self, reading: u32) -> u32 {
        self.0.get().wrapping_sub(reading)
    }
}

struct PlantLinkBench {
    control: Box<Control>,
    board: LockStep<Kept>,
    link: PlantLink<FakeLine>,
    wire: FakeLine,
    watch: FakeWatch,
}

impl PlantLinkBench {
    /// A board that has greeted once.
    fn new() -> PlantLinkBench {
        let (wire, watch) = (FakeLine::default(), FakeWatch(Rc::new(Cell::new(u32::MAX - 500))));
        let kept = FlashStore::take_up(RamFlash::default(), RamFlash::layout(), [0; MEMORY_BYTES]);
        let mut control = Box::<Control>::default();
        control.set_referenced().expect("disarmed");
        let link = PlantLink::new(wire.clone(), TICKS_PER_MS, &watch);
        PlantLinkBench {
            control,
            board: LockStep::new("on a line", kept.expect("it fits").0),
            link,
            wire,
            watch,
        }
    }

    /// One whose hello was answered, so that it waits for inputs.
    fn in_step() -> PlantLinkBench {
        let mut bench = PlantLinkBench::new();
        bench.says(&HELLO);
        bench
    }

    /// The plant says this.
    fn says(&mut self, bytes: &[u8]) {
        self.wire.0.borrow_mut().come.extend(bytes);
        self.link.attend(&mut self.control, &mut self.board, &self.watch);
    }

    /// The plant answers that the rod is there.
    fn rod_at(&mut self, position: i32) {
        let sample = Sample { position, pressure_1: 2000, pressure_2: 2000, ..Sample::default() };
        let mut bytes = Inputs { sample, frozen: false }.to_bytes();
        Tempo::default().mark(&mut bytes);
        self.says(&bytes);
    }

    /// Nobody says anything for so long, while the board looks every millisecond.
    fn silence(&mut self, milliseconds: u32) {
        for _ in 0..milliseconds {
            self.watch.0.set(self.watch.0.get().wrapping_add(TICKS_PER_MS));
            self.link.watch(&mut self.control, &mut self.board, &self.watch);
        }
    }

    fn said(&self) -> usize {
        self.wire.0.borrow().said.len()
    }

    fn greets(&self) -> bool {
        self.wire.0.borrow().said.last().is_some_and(|bytes| bytes[..] == HELLO)
    }

    fn outputs(&self) -> Outputs {
        let bytes = self.wire.0.borrow().said.last().cloned().expect("it has spoken");
        Outputs::from_bytes(bytes.try_into().expect("outputs")).expect("of this version")
    }

    fn arm(&mut self) {
        let test = Entry::Test { name: "still", last_sample: 9999, round: 0, decimation: 1, pre_trigger: 0 };
        let mut room = [0; 64];
        let entries = [test, Entry::Move { at_sample: 0, target: 200 }];
        let change = entries.map(|entry| entry.write(&mut room).expect("room").to_vec()).concat();
        self.control.take_change(&change).expect("disarmed");
        self.control.arm(&mut self.board).expect("disarmed");
    }

    fn start(&mut self) {
        self.control.start(&mut self.board).expect("armed");
    }

    fn mode(&self) -> Mode {
        self.control.state().supervisor.mode()
    }
}

const PERIOD_AND_DELAY: Next = Next::Begin { period_us: 1300, delay_us: 500 };

#[test]
fn a_board_says_hello_every_200_ms_until_it_is_answered() {
    let mut bench = PlantLinkBench::new();
    assert!(bench.greets());
    bench.silence(199);
    assert_eq!(bench.said(), 1);
    bench.silence(1);
    assert!(bench.greets() && bench.said() == 2);
    bench.silence(10 * PATIENCE_MS);
    assert_eq!(bench.said(), 12);
    bench.says(&HELLO);
    assert_eq!(bench.outputs(), Outputs::OFF, "the plant stays where it is, the drive is off");
}

#[test]
fn what_is_no_hello_of_this_version_is_not_answered() {
    for strange in [[b'P', b'N', b'B', HELLO[3] + 1], [0; 4]] {
        let mut bench = PlantLinkBench::new();
        bench.says(&strange);
        assert_eq!(bench.said(), 1, "{strange:?}");
        bench.silence(PATIENCE_MS);
        assert!(bench.greets());
        bench.says(&HELLO);
        assert_eq!(bench.outputs(), Outputs::OFF, "{strange:?} is forgotten");
    }
}

#[test]
fn every_answer_of_the_plant_is_a_sample_and_leads_to_outputs() {
    let mut bench = PlantLinkBench::in_step();
    for position in 100..110 {
        let said = bench.said();
        bench.rod_at(position);
        assert_eq!((bench.said(), bench.outputs().next), (said + 1, Next::Stay), "no run is on");
        assert_eq!(bench.control.state().observation().position, position);
    }
}

#[test]
fn half_an_answer_is_none() {
    let mut bench = PlantLinkBench::in_step();
    bench.says(&[7; Inputs::BYTES - 1]);
    assert_eq!(bench.said(), 2);
    assert_eq!(bench.control.state().observation().position, 0);
    bench.silence(PATIENCE_MS);
    assert!(bench.greets());
}

/// The inputs that are on their way when the start comes are those of the plant before: k = 0 must not see them.
#[test]
fn a_start_while_inputs_are_on_their_way_begins_before_the_next_sample() {
    let mut bench = PlantLinkBench::in_step();
    bench.arm();
    bench.rod_at(90);
    bench.start();
    bench.rod_at(91);
    assert_eq!(bench.outputs().next, PERIOD_AND_DELAY);
    assert_eq!(
        bench.control.state().observation().position,
        0,
        "the start has cleared it, and nothing was sampled"
    );
    bench.rod_at(100);
    let seen = *bench.control.state().observation();
    assert_eq!((seen.index, seen.position, seen.running), (0, 100, true), "the new plant's");
    assert_eq!(bench.outputs().next, Next::Advance);
    bench.rod_at(101);
    assert_eq!(bench.control.state().observation().index, 1);
}

#[test]
fn inputs_that_were_passed_over_cost_no_time() {
    let mut bench = PlantLinkBench::in_step();
    bench.arm();
    (0..3).for_each(|_| bench.rod_at(100));
    bench.start();
    (0..20).for_each(|_| bench.rod_at(100));
    assert_eq!(bench.mode(), Mode::Running, "no sample is late");
    let [intervals, _] = bench.control.timing();
    assert_eq!((intervals.count, intervals.least_us, intervals.most_us), (18, 1300, 1300));
}

#[test]
fn a_run_whose_plant_falls_silent_trips_within_200_ms_and_the_board_greets() {
    let mut bench = PlantLinkBench::in_step();
    bench.arm();
    bench.start();
    (0..5).for_each(|_| bench.rod_at(100));
    bench.silence(199);
    assert_eq!(bench.mode(), Mode::Running);
    bench.silence(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::LateSample));
    assert!(bench.greets());
    let log = bench.board.store();
    assert_eq!(log.event(0).map(|event| event.code), Some(Fault::LateSample.code()));
    bench.silence(5 * PATIENCE_MS);
    assert_eq!(bench.board.store().events(), 1, "logged once");
    bench.says(&HELLO);
    assert_eq!(bench.outputs(), Outputs::OFF, "the plant that is back finds the drive off");
    bench.rod_at(100);
    assert!(!bench.outputs().command.drive_enable);
}

#[test]
fn a_disarmed_drive_whose_plant_falls_silent_is_in_no_fault() {
    let mut bench = PlantLinkBench::in_step();
    bench.rod_at(100);
    bench.silence(3 * PATIENCE_MS);
    assert_eq!(bench.mode(), Mode::Disarmed);
    assert!(bench.greets());
}

/// Nobody would ever take its first sample.
#[test]
fn a_run_that_is_started_without_a_plant_trips() {
    let mut bench = PlantLinkBench::new();
    bench.arm();
    bench.start();
    bench.silence(PATIENCE_MS);
    assert_eq!(bench.mode(), Mode::Fault(Fault::LateSample));
}

#[test]
fn a_run_that_is_started_just_before_the_plant_comes_begins_with_it() {
    let mut bench = PlantLinkBench::new();
    bench.arm();
    bench.start();
    bench.says(&HELLO);
    assert_eq!(bench.outputs().next, PERIOD_AND_DELAY);
    bench.rod_at(100);
    assert_eq!((bench.mode(), bench.outputs().next), (Mode::Running, Next::Advance));
}
