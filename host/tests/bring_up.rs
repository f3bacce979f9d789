//! `pneudrive device bring-up` on virtual rigs whose wires are right, and on those where one is not.

use std::time::Duration;

use crate::program::{folder, transcript};
use anyhow::Result;
use pneudrive_controller::Move;
use pneudrive_controller::parameters::id;
use pneudrive_link::client::Client;
use pneudrive_protocol::Mode;
use pneudrive_records::move_records::MoveRecord;
use pneudrive_rigs::persistent_flash::PersistentFlash;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_rigs::wiring::{Wiring, WiringFault};
use pneudrive_session::bring_up::{Check, Operator, Options, Report, Verdict, bring_up};
use pneudrive_sim::Rig;

const FAST: Pace = Pace { fast: true, live: false };

/// A virtual rig with these wires wrong, and its wires.
fn rig_with(name: &str, faults: &[WiringFault], pace: Pace) -> (Background, Wiring) {
    rig_of(Rig::builtin(name).expect("a built-in rig"), faults, pace)
}

fn rig_of(rig: Rig, faults: &[WiringFault], pace: Pace) -> (Background, Wiring) {
    let rig = VirtualRig::wired(rig, 0, pace, faults).expect("a rig");
    let wiring = rig.wiring().clone();
    (Background::start(rig, Listener::open("tcp:127.0.0.1:0").expect("a port")), wiring)
}

/// Somebody who does what is asked: pushes the slide, takes off the wire of `drive_enable`, reads the instrument.
struct Helper {
    wiring: Wiring,
    /// Whether taking off the wire shuts the amplifier off.
    gated: bool,
    /// Whether the air can be shut off: that of a virtual rig cannot, so a slide may creep in a long ramp.
    vented: bool,
}

impl Operator for Helper {
    fn tell(&mut self, text: &str) {
        if text.starts_with("Push the slide OUT") {
            self.wiring.push();
        }
    }

    fn done(&mut self, _: &Check) {}

    fn lets_it_move(&mut self, _: &str) -> bool {
        true
    }

    fn answers(&mut self, question: &str) -> Option<bool> {
        if question.starts_with("Take the wire of drive_enable off") && self.gated {
            self.wiring.spoil(WiringFault::EnableOpen);
        } else if question.starts_with("Put the wire of drive_enable back") {
            self.wiring.repair(WiringFault::EnableOpen);
        }
        Some(self.vented || !question.starts_with("Shut off the air"))
    }

    fn goes_on(&mut self) -> Result<()> {
        Ok(())
    }
}

fn brought_up(rig: &Background, wiring: &Wiring, gated: bool) -> Report {
    let mut client = Client::connect(rig.port()).expect("an answer");
    let mut helper = Helper { wiring: wiring.clone(), gated, vented: false };
    let report = bring_up(&mut client, &mut helper, Options::default()).expect("a report");
    let mode = client.status().expect("an answer").mode;
    assert_eq!(mode, Mode::Disarmed, "it leaves the drive disarmed: {}", report.markdown());
    report
}

/// Every line of advice, behind the name of its check.
fn advice(report: &Report) -> Vec<String> {
    report
        .wrong()
        .flat_map(|check| check.advice.iter().map(|line| format!("{}: {line}", check.name)))
        .collect()
}

#[test]
fn a_drive_whose_wires_are_right_has_nothing_to_find() {
    at_once(&["servo-b-tuned", "servo-a-tuned", "servo-c", "burrows"], |name| {
        let (rig, wiring) = rig_with(name, &[], FAST);
        let report = brought_up(&rig, &wiring, true);
        assert_eq!(advice(&report), [""; 0], "{name}: {}", report.markdown());
        let is_open = |check: &&Check| check.verdict == Verdict::NotChecked;
        let open: Vec<&str> = report.checks.iter().filter(is_open).map(|check| check.name).collect();
        assert_eq!(open, ["drive stage"], "{name}: {}", report.markdown());
    });
}

/// Goes through cases beside one another: most of a bring-up is waiting.
fn at_once<T: Sync>(cases: &[T], go_through: impl Fn(&T) + Sync) {
    std::thread::scope(|scope| {
        for case in cases {
            scope.spawn(|| go_through(case));
        }
    });
}

/// In real time a status may come before the first sample of a pulse, and its position is none.
#[test]
fn a_drive_in_real_time_whose_plant_never_rests_is_right_too() {
    let (rig, wiring) = rig_with("servo-c", &[], Pace { fast: false, live: true });
    let report = brought_up(&rig, &wiring, true);
    assert_eq!(advice(&report), [""; 0], "{}", report.markdown());
}

