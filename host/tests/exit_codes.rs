//! Each exit code of docs/reference/exit-codes.md.

use std::fs;
use std::path::Path;

use pneudrive::exit::{EXITS, help};
use pneudrive_sim::Rig;

use crate::program::{folder, ok, pneudrive, transcript, unhurried_rig, virtual_rig, virtual_rig_of};

fn code(folder: &Path, arguments: &str) -> i32 {
    pneudrive(folder, arguments).status.code().expect("it was not killed")
}

#[test]
fn the_help_lists_the_codes() {
    let folder = folder();
    let printed = ok(folder.path(), "--help");
    assert!(printed.contains(help().trim_end()), "{printed}");
    assert!(EXITS.len() > 8);
}

#[test]
fn what_is_done_ends_with_0_and_wrong_use_with_2() {
    let folder = folder();
    assert_eq!(code(folder.path(), "rig list"), 0);
    // A trip of a simulated drive is what was asked for.
    let open = "[[faults.event]]\nkind = \"sensor-open\"\nsensor = \"pressure-1\"\nat_s = 0.1\n";
    fs::write(folder.path().join("open.toml"), open).expect("written");
    let printed = transcript(folder.path(), "simulate open.toml --ensemble 1 --no-report --out run");
    assert!(printed.contains("tripped at sample") && printed.ends_with("= 0"), "{printed}");
    assert_eq!(code(folder.path(), "simulate servo-b"), 2);
}

/// For a test that is run by a script: the same files, and an end that tells.
#[test]
fn strictly_a_simulated_trip_ends_with_6_and_an_unconverged_run_with_9() {
    let folder = folder();
    let open = "[[faults.event]]\nkind = \"sensor-open\"\nsensor = \"pressure-1\"\nat_s = 0.1\n";
    fs::write(folder.path().join("open.toml"), open).expect("written");
    for (rig, expected) in [
        ("open.toml", 6),
        ("servo-b-tuned --tolerance 1e-3", 9),
        ("servo-b-tuned --set test.duration_s=0.5", 0),
    ] {
        let simulate = format!("simulate {rig} --ensemble 1 --no-report --overwrite --out run");
        assert_eq!(code(folder.path(), &simulate), 0, "{rig}");
        let run = || fs::read(folder.path().join("run/trace.csv")).expect("written");
        let before = run();
        assert_eq!(code(folder.path(), &format!("{simulate} --strict")), expected, "{rig}");
        assert_eq!(run(), before, "{rig}: the same files");
    }
}

#[test]
fn a_file_with_errors_ends_with_1() {
    let folder = folder();
    fs::write(folder.path().join("wrong.toml"), "[load]\nmass_kgs = 2\n").expect("written");
    assert_eq!(code(folder.path(), "rig check wrong.toml"), 1);
    fs::write(folder.path().join("wrong.dat"), "hello\n").expect("written");
    assert_eq!(code(folder.path(), "eval wrong.dat"), 1);
}

#[test]
fn what_is_not_there_ends_with_3() {
    let folder = folder();
    for arguments in [
        "rig check nothing.toml",
        "simulate nothing --out run",
        "eval TARGET07.DAT",
        "eval nothing",
        "overlay TARGET07.DAT run",
        "replay TARGET07.DAT",
        "identify servo-b TARGET07.DAT",
        "spectrum TARGET07.DAT position",
        "sweep nothing.toml",
        "merge nothing --out whole",
        "virtual nothing --listen pty",
    ] {
        assert_eq!(code(folder.path(), arguments), 3, "{arguments}");
    }
}

#[test]
fn a_port_without_a_rig_ends_with_4() {
    let folder = folder();
    for port in ["tcp://127.0.0.1:1", "/dev/no-such-port", "pty:/no/such/pty"] {
        assert_eq!(code(folder.path(), &format!("device --port {port} info")), 4, "{port}");
        assert_eq!(code(folder.path(), &format!("run servo-b --port {port}")), 4, "{port}");
    }
}

/// The link breaks in the middle: once this ended with 1.
#[test]
fn a_rig_that_closes_the_connection_ends_with_4() {
    use std::process::{Command, Stdio};
    let asks = [
        "monitor --every 0.02 --port",
        "run servo-b-tuned --set test.duration_s=20 --port",
        "run servo-b-tuned --set test.duration_s=20 --stream s.csv --port",
    ];
    for asked in asks {
        let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
        let line = format!("{asked} {}", rig.port());
        let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
        command.current_dir(folder.path()).args(line.split_whitespace());
        let mut program = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it runs");
        std::thread::sleep(std::time::Duration::from_millis(700));
        drop(rig);
        assert_eq!(program.wait().expect("it was started").code(), Some(4), "{asked}");
    }
}

