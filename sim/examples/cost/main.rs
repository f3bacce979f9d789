//! What runs cost. Without an argument the table tests/counts/work.md is written anew; with the name of a rig
//! that one is run and nothing else, for valgrind to count:
//!
//! ```text
//! cargo run --release -p pneudrive-sim --example cost
//! valgrind --tool=callgrind target/release/examples/cost servo-b
//! ```

mod table;

use std::process::ExitCode;

fn main() -> ExitCode {
    let written = match std::env::args().nth(1) {
        Some(name) => table::rig(&name).map(|rig| println!("{}", table::row(&name, &rig))),
        None => write_page(),
    };
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

fn write_page() -> Result<(), String> {
    let old = std::fs::read_to_string(table::PAGE).map_err(|error| format!("{}: {error}", table::PAGE))?;
    let new = table::replaced(&old, &table::rows()?).ok_or("tests/counts/work.md has lost its table")?;
    std::fs::write(table::PAGE, new).map_err(|error| format!("{}: {error}", table::PAGE))
}