/// With the slide blocked the ramp moves nothing, and no pulse moves it either.
#[test]
fn the_ramp_is_read_off_an_instrument_and_a_blocked_slide_is_told_from_a_dead_encoder() {
    let settings = ["static_extend_n", "static_retract_n", "coulomb_extend_n", "coulomb_retract_n"]
        .map(|key| format!("load.{key}=3000"));
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig").with_settings(&settings).expect("valid");
    let rig = VirtualRig::new(rig, 0, FAST).expect("a rig");
    let wiring = rig.wiring().clone();
    let rig = Background::start(rig, Listener::open("tcp:127.0.0.1:0").expect("a port"));
    let mut client = Client::connect(rig.port()).expect("an answer");
    let mut helper = Helper { wiring, gated: true, vented: true };
    let report = bring_up(&mut client, &mut helper, Options::default()).expect("a report");
    let stage = report.checks.iter().find(|check| check.name == "drive stage").expect("in the report");
    assert_eq!(stage.verdict, Verdict::Right);
    assert!(stage.did.contains("-2048 counts = 0.00 V at the pin, -1024 counts = 0.83 V"), "{}", stage.did);
    let found = advice(&report);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].contains("the encoder counted by hand: the slide is blocked"), "{found:?}");
}

/// The fault, and what bring-up says of it: all of it, and in the words of the check that must find it.
#[test]
fn each_wiring_fault_is_found_and_named_and_nothing_else_is() {
    let faults = [
        (WiringFault::ValveInverted, &["pulses: the valve command is turned"][..]),
        (WiringFault::TubesSwapped, &["pulses: the tubes are swapped"]),
        (
            WiringFault::EncoderSwapped,
            &[
                "encoder by hand: the encoder counts the wrong way",
                "pulses: the encoder counts the wrong way",
            ],
        ),
        (WiringFault::EncoderPullUp, &["pulses: the pressures change, but the encoder does not count"]),
        (WiringFault::PressuresSwapped, &["pulses: the pressure transmitters are swapped"]),
        (
            WiringFault::PressureFloats,
            &["sensors at rest: pressure 1 (blind side; A5 of the Nucleo): swings between"],
        ),
        (WiringFault::EnableOpen, &["pulses: nothing answers the command: drive_enable does not reach"]),
        (WiringFault::WatchdogDead, &["watchdog: the watchdog does not bite"]),
    ];
    assert_eq!(faults.len(), WiringFault::ALL.len(), "each of them");
    at_once(&faults, |&(fault, says)| {
        assert_found(Rig::builtin("servo-b-tuned").expect("a built-in rig"), fault, says);
    });
}

/// That a bring-up of a rig with a fault says this, and nothing else.
fn assert_found(rig: Rig, fault: WiringFault, says: &[&str]) {
    let (rig, wiring) = rig_of(rig, &[fault], FAST);
    let mut client = Client::connect(rig.port()).expect("an answer");
    let report = bring_up(&mut client, &mut OneWhoSees(wiring), SOON).expect("a report");
    let found = advice(&report);
    assert_eq!(found.len(), says.len(), "{fault:?}: {found:#?}");
    for (found, says) in found.iter().zip(says) {
        assert!(found.starts_with(says), "{fault:?}: {found}");
    }
}

/// Nobody waits long.
const SOON: Options = Options {
    push_wait: Duration::from_secs(3),
    most_percent: 30,
    reach_mm: 40.0,
    reset_wait: Duration::from_secs(2),
};

fn without_pressure_sensors(name: &str) -> Rig {
    let rig = Rig::builtin(name).expect("a built-in rig");
    rig.with_settings(&["sensors.pressure=false".to_owned()]).expect("valid")
}

#[test]
fn a_drive_without_pressure_sensors_is_brought_up_by_the_rest_and_no_pressure_is_shown() {
    at_once(&["servo-b-tuned", "servo-a-tuned"], |name| {
        let (rig, wiring) = rig_of(without_pressure_sensors(name), &[], FAST);
        let report = brought_up(&rig, &wiring, true);
        let text = report.markdown();
        assert_eq!(advice(&report), [""; 0], "{name}: {text}");
        let is_open = |check: &&Check| check.verdict == Verdict::NotChecked;
        let open: Vec<&str> = report.checks.iter().filter(is_open).map(|check| check.name).collect();
        assert_eq!(open, ["sensors at rest", "drive stage"], "{name}: {text}");
        assert!(text.contains("the drive has no pressure sensors (sensors.pressure = false)"), "{text}");
        assert!(text.contains("pressures not measured") && !text.contains("kPa"), "{text}");
    });
}

