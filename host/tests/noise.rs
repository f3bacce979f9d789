//! The sensor noise of a virtual rig: new in every run, and repeatable.

mod program;

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use pneudrive::target::TargetFile;
use program::{folder, ok};

/// Fifty samples of a drive that stands still.
const TEST: &str = "servo-b-tuned --set test.moves=[[0.0,8192]] --set test.duration_s=0.065";

/// `pneudrive virtual` as a user starts it.
struct Served {
    program: Child,
    port: String,
    terminal: BufReader<std::process::ChildStdout>,
}

impl Served {
    fn start(arguments: &str) -> Served {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pneudrive"));
        command.args(arguments.split_whitespace()).stdout(Stdio::piped());
        let mut program = command.spawn().expect("the program runs");
        let mut terminal = BufReader::new(program.stdout.take().expect("a pipe"));
        let mut line = String::new();
        terminal.read_line(&mut line).expect("a line");
        let port = line.trim().rsplit(' ').next().expect("a port").to_owned();
        Served { program, port, terminal }
    }

    /// What stands on its terminal up to a line with `last`.
    fn said_until(&mut self, last: &str) -> String {
        let mut said = String::new();
        while !said.contains(last) && self.terminal.read_line(&mut said).expect("a line") > 0 {}
        said
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// The pressures that two runs in a row have recorded.
fn two_runs(folder: &Path, port: &str) -> [Vec<i16>; 2] {
    [(); 2].map(|()| {
        ok(folder, &format!("run {TEST} --port {port}"));
        let printed = ok(folder, &format!("record --port {port}"));
        ok(folder, &format!("device --port {port} disarm"));
        let name = printed.split_whitespace().find(|word| word.contains("TARGET")).expect("a file");
        let file = TargetFile::read(&folder.join(name.trim_end_matches(':'))).expect("a record");
        file.samples.iter().map(|(_, sample)| sample.pressure_1).collect()
    })
}

#[test]
fn every_run_has_its_own_noise_and_a_seed_repeats_the_sequence() {
    let folder = folder();
    let noisy = "virtual servo-b-tuned --listen tcp:127.0.0.1:0 --fast --set sensors.noise_counts=2 --seed 5";
    let mut rig = Served::start(noisy);
    let [first, second] = two_runs(folder.path(), &rig.port);
    assert_ne!(first, second, "the same noise in every run is averaged away by no number of runs");
    let said = rig.said_until("run 2");
    assert!(said.contains("--seed 5") && said.contains("run 1"), "{said}");
    let info = ok(folder.path(), &format!("device --port {} info", rig.port));
    assert!(info.contains("virtual rig, seed 5"), "{info}");
    let again = Served::start(noisy);
    assert_eq!(two_runs(folder.path(), &again.port), [first, second]);
}

#[test]
fn runs_without_noise_are_equal() {
    let folder = folder();
    let rig = Served::start("virtual servo-b-tuned --listen tcp:127.0.0.1:0 --fast");
    let [first, second] = two_runs(folder.path(), &rig.port);
    assert_eq!(first, second);
}
