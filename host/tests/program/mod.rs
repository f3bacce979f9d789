//! The program as a user calls it, and rigs for it to talk to.

use std::path::Path;
use std::process::{Command, Output};

use pneudrive_records::target::TargetFile;
use pneudrive_rigs::virtual_rig::{Background, Listener, Pace, VirtualRig};
use pneudrive_sim::Rig;

/// A rig file: an open loop with two strokes, without dither, half a second.
pub const STROKES: &str = include_str!("../fixtures/strokes.toml");

/// Runs `pneudrive` in a folder with arguments as typed.
pub fn pneudrive(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder).args(arguments.split_whitespace()).env_remove("RUST_BACKTRACE");
    command.output().expect("the program runs")
}

/// Output and exit code as a transcript; stderr behind `!`.
pub fn transcript(folder: &Path, arguments: &str) -> String {
    let output = pneudrive(folder, arguments);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
    let errors: String = text(&output.stderr).lines().map(|line| format!("! {line}\n")).collect();
    format!("{}{errors}= {}", text(&output.stdout), output.status.code().expect("it was not killed"))
}

pub fn ok(folder: &Path, arguments: &str) -> String {
    let output = pneudrive(folder, arguments);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(output.status.success(), "{arguments}: {text}{}", String::from_utf8_lossy(&output.stderr));
    text
}

pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

pub fn exists(folder: &Path, names: &[&str]) {
    for name in names {
        assert!(folder.join(name).is_file(), "{name} is not there");
    }
}

/// A fast virtual rig in this process.
pub fn virtual_rig(name: &str) -> Background {
    virtual_rig_at(name, "tcp:127.0.0.1:0")
}

/// The same, at this door.
pub fn virtual_rig_at(name: &str, listener: &str) -> Background {
    background(name, listener, Pace { fast: true, live: false })
}

/// A rig whose moves take their time.
pub fn unhurried_rig(name: &str) -> Background {
    background(name, "tcp:127.0.0.1:0", Pace { fast: false, live: false })
}

fn background(name: &str, listener: &str, pace: Pace) -> Background {
    start(Rig::builtin(name).expect("a built-in rig"), listener, pace)
}

/// A fast virtual rig that is not built in.
pub fn virtual_rig_of(rig: Rig) -> Background {
    Background::of(rig).expect("a rig")
}

fn start(rig: Rig, listener: &str, pace: Pace) -> Background {
    let rig = VirtualRig::new(rig, 0, pace).expect("a rig");
    Background::start(rig, Listener::open(listener).expect("a port"))
}

/// TARGET01.DAT of the test of a rig file, next to it, on a rig with other values.
pub fn recorded_with(folder: &Path, text: &str, hidden: &[(&'static str, f64)]) {
    std::fs::write(folder.join("rig.toml"), text).expect("written");
    let real = Rig::read("rig.toml", text).expect("valid").with_numbers(hidden).expect("valid");
    let rig = virtual_rig_of(real);
    ok(folder, &format!("run rig.toml --port {}", rig.port()));
    ok(folder, &format!("record --port {}", rig.port()));
    rig.stop().expect("it served");
}

/// A TARGET file with a line of its header changed, added before the CRC, or left out.
pub fn with_line(text: &str, key: &str, value: Option<&str>) -> String {
    let mut file = TargetFile::from_text(text).expect("a TARGET file");
    file.header.retain(|(name, _)| name != key);
    file.header.extend(value.map(|value| (key.to_owned(), value.to_owned())));
    file.seal();
    file.to_text()
}
