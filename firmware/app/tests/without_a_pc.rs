//! A drive without a PC: its digital inputs begin move records, its outputs say how that goes, and it has one owner.

use crate::bench::AppBench;
use pneudrive_app::inputs::attend;
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Mode, Refusal};
use pneudrive_protocol::change::{Entry, PART_BYTES};
use pneudrive_protocol::io::input::{ACKNOWLEDGE, ENABLE, HOMING, RUN, START};
use pneudrive_protocol::io::output::{FAULT, IN_POSITION, LAMP, READY};
use pneudrive_protocol::io::refused;
use pneudrive_protocol::{ProfiledMove, RequestBody, code};

/// Inputs of a drive that may move.
const ON: u8 = RUN | ENABLE;
/// A record to where the rod stands.
const HERE: u8 = 1;
/// A record to where it does not come: it stands.
const THERE: u8 = 2;
/// The dwell of both, samples.
const DWELL: u32 = 5;
/// Samples of 1.3 ms until inputs count, 10 ms behind the first reading of them.
const DEBOUNCE: u32 = 9;
/// Samples until a start has settled, 20 ms later.
const SETTLING: u32 = 16;

impl AppBench {
    /// A referenced drive whose rod stands at 0, with two records, its inputs on.
    fn with_records() -> AppBench {
        let mut bench = AppBench { session: 1007, ..AppBench::referenced() };
        bench.board.stands = true;
        for (number, target) in [(HERE, 0), (THERE, 500), (3, 1_000_000)] {
            let told = ProfiledMove { at_sample: DWELL, target, ..ProfiledMove::default() };
            let entry = Entry::MoveRecord { number, bytes: &told.to_bytes() };
            let mut room = [0; PART_BYTES];
            bench.app.control.take_change(entry.write(&mut room).expect("room")).expect("disarmed");
        }
        bench.input(ON);
        bench
    }

    /// Samples, each of which the idle task follows.
    fn live(&mut self, samples: u32) {
        for _ in 0..samples {
            self.samples(1);
            attend(&mut (&mut self.app.control, &mut self.board));
        }
    }

    /// The inputs change, and stay so until they count.
    fn input(&mut self, inputs: u8) {
        self.board.inputs = inputs;
        self.live(DEBOUNCE);
    }

    /// A start of this number, from off to on.
    fn start(&mut self, number: u8) {
        self.input(ON | number);
        self.input(ON | START | number);
        self.live(SETTLING);
    }

    fn shows(&self, output: u8) -> bool {
        self.board.shown & output != 0
    }

    fn why_refused(&self) -> u8 {
        self.app.control.selector().refused()
    }
}

#[test]
fn a_start_begins_the_record_of_the_number_and_the_outputs_say_when_it_is_done() {
    let mut bench = AppBench::with_records();
    assert_eq!((bench.mode(), bench.board.shown & !LAMP), (Mode::Disarmed, READY));
    bench.start(HERE);
    assert_eq!((bench.mode(), bench.shows(READY), bench.shows(IN_POSITION)), (Mode::Running, false, false));
    assert_eq!(bench.app.control.test().name(), "record 01");
    bench.live(1);
    assert!(!bench.shows(IN_POSITION), "it has arrived, but not dwelt");
    bench.live(DWELL + 2);
    assert_eq!((bench.mode(), bench.board.shown & !LAMP), (Mode::Done, READY | IN_POSITION), "it holds");
    bench.start(THERE);
    assert_eq!((bench.mode(), bench.shows(IN_POSITION)), (Mode::Running, false));
    bench.live(4 * DWELL);
    assert_eq!((bench.mode(), bench.shows(IN_POSITION)), (Mode::Running, false), "it has not arrived");
    assert_eq!(bench.board.runs, 0, "no simulated plant begins anew: it goes on from where it stands");
}

#[test]
fn a_start_while_the_axis_moves_is_ignored() {
    let mut bench = AppBench::with_records();
    bench.start(THERE);
    let index = bench.app.control.state().observation().index;
    bench.start(HERE);
    assert_eq!(bench.app.control.selector().number(), THERE);
    assert_eq!(bench.app.control.test().name(), "record 02");
    assert!(bench.app.control.state().observation().index > index, "the run goes on");
}

#[test]
fn nothing_begins_without_enable_or_while_run_is_off() {
    for off in [0, RUN, ENABLE] {
        let mut bench = AppBench::with_records();
        bench.input(off | HERE);
        bench.input(off | START | HERE);
        bench.live(20);
        assert_eq!((bench.mode(), bench.shows(READY)), (Mode::Disarmed, false), "{off:x}");
        assert!(bench.board.driven.iter().all(|command| !command.drive_enable), "never enabled");
    }
}