#[test]
fn without_pressure_sensors_other_wires_are_still_found_by_what_is_left() {
    let faults = [
        (WiringFault::ValveInverted, &["pulses: the valve command is turned"][..]),
        (WiringFault::TubesSwapped, &["pulses: the tubes are swapped"]),
        (
            WiringFault::EncoderSwapped,
            &[
                "encoder by hand: the encoder counts the wrong way",
                "pulses: the encoder counts the wrong way",
            ],
        ),
        (
            WiringFault::EncoderPullUp,
            &[
                "pulses: the spool moves, but the encoder does not count. Without pressure sensors this may be",
            ],
        ),
        (WiringFault::EnableOpen, &["pulses: nothing answers the command, and the encoder counted by hand"]),
    ];
    at_once(&faults, |&(fault, says)| assert_found(without_pressure_sensors("servo-b-tuned"), fault, says));
}

/// Somebody who lets it move, and does something before a watchdog that is not fed bites.
struct Interferer<F>(Option<F>);

impl<F: FnOnce() + Send + 'static> Operator for Interferer<F> {
    fn tell(&mut self, text: &str) {
        if text.starts_with("the board feeds its watchdog no more")
            && let Some(interfere) = self.0.take()
        {
            std::thread::spawn(|| {
                std::thread::sleep(Duration::from_millis(100));
                interfere();
            });
        }
    }

    fn done(&mut self, _: &Check) {}

    fn lets_it_move(&mut self, _: &str) -> bool {
        true
    }

    fn answers(&mut self, _: &str) -> Option<bool> {
        None
    }

    fn goes_on(&mut self) -> Result<()> {
        Ok(())
    }
}

/// What a bring-up finds if the board does this in place of the reset by its watchdog.
fn found_with(interfere: impl FnOnce(Background, PersistentFlash) + Send + 'static) -> Vec<String> {
    let flash = PersistentFlash::default();
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let (rig, _) = served(VirtualRig::with_flash(rig, 0, FAST, flash.clone()).expect("a rig"), "127.0.0.1:0");
    let mut client = Client::connect(rig.port()).expect("an answer");
    let options = Options { push_wait: Duration::ZERO, ..SOON };
    let report = bring_up(&mut client, &mut Interferer(Some(|| interfere(rig, flash))), options);
    advice(&report.expect("a report"))
}

fn served(rig: VirtualRig, address: &str) -> (Background, Wiring) {
    let wiring = rig.wiring().clone();
    (Background::start(rig, Listener::open(&format!("tcp:{address}")).expect("a port")), wiring)
}

#[test]
fn a_board_that_never_comes_back_from_its_reset_is_found() {
    let found = found_with(|rig, _| drop(rig.stop()));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].starts_with("watchdog: the board does not come back: switch its supply off and on"));
}

/// Somebody has switched it off and on; the program opens its port again.
#[test]
fn a_board_that_comes_back_for_another_reason_is_found() {
    let found = found_with(|rig, flash| {
        let address = rig.port().strip_prefix("tcp://").expect("a TCP port").to_owned();
        rig.stop().expect("no failure");
        let again = Rig::builtin("servo-b-tuned").expect("a built-in rig");
        let again = VirtualRig::with_flash(again, 0, FAST, flash).expect("a rig");
        let (_again, _) = served(again, &address);
        std::thread::sleep(Duration::from_secs(10));
    });
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].starts_with("watchdog: the board was reset by something else"), "{found:?}");
}

/// The next bring-up finds the trial in the fault log, and no other reset by the watchdog.
#[test]
fn a_watchdog_that_was_tried_is_no_fault_of_the_board() {
    let (rig, wiring) = rig_with("servo-b-tuned", &[], FAST);
    for _ in 0..2 {
        let report = brought_up(&rig, &wiring, true);
        assert_eq!(advice(&report), [""; 0], "{}", report.markdown());
        let watchdog = report.checks.last().expect("checks");
        assert_eq!((watchdog.name, watchdog.verdict), ("watchdog", Verdict::Right));
        let says = "; the fault log says watchdog";
        assert!(
            watchdog.saw.starts_with("answers again after 0.") && watchdog.saw.ends_with(says),
            "{watchdog:?}"
        );
    }
}

/// Somebody who pushes the slide and lets it move, but touches no wire.
struct OneWhoSees(Wiring);

impl Operator for OneWhoSees {
    fn tell(&mut self, text: &str) {
        if text.starts_with("Push the slide OUT") {
            self.0.push();
        }
    }

    fn done(&mut self, _: &Check) {}

    fn lets_it_move(&mut self, _: &str) -> bool {
        true
    }

