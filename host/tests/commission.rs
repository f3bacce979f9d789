//! `pneudrive commission`: a drive by its data sheets finds its constants and positions with them.

use std::fs;

use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_rigs::wiring::WiringFault;
use pneudrive_sim::Rig;

use crate::program::{exists, folder, ok, transcript};

/// The press at a port, whose true parameters are within 10 % of those of its file, and which goes on between the runs.
fn press_at(listener: &str, seed: u64, faults: &[WiringFault]) -> Background {
    let rig = Rig::builtin("press").expect("a built-in rig").spread(0.1, seed).expect("within its ranges");
    served(rig, listener, seed, faults)
}

fn served(rig: Rig, listener: &str, seed: u64, faults: &[WiringFault]) -> Background {
    let rig = VirtualRig::wired(rig, seed, Pace { fast: false, live: true }, faults).expect("a rig");
    Background::start(rig, Listener::open(listener).expect("a port"))
}

fn press(seed: u64, faults: &[WiringFault]) -> Background {
    press_at("tcp:127.0.0.1:0", seed, faults)
}

/// A serial port has one program at a time, so all steps share it.
#[cfg(unix)]
#[test]
fn a_drive_finds_its_constants_takes_them_over_and_positions() {
    let (folder, rig) = (folder(), press_at("pty", 3, &[]));
    let printed = ok(folder.path(), &format!("commission press --port {} --yes --out found", rig.port()));
    let files = ["fitted.toml", "identification.html", "commissioning.html", "TARGET01.DAT"];
    exists(&folder.path().join("found"), &files);
    assert!(
        printed.contains("The drive ") && printed.contains("Its twin with the values found "),
        "{printed}"
    );
    let fitted = fs::read_to_string(folder.path().join("found/fitted.toml")).expect("there");
    let found = Rig::read("fitted.toml", &fitted).expect("valid");
    let parameters =
        transcript(folder.path(), &format!("device --port {} config get cascade_span", rig.port()));
    let span = found.parameters().get(pneudrive_controller::parameters::id::CASCADE_SPAN).expect("a number");
    assert!(parameters.contains(&span.to_string()), "it has the parameters of the fit: {parameters}");
}

/// The file's friction is rigid; that of any seal gives way before it slides.
#[test]
#[ignore = "long: cargo xtask test long"]
fn a_drive_whose_seals_give_way_is_commissioned_with_such_friction() {
    let press = Rig::builtin("press").expect("a built-in rig");
    let bristles = press.with_plant(&["load.friction=lugre".to_owned()]).expect("valid");
    let rig = served(bristles.spread(0.1, 3).expect("within its ranges"), "tcp:127.0.0.1:0", 3, &[]);
    let folder = folder();
    let printed = ok(folder.path(), &format!("commission press --port {} --yes --out found", rig.port()));
    assert!(
        printed.contains("does not explain the transients; again with friction that gives way"),
        "{printed}"
    );
    let fitted = fs::read_to_string(folder.path().join("found/fitted.toml")).expect("there");
    assert!(fitted.contains("friction = \"lugre\""), "{fitted}");
}

#[test]
fn nothing_moves_where_nobody_can_be_asked() {
    let (folder, rig) = (folder(), press(3, &[]));
    let printed = transcript(folder.path(), &format!("commission press --port {}", rig.port()));
    assert!(printed.contains("the cylinder will move") && printed.contains("--yes"), "{printed}");
    assert!(printed.ends_with("= 2"), "{printed}");
}

/// In closed loop it would run to an end.
#[test]
fn a_drive_with_swapped_tubes_is_told_before_it_moves_in_closed_loop() {
    let (folder, rig) = (folder(), press(3, &[WiringFault::TubesSwapped]));
    let before = transcript(folder.path(), &format!("device --port {} config get", rig.port()));
    let printed = transcript(folder.path(), &format!("commission press --port {} --yes", rig.port()));
    assert!(printed.contains("tubes of the valve's ports are swapped"), "{printed}");
    assert!(!printed.contains("3. the middle"), "{printed}");
    let after = transcript(folder.path(), &format!("device --port {} config get", rig.port()));
    assert_eq!(after, before, "it has what it had");
}

#[test]
fn what_would_be_refused_in_the_end_is_refused_before_anything_moves() {
    let (folder, rig) = (folder(), press(3, &[]));
    let refused = [
        ("--set sensors.pressure=false", "sensors.pressure"),
        ("--set controller.loop=open", "controller.loop"),
        ("--set safety.end_max_mm=150 --trial 40", "safety.end_max"),
    ];
    for (setting, why) in refused {
        let command = format!("commission press {setting} --port {} --yes", rig.port());
        let printed = transcript(folder.path(), &command);
        assert!(printed.contains(why) && !printed.contains("1. the parameters"), "{printed}");
    }
}

/// Ctrl-C while the fit computes: the longest step, in which nothing moves.
#[cfg(unix)]
#[test]
fn an_interrupted_commission_gives_the_drive_back_what_it_had() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let (folder, rig) = (folder(), press(3, &[]));
    let parameters = || transcript(folder.path(), &format!("device --port {} config get", rig.port()));
    ok(folder.path(), &format!("device --port {} config set velocity_gain 17", rig.port()));
    let before = parameters();
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder.path()).args(["commission", "press", "--yes", "--port", rig.port()]);
    let mut program = command.stderr(Stdio::piped()).spawn().expect("it starts");
    let lines = BufReader::new(program.stderr.take().expect("piped")).lines();
    let mut told = String::new();
    for line in lines.map_while(Result::ok) {
        told += &format!("{line}\n");
        if line.starts_with("the first ") && !told.contains("kill") {
            let kill = format!("kill -INT {}", program.id());
            assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
            told += "kill\n";
        }
    }
    assert_eq!(program.wait().expect("it was started").code(), Some(130), "{told}");
    assert!(told.contains("has the parameters again") && told.contains("stopped by Ctrl-C"), "{told}");
    assert_eq!(parameters(), before);
}
