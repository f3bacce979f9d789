//! Standard output or standard error that breaks: no command panics, and a drive that moves is stopped.
#![cfg(target_os = "linux")]

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use pneudrive_rigs::virtual_rig::Background;

use crate::program::{folder, ok, transcript, unhurried_rig, virtual_rig};

/// What becomes of a stream.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fate {
    /// Somebody reads it.
    Read,
    /// A pipe whose reader has gone.
    Gone,
    /// A disk that is full.
    Full,
}

impl Fate {
    fn stdio(self) -> Stdio {
        match self {
            Fate::Read => Stdio::piped(),
            Fate::Gone => std::io::pipe().expect("a pipe").1.into(),
            Fate::Full => File::options().write(true).open("/dev/full").expect("a full device").into(),
        }
    }
}

fn start(folder: &Path, arguments: &str, [output, errors]: [Fate; 2]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
    command.current_dir(folder).args(arguments.split_whitespace()).env_remove("RUST_BACKTRACE");
    command.stdout(output.stdio()).stderr(errors.stdio()).spawn().expect("the program runs")
}

fn run(folder: &Path, arguments: &str, fates: [Fate; 2]) -> (i32, Output) {
    let output = start(folder, arguments, fates).wait_with_output().expect("it was started");
    (output.status.code().unwrap_or_else(|| panic!("{arguments}: killed by a signal")), output)
}

/// Every command that needs no rig at a port, with the file that it leaves if it leaves one.
const COMMANDS: [(&str, &str); 20] = [
    ("--help", ""),
    ("help simulate", ""),
    ("--version", ""),
    ("rig list", ""),
    ("rig show servo-b", ""),
    ("rig check servo-b", ""),
    ("rig explain", ""),
    ("simulate servo-b --set test.duration_s=0.05 --ensemble 2 --out made", "made/run.json"),
    ("eval run --out made.html", "made.html"),
    ("overlay run run --out made.html", "made.html"),
    ("spectrum run position --out made.html", "made.html"),
    ("replay TARGET01.DAT", ""),
    ("characterise servo-b flow-gain --out made", "made/flow-gain.csv"),
    ("study list", ""),
    ("study impulse --starts 1 --out made", "made/impulse.html"),
    ("thesis --only 7.1.5 --out made", "made/thesis.html"),
    ("ladder servo-b --set test.duration_s=0.02 --ensemble 1 --out made", "made/ladder.html"),
    ("sweep s.toml --out made", "made/sweep.csv"),
    ("tune servo-b-tuned --generations 0 --draws 1 --out made", "made/tuned.toml"),
    ("identify servo-b --timer TARGET01.DAT", ""),
];

const SWEEP: &str = "rig = \"servo-b\"\n[set]\ntest.moves = [[0.0, 10000]]\ntest.duration_s = 0.1\n[vary]\nload.mass_kg = [1, 2]\n[metrics]\nair = \"air_l\"\n";

/// A folder with what the commands read.
fn prepared() -> tempfile::TempDir {
    let (folder, rig) = (folder(), virtual_rig("servo-b-tuned"));
    std::fs::write(folder.path().join("s.toml"), SWEEP).expect("written");
    ok(folder.path(), "simulate servo-b --set test.duration_s=0.1 --ensemble 1 --no-report --out run");
    ok(folder.path(), &format!("run servo-b-tuned --set test.duration_s=0.1 --port {}", rig.port()));
    ok(folder.path(), &format!("record --port {}", rig.port()));
    folder
}

#[test]
fn no_command_breaks_down_with_its_output_and_each_leaves_its_files() {
    let prepared = prepared();
    for (arguments, file) in COMMANDS {
        for (fates, code) in [([Fate::Gone, Fate::Read], 141), ([Fate::Full, Fate::Read], 8)] {
            let (ended, output) = run(prepared.path(), arguments, fates);
            let printed = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(ended, code, "{arguments}, {fates:?}: {printed}");
            assert!(!printed.contains("panicked"), "{arguments}: {printed}");
            let told = printed.contains("error: cannot write to standard output: No space left");
            assert_eq!(told, fates[0] == Fate::Full, "{arguments}: {printed}");
            let made = prepared.path().join(file);
            assert!(file.is_empty() || made.is_file(), "{arguments}, {fates:?}: {file} is not there");
            let _ = std::fs::remove_file(prepared.path().join("made.html"));
            let _ = std::fs::remove_dir_all(prepared.path().join("made"));
        }
    }
}

/// Commands that have something to say on standard error.
#[test]
fn an_error_that_cannot_be_told_ends_with_its_code_all_the_same() {
    let folder = folder();
    for (arguments, code) in [("rig show nonsense", 3), ("fly", 2), ("replay nothing.DAT", 3)] {
        for fate in [Fate::Gone, Fate::Full] {
            assert_eq!(run(folder.path(), arguments, [Fate::Read, fate]).0, code, "{arguments}, {fate:?}");
            assert_eq!(run(folder.path(), arguments, [fate, fate]).0, code, "{arguments}, both {fate:?}");
        }
    }
    let simulate = "simulate servo-b --set test.duration_s=0.02 --no-report --out run";
    let (code, output) = run(folder.path(), simulate, [Fate::Read, Fate::Full]);
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        code == 8 && printed.contains("error: cannot write to standard error: No space left"),
        "{printed}"
    );
    assert_eq!(run(folder.path(), simulate, [Fate::Read, Fate::Gone]).0, 141);
}

