//! A drive that its digital inputs command: move records, and a stop that always wins.

use std::time::{Duration, Instant};

use pneudrive_controller::parameters::id;
use pneudrive_controller::{Fault, Move};
use pneudrive_link::client::{Client, Io};
use pneudrive_protocol::io::input::{ACKNOWLEDGE, ENABLE, HOMING, RUN, START};
use pneudrive_protocol::io::output::{FAULT, IN_POSITION, LAMP, READY};
use pneudrive_protocol::io::refused;
use pneudrive_protocol::{Mode, code};
use pneudrive_records::move_records::MoveRecord;

use super::Start;
use super::keeping::StartSupplied;
use super::run::rig;
use crate::Target;

/// Inputs of a drive that may move.
const ON: u8 = RUN | ENABLE;
/// Two records, and one whose dwell is not over for an hour.
const NEAR: u8 = 1;
const FAR: u8 = 2;
const LONG: u8 = 3;
/// Where they go, counts.
const TARGETS: [i32; 3] = [9000, 12_000, 10_000];
/// An axis that is this close has arrived, counts.
const TOLERANCE: i32 = 100;
/// And for so long: it does not only pass.
const MONITORING_US: i32 = 50_000;

fn record(number: u8, dwell: u32) -> MoveRecord {
    let target = TARGETS[usize::from(number) - 1];
    MoveRecord { number, next: Move::step(0, target), dwell }
}

/// A drive with its records.
struct DriveWithRecords {
    target: Box<dyn Target>,
    client: Client,
}

impl DriveWithRecords {
    fn new(start: Start) -> DriveWithRecords {
        let target = start(&rig("servo-b-tuned", &["test.duration_s=0.3"]));
        let mut client = target.connect().expect("a rig that answers");
        client.set_parameters(id::TOLERANCE_COUNTS, &[TOLERANCE, MONITORING_US]).expect("disarmed");
        let records = [record(NEAR, 10), record(FAR, 0), record(LONG, 2_770_000)];
        client.replace_move_records(&records).expect("disarmed");
        assert_eq!(client.move_records().expect("an answer"), records, "{}", target.name());
        DriveWithRecords { target, client }
    }

    fn mode(&mut self) -> Mode {
        self.client.status().expect("an answer").mode
    }

