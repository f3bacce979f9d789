//! `pneudrive fmu` as a user meets it. What is in the FMU is tested by `cargo xtask test fmu`.

use std::fs;

use crate::program::{exists, folder, ok, transcript};

#[test]
fn each_part_becomes_a_file_that_is_the_same_every_time() {
    let folder = folder();
    for part in ["plant", "controller", "drive"] {
        let said = ok(folder.path(), &format!("fmu servo-b-tuned --{part}"));
        assert!(
            said.contains(&format!("{part} of servo-b-tuned")) && said.contains("a step is 0.0013 s"),
            "{said}"
        );
        ok(folder.path(), &format!("fmu servo-b-tuned --{part} -o again.fmu --overwrite"));
        let name = format!("servo-b-tuned-{part}.fmu");
        exists(folder.path(), &[&name]);
        let [first, again] =
            [&name[..], "again.fmu"].map(|name| fs::read(folder.path().join(name)).expect("written"));
        assert!(first.starts_with(b"PK") && first == again);
    }
}

#[test]
fn what_cannot_be_an_fmu_is_refused_and_nothing_is_written() {
    let folder = folder();
    fs::write(folder.path().join("mine.fmu"), "mine").expect("written");
    fs::write(folder.path().join("no.so"), "no library").expect("written");
    for (arguments, code, says) in [
        ("fmu servo-b", 2, "--plant|--controller|--drive"),
        ("fmu servo-b --plant --drive", 2, "cannot be used with"),
        ("fmu nothing.toml --plant", 3, "there is no rig file nothing.toml"),
        ("fmu servo-b --plant --out mine.fmu", 1, "mine.fmu already exists"),
        ("fmu servo-b --plant --library no.so", 1, "no.so is not the library of FMUs"),
        ("fmu servo-b --plant --library gone.so", 3, "cannot read gone.so"),
        ("fmu servo-b --plant --set load.mass_kg=-1", 1, "load.mass_kg"),
        ("fmu servo-b --drive --set faults.gain_bug=positive-error", 1, "is a bug"),
    ] {
        let said = transcript(folder.path(), arguments);
        assert!(said.contains(says) && said.ends_with(&format!("= {code}")), "{arguments}: {said}");
    }
    assert_eq!(fs::read(folder.path().join("mine.fmu")).expect("there"), b"mine");
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 2);
}

#[test]
fn what_is_set_goes_into_the_rig_file_of_the_fmu() {
    let folder = folder();
    ok(folder.path(), "fmu servo-b-tuned --plant -o usual.fmu");
    ok(
        folder.path(),
        "fmu servo-b-tuned --plant --set load.mass_kg=9.5 --set controller.period_s=0.002 -o heavy.fmu",
    );
    let [usual, heavy] =
        ["usual.fmu", "heavy.fmu"].map(|name| fs::read(folder.path().join(name)).expect("written"));
    assert_ne!(usual, heavy);
}
