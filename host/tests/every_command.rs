//! Every command that takes a rig, on a drive by its data sheets: level, inclined, and vertical with its load above or below.
//! `characterise` and `fmu` have tests of their own.

use std::path::Path;

use pneudrive_sim::Rig;

use crate::program::{folder, ok, virtual_rig_of};

const INCLINES: [&str; 4] = ["0", "30", "90", "-90"];

const DRIVE: &str =
    "--cylinder iso-15552-32 --stroke 250mm --mass 8kg --valve proportional-5-3-350 --no-questions";

const SWEEP: &str = "rig = \"d.toml\"\nsettled_mm = 1.0\n[vary]\nload.mass_kg = [6.0, 8.0]\n[metrics]\nsettling_s = \"settling_s\"\n";

/// Commands without a rig at a port, in an order in which each finds what it reads.
const ALONE: [&str; 11] = [
    "rig show d.toml",
    "rig diff d.toml servo-b",
    "rig check d.toml",
    "simulate d.toml --out sim",
    "eval sim",
    "spectrum sim position",
    "export sim --to csv",
    "ladder d.toml --out ladder",
    "sweep s.toml --out sweep",
    "demo --rig d.toml --out demo",
    "replay demo/TARGET01.DAT",
];

/// Makes the drive in a folder.
fn new_drive(folder: &Path, incline: &str) -> Rig {
    ok(folder, &format!("rig new d.toml {DRIVE} --incline={incline}deg"));
    let text = std::fs::read_to_string(folder.join("d.toml")).expect("written");
    Rig::read("d.toml", &text).unwrap_or_else(|problems| panic!("{incline}: {problems}"))
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn each_command_takes_a_drive_of_ones_own_level_inclined_and_vertical() {
    for incline in INCLINES {
        let folder = folder();
        let rig = virtual_rig_of(new_drive(folder.path(), incline));
        std::fs::write(folder.path().join("s.toml"), SWEEP).expect("written");
        ALONE.iter().for_each(|command| drop(ok(folder.path(), command)));
        for command in ["device --port PORT status", "run d.toml --port PORT", "record --port PORT"] {
            ok(folder.path(), &command.replace("PORT", rig.port()));
        }
        ok(folder.path(), "overlay TARGET01.DAT sim");
        rig.stop().expect("it served");
    }
}

#[test]
#[ignore = "long: cargo xtask test long"]
fn a_drive_of_ones_own_is_tuned_and_identified_level_inclined_and_vertical() {
    for incline in INCLINES {
        let folder = folder();
        let rig = virtual_rig_of(new_drive(folder.path(), incline));
        ok(
            folder.path(),
            "tune d.toml --set controller.law=gain-profile --settled 2 --overshoot 50 --population 3 --generations 1 --draws 3 --out t",
        );
        let plan = format!("identify d.toml --plan {} --fit load.mass_kg --out id", rig.port());
        let printed = ok(folder.path(), &plan);
        assert!(printed.contains("load.mass_kg"), "{incline}: {printed}");
        rig.stop().expect("it served");
    }
}
