//! Parameters and a test are taken whole or not at all, and a start names them.

use crate::bench::{AppBench, change};
use pneudrive_controller::parameters::id;
use pneudrive_controller::{Mode, Refusal};
use pneudrive_protocol::change::{Entry, start_crc32, test_crc32};
use pneudrive_protocol::profiled::NO_MOVE;
use pneudrive_protocol::{ProfiledMove, RequestBody, UNTIL_STOPPED, Values, frame};

const ONE: u32 = 1011;
const OTHER: u32 = 1022;

const TEST: Entry<'_> = test_of("whole", 100);
const FIRST: Entry<'_> = Entry::Move { at_sample: 0, target: 500 };
const SECOND: Entry<'_> = Entry::Move { at_sample: 4, target: 0 };

const fn test_of(name: &str, last_sample: u32) -> Entry<'_> {
    Entry::Test { name, last_sample, round: 0, decimation: 1, pre_trigger: 0 }
}

/// Parameters as an entry.
fn parameters(first_id: u16, values: &[i32]) -> Vec<u8> {
    let mut room = [0; 256];
    let values = Values::fill(&mut room, values.iter().copied()).expect("room");
    change(&[Entry::Parameters { first_id, values }])
}

impl AppBench {
    /// A referenced bench, asked by this host.
    fn of(session: u32) -> AppBench {
        AppBench { session, ..AppBench::referenced() }
    }

    fn start_of(&mut self, change: &[u8]) -> String {
        let parameters = self.app.control.configuration().hash();
        self.ask(RequestBody::Start { crc32: start_crc32(test_crc32(change), parameters) })
    }

    fn gain(&self) -> i32 {
        self.app.control.parameters().get(id::VELOCITY_GAIN).expect("there is one")
    }

    fn test_is(&self) -> (&str, u32, usize) {
        let test = self.app.control.test();
        (test.name(), test.sequence().duration_samples, test.sequence().moves().len())
    }
}

#[test]
fn parameters_and_test_are_taken_together_and_run() {
    let mut bench = AppBench::of(ONE);
    let whole = [parameters(id::VELOCITY_GAIN, &[77]), change(&[TEST, FIRST, SECOND])].concat();
    assert_eq!(bench.take(&whole), "Done");
    assert_eq!((bench.gain(), bench.test_is()), (77, ("whole", 100, 2)));
    bench.done(RequestBody::Arm { host: "one" });
    assert_eq!(bench.start_of(&whole), "Done");
    bench.samples(102);
    assert_eq!(bench.mode(), Mode::Done);
    assert_eq!(bench.record().1.len(), 101);
}

#[test]
fn of_a_change_that_is_wrong_anywhere_nothing_is_taken() {
    let good = [parameters(id::VELOCITY_GAIN, &[1]), change(&[TEST, FIRST, SECOND])].concat();
    let early = Entry::Move { at_sample: 3, target: 0 };
    let cases: [(Vec<u8>, &str); 9] = [
        (parameters(id::VELOCITY_GAIN, &[70_000]), "OutOfRange"),
        (parameters(200, &[1]), "UnknownParameter { id: 200 }"),
        (parameters(id::DELAY_US, &[5000]), "delay_us must be less than period_us"),
        (change(&[early]), "MovesOutOfOrder"),
        (change(&[SECOND; 64]), "TooManyMoves"),
        (change(&[TEST]), "Unknown"),
        (vec![99], "Unknown"),
        (vec![2], "Unknown"),
        (vec![0, 1, 3, 1, 2, 3], "Unknown"),
    ];
    for (wrong, refused) in cases {
        let mut bench = AppBench::of(ONE);
        let before = bench.gain();
        let reply = bench.take(&[&good[..], &wrong].concat());
        assert!(reply.starts_with("Refused(") && reply.contains(refused), "{reply}, not {refused}");
        assert_eq!((bench.gain(), bench.test_is()), (before, ("", 0, 0)), "{refused}");
    }
    let mut bench = AppBench::of(ONE);
    assert_eq!(bench.take(&change(&[FIRST])), "Refused(Unknown)", "moves of no test");
    assert_eq!(bench.take(&change(&[test_of("long", UNTIL_STOPPED + 1)])), "Refused(TestTooLong)");
    let repeats = Entry::Test { name: "r", last_sample: 9, round: 4, decimation: 1, pre_trigger: 0 };
    assert_eq!(
        bench.take(&change(&[repeats, FIRST, SECOND])),
        "Refused(MovesOutOfOrder)",
        "behind its round"
    );
}

/// Found by the fuzzer: behind the last id the firmware counted on.
#[test]
fn a_parameter_of_the_last_id_that_can_be_sent_is_refused_as_any_unknown_one() {
    let mut bench = AppBench::of(ONE);
    for (first_id, values) in [(u16::MAX, &[1][..]), (u16::MAX, &[1, 2]), (u16::MAX - 1, &[1, 2, 3])] {
        let refused = bench.take(&parameters(first_id, values));
        assert_eq!(refused, format!("Refused(UnknownParameter {{ id: {first_id} }})"));
    }
}

