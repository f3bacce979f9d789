//! Faults of board, wires and supply, injected while the drive moves, and what becomes of each.
//!
//! docs/explanation/hazards.md has the table, written from this list and held against it. Its times are limits that hold at both
//! ends of what is not known of the board; a hazard that nothing detects stands there as such, and its test fails once
//! something does.

use std::fmt::Write;

use pneudrive_controller::Fault;
use pneudrive_flashed_image::machine::Machine;
use pneudrive_flashed_image::target::FlashedTarget;
use pneudrive_flashed_image::time::{Corner, FAST, MILLISECOND, SLOWEST, Ticks};
use pneudrive_hil_tests::{Target, body};
use pneudrive_link::client::Client;
use pneudrive_sim::Rig;

/// The variable that has the table written anew: any value.
const WRITE: &str = "PNEUDRIVE_WRITE_HAZARDS";

/// The line of docs/explanation/hazards.md behind which the table begins.
const BEGIN: &str = "<!-- from here on written by `cargo xtask flashed --write` -->\n";

/// What becomes of a hazard.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Outcome {
    /// `drive_enable` is low within so many milliseconds, and the drive tells the fault.
    Trips { within_ms: u64, fault: Fault, sees: &'static str },
    /// The same after a reset by the watchdog, or by the program.
    Resets { within_ms: u64, fault: Fault },
    /// `drive_enable` is low within so many milliseconds, and the board does not come up again.
    Silent { within_ms: u64 },
}

use Outcome::{Resets, Silent, Trips};

/// Something that goes wrong.
struct Hazard {
    what: &'static str,
    detected_by: &'static str,
    /// Event of the rig file, for a fault of the plant itself; `now` has it happen then.
    event: Option<&'static str>,
    inject: fn(&mut Machine),
    outcome: Outcome,
}

fn nothing(_: &mut Machine) {}

/// Every hazard that can be injected here.
fn hazards() -> Vec<Hazard> {
    let range = |within_ms| Trips { within_ms, fault: Fault::SensorRange, sees: "sensor-range" };
    let no_motion = |within_ms| Trips { within_ms, fault: Fault::NoMotion, sees: "no-motion" };
    vec![
        Hazard {
            what: "wire of pressure 1 open",
            detected_by: "range of the sensor",
            event: None,
            inject: |machine| machine.board().bench.wiring.sensors_open[0] = true,
            outcome: range(8),
        },
        Hazard {
            what: "wire of pressure 2 open",
            detected_by: "range of the sensor",
            event: None,
            inject: |machine| machine.board().bench.wiring.sensors_open[1] = true,
            outcome: range(8),
        },
        Hazard {
            what: "converter stuck",
            detected_by: "conversions that do not come",
            event: None,
            inject: |machine| machine.board().stick_converter(),
            outcome: range(8),
        },
        Hazard {
            what: "track A of the encoder off",
            detected_by: "command without motion",
            event: None,
            inject: |machine| machine.board().bench.wiring.tracks_off[0] = true,
            outcome: no_motion(520),
        },
        Hazard {
            what: "track B of the encoder off",
            detected_by: "command without motion",
            event: None,
            inject: |machine| machine.board().bench.wiring.tracks_off[1] = true,
            outcome: no_motion(520),
        },
        Hazard {
            what: "spool stuck",
            detected_by: "command without motion",
            event: Some("kind = \"stuck-spool\"\nat_s = 0.15"),
            inject: nothing,
            outcome: no_motion(850),
        },
        Hazard {
            what: "line to the host cut",
            detected_by: "silence of the host",
            event: None,
            inject: |machine| machine.cut_line(true),
            outcome: Trips { within_ms: 510, fault: Fault::HostSilent, sees: "host-silent" },
        },
        Hazard {
            what: "jump to where no memory is",
            detected_by: "fault of the processor",
            event: None,
            inject: |machine| machine.jump(0x6000_0000).expect("an emulator that takes it"),
            outcome: Resets { within_ms: 1, fault: Fault::Panic },
        },
        Hazard {
            what: "program stands still",
            detected_by: "watchdog",
            event: None,
            inject: |machine| machine.board().locked_up = true,
            outcome: Resets { within_ms: 475, fault: Fault::Watchdog },
        },
        Hazard {
            what: "clock of the board lost",
            detected_by: "clock security system",
            event: None,
            inject: |machine| machine.board().lose_crystal(),
            outcome: Silent { within_ms: 1 },
        },
        Hazard {
            what: "processor halted by a debugger",
            detected_by: "watchdog",
            event: None,
            inject: |machine| machine.board().halt(),
            outcome: Silent { within_ms: 475 },
        },
    ]
}

