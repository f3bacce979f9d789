//! Writes the table of docs/reference/firmware-figures.md anew; `cargo xtask figures` calls it.

#[cfg(unix)]
fn main() -> anyhow::Result<()> {
    pneudrive_hil_tests::cost::write_the_table()
}

#[cfg(not(unix))]
fn main() {
    eprintln!("the emulated board needs a Unix system");
    std::process::exit(1);
}
