//! The `pneudrive` program on the emulated board's UART, as a user types it.
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::Command;

use pneudrive::emulated_board::EmulatedBoard;
use pneudrive_hil_tests::{image, program};
use pneudrive_sim::Rig;

struct Shell {
    program: PathBuf,
    folder: tempfile::TempDir,
    port: String,
}

impl Shell {
    /// What the program prints; it must end well.
    fn says(&self, arguments: &str) -> String {
        let mut command = Command::new(&self.program);
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        let output = command.output().expect("the program runs");
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "pneudrive {arguments}: {said}{errors}");
        said
    }

    fn device(&self, action: &str) -> String {
        self.says(&format!("device --port {} {action}", self.port))
    }

    fn has(&self, name: &str) -> bool {
        Path::new(self.folder.path()).join(name).is_file()
    }
}

#[test]
fn an_emulated_board_is_put_into_service_run_recorded_and_overlaid_from_the_command_line() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let image = image().expect("an image");
    let board = EmulatedBoard::start(&rig, image, 0).unwrap_or_else(|error| panic!("no board: {error:#}"));
    let shell = Shell {
        program: program().expect("the program is built"),
        folder: tempfile::tempdir().expect("a folder"),
        port: board.port().to_owned(),
    };
    let port = board.port();

    assert!(shell.device("info").contains("board       QEMU mps2-an386\n"));
    let status = shell.device("status");
    assert!(status.starts_with("mode        disarmed\nreferenced  yes\n"), "{status}");
    assert!(status.contains("position    8192 counts\n"), "{status}");
    shell.device("config import servo-b-tuned");
    assert_eq!(shell.device("config get velocity_gain"), "velocity_gain = 2000\n");
    assert!(shell.device("reference 8192").starts_with("referenced"));

    let run = "servo-b-tuned --set test.duration_s=0.4";
    let said = shell.says(&format!("run {run} --port {port} --stream run.csv"));
    assert!(said.contains("run.csv: 308 samples, none missing\nservo-b-tuned: done\n"), "{said}");
    let said = shell.says(&format!("monitor --port {port} --every 0.01 --count 2 --csv values.csv"));
    assert!(said.starts_with("done ") && shell.has("values.csv"), "{said}");
    assert!(shell.device("status").starts_with("mode        done, holding\n"));
    assert!(shell.says(&format!("record --port {port}")).contains("TARGET01.DAT: 308 samples"));
    shell.says(&format!("simulate {run} --out sim"));
    let said = shell.says("overlay TARGET01.DAT sim --out page.html");
    assert!(shell.has("page.html"));
    let position = said.lines().find(|line| line.starts_with("position")).expect("a row");
    let figures: Vec<f64> = position.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    assert!(figures[3] <= 0.01206, "the rig is its model: within a count of the encoder: {position}");
    assert!(shell.device("disarm").starts_with("disarmed"));
    board.stop().expect("the plant ran to the end");
}
