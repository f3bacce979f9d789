//! The `pneudrive` program on the emulated board's UART, as a user types it.
#![cfg(unix)]

use pneudrive_hil_tests::emulated_board::EmulatedBoard;
use pneudrive_hil_tests::image;
use pneudrive_hil_tests::shell::Shell;
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
