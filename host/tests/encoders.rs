//! Drives with absolute encoders: homed from the start, run, recorded, simulated and replayed like any other.

use std::fs;

use crate::program::{folder, ok, transcript, virtual_rig_of};
use pneudrive_records::run_folder::StoredRun;
use pneudrive_sim::Rig;

/// The tuned drive B with another encoder.
fn rig_text(encoder: &str, moves: &str) -> String {
    let text = pneudrive_sim::rigfile::builtin("servo-b-tuned").expect("a built-in rig");
    let (before, after) = text.split_once("mm_per_count = 0.01205").expect("its encoder");
    format!("{before}{encoder} {after}").replace("[[0.0, 8192], [0.3, 16384], [1.72, 8192]]", moves)
}

const SSI: &str = "model = \"ssi\"\nzero_mm = -7.3\nmm_per_count = 0.01205";
const POTENTIOMETER: &str = "model = \"potentiometer\"\nzero_mm = -5\nrange_mm = 310";

fn drives() -> [(String, f64, &'static str); 2] {
    let (fine, coarse) = ("[[0.0, 8192], [0.3, 16384]]", "[[0.0, 1304], [0.3, 2608]]");
    [
        (rig_text(SSI, fine), 0.01205, "# param.encoder_model = 2\n"),
        (rig_text(POTENTIOMETER, coarse), 310.0 / 4095.0, "# param.encoder_model = 1\n"),
    ]
}

#[test]
fn a_drive_with_an_absolute_encoder_is_homed_from_the_start() {
    for (text, ..) in drives() {
        let (folder, rig) = (folder(), virtual_rig_of(Rig::read("rig", &text).expect("valid")));
        let device = |what: &str| transcript(folder.path(), &format!("device --port {} {what}", rig.port()));
        assert!(device("status").contains("\nreferenced  yes\n"));
        let said = device("home");
        let none = "no homing is needed, as the encoder is absolute: the axis is at ";
        assert!(said.starts_with(none) && said.ends_with(" mm\n= 0"), "{said}");
        let zero = || {
            let said = device("reference 98.72mm");
            let number =
                said.split("encoder_zero_counts is now ").nth(1).and_then(|rest| rest.split(',').next());
            number.and_then(|number| number.parse::<i32>().ok()).unwrap_or_else(|| panic!("{said}"))
        };
        let first = zero();
        assert_eq!(
            device("config get encoder_zero_counts"),
            format!("encoder_zero_counts = {first} counts\n= 0")
        );
        // The axis rests; the reading has noise.
        assert!((zero() - first).abs() <= 3, "the same place, said again, has the same zero");
    }
}

#[test]
fn the_record_of_an_absolute_encoder_is_in_its_counts_and_replays() {
    for (text, mm_per_count, model) in drives() {
        let folder = folder();
        fs::write(folder.path().join("rig.toml"), &text).expect("written");
        let rig = virtual_rig_of(Rig::read("rig", &text).expect("valid"));
        ok(folder.path(), &format!("run rig.toml --port {}", rig.port()));
        ok(folder.path(), &format!("record --port {}", rig.port()));
        let recorded = fs::read_to_string(folder.path().join("TARGET01.DAT")).expect("a record");
        assert!(recorded.contains(model), "{recorded:.2000}");
        let scale = recorded.lines().find_map(|line| line.strip_prefix("# mm_per_count = "));
        let scale: f64 = scale.and_then(|text| text.parse().ok()).expect("a scale");
        assert!((scale / mm_per_count - 1.0).abs() < 1e-7, "{scale}, to whole picometres");
        let said = ok(folder.path(), "replay TARGET01.DAT");
        assert!(said.contains("samples, every command as recorded"), "{said}");
        ok(folder.path(), "simulate rig.toml --ensemble 1 --no-report --out sim");
        let run = StoredRun::read(&folder.path().join("sim")).expect("a run");
        assert_eq!(run.mm_per_count, mm_per_count);
        ok(folder.path(), "overlay TARGET01.DAT sim");
    }
}