#[test]
fn a_rig_that_refuses_ends_with_5() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |action: &str| code(folder.path(), &format!("device --port {} {action}", rig.port()));
    assert_eq!(device("arm"), 0);
    assert_eq!(device("config set velocity_gain 7"), 5, "it is armed");
    assert_eq!(device("stop"), 0);
    assert_eq!(
        code(folder.path(), &format!("run servo-b-tuned --port {}", rig.port())),
        5,
        "it is in a fault"
    );
    assert_eq!(device("arm"), 0);
    assert_eq!(device("disarm"), 0);
    assert_eq!(device("config set velocity_gain 70000"), 5, "out of range");
}

#[test]
fn what_the_state_of_the_rig_does_not_allow_ends_with_5() {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    let device = |action: &str| code(folder.path(), &format!("device --port {} {action}", rig.port()));
    let record = || code(folder.path(), &format!("record --port {}", rig.port()));
    assert_eq!(device("home"), 5, "it is disarmed");
    assert_eq!(record(), 5, "nothing has been recorded");
    assert_eq!(device("config export all.txt"), 0);
    assert_eq!(device("arm"), 0);
    assert_eq!(device("config import all.txt"), 5, "it is armed");
    assert_eq!(record(), 5, "a run has yet to come");
}

#[test]
fn a_drive_that_another_program_commands_ends_with_5() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let mut owner = pneudrive_link::client::Client::connect(rig.port()).expect("a rig");
    owner.arm().expect("armed");
    let printed = transcript(folder.path(), &format!("device --port {} disarm", rig.port()));
    assert!(printed.contains("commands the drive") && printed.ends_with("= 5"), "{printed}");
}

#[test]
fn a_drive_that_trips_during_its_run_ends_with_6() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let run = format!("run servo-b-tuned --set test.duration_s=20 --port {}", rig.port());
    let program = std::thread::scope(|scope| {
        let program = scope.spawn(|| transcript(folder.path(), &run));
        // Another program stops it.
        while !transcript(folder.path(), &format!("device --port {} status", rig.port())).contains("running")
        {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        ok(folder.path(), &format!("device --port {} stop", rig.port()));
        program.join().expect("it ends")
    });
    assert!(program.contains("tripped at sample") && program.ends_with("= 6"), "{program}");
}

/// So few samples, on converters so coarse, that no fit to them can be judged.
const BRIEF: &str = "\
controller.loop = \"open\"
operator.dither_mm = 0.0
test.moves = [[0.0, 0], [0.066, 1200]]
test.duration_s = 0.07
sensors.pressure_max_pa = 1e7
";

#[test]
fn data_that_do_not_bear_it_out_end_with_7() {
    let folder = folder();
    fs::write(folder.path().join("rig.toml"), BRIEF).expect("written");
    let real = Rig::read("rig.toml", &format!("{BRIEF}operator.spring_n_per_mm = 22.0\n")).expect("valid");
    let rig = virtual_rig_of(real);
    ok(folder.path(), &format!("run rig.toml --config --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    let printed = transcript(folder.path(), "identify rig.toml TARGET01.DAT --fit operator.spring_n_per_mm");
    assert!(printed.contains("too few samples to judge") && printed.ends_with("= 7"), "{printed}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_cannot_be_written_ends_with_8() {
    let folder = folder();
    let printed =
        limited(folder.path(), 8, "simulate servo-b --set test.duration_s=1 --ensemble 1 --out run");
    assert!(
        printed.contains("cannot write run/trace.csv: File too large") && printed.ends_with("= 8"),
        "{printed}"
    );
}

/// A file-size limit in KiB, as a shell sets it; once it killed the program.
#[cfg(target_os = "linux")]
fn limited(folder: &Path, limit: u32, arguments: &str) -> String {
    let program = env!("CARGO_BIN_EXE_pneudrive");
    let line = format!("ulimit -f {limit}; {program} {arguments} 2>&1; echo = $?");
    let mut shell = std::process::Command::new("bash");
    let output = shell.current_dir(folder).args(["-c", &line]).output().expect("a shell");
    String::from_utf8_lossy(&output.stdout).trim_end().to_owned()
}

#[cfg(unix)]
#[test]
fn a_run_that_ctrl_c_stops_ends_with_130() {
    use std::process::{Command, Stdio};
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let run = format!("run servo-b-tuned --set test.duration_s=20 --port {}", rig.port());
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder.path()).args(run.split_whitespace());
    let mut program = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it runs");
    let status = || transcript(folder.path(), &format!("device --port {} status", rig.port()));
    while !status().contains("running") {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let interrupt = format!("kill -INT {}", program.id());
    assert!(Command::new("sh").args(["-c", &interrupt]).status().expect("a shell").success());
    assert_eq!(program.wait().expect("it was started").code(), Some(130));
    assert!(status().starts_with("mode        fault stop"), "{}", status());
}
