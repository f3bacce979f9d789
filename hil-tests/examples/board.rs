//! Runs the test bodies on a real board; `cargo xtask hil` calls it. Arguments choose bodies whose names have
//! one of them in it.

#[cfg(unix)]
fn main() -> std::process::ExitCode {
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::process::ExitCode;

    use pneudrive_hil_tests::board::BoardBench;

    let bench = match BoardBench::from_environment() {
        Ok(bench) => bench,
        Err(error) => {
            eprintln!("error: {error:#}");
            return ExitCode::from(2);
        }
    };
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|part| name.contains(part.as_str()));
    let (mut passed, mut failed) = (0, 0);
    for (name, body) in bench.bodies().into_iter().filter(|(name, _)| is_wanted(name)) {
        let is_good = catch_unwind(AssertUnwindSafe(body)).is_ok();
        println!("{name} ... {}", if is_good { "ok" } else { "FAILED" });
        *(if is_good { &mut passed } else { &mut failed }) += 1;
    }
    println!("board: {passed} passed, {failed} failed");
    // Nothing done is nothing proved.
    if failed == 0 && passed > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

#[cfg(not(unix))]
fn main() {
    eprintln!("the runner for a board needs a Unix system");
    std::process::exit(1);
}