    /// Waits until inputs and outputs are as they must be.
    fn until(&mut self, what: &str, is: impl Fn(&Io) -> bool) -> Io {
        let begun = Instant::now();
        loop {
            let io = self.client.io().expect("an answer");
            if is(&io) {
                return io;
            }
            assert!(
                begun.elapsed() < Duration::from_secs(30),
                "{}: never {what}: {io:x?}",
                self.target.name()
            );
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// The inputs change, and stay so until they count.
    fn input(&mut self, inputs: u8) {
        self.target.set_inputs(&mut self.client, inputs).expect("a rig that answers");
        self.until("settled", |io| io.settled == inputs);
    }

    /// A start of this number, from off to on.
    fn start(&mut self, number: u8) {
        self.input(ON | number);
        self.input(ON | START | number);
    }

    fn arrives(&mut self, number: u8) {
        self.until("in position", |io| io.number == number && io.outputs & IN_POSITION != 0);
        let status = self.client.status().expect("an answer");
        let target = TARGETS[usize::from(number) - 1];
        let off = (status.position - target).abs();
        assert!(off <= 2 * TOLERANCE, "{}: {} is not {target}", self.target.name(), status.position);
        assert_eq!(status.mode, Mode::Done, "{}: it holds", self.target.name());
    }
}

/// Records begin by their number, one after the other from where the axis stands. A start while the axis moves is ignored, a
/// record that does not exist changes nothing, number 0 is none, and number 15 homes the axis.
///
/// # Panics
/// When it is not so.
pub fn records_begin_by_their_numbers(start: Start) {
    let mut bench = DriveWithRecords::new(start);
    bench.input(ON);
    bench.until("ready", |io| io.outputs & !LAMP == READY);
    for number in [NEAR, FAR, NEAR] {
        bench.start(number);
        bench.arrives(number);
    }
    bench.start(4);
    let io = bench.until("refused", |io| io.refused == refused::NO_RECORD);
    assert_eq!((io.number, bench.mode()), (4, Mode::Done), "{}: it holds on", bench.target.name());
    bench.start(LONG);
    bench.until("begun", |io| io.number == LONG && io.outputs & READY == 0);
    bench.start(NEAR);
    let io = bench.client.io().expect("an answer");
    assert_eq!((io.number, bench.mode()), (LONG, Mode::Running), "{}: it is ignored", bench.target.name());
    bench.input(RUN);
    assert_eq!(bench.mode(), Mode::Disarmed, "{}: enable off is no fault", bench.target.name());
    bench.start(0);
    bench.until("refused", |io| io.number == 0 && io.refused == refused::NO_RECORD);
    bench.start(HOMING);
    bench.until("homed", |io| io.number == HOMING && io.outputs & IN_POSITION != 0);
    assert_eq!(bench.mode(), Mode::Armed, "{}", bench.target.name());
}

/// Run off stops whatever moves; it wins over a start that comes with it. Nothing begins without enable, nor before the fault
/// is acknowledged.
///
/// # Panics
/// When it is not so.
pub fn a_stop_by_an_input_always_wins(start: Start) {
    let mut bench = DriveWithRecords::new(start);
    bench.input(ENABLE | NEAR);
    bench.input(ENABLE | START | NEAR);
    bench.input(RUN | NEAR);
    bench.input(RUN | START | NEAR);
    assert_eq!(bench.mode(), Mode::Disarmed, "{}: run or enable was off", bench.target.name());
    bench.input(ON | NEAR);
    bench.input(ENABLE | START | NEAR);
    bench.input(ON | START | NEAR);
    assert_eq!(bench.mode(), Mode::Disarmed, "{}: the start came with a stop", bench.target.name());
    bench.start(LONG);
    bench.until("begun", |io| io.number == LONG && io.outputs & READY == 0);
    bench.input(ENABLE | LONG);
    bench.until("tripped", |io| io.outputs & !LAMP == FAULT);
    let status = bench.client.status().expect("an answer");
    assert_eq!((status.mode, status.fault), (Mode::Fault, Fault::Stop.code()), "{}", bench.target.name());
    bench.start(NEAR);
    bench.until("refused", |io| io.refused == refused::FAULT);
    bench.input(ON | ACKNOWLEDGE);
    bench.until("acknowledged", |io| io.outputs & !LAMP == READY);
    bench.start(NEAR);
    bench.arrives(NEAR);
}

/// The inputs begin nothing that a host has enabled, and a host arms nothing that the inputs have. Run off stops a host's
/// drive, too.
///
/// # Panics
/// When it is not so.
pub fn a_drive_has_one_owner(start: Start) {
    let mut bench = DriveWithRecords::new(start);
    bench.input(ON);
    bench.client.arm().expect("nobody commands it");
    bench.start(NEAR);
    bench.until("refused", |io| io.refused == code::OWNED);
    assert_eq!(bench.mode(), Mode::Armed, "{}", bench.target.name());
    bench.input(ENABLE);
    assert_eq!(bench.mode(), Mode::Fault, "{}: a stop is of everybody", bench.target.name());
    bench.input(ON | ACKNOWLEDGE);
    bench.start(LONG);
    bench.until("begun", |io| io.number == LONG && io.refused == 0 && io.outputs & READY == 0);
    let refused = bench.client.arm().expect_err("the inputs command it").to_string();
    assert!(refused.contains("digital inputs commands the drive"), "{}: {refused}", bench.target.name());
    bench.client.stop().expect("everybody may stop");
    assert_eq!(bench.mode(), Mode::Fault, "{}", bench.target.name());
}

/// A PC's stop is acknowledged before the inputs begin anything, also if the drive had tripped before and that was acknowledged,
/// and if it was disabled.
///
/// # Panics
/// When it is not so.
pub fn a_stop_by_a_host_withdraws_what_the_inputs_may(start: Start) {
    let mut bench = DriveWithRecords::new(start);
    bench.input(ON);
    bench.start(LONG);
    bench.until("begun", |io| io.number == LONG && io.outputs & READY == 0);
    bench.input(ENABLE);
    bench.input(ON | ACKNOWLEDGE);
    bench.until("acknowledged", |io| io.outputs & !LAMP == READY);
    bench.client.stop().expect("everybody may stop");
    bench.until("withdrawn", |io| io.outputs & !LAMP == FAULT);
    bench.start(NEAR);
    bench.until("refused", |io| io.refused == refused::FAULT);
    assert_eq!(bench.mode(), Mode::Fault, "{}: nothing moves", bench.target.name());
    bench.input(ON | ACKNOWLEDGE);
    bench.start(NEAR);
    bench.arrives(NEAR);
    bench.client.stop().expect("everybody may stop");
    bench.client.arm().expect("a host arms anew");
    bench.client.disarm().expect("and disarms");
    bench.start(NEAR);
    let io = bench.until("refused", |io| io.refused == refused::FAULT);
    assert_eq!((bench.mode(), io.outputs & !LAMP), (Mode::Disarmed, FAULT), "{}", bench.target.name());
}

/// The power goes at every other operation while a table is saved: after it, the drive has the old table or the new one.
///
/// # Panics
/// When it has not.
pub fn a_power_cut_while_a_table_is_saved_leaves_the_old_or_the_new(start: StartSupplied) {
    let mut target = start(&rig("servo-b", &["test.duration_s=0.3"]));
    let table =
        |target: i32| [1, 14].map(|number| MoveRecord { number, next: Move::step(0, target), dwell: 0 });
    let mut client = target.connect().expect("a rig that answers");
    client.replace_move_records(&table(0)).expect("disarmed");
    client.save_parameters().expect("disarmed");
    let (mut in_force, mut old_ones, mut new_ones) = (0, 0, 0);
    for nth in (1..).step_by(2) {
        let new = nth as i32;
        client.replace_move_records(&table(new)).expect("disarmed");
        target.cut_power_at(nth);
        let saved = client.save_parameters().is_ok();
        drop(client);
        target.power_up().expect("it starts again");
        client = target.connect().expect("a rig that answers");
        let found = client.move_records().expect("an answer");
        if saved {
            assert_eq!(found, table(new), "{}", target.name());
            break;
        }
        assert!(
            found == table(in_force) || found == table(new),
            "{}: a mixture, cut at {nth}: {found:?}",
            target.name()
        );
        *(if found == table(new) { &mut new_ones } else { &mut old_ones }) += 1;
        in_force = found[0].next.target;
    }
    println!("{}: the old table {old_ones} times, the new one {new_ones} times", target.name());
    assert!(old_ones > 10);
}