/// The sample at which it goes wrong: 50 ms after the drive was told to move.
const SAMPLE: u64 = 116;

/// A drive that moves, and will be hit at [`SAMPLE`].
fn moving(hazard: &Hazard, corner: Corner) -> (FlashedTarget, Client) {
    let moves = ["test.duration_s=60", "test.moves=[[0.0, 8192], [0.1, 20000], [1.5, 8192], [3.0, 20000]]"];
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let event = hazard.event.map_or(String::new(), |event| format!("\n[[faults.event]]\n{event}\n"));
    let moves = moves.map(str::to_owned);
    let rig = Rig::read_with("servo-b-tuned", &format!("{text}{event}"), &moves);
    let rig = rig.unwrap_or_else(|problems| panic!("{problems}"));
    let target = FlashedTarget::start(&rig, corner).expect("a board");
    let inject = hazard.inject;
    target.with(move |machine| machine.inject_at(SAMPLE, Box::new(inject))).expect("a board that runs");
    let mut client = target.connect().expect("a rig that answers");
    body::start_run(&mut client, &rig);
    (target, client)
}

/// How long the drive stayed enabled after it was hit, and how long ago that was, ticks.
fn since_hit(target: &FlashedTarget) -> Option<(Option<Ticks>, Ticks)> {
    let look = |machine: &mut Machine| {
        let hit = machine.injected?;
        let board = machine.board();
        let low = board.enable_log.iter().find(|(at, enabled)| *at >= hit && !enabled);
        Some((low.map(|(at, _)| at - hit), board.now - hit))
    };
    target.with(look).expect("a board that runs")
}

