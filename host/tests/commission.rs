//! `pneudrive commission`: a drive by its data sheets finds its constants and positions with them.

use std::fs;

use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;

use crate::program::{exists, folder, ok, transcript};

/// The press, whose true parameters are within 10 % of those of its file, and which goes on between the runs.
fn press(seed: u64) -> Background {
    let rig = Rig::builtin("press").expect("a built-in rig").spread(0.1, seed).expect("within its ranges");
    let rig = VirtualRig::new(rig, seed, Pace { fast: false, live: true }).expect("a rig");
    Background::start(rig, Listener::open("tcp:127.0.0.1:0").expect("a port"))
}

#[test]
fn a_drive_finds_its_constants_takes_them_over_and_positions() {
    let (folder, rig) = (folder(), press(3));
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

#[test]
fn nothing_moves_where_nobody_can_be_asked() {
    let (folder, rig) = (folder(), press(3));
    let printed = transcript(folder.path(), &format!("commission press --port {}", rig.port()));
    assert!(printed.contains("the cylinder will move") && printed.contains("--yes"), "{printed}");
    assert!(printed.ends_with("= 2"), "{printed}");
}