#[test]
fn enable_off_disables_at_the_next_output_without_a_fault() {
    let mut bench = AppBench::with_records();
    bench.start(THERE);
    bench.board.inputs = RUN;
    bench.live(1);
    assert_eq!((bench.mode(), bench.shows(FAULT)), (Mode::Disarmed, false));
    bench.live(1);
    assert_eq!(
        bench.board.driven.last().map(|command| (command.drive_enable, command.counts)),
        Some((false, 0))
    );
    bench.start(HERE);
    assert_eq!(bench.mode(), Mode::Running, "nothing is to be acknowledged");
}

#[test]
fn run_off_trips_what_moves_and_the_fault_is_acknowledged_before_the_next_start() {
    let mut bench = AppBench::with_records();
    bench.start(THERE);
    bench.board.inputs = ENABLE;
    bench.live(1);
    assert_eq!((bench.mode(), bench.board.shown & !LAMP), (Mode::Fault(Fault::Stop), FAULT));
    bench.start(HERE);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Fault(Fault::Stop), refused::FAULT));
    bench.input(ON | ACKNOWLEDGE);
    assert_eq!(bench.board.shown & !LAMP, READY);
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop), "only arming leaves it");
    bench.start(HERE);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Running, 0));
}

/// Run off and start on in the same reading, and run off while the start has yet to count.
#[test]
fn a_stop_during_a_start_wins() {
    for before in [0, DEBOUNCE - 1, DEBOUNCE + SETTLING - 1] {
        let mut bench = AppBench::with_records();
        bench.board.inputs = ON | START | HERE;
        bench.live(before);
        bench.board.inputs = ENABLE | START | HERE;
        bench.live(30);
        bench.board.inputs = ON | START | HERE;
        bench.live(60);
        assert_eq!(bench.mode(), Mode::Disarmed, "{before}: the edge was while run was off");
    }
}

#[test]
fn what_cannot_begin_says_why_and_leaves_the_drive_as_it_was() {
    let mut bench = AppBench::with_records();
    for (number, why) in [(4, refused::NO_RECORD), (3, Refusal::BeyondSoftLimit.code())] {
        bench.start(number);
        assert_eq!((bench.mode(), bench.why_refused()), (Mode::Disarmed, why));
    }
    bench.start(HERE);
    bench.live(3 * DWELL);
    bench.start(4);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Done, refused::NO_RECORD), "it holds on");
    bench.input(RUN);
    bench.app.control.set_parameters(id::OPEN_LOOP, [1].into_iter()).expect("disarmed");
    bench.input(ON);
    assert!(!bench.shows(READY));
    bench.start(HERE);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Disarmed, refused::OPEN_LOOP));
}

#[test]
fn an_axis_that_is_not_referenced_is_homed_by_number_15_first() {
    let mut bench = AppBench::with_records();
    bench.app.control.set_parameters(id::ENCODER_INVERTED, [1].into_iter()).expect("disarmed");
    bench.start(HERE);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Disarmed, Refusal::NotReferenced.code()));
    bench.board.stop = Some(-300);
    bench.start(0);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Disarmed, refused::NO_RECORD), "a cut cable");
    bench.start(HOMING);
    assert_eq!(bench.mode(), Mode::Homing);
    bench.live(5000);
    assert!(bench.app.control.state().supervisor.is_referenced());
    assert_eq!((bench.mode(), bench.board.shown & !LAMP), (Mode::Armed, READY | IN_POSITION));
}

#[test]
fn the_inputs_begin_nothing_that_a_host_has_enabled_and_stop_it_all_the_same() {
    let mut bench = AppBench::with_records();
    bench.done(RequestBody::Arm { host: "a host" });
    bench.live(1);
    assert!(!bench.shows(READY));
    bench.start(HERE);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Armed, code::OWNED));
    bench.input(RUN);
    assert_eq!(bench.mode(), Mode::Armed, "enable is of what the inputs have begun");
    bench.board.inputs = ENABLE;
    bench.live(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop));
    bench.done(RequestBody::Arm { host: "a host" });
    bench.live(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop), "as long as run is off");
}

#[test]
fn a_host_may_read_and_stop_what_the_inputs_have_begun() {
    let mut bench = AppBench::with_records();
    bench.start(THERE);
    let owned = bench.ask(RequestBody::Arm { host: "a host" });
    assert!(owned.contains("Owned(Owner { presence: There") && owned.contains("digital inputs"), "{owned}");
    assert!(bench.ask(RequestBody::Disarm).contains("Owned"));
    assert!(bench.ask(RequestBody::Io).starts_with("Io { inputs: 210, settled: 210, outputs: "));
    bench.done(RequestBody::Stop);
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop));
}