/// How long the drive stays enabled, ms; None: as long as was waited. The host asks for the status meanwhile, unless
/// its line is cut or nobody can answer.
fn enabled_for(hazard: &Hazard, target: &FlashedTarget, client: &mut Client, wait_ms: u64) -> Option<f64> {
    let answers = matches!(hazard.outcome, Trips { fault, .. } if fault != Fault::HostSilent);
    loop {
        let hit = since_hit(target);
        if answers || hit.is_none() {
            let _ = client.status();
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
        match hit {
            Some((Some(low), _)) => return Some(low as f64 / MILLISECOND as f64),
            Some((None, ago)) if ago > wait_ms * MILLISECOND => return None,
            _ => {}
        }
    }
}

fn newest_fault(client: &mut Client) -> Option<u8> {
    client.events().expect("a log").first().map(|event| event.code)
}

/// Injects a hazard and holds what becomes of it against the list.
fn hold(hazard: &Hazard, corner: Corner) {
    let what = format!("{}, {} cycles an instruction", hazard.what, corner.cycles_per_instruction);
    let (target, mut client) = moving(hazard, corner);
    let wait_ms = match hazard.outcome {
        Trips { within_ms, .. } | Resets { within_ms, .. } | Silent { within_ms } => within_ms + 200,
    };
    let low_ms = enabled_for(hazard, &target, &mut client, wait_ms);
    target.with(|machine| machine.cut_line(false)).expect("a board that runs");
    println!("{what}: low after {low_ms:?} ms");
    let low_ms = low_ms.unwrap_or_else(|| panic!("{what}: the drive stays enabled"));
    let (Trips { within_ms, .. } | Resets { within_ms, .. } | Silent { within_ms }) = hazard.outcome;
    assert!(low_ms <= within_ms as f64, "{what}: {low_ms} ms");
    match hazard.outcome {
        Trips { fault, sees, .. } => {
            let error = client.follow(&false.into(), |_| {}).expect_err("it has tripped").to_string();
            assert!(error.contains(sees), "{what}: {error}");
            assert_eq!(newest_fault(&mut client), Some(fault.code()), "{what}");
        }
        Resets { fault, .. } => {
            drop(client);
            let mut client = target.connect().expect("a board that comes up again");
            assert_eq!(client.status().expect("an answer").fault, fault.code(), "{what}");
            assert_eq!(newest_fault(&mut client), Some(fault.code()), "{what}");
        }
        Silent { .. } => assert!(client.status().is_err(), "{what}: the board answers"),
    }
}

/// All of them, so that one that ends otherwise does not hide the next.
fn hold_all(corner: Corner) {
    let held = |hazard: &&Hazard| std::panic::catch_unwind(|| hold(hazard, corner)).is_ok();
    let failed: Vec<&str> =
        hazards().iter().filter(|hazard| !held(hazard)).map(|hazard| hazard.what).collect();
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn every_hazard_ends_as_the_list_says_with_fast_code_and_a_slow_watchdog() {
    hold_all(FAST);
}

#[test]
fn every_hazard_ends_as_the_list_says_with_slow_code_and_a_fast_watchdog() {
    hold_all(SLOWEST);
}

#[test]
fn noise_on_the_line_costs_requests_and_changes_nothing_in_the_run() {
    let rig = body::rig("servo-b-tuned", &["test.duration_s=0.5", "test.moves=[[0.0, 8192], [0.1, 16384]]"]);
    let target = FlashedTarget::start(&rig, FAST).expect("a board");
    target.with(|machine| machine.disturb(Some(251))).expect("a board that runs");
    body::assert_equal_in_every_integer(&target, &rig);
    let mut client = target.connect().expect("a rig that answers");
    let damaged = (0..200).any(|_| client.status().expect("an answer").damaged_frames > 0);
    assert!(damaged, "no frame was hit");
}

fn row(hazard: &Hazard) -> String {
    let Hazard { what, detected_by, outcome, .. } = hazard;
    let named = |fault: Fault| format!("{} ({fault:?})", fault.code());
    let (time, code, sees) = match *outcome {
        Trips { within_ms, fault, sees } => {
            (format!("{within_ms} ms"), named(fault), format!("fault `{sees}`"))
        }
        Resets { within_ms, fault } => {
            (format!("{within_ms} ms"), named(fault), "another boot, in this fault".to_owned())
        }
        Silent { within_ms } => (format!("{within_ms} ms"), "none".to_owned(), "no answer".to_owned()),
    };
    format!("| {what} | {detected_by} | {time} | {code} | {sees} |\n")
}

#[test]
fn the_table_of_the_documentation_is_this_list() {
    let path = pneudrive_build::cargo::root().join("docs/explanation/hazards.md");
    let text = std::fs::read_to_string(&path).expect("docs/explanation/hazards.md");
    let (head, table) = text.split_once(BEGIN).expect("a line that says where the table begins");
    let mut now =
        String::from("\n| fault | detected by | `drive_enable` low within | code | the operator sees |\n");
    now.push_str("|---|---|---|---|---|\n");
    hazards().iter().for_each(|hazard| now.push_str(&row(hazard)));
    if std::env::var_os(WRITE).is_some() {
        let mut whole = String::new();
        let _ = write!(whole, "{head}{BEGIN}{now}");
        return std::fs::write(&path, whole).expect("docs/explanation/hazards.md is written");
    }
    assert_eq!(table, now, "cargo xtask flashed --write");
}