    fn answers(&mut self, _: &str) -> Option<bool> {
        None
    }

    fn goes_on(&mut self) -> Result<()> {
        Ok(())
    }
}

#[test]
fn an_amplifier_that_needs_no_enable_line_is_found_and_nothing_more_is_moved() {
    let (rig, wiring) = rig_with("servo-b-tuned", &[], FAST);
    let report = brought_up(&rig, &wiring, false);
    let found = advice(&report);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(
        found[0].starts_with("enable line: the amplifier drives the valve without drive_enable"),
        "{found:?}"
    );
    let pulses = report.checks.iter().find(|check| check.name == "pulses").expect("in the report");
    assert_eq!(pulses.verdict, Verdict::NotChecked);
}

/// What the advice says mends the fault.
#[test]
fn a_polarity_that_is_set_as_advised_mends_its_fault() {
    for (fault, id) in [
        (WiringFault::EncoderSwapped, id::ENCODER_INVERTED),
        (WiringFault::ValveInverted, id::OUTPUT_INVERTED),
    ] {
        let (rig, wiring) = rig_with("servo-b-tuned", &[fault], FAST);
        assert!(!advice(&brought_up(&rig, &wiring, true)).is_empty(), "{fault:?}");
        let mut client = Client::connect(rig.port()).expect("an answer");
        client.set_parameters(id, &[1]).expect("disarmed");
        assert_eq!(advice(&brought_up(&rig, &wiring, true)), [""; 0], "{fault:?}");
    }
}

#[test]
fn the_parameters_are_those_from_before() {
    let (rig, wiring) = rig_with("servo-b-tuned", &[], FAST);
    let mut client = Client::connect(rig.port()).expect("an answer");
    // Not stored: a reset takes them.
    client.set_parameters(id::VELOCITY_GAIN, &[77]).expect("disarmed");
    let record = MoveRecord { number: 3, next: Move::step(0, 5000), dwell: 9 };
    client.put_move_records(&[record]).expect("disarmed");
    let before = client.parameters().expect("an answer");
    let report = brought_up(&rig, &wiring, true);
    assert_eq!(report.checks.last().expect("checks").name, "watchdog");
    assert_eq!(client.parameters().expect("an answer"), before);
    assert_eq!(client.move_records().expect("an answer"), [record]);
}

#[test]
fn the_command_reports_to_a_file_and_as_json_and_its_exit_code_says_whether_all_is_right() {
    let folder = folder();
    let (rig, wiring) = rig_with("servo-b-tuned", &[], FAST);
    wiring.push_again_and_again();
    let call = |more: &str| {
        transcript(folder.path(), &format!("device --port {} bring-up --yes {more}", rig.port()))
    };
    let printed = call("--report report.md");
    assert!(printed.contains("right        encoder by hand: +") && printed.ends_with("= 0"), "{printed}");
    let report = std::fs::read_to_string(folder.path().join("report.md")).expect("written");
    assert!(
        report.starts_with("# Bring-up\n\n- board: virtual rig\n") && report.contains("| pulses |"),
        "{report}"
    );

    // A hand that is not asked for would move a slide that is to rest.
    wiring.push_no_more();
    wiring.spoil(WiringFault::PressuresSwapped);
    let printed = call("--push-wait 0 --json");
    assert!(printed.ends_with("= 1") && printed.contains("! error: wrong: pulses; "), "{printed}");
    let json = printed.split("\n!").next().expect("the output");
    let json: serde_json::Value = serde_json::from_str(json).expect("JSON");
    let checks = json["result"]["checks"].as_array().expect("a list");
    let verdict =
        |name: &str| &checks.iter().find(|check| check["name"] == name).expect("a check")["verdict"];
    assert_eq!([verdict("pulses"), verdict("watchdog")], ["wrong", "right"]);
}

#[test]
fn nothing_moves_where_nobody_can_be_asked() {
    let folder = folder();
    let (rig, _) = rig_with("servo-b-tuned", &[], FAST);
    let printed = transcript(folder.path(), &format!("device --port {} bring-up", rig.port()));
    assert!(
        printed.contains("--yes lets it move without being asked") && printed.ends_with("= 2"),
        "{printed}"
    );
}

#[test]
fn an_enabled_drive_is_not_brought_up() {
    let folder = folder();
    let (rig, _) = rig_with("servo-b-tuned", &[], FAST);
    transcript(folder.path(), &format!("device --port {} arm", rig.port()));
    let printed = transcript(folder.path(), &format!("device --port {} bring-up --yes", rig.port()));
    assert!(printed.contains("the drive is enabled") && printed.ends_with("= 5"), "{printed}");
}