#[test]
fn a_stop_by_a_host_withdraws_the_acknowledgement_and_the_start_whatever_the_drive_does() {
    let mut bench = AppBench::with_records();
    bench.start(THERE);
    bench.input(ENABLE);
    bench.input(ON | ACKNOWLEDGE);
    bench.done(RequestBody::Stop);
    bench.start(HERE);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Fault(Fault::Stop), refused::FAULT));
    assert!(bench.shows(FAULT) && !bench.shows(READY));
    bench.input(ON | ACKNOWLEDGE);
    bench.start(HERE);
    assert_eq!(bench.mode(), Mode::Running, "acknowledged once more");

    let mut disabled = AppBench::with_records();
    disabled.done(RequestBody::Stop);
    disabled.start(HERE);
    assert_eq!(disabled.why_refused(), refused::FAULT, "nothing had moved");

    let mut starting = AppBench::with_records();
    starting.input(ON | START | HERE);
    starting.done(RequestBody::Stop);
    starting.live(2 * SETTLING);
    assert!(!matches!(starting.mode(), Mode::Running), "a start that had yet to settle");
}

/// The contacts have closed, but not for long enough to count.
#[test]
fn an_acknowledgement_that_has_yet_to_count_at_a_stop_is_none_of_that_stop() {
    let mut bench = AppBench::with_records();
    bench.board.inputs = ON | ACKNOWLEDGE;
    bench.live(DEBOUNCE - 2);
    bench.done(RequestBody::Stop);
    bench.live(DEBOUNCE);
    bench.start(HERE);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Fault(Fault::Stop), refused::FAULT));
    bench.input(ON | ACKNOWLEDGE);
    bench.start(HERE);
    assert_eq!(bench.mode(), Mode::Running, "acknowledged since");
}

#[test]
fn a_start_that_has_yet_to_count_at_a_stop_begins_nothing_once_that_is_acknowledged() {
    let mut bench = AppBench::with_records();
    bench.board.inputs = ON | START | HERE;
    bench.live(DEBOUNCE - 2);
    bench.done(RequestBody::Stop);
    bench.input(ON | START | ACKNOWLEDGE | HERE);
    bench.live(2 * SETTLING);
    assert_eq!(bench.mode(), Mode::Fault(Fault::Stop));
}

/// A trip that no input has caused: acknowledged is what came behind it, and so is the start.
#[test]
fn what_was_acknowledged_or_started_before_a_trip_is_not_meant_for_it() {
    for before in [DEBOUNCE - 2, DEBOUNCE + 2] {
        let mut bench = AppBench::with_records();
        bench.board.inputs = ON | START | ACKNOWLEDGE | HERE;
        bench.live(before);
        bench.app.control.trip(Fault::LateSample);
        bench.live(2 * SETTLING);
        assert_eq!(bench.mode(), Mode::Fault(Fault::LateSample), "{before}");
        assert!(bench.shows(FAULT), "{before}: not acknowledged");
        bench.input(ON | START | HERE);
        bench.input(ON | START | ACKNOWLEDGE | HERE);
        bench.live(2 * SETTLING);
        assert!(!bench.shows(FAULT), "{before}: acknowledged");
        assert_eq!(bench.mode(), Mode::Fault(Fault::LateSample), "{before}: the start was before it");
        bench.start(HERE);
        assert_eq!(bench.mode(), Mode::Running, "{before}");
    }
}

#[test]
fn a_number_that_comes_behind_its_start_begins_no_other_record() {
    let mut bench = AppBench::with_records();
    bench.input(ON | START | HERE);
    bench.board.inputs = ON | START | THERE;
    bench.live(3 * SETTLING);
    assert_eq!((bench.mode(), bench.why_refused()), (Mode::Disarmed, refused::UNSETTLED));
}

#[test]
fn no_host_can_pass_for_the_inputs() {
    let mut bench = AppBench::with_records();
    bench.start(THERE);
    bench.session = u32::MAX;
    let disarm = bench.frame(RequestBody::Disarm);
    assert_eq!(bench.send(&disarm), []);
    assert_eq!(bench.mode(), Mode::Running);
}

/// The inputs are a sign of life as requests are: an idle task that stands still is a host that is silent.
#[test]
fn a_drive_whose_inputs_nobody_looks_at_any_more_trips() {
    let mut bench = AppBench::with_records();
    bench.board.host_clock_ms = Some(0);
    bench.start(THERE);
    for ms in 0..2000 {
        bench.board.host_clock_ms = Some(ms);
        bench.live(1);
        if bench.mode() != Mode::Running {
            break;
        }
    }
    let seen_by_the_drive = bench.mode();
    assert_ne!(seen_by_the_drive, Mode::Fault(Fault::HostSilent), "they are looked at");
    let mut bench = AppBench::with_records();
    bench.board.host_clock_ms = Some(0);
    bench.start(THERE);
    bench.board.host_clock_ms = Some(600);
    bench.samples(1);
    assert_eq!(bench.mode(), Mode::Fault(Fault::HostSilent));
}

#[test]
fn a_board_whose_inputs_are_pins_takes_none_by_request() {
    let mut bench = AppBench::with_records();
    let refused = bench.ask(RequestBody::IoSet { inputs: ON | START | HERE });
    assert_eq!(refused, format!("Refused(NotNow({}))", code::INPUTS_ARE_PINS));
}
