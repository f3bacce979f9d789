//! The `pneudrive` program on the emulated board's UART, as a user types it.
#![cfg(unix)]

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout, Command, Stdio};

use pneudrive_hil_tests::emulated_board::EmulatedBoard;
use pneudrive_hil_tests::shell::Shell;
use pneudrive_hil_tests::{board_server, image};
use pneudrive_sim::Rig;

#[test]
fn an_emulated_board_is_put_into_service_run_recorded_and_overlaid_from_the_command_line() {
    let rig = Rig::builtin("servo-b-tuned").expect("a built-in rig");
    let image = image().expect("an image");
    let board = EmulatedBoard::start(&rig, image, 0).unwrap_or_else(|error| panic!("no board: {error:#}"));
    let shell = Shell::at(board.port()).expect("the program is built");
    let port = board.port();

    assert!(shell.device("info").contains("board       QEMU mps2-an386\n"));
    let status = shell.device("status");
    assert!(status.starts_with("mode        disarmed\nreferenced  yes\n"), "{status}");
    assert!(status.contains("position    98.714 mm\n"), "{status}");
    let _ = shell.device("config import servo-b-tuned");
    assert_eq!(shell.device("config get velocity_gain"), "velocity_gain = 2000\n");
    assert!(shell.device("reference 8192").starts_with("referenced"));

    let run = "servo-b-tuned --set test.duration_s=0.4";
    let printed = shell.says(&format!("run {run} --port {port} --stream run.csv"));
    assert!(printed.contains("run.csv: 308 samples, none missing\nservo-b-tuned: done\n"), "{printed}");
    let printed = shell.says(&format!("monitor --port {port} --every 0.01 --count 2 --csv values.csv"));
    assert!(printed.starts_with("done ") && shell.has("values.csv"), "{printed}");
    assert!(shell.device("status").starts_with("mode        done, holding\n"));
    assert!(shell.says(&format!("record --port {port}")).contains("TARGET01.DAT: 308 samples"));
    let _ = shell.says(&format!("simulate {run} --out sim"));
    let printed = shell.says("overlay TARGET01.DAT sim --out page.html");
    assert!(shell.has("page.html"));
    let position = printed.lines().find(|line| line.starts_with("position")).expect("a row");
    let figures: Vec<f64> = position.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    assert!(figures[3] <= 0.01206, "the rig is its model: within a count of the encoder: {position}");
    assert!(shell.device("disarm").starts_with("disarmed"));
    board.stop().expect("the plant ran to the end");
}

/// The program that serves the emulated board, with what it has yet to say.
struct Served(Child, BufReader<ChildStdout>);

impl Served {
    fn start(rig: &str) -> Served {
        let mut server = Command::new(board_server().expect("the program is built"));
        let served = server.args([rig, "127.0.0.1:0"]).stdout(Stdio::piped()).spawn();
        let mut child = served.expect("it starts");
        let said = BufReader::new(child.stdout.take().expect("a pipe"));
        Served(child, said)
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.1.read_line(&mut line).expect("a line");
        line
    }

    /// Its last words, after Ctrl-C.
    fn interrupt(&mut self) -> String {
        let sent = Command::new("kill").args(["-INT", &self.0.id().to_string()]).status().expect("kill");
        assert!(sent.success() && self.0.wait().expect("it ends").success());
        let mut rest = String::new();
        self.1.read_to_string(&mut rest).expect("text");
        rest
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        // One that has ended is not there any more.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn an_emulated_board_that_is_served_records_what_is_simulated_until_ctrl_c() {
    let mut served = Served::start("press");
    let line = served.line();
    let port = line.split([' ', ',']).find(|word| word.starts_with("tcp://")).expect("a port");
    let shell = Shell::at(port).expect("the program is built");
    assert!(shell.device("info").contains("board       QEMU mps2-an386\n"));
    assert!(shell.says(&format!("run press --port {port}")).contains("press: done\n"));
    let _ = shell.says(&format!("record --port {port}"));
    assert!(shell.says("replay TARGET01.DAT").contains("every command as recorded"));
    let _ = shell.says("simulate press --out twin --ensemble 1 --no-report");
    let printed = shell.says("overlay TARGET01.DAT twin");
    let commands = printed.lines().find(|line| line.starts_with("command")).expect("a row");
    let mut figures = commands.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
    assert!(figures.all(|figure| figure == 0.0), "the record is the simulation: {printed}");
    assert!(served.interrupt().contains("instructions"));
}
