//! Replaces golden hashes that have changed; `cargo xtask bless` calls it.

fn main() -> anyhow::Result<()> {
    let cause = std::env::args().nth(1).unwrap_or_default();
    let changed = pneudrive_hil_tests::golden::bless(&cause)?;
    println!("{} golden hashes replaced: {}", changed.len(), changed.join(", "));
    Ok(())
}