fn mode(rig: &Background, folder: &Path) -> String {
    let printed = transcript(folder, &format!("device --port {} status", rig.port()));
    printed.lines().next().unwrap_or_default().trim_start_matches("mode").trim().to_owned()
}

fn wait_until_it_runs(rig: &Background, folder: &Path) {
    let begun = Instant::now();
    while !mode(rig, folder).starts_with("running") {
        assert!(begun.elapsed() < Duration::from_secs(30), "it does not run: {}", mode(rig, folder));
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Once a panic left the drive moving, until it missed its host half a second later.
#[test]
fn a_drive_is_stopped_as_soon_as_nobody_reads_what_the_program_says() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let test = "--set test.duration_s=60";
    let arguments = format!("run servo-b-tuned {test} --port {}", rig.port());
    for output_goes in [true, false] {
        ok(folder.path(), &format!("device --port {} arm", rig.port()));
        let mut program = start(folder.path(), &arguments, [Fate::Read, Fate::Read]);
        wait_until_it_runs(&rig, folder.path());
        // One reader goes; the other one stays.
        let (output, errors) = (program.stdout.take(), program.stderr.take());
        let kept = if output_goes {
            drop(output);
            errors.map(Stdio::from)
        } else {
            drop(errors);
            output.map(Stdio::from)
        };
        let code = program.wait().expect("it was started").code();
        assert_eq!(code, Some(141));
        assert_eq!(mode(&rig, folder.path()), "fault stop: a stop was requested");
        drop(kept);
    }
}

#[test]
fn a_drive_is_stopped_where_its_progress_cannot_be_written() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let arguments = format!("run servo-b-tuned --set test.duration_s=4 --port {}", rig.port());
    let full = |arguments: &str| {
        let begun = Instant::now();
        let (code, output) = run(folder.path(), arguments, [Fate::Read, Fate::Full]);
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(code == 8 && printed.contains("cannot write to standard error"), "{code}: {printed}");
        assert!(begun.elapsed() < Duration::from_secs(3), "it was not run to its end");
        mode(&rig, folder.path())
    };
    // The first that is told is the progress of the run.
    assert_eq!(full(&arguments), "fault stop: a stop was requested");
    for action in ["arm", "disarm"] {
        ok(folder.path(), &format!("device --port {} {action}", rig.port()));
    }
    // Another host's parameters are told before the start: nothing has moved.
    ok(folder.path(), &format!("device --port {} config set velocity_gain 1999", rig.port()));
    assert_eq!(full(&arguments), "disarmed");
    // Likewise while what the test wants from before its start is recorded.
    assert_eq!(full(&format!("{arguments} --set test.pre_trigger=60")), "disarmed");
}

/// The signal that a file at its limit sends once killed the program.
#[test]
fn a_drive_is_stopped_when_the_file_of_its_stream_cannot_grow() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let run = format!("run servo-b-tuned --set test.duration_s=20 --stream run.csv --port {}", rig.port());
    let program = env!("CARGO_BIN_EXE_pneudrive");
    let mut shell = Command::new("bash");
    // In KiB: a second or so.
    shell.current_dir(folder.path()).args(["-c", &format!("ulimit -f 32; exec {program} {run}")]);
    let output = shell.output().expect("a shell");
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(printed.contains("cannot write run.csv: File too large"), "{printed}");
    assert_eq!(output.status.code(), Some(8), "{printed}");
    assert_eq!(mode(&rig, folder.path()), "fault stop: a stop was requested");
}

#[test]
fn a_run_until_stopped_disarms_the_drive_when_nobody_reads_it_any_more() {
    let (folder, rig) = (folder(), unhurried_rig("servo-b-tuned"));
    let arguments = format!("run servo-b-tuned --until-stopped --stream run.csv --port {}", rig.port());
    let mut program = start(folder.path(), &arguments, [Fate::Read, Fate::Read]);
    wait_until_it_runs(&rig, folder.path());
    drop(program.stdout.take());
    assert_eq!(program.wait().expect("it was started").code(), Some(141));
    assert_eq!(mode(&rig, folder.path()), "disarmed");
    let mut printed = String::new();
    program.stderr.take().expect("read").read_to_string(&mut printed).expect("UTF-8");
    assert!(
        printed
            .contains("error: the run was ended and the drive disarmed because the output of this program"),
        "{printed}"
    );
    let text = std::fs::read_to_string(folder.path().join("run.csv")).expect("written");
    assert!(text.contains("\n# samples = "), "the stream has its end");
}

#[test]
fn who_looks_on_ends_when_nobody_reads_it_and_a_rig_stays() {
    let (folder, rig) = (folder(), virtual_rig("servo-b"));
    let monitor = format!("monitor --every 0.01 --port {}", rig.port());
    assert_eq!(run(folder.path(), &monitor, [Fate::Gone, Fate::Read]).0, 141);
    assert_eq!(run(folder.path(), &monitor, [Fate::Full, Fate::Read]).0, 8);
    let unheard = "virtual servo-b --listen tcp:127.0.0.1:0";
    let (code, output) = run(folder.path(), unheard, [Fate::Full, Fate::Read]);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(code == 8 && printed.contains("the port of the rig cannot be printed"), "{printed}");
}
