//! Changes one rounding in a copy of the sources and shows how the equality test fails; `cargo xtask
//! prove-rounding` calls it.

#[cfg(unix)]
fn main() -> anyhow::Result<()> {
    let message = pneudrive_hil_tests::rounding::prove()?;
    println!("with one rounding changed in the image, the test fails as it must:\n{message}");
    Ok(())
}

#[cfg(not(unix))]
fn main() {
    eprintln!("the emulated board needs a Unix system");
    std::process::exit(1);
}