#[test]
fn a_change_is_taken_only_once_all_its_parts_have_come() {
    let mut bench = AppBench::of(ONE);
    let whole = change(&[TEST, FIRST, SECOND]);
    let crc32 = frame::crc32(&whole);
    let part = |range: std::ops::Range<usize>| RequestBody::ChangePart {
        crc32,
        first: range.start as u16,
        part: &whole[range],
    };
    let not_whole = "Refused(ChangeNotWhole)";
    bench.done(part(0..5));
    assert_eq!(bench.ask(part(6..8)), not_whole, "a byte was lost");
    assert_eq!(bench.ask(RequestBody::ChangeTake { crc32 }), not_whole);
    bench.done(part(5..whole.len()));
    bench.done(part(0..5));
    bench.done(RequestBody::ChangeTake { crc32 });
    assert_eq!(bench.test_is(), ("whole", 100, 2));
    assert_eq!(bench.ask(RequestBody::ChangeTake { crc32 }), not_whole, "it has been taken");
}

#[test]
fn nothing_is_taken_by_an_enabled_drive() {
    let mut bench = AppBench::of(ONE);
    bench.done(RequestBody::Arm { host: "one" });
    let refused = format!("Refused(NotNow({}))", Refusal::NotDisarmed.code());
    assert_eq!(bench.take(&change(&[TEST, FIRST])), refused);
    assert_eq!(bench.test_is(), ("", 0, 0));
}

#[test]
fn what_another_host_has_changed_meanwhile_does_not_start() {
    let [mine, theirs] = [change(&[TEST, FIRST, SECOND]), change(&[TEST, FIRST])];
    let gain = parameters(id::VELOCITY_GAIN, &[9]);
    let hash = |bench: &AppBench| bench.app.control.configuration().hash();
    for other in [&theirs, &gain] {
        let mut bench = AppBench::of(ONE);
        assert_eq!(bench.take(&mine), "Done");
        let meant = start_crc32(test_crc32(&mine), hash(&bench));
        bench.session = OTHER;
        assert_eq!(bench.take(other), "Done");
        bench.session = ONE;
        bench.done(RequestBody::Arm { host: "one" });
        assert_eq!(bench.ask(RequestBody::Start { crc32: meant }), "Refused(OtherTest)");
        assert_eq!(bench.mode(), Mode::Armed);
    }
}

#[test]
fn a_change_of_parameters_alone_leaves_a_test_that_still_means_the_same() {
    let mut bench = AppBench::of(ONE);
    assert_eq!(bench.take(&change(&[TEST, FIRST, SECOND])), "Done");
    assert_eq!(bench.take(&parameters(id::VELOCITY_GAIN, &[3])), "Done");
    assert_eq!(bench.test_is(), ("whole", 100, 2));
    assert_eq!(bench.take(&parameters(id::PERIOD_US, &[1400])), "Done");
    assert_eq!(bench.test_is(), ("", 0, 0), "its samples would mean other times");
}

/// A move record as it travels.
fn record(target: i32, kind: u8) -> [u8; ProfiledMove::BYTES] {
    ProfiledMove { at_sample: 9, target, kind, numbers: [3, 2, 1, 0, 0, 0] }.to_bytes()
}

#[test]
fn a_table_of_records_is_taken_whole_or_not_at_all_and_leaves_the_test_alone() {
    let mut bench = AppBench::of(ONE);
    bench.take(&change(&[TEST, FIRST]));
    let [one, two, none, of_no_kind] = [record(100, 0), record(200, 1), record(0, NO_MOVE), record(1, 9)];
    let put = |number, bytes| Entry::MoveRecord { number, bytes };
    assert_eq!(bench.take(&change(&[put(1, &one), put(14, &two)])), "Done");
    let target = |bench: &AppBench, number| {
        let records = bench.app.control.configuration().records();
        records.get(number).map(|record| (record.next.target, record.dwell))
    };
    assert_eq!([1, 2, 14].map(|number| target(&bench, number)), [Some((100, 9)), None, Some((200, 9))]);
    assert_eq!(bench.test_is(), ("whole", 100, 1));
    for wrong in [put(0, &one), put(15, &one), put(2, &of_no_kind), put(2, &one[1..])] {
        assert!(bench.take(&change(&[put(1, &two), wrong])).starts_with("Refused"), "{wrong:?}");
        assert_eq!(target(&bench, 1), Some((100, 9)), "nothing of it was taken");
    }
    assert_eq!(bench.take(&change(&[put(1, &none)])), "Done");
    assert_eq!(target(&bench, 1), None);
    bench.done(RequestBody::Arm { host: "one" });
    assert_eq!(bench.take(&change(&[put(2, &one)])), "Refused(NotNow(4))", "the drive is enabled");
}

#[test]
fn the_table_is_read_from_any_number_on() {
    let mut bench = AppBench::of(ONE);
    bench.take(&change(&[Entry::MoveRecord { number: 14, bytes: &record(7, 1) }]));
    let from = |first: u8, bench: &mut AppBench| bench.ask(RequestBody::MoveRecordsRead { first });
    assert_eq!(from(1, &mut bench).matches("255").count(), 12, "as many as a message carries, all empty");
    let told = from(14, &mut bench);
    assert!(told.starts_with("MoveRecords { first: 14, records: [9, 0, 0, 0, 7, 0, 0, 0, 3, "), "{told}");
    for beyond in [0, 15, 255] {
        assert_eq!(from(beyond, &mut bench), format!("MoveRecords {{ first: {beyond}, records: [] }}"));
    }
}
